#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The variants of a comparison of contact problems by classes of problems, as Markdown.

    contact_classes.py PERP DIR

DIR is a folder of `perp-compare contact PROBLEMS --out DIR`. The default method of PERP solves each problem again,
for the states of its contacts. The classes are:

    few          at most FEW contacts
    hyperstatic  more, and W is singular: contacts are redundant
    isostatic    more, and W is regular; of W with groups of more than 1000 rows perp does not tell
    sliding      more, and a tenth or more of the contacts that carry slip
    resting      more, and fewer do

The first table has solved problems and seconds, with the time limit for what is not solved. The second has the
performance profile: the share of all problems that a variant solves within tau times the best time.
"""
import csv
import json
import re
import subprocess
import sys

FEW = 9
TAUS = [1, 2, 5, 10, 100]
CLASSES = ["few", "hyperstatic", "isostatic", "sliding", "resting", "all"]


def classes_of(perp, problem, contacts):
    """The classes of a problem; of its states nothing is said if it is not solved."""
    if contacts <= FEW:
        return {"few", "all"}
    run = subprocess.run([perp, "contact", problem, "--time-limit", "60", "--json", "-"], capture_output=True, text=True)
    names = {"all"}
    if re.search(r"contacts\s+are\s+redundant", run.stderr):
        names.add("hyperstatic")
    elif re.search(r"of\s+full\s+rank", run.stderr):
        names.add("isostatic")
    result = json.loads(run.stdout)
    if result["status"] == "Solved":
        slip, stick = result["states"]["slip"], result["states"]["stick"]
        names.add("sliding" if 10 * slip >= slip + stick and slip > 0 else "resting")
    return names


def class_table(variants, of, cells, limit):
    sizes = {c: sum(c in names for names in of.values()) for c in CLASSES}
    print("| variant | " + " | ".join(f"{c} ({sizes[c]})" for c in CLASSES) + " |")
    print("|---" * (len(CLASSES) + 1) + "|")
    for variant in variants:
        row = []
        for c in CLASSES:
            times = [cells[variant, p] for p, names in of.items() if c in names]
            solved = [t for t in times if t is not None]
            row.append(f"{len(solved)}, {sum(solved) + limit * (len(times) - len(solved)):.3g} s")
        print(f"| `{variant}` | " + " | ".join(row) + " |")


def profile_table(variants, problems, cells):
    print("\n| variant | " + " | ".join(f"tau = {tau}" for tau in TAUS) + " | solved |")
    print("|---" * (len(TAUS) + 2) + "|")
    best = {p: min((t for v in variants if (t := cells[v, p]) is not None), default=None) for p in problems}
    for variant in variants:
        ratios = [cells[variant, p] / best[p] for p in problems if cells[variant, p] is not None]
        shares = [sum(r <= tau for r in ratios) / len(problems) for tau in TAUS] + [len(ratios) / len(problems)]
        print(f"| `{variant}` | " + " | ".join(f"{share:.2f}" for share in shares) + " |")


def main(perp, folder):
    with open(f"{folder}/campaign.json") as file:
        campaign = json.load(file)
    with open(f"{folder}/cells.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    cells = {(r["method"], r["problem"]): float(r["seconds"]) if r["outcome"] == "solved" else None for r in rows}
    contacts = {r["problem"]: int(r["contacts"]) for r in rows if r["contacts"]}
    of = {}
    for problem in campaign["problems"]:
        name = problem["name"]
        of[name] = classes_of(perp, problem.get("file", name), contacts[name])
        print(f"{name}: {', '.join(sorted(of[name]))}", file=sys.stderr, flush=True)
    variants = [method["label"] for method in campaign["methods"]]
    class_table(variants, of, cells, campaign["time_limit"])
    profile_table(variants, list(of), cells)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2]) if len(sys.argv) == 3 else __doc__)
