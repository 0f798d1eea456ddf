# SPDX-License-Identifier: Apache-2.0
"""perp-compare forces: the forces of a solution in their friction disks."""

import argparse
import math
import sys

from .campaign import SOLVED, UNSOLVED, Program, count
from .files import InputError, number, write_file

LEAST = sys.float_info.min
STATES = {"stick": ("#0072B2", "o"), "slip": ("#D55E00", "D"), "open": ("#767676", "x")}


def picture(path):
    """The name of a picture, so that no problem is written over by a slip."""
    if not path.endswith(".svg"):
        raise argparse.ArgumentTypeError(f"'{path}': the name of a picture ends in .svg")
    return path


def corners_of(K, outer, turn):
    """Of the polygon in the unit disk, the first at `turn`; or around it, the first facet's normal there."""
    radius, first = (1 / math.cos(math.pi / K), turn + math.pi / K) if outer else (1, turn)
    angles = [first + 2 * math.pi * k / K for k in range(K)]
    return [(radius * math.cos(angle), radius * math.sin(angle)) for angle in angles]


def forces_svg(answer):
    """The friction disk (2D: interval) of each contact, all of one size, with r_T, a tick along -u_T, a bar of r_N."""
    from matplotlib.collections import LineCollection

    from .report import figure, svg_of

    contacts = answer["contacts"]
    across = max(1, math.ceil(math.sqrt(1.5 * len(contacts))))
    down = max(1, math.ceil(len(contacts) / across))
    made, axes = figure("forces", 11, 1.5 + min(60, 10 * down / across))
    side, _, K = answer["formulation"].partition(":")
    polygon = corners_of(int(K), side == "outer", answer["rotation"] or 0) if K and answer["dimension"] == 3 else []
    rim = corners_of(48, False, 0) if answer["dimension"] == 3 else [(-1, 0), (1, 0)]
    largest = max([LEAST, *(number(c["r"][0]) for c in contacts)])
    lines = {"#bbbbbb": [], "#333333": []}
    for name, (colour, marker) in STATES.items():
        points, lines[colour] = [], []
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
            for outline, corners in ((colour, rim), ("#bbbbbb", polygon or rim)):
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
    parser.add_argument("problem", metavar="PROBLEM", help="a file of FCLIB or Siconos, or NAME:SIZE[:SEED[:MU]]")
    parser.add_argument("--svg", required=True, type=picture, metavar="FILE.svg", help="the picture")
    parser.add_argument("--program", metavar="FILE", help="the program perp")
    given, others = parser.parse_known_args(arguments)
    answer = Program(given.program).json("contact", given.problem, *others, "--log-level", "quiet", "--json", "-")
    if "contacts" not in answer:
        raise InputError(answer["message"])
    write_file(given.svg, forces_svg(answer))
    states = ", ".join(f"{n} {name}" for name, n in answer["states"].items())
    print(f"{answer['status']}: {states}; {given.svg}")
    return SOLVED if answer["status"] == "Solved" else UNSOLVED
