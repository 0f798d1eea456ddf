# SPDX-License-Identifier: Apache-2.0
"""perp-compare facets: what friction by polygons of K facets costs. perp-compare ball: the path of a ball by polygons.

Errors of a polygon's solution (r, u), free of units: natural and velocity are of the angle between friction and the
nearest corner, up to pi / K; cone and slip of the gap between polygon and disk, 1 - cos(pi / K).
"""

import argparse
import math
from statistics import linear_regression, median

import numpy as np

from .campaign import INTERRUPTED, SOLVED, UNSOLVED, Program, add_options, between, count, print_table
from .cells import answer_of
from .contact import EXACT, PROBLEM, ContactRunner
from .files import InputError, NotSeen, number, pretty, write_file
from .forces import LEAST, corners_of, picture
from .process import run_all

ERRORS = {
    "natural": "natural map of Coulomb's law, free of units",
    "velocity": "|u - u_exact| / |q|",
    "cone": "(|r_T| - mu r_N) / max r_N",
    "slip": "missing dissipation over max r_N times max |q|",
}
SIDES = {"inner": "in the disk (inner:K)", "outer": "around the disk (outer:K)"}
POSITIONS = (1 / 12, 5 / 12, 9 / 12)  # of the angle between two corners; in one position a corner may lie well by luck
ROUNDING = 1e-12  # errors below are rounding
EXACT_TOL, EXACT_ENOUGH = 1e-9, 1e-8  # asked for; what a solution is by all metrics


def list_of(kind):
    def check(text):
        return sorted({kind(word) for word in text.split(",")})

    check.__name__ = "list"
    return check


def solve(runner, problem, tol, *flags):
    end, command = runner.contact(problem, flags, tol)
    answer = answer_of(end, command)
    if answer is None or "stats" not in answer:
        raise NotSeen(f"{command}: {answer['message'] if answer else end.words()}")
    return answer


def study(runner, problem, words):
    """(facts of the problem by the exact law, the runs of both polygons of each K in each position)."""
    exact, runs = solve(runner, problem, min(EXACT_TOL, words.tol)), []
    solved = all(number(exact["residual"][name]) <= EXACT_ENOUGH for name in EXACT)
    facts = {"problem": problem, "dimension": exact["dimension"], "contacts": len(exact["contacts"])}
    facts |= {"slipping": exact["states"]["slip"], "exact_solved": solved, "siconos": exact["residual"]["siconos"]}
    facts["counts"] = solved and facts["slipping"] > 0 and facts["dimension"] == 3  # else polygons have no error
    for side, K, position in ((side, K, position) for side in SIDES for K in words.facets for position in POSITIONS):
        turn = position * 2 * math.pi / K
        flags = ("--formulation", f"{side}:{K}", "--form", words.form, "--rotation", repr(turn))
        answer = solve(runner, problem, words.tol, *flags)
        run = {"problem": problem, "polygon": side, "facets": K, "rotation": turn, "unknowns": answer["unknowns"] or 0}
        run |= {"time_s": answer["stats"]["time_s"], "errors": errors_of(answer, exact if solved else None)}
        runs.append({**run, **{key: answer[key] for key in ("status", "own_residual")}})
    return facts, runs


def errors_of(answer, exact):
    residual, q = answer["residual"], {key: max(LEAST, number(v)) for key, v in answer["free_velocity"].items()}
    r_N, velocity = max([LEAST, *(number(c["r"][0]) for c in answer["contacts"])]), None
    if exact:
        u, u_exact = (np.array([[*map(number, c["u"])] for c in of["contacts"]]) for of in (answer, exact))
        velocity = float(np.linalg.norm(u - u_exact)) / q["norm"]
    cone, slip = number(residual["cone"]) / r_N, number(residual["slip"]) / (r_N * q["largest"])
    return {"natural": number(residual["scaled"]), "velocity": velocity, "cone": cone, "slip": slip}


def line_of(side, K, runs, counting):
    """What the runs of a polygon have in common; `counting`: the problems whose errors count."""
    runs = [run for run in runs if (run["polygon"], run["facets"]) == (side, K)]
    solved = [run for run in runs if run["status"] == "Solved"]
    errors = [run["errors"] for run in solved if run["problem"] in counting]
    medians = {name: median(of[name] for of in errors) if errors else None for name in ERRORS}
    own = max((number(run["own_residual"]) for run in solved), default=None)
    facts = {"polygon": side, "facets": K, "runs": len(runs), "solved": len(solved), "own_residual": own}
    return {**facts, "slowest_s": max(run["time_s"] for run in runs), "medians": medians}


def curve(lines, side, error):
    """([(K, median error) above rounding], p of the least-squares fit c K^p or None of fewer than two points)."""
    points = [(line["facets"], line["medians"][error] or 0) for line in lines if line["polygon"] == side]
    points = [(K, value) for K, value in points if value >= ROUNDING]
    return points, linear_regression(*np.log(points).T.tolist()).slope if len(points) > 1 else None


def print_facets(problems, lines, powers):
    slips, exact = (sum(p[key] for p in problems) for key in ("counts", "exact_solved"))
    print(f"{count(len(problems), 'problem')}, {exact} solved by the exact law; in {slips} something slips")
    print(f"Polygons in {len(POSITIONS)} positions; errors: medians over problems in which something slips\n")
    rows = []
    for line in lines:
        errors = ["-" if v is None else "0" if v < ROUNDING else f"{v:.3g}" for v in line["medians"].values()]
        own = "-" if line["own_residual"] is None else f"{line['own_residual']:.2g}"
        solved, slowest = f"{line['solved']}/{line['runs']}", f"{line['slowest_s']:.3f}"
        rows.append([line["polygon"], str(line["facets"]), solved, own, *errors, slowest])
    for side, of in powers.items():
        rows.append([side, "fit", "", "", *("-" if p is None else f"K^{p:.2f}" for p in of.values()), ""])
    print_table(["polygon", ">K", ">solved", ">own residual", *(f">{e}" for e in ERRORS), ">slowest [s]"], rows)
    print("".join(f"\n  {name:9} {words}" for name, words in ERRORS.items()))
    for p in (p for p in problems if not p["exact_solved"]):
        print(f"{p['problem']}: no exact solution to compare with (Siconos' metric {number(p['siconos']):.2g})")


def facets_svg(lines, title):
    """A panel for each error, doubly logarithmic, all of one scale, with guides that fall like 1/K and 1/K^2."""
    from .report import figure, line_style, svg_of

    made, panels = figure("facets", 11, 8.2, (2, 2))
    K = sorted({line["facets"] for line in lines})
    medians = [value or 0 for line in lines for value in line["medians"].values()]
    top, least = max(medians) or 1, min((v for v in medians if v >= ROUNDING), default=0.1)
    for axes, (error, words) in zip(panels.flat, ERRORS.items()):
        for k, (side, where) in enumerate(SIDES.items()):
            points, p = curve(lines, side, error)
            falls = f"falls like K^{p:.2f}" if p is not None else "" if points else "0, to rounding"
            axes.plot(*np.reshape(points, (-1, 2)).T, label=f"{where}: {falls}", **line_style(k))
        for slope, label in ((1, "c / K"), (2, "c / K ^ 2")):
            axes.plot(K, [1.6 * top * (K[0] / k) ** slope for k in K], color="#8a8a8a", linestyle=":", label=label)
        heights = (least * (least / top) ** 0.7, 2 * top)  # with room for the legend
        axes.set(xscale="log", yscale="log", title=f"{error}: {words}", xlabel="facets K", ylim=heights)
        axes.set_xticks(K, K)
        axes.set_xticks([], minor=True)
        axes.grid(color="#e2e2e2")
        axes.legend(fontsize=8.5, loc="lower left")
    made.suptitle(title, fontsize=11)
    return svg_of(made, inline=False)


def facets(arguments, interrupt):
    parser = argparse.ArgumentParser(prog="perp-compare facets", description=__doc__.partition(" perp-")[0])
    add, forms = parser.add_argument, "an LCP, or an MLCP with r_T free (%(default)s)"
    add("problems", nargs="+", metavar="PROBLEM", help=PROBLEM)
    K = list_of(between(3, 1000, int))
    add("--facets", required=True, type=K, metavar="K,K,...", help="numbers of facets, from 3")
    add("--form", choices=("reduced", "mixed"), default="reduced", help=forms)
    add_options(parser, tol=1e-9, time_limit=30.0, jobs=1)
    add("--svg", type=picture, metavar="FILE.svg", help="draw the errors over K")
    add("--json", metavar="FILE", help="write the study as JSON")
    words = parser.parse_args(arguments)
    program, found = Program(words.program), dict.fromkeys(words.problems)
    program.json("contact", *found, "--variants", "inner:3", "--json", "-")  # refuses what cannot be read
    runner = ContactRunner({"time_limit": words.time_limit, "memory_limit_mb": 1 << 20}, program, "", interrupt)
    run_all(words.jobs, lambda one: found.update({one: study(runner, one, words)}), list(found), interrupt)
    if interrupt():
        return INTERRUPTED
    problems, runs = [facts for facts, _ in found.values()], [run for _, runs in found.values() for run in runs]
    counting = {p["problem"] for p in problems if p["counts"]}
    lines = [line_of(side, K, runs, counting) for side in SIDES for K in words.facets]
    powers = {side: {error: curve(lines, side, error)[1] for error in ERRORS} for side in SIDES}
    print_facets(problems, lines, powers)
    complete = all(p["exact_solved"] for p in problems) and all(line["solved"] == line["runs"] for line in lines)
    code = SOLVED if complete else UNSOLVED
    if words.svg:
        title = "Polygons of K facets in place of the friction disk: errors by Coulomb's exact law\n"
        title += f"{count(len(problems), 'problem')}, in {len(counting)} of them something slips; "
        write_file(words.svg, facets_svg(lines, title + "medians over those and three positions of each polygon"))
    if words.json:
        version = program.json("methods", "--json")["version"]
        head = {"program": "perp", "version": version, "schema": "perp/contact-facets/1", "exit_code": code}
        facts = {"form": words.form, "tol": words.tol, "lines": lines, "powers": powers}
        write_file(words.json, pretty({**head, **facts, "problems": problems, "runs": runs}))
    return code


# The ball.

PHASE = 5  # s, for which the load keeps a direction


def nearest(point, corners):
    """The point of the unit disk, or of a polygon, that is nearest to a point."""
    if corners is None:
        return point / max(1, np.hypot(*point))
    edges, offsets = np.roll(corners, -1, 0) - corners, point - corners
    if (edges[:, 0] * offsets[:, 1] >= edges[:, 1] * offsets[:, 0]).all():
        return point
    along = np.clip((edges * offsets).sum(1) / (edges**2).sum(1), 0, 1)
    near = corners + along[:, None] * edges
    return near[np.hypot(*(near - point).T).argmin()]


def ball_path(load, corners, words, gravity=9.81):
    """Positions after each step of the midpoint rule, and the drift: the mean velocity over the last cycle.

    The contact has r_N = m g h and W_T = 1 / m: r_T is the projection of -m u_free on mu r_N times the disk or polygon.
    Velocities are in mu g h here, until the end."""
    x, u, step, path = np.zeros(2), np.zeros(2), words.step, [np.zeros(2)]
    for k in range(round(3 * PHASE * words.cycles / step)):
        angle = math.radians((60, 180, -60)[int((k + 0.5) * step / PHASE) % 3])
        push = load * np.array([math.cos(angle), math.sin(angle)])
        push = push + nearest(-(u + push), corners)
        x, u = x + u + push / 2, u + push
        path.append(x)
    path = words.mu * gravity * step**2 * np.array(path)
    cycle = min(len(path) - 1, round(3 * PHASE / step))
    return path, (path[-1] - path[-1 - cycle]) / (max(1, cycle) * step)


def ball_svg(scenes, title):
    """For each load its paths, seen from above, and without the longest, which may make the others small."""
    from .report import figure, line_style, svg_of

    made, panels = figure("ball", 11, 0.8 + 4.4 * len(scenes), (len(scenes), 2))
    for (axes, closer), (load, paths) in zip(panels.reshape(-1, 2), scenes.items()):
        sizes = [np.abs(path).max() for path, _ in paths.values()]
        for k, (law, (path, drift)) in enumerate(paths.items()):
            style = {**line_style(k), "marker": "", "linewidth": 1.7 if k else 4}
            rest = "stays at rest" if sizes[k] < 1e-3 else f"drift {math.hypot(*drift):.3f} m/s"
            for panel in (axes, closer) if sizes[k] < max(sizes) else (axes,):
                panel.plot(*path[:: 1 + len(path) // 1000].T, label=f"{law}: {rest}", **style)
        for panel in (axes, closer):
            panel.plot(0, 0, marker="o", color="white", markeredgecolor="black", zorder=5)
            panel.set_aspect("equal", adjustable="datalim")
            panel.set(xlabel="x [m]", ylabel="y [m]")
            panel.grid(color="#e2e2e2")
        axes.set_title(f"Load {load:g} mu m g")
        axes.legend(fontsize=8.5, loc="best")
        closer.set_title("Without the longest path")
    made.suptitle(title, fontsize=10.5)
    return svg_of(made, inline=False)


def ball(arguments):
    words = "The path of a ball on a plane under a load from 60, 180 and -60 degrees in turn (lecture 3 by Acary), "
    parser = argparse.ArgumentParser(prog="perp-compare ball", description=words + "by Coulomb's law and by polygons.")
    add, K, steps = parser.add_argument, list_of(between(3, 1000, int)), f"time step [s], at most {PHASE} (%(default)s)"
    add("--facets", type=K, default=[4, 6, 8, 16], metavar="K,K,...", help="friction polygons (4,6,8,16)")
    add("--outer", action="store_true", help="polygons around the friction disk, not inside it")
    add("--mu", type=between(0, 1e6), default=0.3, help="coefficient of friction (%(default)s)")
    add("--frame", type=between(-360, 360), default=0, help="turn the contact's tangents by so many degrees")
    cycles = f"cycles of three loads of {PHASE} s each (%(default)s)"
    add("--cycles", type=between(1e-9, 1e6), default=4, help=cycles)
    add("--step", type=between(1e-9, PHASE), default=0.01, help=steps)
    loads = list_of(between(0, 1e6))
    add("--load", type=loads, default=[1, 1.5], metavar="L,L,...", help="loads over mu m g (1,1.5)")
    add("--svg", type=picture, metavar="FILE.svg", help="draw the paths, seen from above")
    given = parser.parse_args(arguments)
    if 3 * PHASE * given.cycles > 1e6 * given.step:
        raise InputError("--step: at most 1e6 steps in all")
    side, turn, scenes = "outer" if given.outer else "inner", math.radians(given.frame), {}
    laws = {"Coulomb's law": None} | {f"{side}:{K}": np.array(corners_of(K, given.outer, turn)) for K in given.facets}
    for load in given.load:
        paths = scenes[load] = {law: ball_path(load, corners, given) for law, corners in laws.items()}
        rows, exact = [], paths["Coulomb's law"][0][-1]
        for law, (path, drift) in paths.items():
            end = [*path[-1], math.dist(path[-1], exact)]
            rows.append([law, *(f"{round(v, 3) + 0.0:.3f}" for v in end), f"{math.hypot(*drift):.4f}"])
        print(f"Load {load:g} mu m g")
        print_table(["law", ">end x [m]", ">y [m]", ">from exact [m]", ">drift [m/s]"], rows)
    if given.svg:
        title = f"Ball on a plane, seen from above: a load from 60, 180 and -60 degrees in turn, {PHASE} s each, "
        title += f"{given.cycles:g} cycles, mu = {given.mu:g}\nring: the start, at rest; drift: mean velocity over the "
        write_file(given.svg, ball_svg(scenes, title + "last cycle, 0 by Coulomb's law"))
    return SOLVED
