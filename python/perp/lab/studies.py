# SPDX-License-Identifier: Apache-2.0
"""perp-compare facets: what friction by polygons of K facets costs. perp-compare ball: the path of a ball by polygons.
perp-compare forces: the forces of a solution in their friction disks.

Errors of a polygon's solution (r, u), free of units: natural and velocity are of the angle between friction and the
nearest corner, up to pi / K; cone and slip of the gap between polygon and disk, 1 - cos(pi / K).
"""

import argparse
import math
import os
import sys
from statistics import linear_regression, median

import numpy as np

from .campaign import INTERRUPTED, SOLVED, UNSOLVED, Program, add_options, count, print_table
from .contact import run_contact, seconds
from .files import InputError, NotSeen, number, pretty, write_files
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


def picture(path):
    """So that no problem is written over by a slip."""
    if not path.endswith(".svg"):
        raise argparse.ArgumentTypeError(f"'{path}': the name of a picture ends in .svg")
    return path


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
    for p in (p for p in problems if not p["exact_solved"]):
        print(f"{p['problem']}: no exact solution to compare with (Siconos' metric {number(p['siconos']):.2g})")


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
    add("--svg", type=picture, metavar="FILE.svg", help="draw the errors over K")
    add("--json", metavar="FILE", help="write the study as JSON")
    words = parser.parse_args(arguments)
    if len(set(words.problems)) < len(words.problems):
        raise InputError("a problem is there twice")
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

PHASE = 5  # s, for which the load keeps a direction


def ball_svg(loads, words):
    """A panel for each load, seen from above, and a closer one where some paths make the others small."""
    from .report import figure, line_style, svg_of

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
            axes.plot(xs, ys, label=f"{name}: {rest}", **style)
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
    how = f"a load from 60, 180 and -60 degrees in turn, {PHASE} s each, {words.cycles:g} cycles, mu = {words.mu:g}"
    ring = "ring: the start, at rest; drift: mean velocity over the last cycle, 0 by Coulomb's law"
    made.suptitle(f"Ball on a plane, seen from above: {how}\n{ring}", fontsize=10.5)
    return svg_of(made, inline=False)


def corners_of(K, outer, turn):
    """Of the polygon in the unit disk, the first at `turn`; or around it, the first facet's normal there."""
    radius, first = (1 / math.cos(math.pi / K), turn + math.pi / K) if outer else (1, turn)
    angles = [first + 2 * math.pi * k / K for k in range(K)]
    return [(radius * math.cos(angle), radius * math.sin(angle)) for angle in angles]


def nearest(point, corners):
    """The point of the unit disk, or of a polygon, that is nearest to a point."""
    if corners is None:
        return point / max(1, np.hypot(*point))
    corners = np.array(corners)
    edges, offsets = np.roll(corners, -1, 0) - corners, point - corners
    if (edges[:, 0] * offsets[:, 1] >= edges[:, 1] * offsets[:, 0]).all():
        return point
    along = np.clip((edges * offsets).sum(1) / (edges**2).sum(1), 0, 1)
    near = corners + along[:, None] * edges
    return near[np.hypot(*(near - point).T).argmin()]


def ball_path(load, corners, words, gravity=9.81):
    """(t, x, y) by the midpoint rule, and the drift: the mean velocity over the last cycle.

    The contact has r_N = m g h and W_T = 1 / m: r_T is the projection of -m u_free on mu r_N times the disk or polygon.
    Velocities are in mu g h here, until the end."""
    x, u, step, path = np.zeros(2), np.zeros(2), words.step, [(0, 0, 0)]
    scale = words.mu * gravity * step * step
    for k in range(round(3 * PHASE * words.cycles / step)):
        angle = math.radians((60, 180, -60)[int((k + 0.5) * step / PHASE) % 3])
        push = load * np.array([math.cos(angle), math.sin(angle)])
        push = push + nearest(-(u + push), corners)
        x, u = x + u + push / 2, u + push
        path.append(((k + 1) * step, *(scale * x).tolist()))
    back = path[max(0, len(path) - 1 - round(3 * PHASE / step))]
    span = max(path[-1][0] - back[0], step)
    return path, [(path[-1][i] - back[i]) / span for i in (1, 2)]


def ball(arguments, _):
    words = "The path of a ball on a plane under a load from 60, 180 and -60 degrees in turn (lecture 3 by Acary), "
    words += "by Coulomb's law and by polygons."
    parser = argparse.ArgumentParser(prog="perp-compare ball", description=words)
    add, loads = parser.add_argument, lambda text: [real(0)(word) for word in text.split(",")]
    add("--facets", type=facet_numbers, default=[4, 6, 8, 16], metavar="K,K,...", help="friction polygons (4,6,8,16)")
    add("--outer", action="store_true", help="polygons around the friction disk, not inside it")
    add("--mu", type=real(0), default=0.3, help="coefficient of friction (%(default)s)")
    add("--frame", type=real(-math.inf), default=0, help="turn the contact's tangents by so many degrees")
    add("--cycles", type=real(1e-9), default=4, help=f"cycles of three loads of {PHASE} s each (%(default)s)")
    add("--step", type=real(1e-9), default=0.01, help="time step [s] (%(default)s)")
    add("--load", type=loads, default=[1, 1.5], metavar="L,L,...", help="loads over mu m g (1,1.5)")
    add("--svg", type=picture, metavar="FILE.svg", help="draw the paths, seen from above")
    given = parser.parse_args(arguments)
    if 3 * PHASE * given.cycles > 1e6 * given.step or given.step > PHASE:
        raise InputError(f"--step: at most {PHASE} s, and at most 1e6 steps in all")
    side, turn = "outer" if given.outer else "inner", math.radians(given.frame)
    laws = {"exact": None} | {f"{side}:{K}": corners_of(K, given.outer, turn) for K in given.facets}
    scenes = []
    for load in given.load:
        paths, rows, end = [], [], None
        for law, corners in laws.items():
            path, drift = ball_path(load, corners, given)
            paths.append({"law": law, "drift": drift, "path": path[:: 1 + len(path) // 1000] + path[-1:]})
            end = end or path[-1][1:]  # by Coulomb's law, which is the first
            far = f"{math.dist(path[-1][1:], end):.3f}"
            rows.append([law, *(f"{round(v, 3) + 0.0:.3f}" for v in path[-1][1:]), far, f"{math.hypot(*drift):.4f}"])
        scenes.append({"load": load, "paths": paths})
        print(f"Load {load:g} mu m g")
        print_table(["law", ">end x [m]", ">y [m]", ">from exact [m]", ">drift [m/s]"], rows)
    if given.svg:
        write_file(given.svg, ball_svg(scenes, given))
    return SOLVED


def real(least):
    def check(text):
        value = float(text)
        if not (math.isfinite(value) and value >= least):
            raise argparse.ArgumentTypeError(f"{text}: a number, at least {least:g}, is asked for")
        return value

    check.__name__ = "number"
    return check


# Forces.

STATES = {"stick": ("#0072B2", "o"), "slip": ("#D55E00", "D"), "open": ("#767676", "x")}
MOST = 3000  # contacts that are drawn


def forces_svg(answer):
    """The friction disk (2D: interval) of each contact, all of one size, with r_T, a tick along -u_T, a bar of r_N."""
    from matplotlib.collections import EllipseCollection, LineCollection

    from .report import figure, svg_of

    contacts = sorted(answer["contacts"], key=lambda c: -number(c["r"][0]))[:MOST]
    contacts.sort(key=lambda c: c["contact"])
    across = max(1, math.ceil(math.sqrt(1.5 * len(contacts))))
    down = max(1, math.ceil(len(contacts) / across))
    made, axes = figure("forces", 11, 1.5 + min(60, 10 * down / across))
    side, _, K = answer["formulation"].partition(":")
    polygon = corners_of(int(K), side == "outer", answer["rotation"] or 0) if K and answer["dimension"] == 3 else []
    largest = max([LEAST, *(number(c["r"][0]) for c in contacts)])
    lines = {"#bbbbbb": [], "#333333": []}
    for name, (colour, marker) in STATES.items():
        rims, points, lines[colour] = [], [], []
        for k, c in enumerate(contacts):
            if c["state"] != name:
                continue
            x, y = 3 * (k % across), -3 * (k // across)
            r_N, *r_T = map(number, c["r"])
            u_T = [*map(number, c["u"][1:]), 0.0][:2]
            radius = number(c["mu"]) * max(r_N, 0)
            fx, fy = ([v / radius for v in [*r_T, 0.0][:2]]) if radius > 0 and name != "open" else (0.0, 0.0)
            shown = min(1, 1.4 / max(LEAST, math.hypot(fx, fy)))  # of a force out of its cone
            points.append((x + shown * fx, y + shown * fy))
            lines[colour] += [((x, y), points[-1]), ((x + 1.4, y - 1), (x + 1.4, y - 1 + 2 * max(r_N, 0) / largest))]
            if (size := math.hypot(*u_T)) > 0 and name == "slip":
                lines["#333333"].append([(x - s * u_T[0] / size, y - s * u_T[1] / size) for s in (1.05, 1.35)])
            if answer["dimension"] == 2:
                lines[colour].append(((x - 1, y), (x + 1, y)))
            else:
                rims.append((x, y))
            if polygon:
                lines["#bbbbbb"].append([(x + px, y + py) for px, py in polygon + polygon[:1]])
            if len(contacts) <= 200:
                axes.text(x - 1.2, y + 0.95, str(c["contact"]), fontsize=7, color="#555555")
        if rims:
            rim = {"edgecolors": colour, "facecolors": "none", "linewidths": 1.6 if name == "slip" else 0.8}
            axes.add_collection(EllipseCollection(2, 2, 0, units="xy", offsets=rims, transOffset=axes.transData, **rim))
        xs, ys = zip(*points) if points else ((), ())
        axes.plot(xs, ys, linestyle="", marker=marker, markersize=3.5, color=colour, label=f"{name}: {len(points)}")
    for colour, segments in lines.items():
        axes.add_collection(LineCollection(segments, colors=colour, linewidths=1))
    axes.set(xlim=(-2, 3 * across), ylim=(1 - 3 * down, 2), aspect="equal")
    axes.axis("off")
    axes.legend(loc="upper left", bbox_to_anchor=(0, 0), ncols=3, frameon=False)
    solved = "" if answer["status"] == "Solved" else f"NOT SOLVED ({answer['status']}), "
    some, all_of_them = count(len(contacts), "contact"), len(answer["contacts"])
    if len(contacts) < all_of_them:
        some += f" of {all_of_them}, those of the largest r_N"
    key = "r_T / (mu r_N) in the friction disk; bar: r_N; tick: -u_T"
    made.suptitle(f"{answer['problem']} by {answer['variant']}: {solved}{some}\n{key}", fontsize=11)
    return svg_of(made, inline=False)


def forces(arguments, interrupt):
    words = "Draws the forces of a solution in their friction disks. Other flags are those of 'perp contact --help'."
    usage = "%(prog)s PROBLEM --svg FILE [FLAG OF perp contact]..."
    parser = argparse.ArgumentParser(prog="perp-compare forces", usage=usage, description=words)
    parser.add_argument("problem", metavar="PROBLEM", help="a file of FCLIB or Siconos, or NAME:SIZE[:SEED[:MU]]")
    parser.add_argument("--svg", required=True, type=picture, metavar="FILE.svg", help="the picture")
    parser.add_argument("--time-limit", type=float, default=30.0, metavar="SECONDS", help="of the solution (30)")
    parser.add_argument("--tol", type=float, default=1e-8, help="of the solution (1e-8)")
    parser.add_argument("--program", metavar="FILE", help="the program perp")
    given, others = parser.parse_known_args(arguments)
    limits = given.tol, given.time_limit, 1 << 20
    end, answer, command = run_contact(Program(given.program), [given.problem, *others], *limits, interrupt)
    if answer is None or "contacts" not in answer:
        raise InputError(f"{command}: {answer['message'] if answer else end.words()}")
    write_file(given.svg, forces_svg(answer))
    states = ", ".join(f"{n} {name}" for name, n in answer["states"].items())
    print(f"{answer['status']}: {states}; {given.svg}")
    return SOLVED if answer["status"] == "Solved" else UNSOLVED
