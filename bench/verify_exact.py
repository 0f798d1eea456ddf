#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Judges `perp solve --verify` in rational arithmetic: python3 bench/verify_exact.py PERP [PROBLEMS [SEED]]

Random affine problems of up to 5 variables, 0 <= M x + q _|_ x and with other bounds: well and badly conditioned,
monotone or not, with margins from 1 down to rounding. All of their solutions are computed exactly, one for each choice
of the variables at a bound. "Exactly one solution in this box" is wrong unless exactly one of them is in it. Printed is
how many claims were made and wrong, and the share proven of the points near solutions whose J_FF has a condition of at
most 1e8 and whose margins x_F and F_A are at least 1e-6. Standard library only.
"""

import itertools
import json
import math
import random
import subprocess
import sys
import tempfile
from fractions import Fraction
from pathlib import Path

INF = math.inf


def inverse(A):
    """Of a square matrix of Fractions; None if it is singular."""
    n = len(A)
    B = [row + [Fraction(i == j) for j in range(n)] for i, row in enumerate(A)]
    for k in range(n):
        pivot = next((i for i in range(k, n) if B[i][k] != 0), None)
        if pivot is None:
            return None
        B[k], B[pivot] = B[pivot], B[k]
        B[k] = [b / B[k][k] for b in B[k]]
        for i in range(n):
            if i != k and B[i][k] != 0:
                B[i] = [b - B[i][k] * c for b, c in zip(B[i], B[k])]
    return [row[n:] for row in B]


def norm(A):
    return max((sum(map(abs, row)) for row in A), default=1)


def solution(M, q, lower, upper, places):
    """(x, margin, condition) with x_i at the bound that places[i] = -1 or 1 names; None if it is no solution."""
    n = len(q)
    free = [i for i in range(n) if places[i] == 0]
    x = [Fraction((lower, None, upper)[p + 1][i]) if p else Fraction(0) for i, p in enumerate(places)]
    J = [[M[i][j] for j in free] for i in free]
    C = inverse(J)
    if C is None:
        return None
    rest = [-q[i] - sum(M[i][j] * x[j] for j in range(n)) for i in free]
    for i, row in zip(free, C):
        x[i] = sum(c * r for c, r in zip(row, rest))
    F = [q[i] + sum(M[i][j] * x[j] for j in range(n)) for i in range(n)]
    margins = []
    for i, p in enumerate(places):
        margins += [p * -F[i]] if p else [abs(x[i] - Fraction(b)) * s for b, s in bounds_of(x[i], lower[i], upper[i])]
    margin = min(margins, default=INF)
    return None if margin < 0 else (x, margin, norm(J) * norm(C))


def bounds_of(x, lower, upper):
    """The finite bounds, and 1 if x is on the right side of it, else -1."""
    return [(b, 1 if inside else -1) for b, inside in ((lower, x >= lower), (upper, x <= upper)) if abs(b) < INF]


def problem(rng):
    n = rng.randint(1, 5)
    M = [[rng.gauss(0, 1) for _ in range(n)] for _ in range(n)]
    if rng.random() < 0.6:  # monotone: B'D B + K, D of many sizes
        D = [10 ** rng.uniform(-rng.choice([0, 3, 6, 9]), 0) for _ in range(n)]
        K = rng.choice([0, 1e-3, 1])
        M = [
            [sum(M[k][i] * D[k] * M[k][j] for k in range(n)) + K * (M[i][j] - M[j][i]) for j in range(n)]
            for i in range(n)
        ]
    if rng.random() < 0.2:
        M = [[float(round(3 * m)) for m in row] for row in M]
    margin = 10 ** rng.choice([0, 0, 0, -2, -4, -5.5, -8, -12, -16])
    lower, upper, x, w = [], [], [], []
    for _ in range(n):
        l, u = rng.choice([(0.0, INF)] * 5 + [(0.0, 1.0), (-INF, INF), (-INF, 2.5), (-rng.uniform(0.1, 3), 0.3)])
        place = rng.choice([0] + [-1] * (l > -INF) + [1] * (u < INF))
        inner = rng.uniform(max(l, -9), min(u, 9))
        near = l + min(margin, 0.1) if l > -INF else inner
        x.append((l, rng.choice([inner, inner, near]), u)[place + 1])
        w.append(-place * margin * rng.uniform(1, 3))
        lower.append(l)
        upper.append(u)
    q = [w[i] - sum(m * y for m, y in zip(M[i], x)) for i in range(n)]
    return M, q, lower, upper


def write(path, columns, rows):
    numbers = "".join(f"{row[j]!r}\n" for j in range(columns) for row in rows)
    path.write_text(f"%%MatrixMarket matrix array real general\n{len(rows)} {columns}\n{numbers}", encoding="ascii")


def claim(perp, folder, M, q, lower, upper):
    """What the program says, as its JSON."""
    write(folder / "M.mtx", len(q), M)
    names = {"q": q, "l": lower, "u": upper}
    for name, vector in names.items():
        write(folder / f"{name}.mtx", 1, [[v] for v in vector])
    files = [str(folder / f"{name}.mtx") for name in ("M", *names)]
    command = [perp, "solve", *files[:2], "--lower", files[2], "--upper", files[3], "--verify", "--json", "-"]
    return json.loads(subprocess.run(command, capture_output=True, text=True, check=False).stdout)


def main(perp, problems=1000, seed=1):
    rng = random.Random(int(seed))
    count = dict.fromkeys(["problems", "with several solutions", "proven", "wrong", "regular", "regular and proven"], 0)
    with tempfile.TemporaryDirectory() as folder:
        for k in range(int(problems)):
            M, q, lower, upper = problem(rng)
            found = claim(perp, Path(folder), M, q, lower, upper)
            x = [Fraction(v["value"]) for v in found["variables"]]
            radii = found.get("verified", {}).get("radii", [])
            proven = found.get("verified", {}).get("unique", False)
            exact = ([[Fraction(m) for m in row] for row in M], [Fraction(c) for c in q])
            places = [[0] + [-1] * (l > -INF) + [1] * (u < INF) for l, u in zip(lower, upper)]
            all_of_them = (solution(*exact, lower, upper, p) for p in itertools.product(*places))
            solutions = {tuple(s[0]): s for s in all_of_them if s}
            distance = {y: max(abs(a - b) for a, b in zip(x, y)) for y in solutions}
            count["problems"] += 1
            count["with several solutions"] += len(solutions) > 1
            count["proven"] += proven
            held = sum(all(abs(a - b) <= r for a, b, r in zip(x, y, map(Fraction, radii))) for y in solutions)
            if proven and held != 1:
                count["wrong"] += 1
                print(f"wrong: problem {k} of seed {seed}: {held} solutions in the box", M, q, lower, upper)
            if solutions:
                _, margin, condition = solutions[min(distance, key=distance.get)]
                regular = margin >= 1e-6 and condition <= 1e8
                count["regular"] += regular
                count["regular and proven"] += regular and proven
    print(", ".join(f"{name} {value}" for name, value in count.items()))
    return count["wrong"] > 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
