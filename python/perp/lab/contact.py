# SPDX-License-Identifier: Apache-2.0
"""Contact with friction. perp-compare contact: variants x problems, each cell a `perp contact` of its own. perp-compare
forces: a solution's forces in their friction disks. perp-compare facets: what friction by polygons of K facets costs.
perp-compare ball: the path of a ball by polygons.

A cell counts as solved by its variant's own law: glocker, coulomb and ncp1 by Coulomb's exact law, faceted and
frictionless variants by the law of their affine problem; what Coulomb's law says of them stands beside it.

Errors of a polygon's solution (r, u), free of units: natural and velocity are of the angle between friction and the
nearest corner, up to pi / K; cone and slip of the gap between polygon and disk, 1 - cos(pi / K).
"""

import argparse
import cmath
import itertools
import math
import os
import shlex
import sys
from statistics import linear_regression, median

import numpy as np

from .campaign import (
    INTERRUPTED, SOLVED, UNSOLVED, Program, add_folder, add_options, between, count, interrupts, print_table,
)  # fmt: skip
from .cells import FACTS, CellRunner, attempt_of, source_of
from .comparison import Comparison
from .files import InputError, NotSeen, number, pretty, write_file
from .lists import file_facts, method_of
from .process import run_all
from .report import figure, line_style, svg_of

DEFAULT = (
    "glocker+auto,glocker+homotopy,glocker+path/B,glocker+semismooth/B,glocker+smooth/B,inner:8,outer:8,frictionless"
)
PROBLEM = "a file of FCLIB or Siconos, or NAME:SIZE[:SEED[:MU]]"
READING = 10  # s, beside the solve's own limit twice: then a process counts as hanging
LEAST = sys.float_info.min
FACETS, LOADS = between(3, 1000, int, many=True), between(0, 1e6, many=True)
EXACT = ("siconos", "rr9118", "cone_share", "normal_share", "slip_share")  # what Coulomb's law asks to be small


def read_contact(answer):
    """Of a finished `perp contact`, whose judge has seen its point."""
    stats, residual = answer["stats"], answer["residual"]
    natural = max(number(residual[name]) for name in EXACT) if answer["exact"] else number(answer["own_residual"])
    steps = sum(stats.get(name, 0) for name in ("iterations", "newton_steps", "sweeps"))
    facts = {"contacts": len(answer["contacts"]), "solved_by": answer["solved_by"] or ""}
    facts |= {name: residual[name] for name in ("siconos", "rr9118")}
    return {"counts": (steps, None, None, None, None), "seconds": stats["time_s"], "natural": natural, "facts": facts}


class ContactRunner(CellRunner):
    def contact(self, source, flags, tol):
        """(its End, the command that repeats it) of a run of `perp contact`."""
        limit = self.campaign["time_limit"]
        words = ["contact", source, *flags, "--tol", repr(tol), "--time-limit", repr(limit)]
        end = self.run(self.program, *words, "--log-level", "quiet", "--json", "-", seconds=2 * limit + READING)
        return end, "perp " + shlex.join(words)

    def attempt(self, method, problem, start, restart):
        end, command = self.contact(source_of(problem), method["options"], self.campaign["tol"])
        made = attempt_of(end, f"{method['label']} on {problem['name']}", read_contact)
        if made.claim in ("solved", "failed") and made.seconds > self.campaign["time_limit"]:
            made.claim, made.message = "time-limit", f"{made.message} after {made.seconds:.3g} s, beyond the limit"
        made.facts = {**dict.fromkeys(FACTS), **made.facts, "command": command}
        return made


class ContactComparison(Comparison):
    COMMAND, RUNNER, KIND = "perp-compare contact", ContactRunner, {"contact": True}
    LISTS = ("problems", "variants")

    @classmethod
    def parser(cls):
        words = "Runs variants of formulation and method on problems of contact with friction, a process for each run."
        parser = argparse.ArgumentParser(prog=cls.COMMAND, description=words, allow_abbrev=False)
        variants = f"FORMULATION[+METHOD][/WORD]...; * as METHOD is every method, * as WORD every form ({DEFAULT})"
        parser.add_argument("problems", nargs="*", metavar="PROBLEM", help=PROBLEM)
        parser.add_argument("--variants", metavar="LIST", help=variants)
        add_options(parser, tol=1e-8, time_limit=30.0, memory_limit_mb=4096, jobs=1)
        parser.set_defaults(restarts=0, seed=1, starts=1)
        add_folder(parser, "contact-comparison")
        return parser

    def items(self):
        asked = self.words.problems
        if not asked:
            raise InputError("which problems? FILE..., or NAME:SIZE[:SEED[:MU]] of a generator")
        if len(set(asked)) < len(asked):
            raise InputError("a problem is there twice")
        unknown = {"n": None, "nonzeros": None, "affine": False, "starts": 1, "known_solutions": 0}
        problems = []
        for name in asked:
            of = {"name": name, "class": name.partition(":")[0], **unknown, "solvable": True, "no_solution": ""}
            problems.append({**of, **file_facts(name)} if os.path.isfile(name) else of)
        # Files are read once before anything runs: a misspelt name is no result.
        variants = self.program.json("contact", *asked, "--variants", self.words.variants or DEFAULT, "--json", "-")
        found = ((v["label"], v["flags"], {"exact": v["exact"]}) for v in variants["variants"])
        return [method_of(label, label, flags, **exact) for label, flags, exact in found], problems


# Studies.


def picture(path):
    """The name of a picture, so that no problem is written over by a slip."""
    if not path.endswith(".svg"):
        raise argparse.ArgumentTypeError(f"'{path}': the name of a picture ends in .svg")
    return path


# Forces.

STATES = {"stick": ("#0072B2", "o"), "slip": ("#D55E00", "D"), "open": ("#767676", "x")}


def corners_of(K, outer=False, turn=0):
    """Of the polygon in the unit disk, the first at `turn`; or around it, the first facet's normal there."""
    radius, first = (1 / math.cos(math.pi / K), turn + math.pi / K) if outer else (1, turn)
    angles = [first + 2 * math.pi * k / K for k in range(K)]
    return [(radius * math.cos(angle), radius * math.sin(angle)) for angle in angles]


def forces_svg(answer):
    """The friction disk (2D: interval) of each contact, all of one size, with r_T, a tick along -u_T, a bar of r_N."""
    from matplotlib.collections import LineCollection

    contacts, space = answer["contacts"], answer["dimension"] == 3
    across = max(1, math.ceil(math.sqrt(1.5 * len(contacts))))
    down = max(1, math.ceil(len(contacts) / across))
    made, axes = figure("forces", 11, 1.5 + min(60, 10 * down / across))
    side, _, K = answer["formulation"].partition(":")
    rim = corners_of(48) if space else [(-1, 0), (1, 0)]
    polygon = corners_of(int(K), side == "outer", answer["rotation"] or 0) if K and space else rim
    largest = max([LEAST, *(number(c["r"][0]) for c in contacts)])
    lines = {"#bbbbbb": [], "#333333": []}
    for name, (colour, marker) in STATES.items():
        points, lines[colour] = [], []
        for k, c in ((k, c) for k, c in enumerate(contacts) if c["state"] == name):
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
            for outline, corners in ((colour, rim), ("#bbbbbb", polygon)):
                lines[outline].append([(x + px, y + py) for px, py in corners + corners[:1]])
            if len(contacts) <= 200:
                axes.text(x - 1.2, y + 0.95, str(c["contact"]), fontsize=7, color="#555555")
        xs, ys = zip(*points) if points else ((), ())
        axes.plot(xs, ys, linestyle="", marker=marker, markersize=3.5, color=colour, label=f"{name}: {len(points)}")
    for colour, segments in lines.items():
        axes.add_collection(LineCollection(segments, colors=colour, linewidths=1))
    axes.set(xlim=(-2, 3 * across), ylim=(1 - 3 * down, 2), aspect="equal")
    axes.axis("off")
    axes.legend(loc="upper left", bbox_to_anchor=(0, 0), ncols=3, frameon=False)
    solved = "" if answer["status"] == "Solved" else f"NOT SOLVED ({answer['status']}), "
    title = f"{answer['problem']} by {answer['variant']}: {solved}{count(len(contacts), 'contact')}"
    made.suptitle(f"{title}\nr_T / (mu r_N) in the friction disk; bar: r_N; tick: -u_T", fontsize=11)
    return svg_of(made, inline=False)


def forces(arguments):
    words = "Draws the forces of a solution in their friction disks. Other flags are those of 'perp contact --help'."
    usage = "%(prog)s PROBLEM --svg FILE [FLAG OF perp contact]..."
    parser = argparse.ArgumentParser(prog="perp-compare forces", usage=usage, description=words)
    parser.add_argument("problem", metavar="PROBLEM", help=PROBLEM)
    parser.add_argument("--svg", required=True, type=picture, metavar="FILE.svg", help="the picture")
    add_options(parser)
    given, others = parser.parse_known_args(arguments)
    answer = Program(given.program).json("contact", given.problem, *others, "--log-level", "quiet", "--json", "-")
    if "contacts" not in answer:
        raise InputError(answer["message"])
    write_file(given.svg, forces_svg(answer))
    states = ", ".join(f"{n} {name}" for name, n in answer["states"].items())
    print(f"{answer['status']}: {states}; {given.svg}")
    return SOLVED if answer["status"] == "Solved" else UNSOLVED


# Facets.

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


def solve(runner, problem, tol, *flags):
    """The answer of a run that came to an end of its own."""
    end, command = runner.contact(problem, flags, tol)
    made = attempt_of(end, command, lambda answer: {"facts": answer})
    if not made.facts:
        raise NotSeen(f"{command}: {made.message}")
    return made.facts


def study(runner, problem, words):
    """(facts of the problem by the exact law, the runs of both polygons of each K in each position)."""
    exact, runs = solve(runner, problem, min(EXACT_TOL, words.tol)), []
    solved = all(number(exact["residual"][name]) <= EXACT_ENOUGH for name in EXACT)
    facts = {"problem": problem, "dimension": exact["dimension"], "contacts": len(exact["contacts"])}
    facts |= {"slipping": exact["states"]["slip"], "exact_solved": solved, "siconos": exact["residual"]["siconos"]}
    facts["counts"] = solved and facts["slipping"] > 0 and facts["dimension"] == 3  # else polygons have no error
    for side, K, position in itertools.product(SIDES, words.facets, POSITIONS):
        turn = position * 2 * math.pi / K
        flags = ("--formulation", f"{side}:{K}", "--form", words.form, "--rotation", repr(turn))
        answer = solve(runner, problem, words.tol, *flags)
        run = {"problem": problem, "polygon": side, "facets": K, "rotation": turn, "unknowns": answer["unknowns"] or 0}
        run |= {"time_s": answer["stats"]["time_s"], "status": answer["status"], "own_residual": answer["own_residual"]}
        residual, q = answer["residual"], {key: max(LEAST, number(v)) for key, v in answer["free_velocity"].items()}
        r_N = max([LEAST, *(number(c["r"][0]) for c in answer["contacts"])])
        u, u_exact = (np.array([[*map(number, c["u"])] for c in of["contacts"]]) for of in (answer, exact))
        velocity = float(np.linalg.norm(u - u_exact)) / q["norm"] if solved else None
        cone, slip = number(residual["cone"]) / r_N, number(residual["slip"]) / (r_N * q["largest"])
        errors = {"natural": number(residual["scaled"]), "velocity": velocity, "cone": cone, "slip": slip}
        runs.append({**run, "errors": errors})
    return facts, runs


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
    made, panels = figure("facets", 11, 8.2, (2, 2))
    K = sorted({line["facets"] for line in lines})
    medians = [value or 0 for line in lines for value in line["medians"].values()]
    top, least = max(medians) or 1, min((v for v in medians if v >= ROUNDING), default=0.1)
    heights = (least * (least / top) ** 0.7, 2 * top)  # with room for the legend
    for axes, (error, words) in zip(panels.flat, ERRORS.items()):
        for k, (side, where) in enumerate(SIDES.items()):
            points, p = curve(lines, side, error)
            falls = f"falls like K^{p:.2f}" if p is not None else "" if points else "0, to rounding"
            axes.plot(*np.reshape(points, (-1, 2)).T, label=f"{where}: {falls}", **line_style(k))
        for slope, label in ((1, "c / K"), (2, "c / K ^ 2")):
            axes.plot(K, [1.6 * top * (K[0] / k) ** slope for k in K], color="#8a8a8a", linestyle=":", label=label)
        axes.set(xscale="log", yscale="log", title=f"{error}: {words}", xlabel="facets K", ylim=heights)
        axes.set_xticks(K, K)
        axes.set_xticks([], minor=True)
        axes.legend(fontsize=8.5, loc="lower left")
    made.suptitle(title, fontsize=11)
    return svg_of(made, inline=False)


def facets(arguments):
    parser = argparse.ArgumentParser(prog="perp-compare facets", description="What polygons in place of disks cost.")
    add, forms = parser.add_argument, "an LCP, or an MLCP with r_T free (%(default)s)"
    add("problems", nargs="+", metavar="PROBLEM", help=PROBLEM)
    add("--facets", required=True, type=FACETS, metavar="K,K,...", help="numbers of facets, from 3")
    add("--form", choices=("reduced", "mixed"), default="reduced", help=forms)
    add_options(parser, tol=1e-9, time_limit=30.0, jobs=1)
    add("--svg", type=picture, metavar="FILE.svg", help="draw the errors over K")
    add("--json", metavar="FILE", help="write the study as JSON")
    words, interrupt = parser.parse_args(arguments), interrupts()
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


def nearest(point, law, turn):
    """The point of the unit disk, or of a polygon (K, is it around the disk?), nearest to a complex number."""
    if law is None:
        return point / max(1, abs(point))
    outer, half = law[1], math.pi / law[0]
    height, first = (1, turn) if outer else (math.cos(half), turn + half)  # of its facets, and the normal of one
    normal = cmath.rect(1, first + 2 * half * round((cmath.phase(point) - first) / (2 * half)))
    seen, width = point / normal, height * math.tan(half)
    return point if seen.real <= height else normal * complex(height, min(max(seen.imag, -width), width))


def ball_path(load, law, words, gravity=9.81):
    """Positions after each step of the midpoint rule, and the drift: the mean speed over the last cycle.

    The contact has r_N = m g h and W_T = 1 / m: r_T is the projection of -m u_free on mu r_N times the disk or polygon.
    Velocities are in mu g h here, until the end. Vectors are complex numbers."""
    x, u, step, path, turn = 0j, 0j, words.step, [0j], math.radians(words.frame)
    for k in range(round(3 * PHASE * words.cycles / step)):
        push = cmath.rect(load, math.radians((60, 180, -60)[int((k + 0.5) * step / PHASE) % 3]))
        push += nearest(-(u + push), law, turn)
        x, u = x + u + push / 2, u + push
        path.append(x)
    path = words.mu * gravity * step**2 * np.array(path)
    cycle = min(len(path) - 1, round(3 * PHASE / step))
    return path, abs(path[-1] - path[-1 - cycle]) / (max(1, cycle) * step)


def ball_svg(scenes, title):
    """For each load its paths, seen from above, and without the longest, which may make the others small."""
    made, panels = figure("ball", 11, 0.8 + 4.4 * len(scenes), (len(scenes), 2))
    for (axes, closer), (load, paths) in zip(panels.reshape(-1, 2), scenes.items()):
        sizes = [max(np.abs(path.real).max(), np.abs(path.imag).max()) for path, _ in paths.values()]
        for k, (law, (path, drift)) in enumerate(paths.items()):
            style = {**line_style(k), "marker": "", "linewidth": 1.7 if k else 4}
            rest = "stays at rest" if sizes[k] < 1e-3 else f"drift {drift:.3f} m/s"
            few = path[:: 1 + len(path) // 1000]
            for panel in (axes, closer) if sizes[k] < max(sizes) else (axes,):
                panel.plot(few.real, few.imag, label=f"{law}: {rest}", **style)
        for panel in (axes, closer):
            panel.plot(0, 0, marker="o", color="white", markeredgecolor="black", zorder=5)
            panel.set_aspect("equal", adjustable="datalim")
            panel.set(xlabel="x [m]", ylabel="y [m]")
        axes.set_title(f"Load {load:g} mu m g")
        axes.legend(fontsize=8.5, loc="best")
        closer.set_title("Without the longest path")
    made.suptitle(title, fontsize=10.5)
    return svg_of(made, inline=False)


def ball(arguments):
    words = "The path of a ball on a plane under a load from 60, 180 and -60 degrees in turn (lecture 3 by Acary), "
    parser = argparse.ArgumentParser(prog="perp-compare ball", description=words + "by Coulomb's law and by polygons.")
    add, steps = parser.add_argument, f"time step [s], at most {PHASE} (%(default)s)"
    cycles = f"cycles of three loads of {PHASE} s each (%(default)s)"
    add("--facets", type=FACETS, default=[4, 6, 8, 16], metavar="K,K,...", help="friction polygons (4,6,8,16)")
    add("--outer", action="store_true", help="polygons around the friction disk, not inside it")
    add("--mu", type=between(0, 1e6), default=0.3, help="coefficient of friction (%(default)s)")
    add("--frame", type=between(-360, 360), default=0, help="turn the contact's tangents by so many degrees")
    add("--cycles", type=between(1e-9, 1e6), default=4, help=cycles)
    add("--step", type=between(1e-9, PHASE), default=0.01, help=steps)
    add("--load", type=LOADS, default=[1, 1.5], metavar="L,L,...", help="loads over mu m g (1,1.5)")
    add("--svg", type=picture, metavar="FILE.svg", help="draw the paths, seen from above")
    given = parser.parse_args(arguments)
    if 3 * PHASE * given.cycles > 1e6 * given.step:
        raise InputError("--step: at most 1e6 steps in all")
    side, scenes = "outer" if given.outer else "inner", {}
    laws = {"Coulomb's law": None} | {f"{side}:{K}": (K, given.outer) for K in given.facets}
    for load in given.load:
        paths = scenes[load] = {name: ball_path(load, law, given) for name, law in laws.items()}
        rows, exact = [], paths["Coulomb's law"][0][-1]
        for name, (path, drift) in paths.items():
            end = path[-1].real, path[-1].imag, abs(path[-1] - exact)
            rows.append([name, *(f"{round(v, 3) + 0.0:.3f}" for v in end), f"{drift:.4f}"])
        print(f"Load {load:g} mu m g")
        print_table(["law", ">end x [m]", ">y [m]", ">from exact [m]", ">drift [m/s]"], rows)
    if given.svg:
        title = f"Ball on a plane, seen from above: a load from 60, 180 and -60 degrees in turn, {PHASE} s each, "
        title += f"{given.cycles:g} cycles, mu = {given.mu:g}\nring: the start, at rest; drift: mean velocity over the "
        write_file(given.svg, ball_svg(scenes, title + "last cycle, 0 by Coulomb's law"))
    return SOLVED
