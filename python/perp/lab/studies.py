# SPDX-License-Identifier: Apache-2.0
"""perp-compare facets: what friction by polygons of K facets costs. perp-compare ball: the path of a ball by polygons.

Errors of a polygon's solution (r, u), free of units: natural and velocity are of the angle between friction and the
nearest corner, up to pi / K; cone and slip of the gap between polygon and disk, 1 - cos(pi / K).
"""

import argparse
import json
import math
import os
import subprocess
import sys
from statistics import linear_regression, median

from .campaign import INTERRUPTED, SOLVED, UNSOLVED, Program, add_options, count, note, print_table
from .contact import run_contact, seconds
from .files import InputError, NotSeen, check_apart, number, pretty, write_files
from .process import run_all

ERRORS = {
    "natural": ("Natural map of Coulomb's law", "natural map of Coulomb's law, free of units"),
    "velocity": ("Velocity", "|u - u_exact| / |q|"),
    "cone": ("Force outside of the friction cone", "(|r_T| - mu r_N) / max r_N"),
    "slip": ("Missing dissipation", "missing dissipation over max r_N times max |q|"),
}
SIDES = {
    "inner": {"label": "in the disk (inner:K)", "color": "#0072B2", "linestyle": "-", "marker": "o"},
    "outer": {"label": "around the disk (outer:K)", "color": "#D55E00", "linestyle": "--", "marker": "s"},
}
POSITIONS = (1 / 12, 5 / 12, 9 / 12)  # of the angle between two corners; in one position a corner may lie well by luck
ROUNDING = 1e-12  # errors below are rounding
EXACT_TOL, EXACT_ENOUGH = 1e-9, 1e-8  # asked for; what a solution is by all metrics
LEAST = sys.float_info.min


def facet_numbers(text):
    try:
        values = [int(word) for word in text.split(",")]
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"{text}: {error}; a list is like 4,6,8") from error
    for value in values:
        if not 3 <= value <= 1000 or values.count(value) > 1:
            raise argparse.ArgumentTypeError(f"{text}: {value} is not in [3, 1000], or stands there twice")
    return sorted(values)


def write_file(path, text):
    folder, name = os.path.split(os.path.abspath(path))
    write_files(folder, {name: text})


class Facets:
    """A campaign over K: each problem by the exact law, then by both polygons of each K in three positions."""

    def __init__(self, words, program, interrupt):
        self.words, self.program, self.interrupt, self.problems, self.runs = words, program, interrupt, [], []

    def solve(self, problem, tol, *flags):
        limits = self.words.time_limit, 1 << 20
        end, answer, command = run_contact(self.program, [problem, *flags], tol, *limits, self.interrupt)
        if answer is None or "stats" not in answer:
            raise NotSeen(f"{command}: {answer['message'] if answer else end.words()}")
        return answer

    def work(self, label):
        exact = self.solve(label, min(EXACT_TOL, self.words.tol))
        residual, contacts = exact["residual"], exact["contacts"]
        shares = ("siconos", "rr9118", "cone_share", "normal_share", "slip_share")
        solved = all(number(residual[name]) <= EXACT_ENOUGH for name in shares)
        slipping, dimension = exact["states"]["slip"], exact["dimension"]
        problem = {"problem": label, "dimension": dimension, "contacts": len(contacts), "slipping": slipping}
        counts = solved and slipping > 0 and dimension == 3  # else polygons have no error
        self.problems.append({**problem, "exact_solved": solved, "siconos": residual["siconos"], "counts": counts})
        if solved and not counts:
            note(f"{label}: nothing slips, or it is plane: polygons have no error there; Ctrl-C ends the study")
        for side in SIDES:
            for K in self.words.facets:
                for position in POSITIONS:
                    turn = position * 2 * math.pi / K
                    flags = ("--formulation", f"{side}:{K}", "--form", self.words.form, "--rotation", repr(turn))
                    answer = self.solve(label, self.words.tol, *flags)
                    run = {"problem": label, "polygon": side, "facets": K, "rotation": turn}
                    run |= {"status": answer["status"], "own_residual": answer["own_residual"]}
                    run |= {"unknowns": answer["unknowns"] or 0, "time_s": answer["stats"]["time_s"]}
                    self.runs.append({**run, "errors": errors_of(answer, contacts if solved else None)})

    def lines(self):
        found, counting = [], {p["problem"] for p in self.problems if p["counts"]}
        for side in SIDES:
            for K in self.words.facets:
                runs = [r for r in self.runs if (r["polygon"], r["facets"]) == (side, K)]
                solved = [r for r in runs if r["status"] == "Solved"]
                errors = [r["errors"] for r in solved if r["problem"] in counting]
                medians = {e: median([of[e] for of in errors]) if errors else None for e in ERRORS}
                own = max((number(r["own_residual"]) for r in solved), default=None)
                facts = {"polygon": side, "facets": K, "runs": len(runs), "solved": len(solved), "own_residual": own}
                found.append({**facts, "slowest_s": max((r["time_s"] for r in runs), default=0.0), "medians": medians})
        return found


def errors_of(answer, exact):
    """`exact`: the contacts of the exact law; None if that was not solved."""
    q, residual, velocity = answer["free_velocity"], {k: number(v) for k, v in answer["residual"].items()}, None
    r_N = max([LEAST, *(number(c["r"][0]) for c in answer["contacts"])])
    if exact:
        pairs = [pair for a, b in zip(answer["contacts"], exact) for pair in zip(a["u"], b["u"])]
        velocity = math.hypot(*(number(v) - number(w) for v, w in pairs)) / max(LEAST, number(q["norm"]))
    slip = residual["slip"] / (r_N * max(LEAST, number(q["largest"])))
    return {"natural": residual["scaled"], "velocity": velocity, "cone": residual["cone"] / r_N, "slip": slip}


def points_of(lines, side, error):
    """(K, median error) above rounding."""
    points = [(x["facets"], x["medians"][error] or 0) for x in lines if x["polygon"] == side]
    return [(K, value) for K, value in points if value >= ROUNDING]


def power(lines, side, error):
    """p of the least-squares fit c K^p; None of fewer than two points."""
    points = [(math.log(K), math.log(v)) for K, v in points_of(lines, side, error)]
    return linear_regression(*zip(*points)).slope if len(points) > 1 else None


def print_facets(study, lines, powers):
    problems = study.problems
    slips, sizes = sum(p["counts"] for p in problems), [p["contacts"] for p in problems]
    exact = sum(p["exact_solved"] for p in problems)
    which = f"{count(len(problems), 'problem')} of {min(sizes)} to {max(sizes)} contacts"
    print(f"{which}, {exact} of them solved by the exact law; in {slips} something slips")
    what = "own residual: the largest of the solved; errors: medians over problems in which something slips"
    print(f"Polygons of K facets in {len(POSITIONS)} positions; {what}\n")
    rows = []
    for line in lines:
        errors = ["-" if v is None else "0" if v < ROUNDING else f"{v:.3g}" for v in line["medians"].values()]
        own = "-" if line["own_residual"] is None else f"{line['own_residual']:.2g}"
        solved = f"{line['solved']}/{line['runs']}"
        rows.append([line["polygon"], str(line["facets"]), solved, own, *errors, seconds(line["slowest_s"])])
    for side, of in powers.items():
        rows.append([side, "fit", "", "", *("-" if p is None else f"K^{p:.2f}" for p in of.values()), ""])
    print_table(["polygon", ">K", ">solved", ">own residual", *(f">{e}" for e in ERRORS), ">slowest"], rows)
    for name, (_, words) in ERRORS.items():
        print(f"  {name:9} {words}")
    if not slips:
        print("Nothing slips (or all is plane): polygons have no error here.")
    for p in problems:
        if not p["exact_solved"]:
            print(f"{p['problem']}: no exact solution to compare with (Siconos' metric {number(p['siconos']):.2g})")
    for r in study.runs:
        if r["status"] != "Solved":
            residual = number(r["own_residual"])
            print(f"{r['problem']}, {r['polygon']}:{r['facets']}: {r['status']}, natural residual {residual:.2g}")


def facets_svg(study, lines, powers):
    """A panel for each error, doubly logarithmic, all of one scale, with guides that fall like 1/K and 1/K^2."""
    from .report import figure, grid_and_ticks, svg_of

    made, panels = figure("facets", 11, 8.2, (2, 2))
    K, medians = study.words.facets, [x["medians"][e] or 0 for x in lines for e in ERRORS]
    top, least = max(medians) or 1, min((v for v in medians if v >= ROUNDING), default=0.1)
    for axes, (error, titles) in zip(panels.flat, ERRORS.items()):
        for side, style in SIDES.items():
            points, p = points_of(lines, side, error), powers[side][error]
            falls = f"falls like K^{p:.2f}" if p is not None else "" if points else "0, to rounding"
            axes.plot(*(zip(*points) if points else ((), ())), **{**style, "label": f"{style['label']}: {falls}"})
        for slope, label in ((1, "c / K"), (2, "c / K ^ 2")):
            axes.plot(K, [1.6 * top * (K[0] / k) ** slope for k in K], color="#8a8a8a", linestyle=":", label=label)
        heights = (least * (least / top) ** 0.7, 2 * top)  # with room for the legend
        axes.set(xscale="log", yscale="log", title="\n".join(titles), xlabel="facets K", ylim=heights)
        axes.set_xticks(K)
        grid_and_ticks(axes, share="")
        axes.legend(fontsize=8.5, loc="lower left")
    slips = sum(p["counts"] for p in study.problems)
    title = "Polygons of K facets in place of the friction disk: errors by Coulomb's exact law\n"
    title += f"{count(len(study.problems), 'problem')}, in {slips} of them something slips; "
    made.suptitle(title + "medians over those and three positions of each polygon", fontsize=11)
    return svg_of(made, inline=False)


def facets(arguments, interrupt):
    parser = argparse.ArgumentParser(prog="perp-compare facets", description=__doc__.splitlines()[0])
    add, problems = parser.add_argument, "files of FCLIB or Siconos, or NAME:SIZE[:SEED[:MU]]"
    add("problems", nargs="+", metavar="PROBLEM", help=problems)
    add("--facets", required=True, type=facet_numbers, metavar="K,K,...", help="numbers of facets, from 3")
    forms = "an LCP, or an MLCP with r_T free (%(default)s)"
    add("--form", choices=("reduced", "mixed"), default="reduced", help=forms)
    tol = "tolerance on the natural residual of the affine problems"
    limits = ("--time-limit", 30.0, "limit of each run"), ("--jobs", 1, "number of problems at a time")
    add_options(parser, ("--tol", 1e-9, tol), *limits)
    add("--svg", metavar="FILE", help="draw the errors over K")
    add("--json", metavar="FILE", help="write the study as JSON")
    words = parser.parse_args(arguments)
    if len(set(words.problems)) < len(words.problems):
        raise InputError("a problem is there twice")
    check_apart([path for path in (words.svg, words.json) if path], words.problems)
    program = Program(words.program)
    program.json("contact", *words.problems, "--variants", "inner:3", "--json", "-")  # refuses what cannot be read
    study = Facets(words, program, interrupt)
    run_all(words.jobs, study.work, words.problems, interrupt)
    if interrupt():
        return INTERRUPTED
    lines = study.lines()
    powers = {side: {error: power(lines, side, error) for error in ERRORS} for side in SIDES}
    print_facets(study, lines, powers)
    complete = all(p["exact_solved"] for p in study.problems) and all(r["status"] == "Solved" for r in study.runs)
    code = SOLVED if complete else UNSOLVED
    head = {"program": "perp", "version": program.version(), "schema": "perp/contact-facets/1"}
    facts = {"exit_code": code, "form": words.form, "tol": words.tol, "lines": lines, "powers": powers}
    if words.svg:
        write_file(words.svg, facets_svg(study, lines, powers))
    if words.json:
        write_file(words.json, pretty({**head, **facts, "problems": study.problems, "runs": study.runs}))
    return code


# The ball.


def ball_svg(answer):
    """A panel for each load, seen from above, and a closer one where some paths make the others small."""
    from .report import figure, line_style, svg_of

    loads = answer["loads"]
    made, panels = figure("ball", 11, 0.8 + 4.4 * len(loads), (len(loads), 2))
    for (axes, closer), scene in zip(panels.reshape(-1, 2), loads):
        sizes = [max(math.hypot(x, y) for _, x, y in path["path"]) for path in scene["paths"]]
        near = max((a for a, b in zip(sorted(sizes), sorted(sizes)[1:]) if a > 1e-2 and b > 2.2 * a), default=None)
        for k, (path, size) in enumerate(zip(scene["paths"], sizes)):
            style, name = {**line_style(k + 3 * (k > 1)), "marker": ""}, f"{path['law'].partition(':')[2]} facets"
            if path["law"] == "exact":
                style, name = {"color": "#000000", "linewidth": 4, "zorder": 1}, "Coulomb's law"
            rest = "stays at rest" if size < 1e-3 else f"drift {math.hypot(*path['drift']):.3f} m/s"
            _, xs, ys = zip(*path["path"])
            axes.plot(xs, ys, label=f"{name}: {rest}" + ("" if path["solved"] else ", UNSOLVED"), **style)
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
    how = f"a load from 60, 180 and -60 degrees in turn, {answer['phase']:g} s each, "
    how += f"{count(int(answer['cycles']), 'cycle')}, mu = {answer['mu']:g}"
    ring = "ring: the start, at rest; drift: mean velocity over the last cycle, 0 by Coulomb's law"
    made.suptitle(f"Ball on a plane, seen from above: {how}\n{ring}", fontsize=10.5)
    return svg_of(made, inline=False)


def ball(arguments, _):
    words = "Draws the paths that 'perp contact ball' computes. Other flags are those of 'perp contact ball --help'."
    parser = argparse.ArgumentParser(prog="perp-compare ball", description=words)
    parser.add_argument("--svg", required=True, metavar="FILE", help="draw the paths, seen from above")
    parser.add_argument("--program", metavar="FILE", help="the program perp")
    given, others = parser.parse_known_args(arguments)
    command = [Program(given.program).path, "contact", "ball", *others, "--json", "-"]
    run = subprocess.run(command, stdout=subprocess.PIPE, check=False)
    if run.returncode in (0, 1):
        write_file(given.svg, ball_svg(json.loads(run.stdout)))
    return run.returncode
