# SPDX-License-Identifier: Apache-2.0
"""`python -m perp trace MODEL --parameter NAME=FROM:TO`: a model's solutions as a curve in one of its variables."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from perp import read_nl, trace


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m perp")
    commands = parser.add_subparsers(dest="command", required=True)
    tracing = commands.add_parser("trace", help="the solutions of a model as a curve in one of its variables")
    tracing.add_argument("model", help="an .nl file")
    tracing.add_argument(
        "--parameter", required=True, metavar="NAME=FROM:TO",
        help="the variable, whose condition is left out, and where the curve begins and ends",
    )  # fmt: skip
    tracing.add_argument("--step", type=float, help="the longest step along the curve; a 50th of the interval")
    tracing.add_argument("--json", type=Path, metavar="FILE", help="writes all points and events")
    tracing.add_argument("--plot", type=Path, metavar="FILE", help="draws all variables, .svg, .pdf or .png")
    given = parser.parse_args()
    name, _, interval = given.parameter.rpartition("=")
    try:
        first, last = (float(end) for end in interval.split(":"))
    except ValueError:
        parser.error(f"--parameter: {given.parameter!r} is not NAME=FROM:TO")
    try:
        curve = trace(read_nl(given.model), None, (first, last), parameter=name, step=given.step)
    except (ValueError, OSError) as error:
        parser.error(str(error))
    print(curve.table())
    print(("" if curve.success else "stopped: ") + curve.message)
    if given.json:
        given.json.write_text(json.dumps(curve.to_dict()))
    if given.plot:
        curve.plot().figure.savefig(given.plot)
    return 0 if curve.success else 1


if __name__ == "__main__":
    sys.exit(main())
