#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the counts of two builds of perp on contact problems:

    contact_counts.py PROGRAM OTHER PROBLEMS

PROBLEMS are files or generated scenes, NAME:SIZE[:SEED[:MU]]. A line for each whose factorizations or method differ, and
how many are solved. Fails where OTHER solves less, or takes more factorizations. The counts do not depend on the machine.
"""
import json
import subprocess
import sys


def run(program, problem):
    """What solved it, or None, and its factorizations."""
    command = [program, "contact", problem, "--time-limit", "60", "--log-level", "warning", "--json", "-"]
    text = subprocess.run(command, capture_output=True, text=True, check=False).stdout
    result = json.loads(text)
    return result.get("solved_by"), result["stats"].get("factorizations")


def main(program, other, problems):
    solved = [0, 0]
    worse = 0
    for problem in problems:
        (by, count), (by_other, count_other) = run(program, problem), run(other, problem)
        solved[0] += by is not None
        solved[1] += by_other is not None
        if (by, count) == (by_other, count_other):
            continue
        print(f"{problem}: {by} {count}, {by_other} {count_other}")
        worse += by is not None and (by_other is None or count_other > count)
    print(f"solved: {solved[0]} and {solved[1]} of {len(problems)}; worse: {worse}")
    return 1 if worse else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2], sys.argv[3:]) if len(sys.argv) > 3 else __doc__)
