# SPDX-License-Identifier: Apache-2.0
"""perp-compare facets: what friction by polygons of K facets costs. perp-compare ball: the path of a ball by polygons.

Errors of a polygon's solution (r, u), free of units: natural and velocity are of the angle between friction and the nearest
corner, up to pi / K; cone and slip of the gap between polygon and disk, 1 - cos(pi / K).
"""

import argparse
import json
import math
import os
import statistics
import subprocess
import sys

from .campaign import Environment, InputError, Program, check_apart, count, number, pretty, write_files
from .cells import answer_of
from .compare import SOLVED, UNSOLVED, table, within
from .contact import seconds
from .process import Pool, Request

ERRORS = {
    "natural": "natural map of Coulomb's law, free of units", "velocity": "|u - u_exact| / |q|",
    "cone": "(|r_T| - mu r_N) / max r_N", "slip": "missing dissipation over max r_N times max |q|",
}  # fmt: skip
TITLES = {"natural": "Natural map of Coulomb's law", "velocity": "Velocity", "cone": "Force outside of the friction cone", "slip": "Missing dissipation"}
POSITIONS = (1 / 12, 5 / 12, 9 / 12)  # of the angle between two corners; in one position a corner may lie well by luck
ROUNDING = 1e-12  # errors below are rounding
EXACT_TOL, EXACT_ENOUGH = 1e-9, 1e-8  # asked for; what a solution is by all metrics


def numbers(text, low, high, kind, flag):
    try:
        values = [kind(word) for word in text.split(",")]
    except ValueError as error:
        raise InputError(f"{flag} {text}: {error}; a list is like 4,6,8") from error
    for value in values:
        if not low <= value <= high or values.count(value) > 1:
            raise InputError(f"{flag} {text}: {value} is not in [{low}, {high}], or stands there twice")
    return sorted(values)


class Facets:
    def __init__(self, words):
        self.words, self.program, self.problems, self.runs = words, Program(words.program), [], []

    def perp(self, problem, tol, *flags):
        limit = self.words.time_limit
        words = ["contact", problem, *flags, "--tol", repr(tol), "--time-limit", repr(limit), "--log-level", "quiet", "--json", "-"]
        end = yield Request([self.program.path, *words], 2 * limit + 10, 2, 1 << 20)
        answer = answer_of(end)
        if answer is None or "stats" not in answer:
            raise Environment(f"perp {' '.join(words)}: {answer['message'] if answer else end.words()}")
        return answer

    def task(self, label):
        exact = yield from self.perp(label, min(EXACT_TOL, self.words.tol))
        residual, contacts = exact["residual"], exact["contacts"]
        shares = ("siconos", "rr9118", "cone_share", "normal_share", "slip_share")
        solved = all(number(residual[name]) <= EXACT_ENOUGH for name in shares)
        problem = {"problem": label, "dimension": exact["dimension"], "contacts": len(contacts), "slipping": exact["states"]["slip"]}
        counts = solved and problem["slipping"] > 0 and problem["dimension"] == 3  # else polygons have no error
        self.problems.append({**problem, "exact_solved": solved, "siconos": residual["siconos"], "counts": counts})
        for side in ("inner", "outer"):
            for K in self.words.facets:
                for position in POSITIONS:
                    turn = position * 2 * math.pi / K
                    flags = ("--formulation", f"{side}:{K}", "--form", self.words.form, "--rotation", repr(turn))
                    answer = yield from self.perp(label, self.words.tol, *flags)
                    self.runs.append({"counts": counts, **self.run(label, side, K, turn, answer, contacts if solved else None)})

    def run(self, label, side, K, turn, answer, exact):
        least, q, residual = sys.float_info.min, answer["free_velocity"], {k: number(v) for k, v in answer["residual"].items()}
        r_N = max([least, *(number(c["r"][0]) for c in answer["contacts"])])
        errors = {"natural": residual["scaled"], "velocity": None, "cone": residual["cone"] / r_N}
        if exact:
            pairs = (zip(a["u"], b["u"]) for a, b in zip(answer["contacts"], exact))
            errors["velocity"] = math.hypot(*(number(v) - number(w) for pair in pairs for v, w in pair)) / max(least, number(q["norm"]))
        errors["slip"] = residual["slip"] / (r_N * max(least, number(q["largest"])))
        facts = {"status": answer["status"], "own_residual": answer["own_residual"], "unknowns": answer["unknowns"] or 0}
        return {"problem": label, "polygon": side, "facets": K, "rotation": turn, **facts, "time_s": answer["stats"]["time_s"], "errors": errors}

    def lines(self):
        found = []
        for side in ("inner", "outer"):
            for K in self.words.facets:
                runs = [r for r in self.runs if (r["polygon"], r["facets"]) == (side, K)]
                solved = [r for r in runs if r["status"] == "Solved"]
                medians = {e: median([r["errors"][e] for r in solved if r["counts"]]) for e in ERRORS}
                own = max((number(r["own_residual"]) for r in solved), default=None)
                facts = {"polygon": side, "facets": K, "runs": len(runs), "solved": len(solved), "own_residual": own}
                found.append({**facts, "slowest_s": max((r["time_s"] for r in runs), default=0.0), "medians": medians})
        return found


def median(values):
    values = [v for v in values if v is not None]
    return statistics.median(values) if values else None


def power(lines, side, error):
    """p of the least-squares fit c K^p to the medians above rounding; None of fewer than two."""
    points = [(math.log(x["facets"]), math.log(x["medians"][error])) for x in lines if x["polygon"] == side and (x["medians"][error] or 0) >= ROUNDING]
    return statistics.linear_regression(*zip(*points)).slope if len(points) > 1 else None


def print_facets(study, lines, powers):
    problems = study.problems
    slips, sizes = sum(p["counts"] for p in problems), [p["contacts"] for p in problems]
    print(f"{count(len(problems), 'problem')} of {min(sizes)} to {max(sizes)} contacts, {sum(p['exact_solved'] for p in problems)} of them solved by the exact law; in {slips} something slips")
    print(f"Polygons of K facets in {len(POSITIONS)} positions; own residual: the largest of the solved; errors: medians over problems in which something slips\n")
    rows = []
    for line in lines:
        errors = ["-" if v is None else "0" if v < ROUNDING else f"{v:.3g}" for v in line["medians"].values()]
        own = "-" if line["own_residual"] is None else f"{line['own_residual']:.2g}"
        rows.append([line["polygon"], str(line["facets"]), f"{line['solved']}/{line['runs']}", own, *errors, seconds(line["slowest_s"])])
    rows += [[side, "fit", "", "", *("-" if p is None else f"K^{p:.2f}" for p in of.values()), ""] for side, of in powers.items()]
    table(["polygon", ">K", ">solved", ">own residual", *(f">{e}" for e in ERRORS), ">slowest"], rows)
    for name, words in ERRORS.items():
        print(f"  {name:9} {words}")
    if not slips:
        print("Nothing slips (or all is plane): polygons have no error here.")
    for p in problems:
        if not p["exact_solved"]:
            print(f"{p['problem']}: no exact solution to compare with (Siconos' metric {number(p['siconos']):.2g})")
    for r in study.runs:
        if r["status"] != "Solved":
            print(f"{r['problem']}, {r['polygon']}:{r['facets']}: {r['status']}, natural residual {number(r['own_residual']):.2g}")


def facets_svg(study, lines, powers):
    """A panel for each error, doubly logarithmic, all of one scale, with guides that fall like 1/K and 1/K^2."""
    from .report import figure, plain_ticks, svg_of

    made, panels = figure("facets", 11, 8.2, (2, 2))
    top = max((x["medians"][e] or 0 for x in lines for e in ERRORS), default=1) or 1
    for axes, (error, title) in zip(panels.flat, TITLES.items()):
        for side, style in (("inner", ("#0072B2", "-", "o")), ("outer", ("#D55E00", "--", "s"))):
            points = [(x["facets"], x["medians"][error]) for x in lines if x["polygon"] == side and (x["medians"][error] or 0) >= ROUNDING]
            p, words = powers[side][error], "in the disk (inner:K)" if side == "inner" else "around the disk (outer:K)"
            label = f"{words}: {f'falls like K^{p:.2f}' if p is not None else '0, to rounding' if not points else ''}"
            axes.plot(*(zip(*points) if points else ([], [])), label=label, color=style[0], linestyle=style[1], marker=style[2])
        K = study.words.facets
        for slope in (1, 2):
            axes.plot(K, [1.6 * top * (K[0] / k) ** slope for k in K], color="#8a8a8a", linestyle=":", label="c / K" + (" ^ 2" if slope == 2 else ""))
        axes.set(xscale="log", yscale="log", title=f"{title}\n{ERRORS[error]}", xlabel="facets K")
        axes.set_xticks(K)
        plain_ticks(axes.xaxis)
        axes.grid(color="#ececec")
        axes.legend(fontsize=8.5)
    slips = sum(p["counts"] for p in study.problems)
    made.suptitle(f"Polygons of K facets in place of the friction disk: errors by Coulomb's exact law\n{count(len(study.problems), 'problem')}, in {slips} of them something slips; medians over those and three positions of each polygon", fontsize=11)
    return svg_of(made, inline=False)


def facets(arguments):
    parser = argparse.ArgumentParser(prog="perp-compare facets", description=__doc__.splitlines()[0])
    parser.add_argument("problems", nargs="+", metavar="PROBLEM", help="files of FCLIB or Siconos, or NAME:SIZE[:SEED[:MU]]")
    parser.add_argument("--facets", required=True, metavar="K,K,...", help="numbers of facets, from 3")
    parser.add_argument("--form", choices=("reduced", "mixed"), default="reduced", help="an LCP, or an MLCP with r_T free (reduced)")
    parser.add_argument("--tol", type=within(1e-15, 1), default=1e-9, help="on the natural residual of the affine problems (1e-9)")
    parser.add_argument("--time-limit", type=within(0.01, 1e6), default=30.0, metavar="SECONDS", help="limit of each run (30)")
    parser.add_argument("--jobs", type=within(1, 1024, int), default=1, metavar="N", help="number of problems at a time (1)")
    for flag, what in (("--svg", "draw the errors over K"), ("--json", "write the study as JSON"), ("--program", "the program perp")):
        parser.add_argument(flag, metavar="FILE", help=what)
    words = parser.parse_args(arguments)
    words.facets = numbers(words.facets, 3, 1000, int, "--facets")
    if len(set(words.problems)) < len(words.problems):
        raise InputError("a problem is there twice")
    check_apart([path for path in (words.svg, words.json) if path], words.problems)
    study = Facets(words)
    study.program.json("contact", *words.problems, "--variants", "inner:3", "--json", "-")  # refuses files that cannot be read
    Pool(words.jobs).run(map(study.task, words.problems))
    lines = study.lines()
    powers = {side: {error: power(lines, side, error) for error in ERRORS} for side in ("inner", "outer")}
    print_facets(study, lines, powers)
    complete = all(p["exact_solved"] for p in study.problems) and all(r["status"] == "Solved" for r in study.runs)
    code, files = SOLVED if complete else UNSOLVED, []
    if words.svg:
        files.append((words.svg, facets_svg(study, lines, powers)))
    if words.json:
        head = {"program": "perp", "version": study.program.json("methods", "--json")["version"], "schema": "perp/contact-facets/1"}
        runs = [{k: v for k, v in r.items() if k != "counts"} for r in study.runs]
        facts = {"exit_code": code, "form": words.form, "tol": words.tol, "lines": lines, "powers": powers}
        files.append((words.json, pretty({**head, **facts, "problems": study.problems, "runs": runs})))
    if files:
        write_files(files)
    return code


# The ball.


def ball_svg(answer):
    """A panel for each load, seen from above, and a closer one where some paths make the others small."""
    from .report import COLOURS, DASHES, figure, svg_of

    loads = answer["loads"]
    made, panels = figure("ball", 11, 0.8 + 4.4 * len(loads), (len(loads), 2))
    for (axes, closer), scene in zip(panels, loads):
        sizes = [max(math.hypot(x, y) for _, x, y in path["path"]) for path in scene["paths"]]
        jumps = [a for a, b in zip(sorted(sizes), sorted(sizes)[1:]) if a > 1e-2 and b > 2.2 * a]
        near = jumps[-1] if jumps else None
        for k, (path, size) in enumerate(zip(scene["paths"], sizes)):
            exact = path["law"] == "exact"
            name = "Coulomb's law" if exact else f"{path['law'].partition(':')[2]} facets"
            style = {"color": "#000000", "linewidth": 4, "zorder": 1} if exact else {"color": COLOURS[(k + 1) % 7 if (k + 1) % 7 != 2 else 6], "linestyle": DASHES[k % 4], "linewidth": 1.7}
            drift = math.hypot(*path["drift"])
            rest = "stays at rest" if size < 1e-3 else f"drift {drift:.3f} m/s"
            label = f"{name}: {rest}" + ("" if path["solved"] else ", UNSOLVED")
            _, xs, ys = zip(*path["path"])
            axes.plot(xs, ys, label=label, **style)
            if near is not None and size <= near:
                closer.plot(xs, ys, **style)
        for panel in (axes, closer):
            panel.plot(0, 0, marker="o", color="white", markeredgecolor="black", zorder=5)
            panel.set_aspect("equal", adjustable="datalim")
            panel.set(xlabel="x [m]", ylabel="y [m]")
            panel.grid(color="#e7e7e7")
        axes.set_title(f"Load {scene['load']:g} mu m g")
        axes.legend(fontsize=8.5, loc="best")
        closer.set_title("The small paths, closer")
        closer.set_visible(near is not None)
    cycles = count(int(answer["cycles"]), "cycle")
    made.suptitle(f"Ball on a plane, seen from above: a load from 60, 180 and -60 degrees in turn, {answer['phase']:g} s each, {cycles}, mu = {answer['mu']:g}\nring: the start, at rest; drift: mean velocity over the last cycle, 0 by Coulomb's law", fontsize=10.5)
    return svg_of(made, inline=False)


def ball(arguments):
    parser = argparse.ArgumentParser(prog="perp-compare ball", description="Draws the paths that 'perp contact ball' computes. Other flags are those of 'perp contact ball --help'.")
    parser.add_argument("--svg", required=True, metavar="FILE", help="draw the paths, seen from above")
    parser.add_argument("--program", metavar="FILE", help="the program perp")
    words, others = parser.parse_known_args(arguments)
    run = subprocess.run([Program(words.program).path, "contact", "ball", *others, "--json", "-"], stdout=subprocess.PIPE, check=False)
    if run.returncode not in (0, 1):
        return run.returncode
    write_files([(os.path.abspath(words.svg), ball_svg(json.loads(run.stdout)))])
    return run.returncode
