#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Each method of the literature beside Siconos' solver of the same kind, on recorded contact problems.

    contact_pairs.py PERP SICONOS LIMIT FILE...

PERP is the program perp, SICONOS is bench_contact_siconos, LIMIT is in seconds. The two of a pair run one after the
other, so that both find the same load; what takes less than half a second runs three times, and the least counts.
Prints a table as Markdown: solved, and seconds with LIMIT for what is not solved. Below are the problems of a pair that
one of the two alone solves. Standard error has each pair of runs.
"""
import json
import subprocess
import sys
from pathlib import Path

PAIRS = [
    ("auto", "ADMM"),
    ("auto", "NSN_AC_HYBRID"),
    ("nsgs", "NSGS"),
    ("fixed-point", "VI_FPP"),
    ("extragradient", "VI_EG"),
    ("hyperplane", "HP"),
    ("alart-curnier", "NSN_AC"),
    ("fischer-burmeister", "NSN_FB"),
    ("natural-map", "NSN_NM"),
    ("tresca", "TFP"),
    ("panagiotopoulos", "PFP"),
    ("cadoux", "ACLMFP"),
]


def output(command, limit):
    """What COMMAND prints; empty if it crashes or takes too long. Reading the file is not part of the limit."""
    try:
        return subprocess.run(command, capture_output=True, text=True, timeout=limit + 2).stdout
    except subprocess.TimeoutExpired:
        return ""


def perp(program, method, file, limit):
    """Seconds, or None if not solved; and whether the judge of Perp accepts the point."""
    text = output([program, "contact", file, "--method", method, "--time-limit", str(limit), "--json", "-"], limit)
    result = json.loads(text) if text else {}
    return (result["stats"]["time_s"], True) if result.get("status") == "Solved" else (None, False)


def siconos(program, solver, file, limit):
    """The same."""
    for line in output([program, solver, file], limit).splitlines():
        fields = line.split(",")
        if len(fields) == 10 and fields[1] == solver and fields[3] == "solved" and float(fields[5]) <= limit:
            return float(fields[5]), fields[4] == "accepted"
    return None, False


def least(run, *arguments):
    """The quickest of three runs, or the only one if it is slow or does not solve the problem."""
    first = run(*arguments)
    if first[0] is None or first[0] > 0.5:
        return first
    return min([first] + [r for r in (run(*arguments) for _ in range(2)) if r[0] is not None])


def main():
    ours, theirs, limit, files = sys.argv[1], sys.argv[2], float(sys.argv[3]), sys.argv[4:]
    print("| method | solved | s | Siconos | solved | accepted by both metrics and shares | s |")
    print("|---|---|---|---|---|---|---|")
    alone = []
    for method, solver in PAIRS:
        a, b, accepted = [], [], 0
        for file in files:
            a.append(least(perp, ours, method, file, limit)[0])
            seconds, good = least(siconos, theirs, solver, file, limit)
            b.append(seconds)
            accepted += good
            print(Path(file).name, method, a[-1], solver, seconds, good, sep=",", file=sys.stderr, flush=True)
        total = [sum(limit if s is None else s for s in column) for column in (a, b)]
        print(
            f"| `{method}` | {len(a) - a.count(None)} | {total[0]:.3g} "
            f"| {solver} | {len(b) - b.count(None)} | {accepted} | {total[1]:.3g} |",
            flush=True,
        )
        for who, mine, other in ((method, a, b), (solver, b, a)):
            names = [Path(f).name for f, s, t in zip(files, mine, other) if s is not None and t is None]
            if names:
                alone.append(f"* of {method} and {solver}, {who} alone: {', '.join(names)}")
    print("\n".join(["", *alone]))


if __name__ == "__main__":
    main()
