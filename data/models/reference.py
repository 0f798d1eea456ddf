#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Solves the models of this folder without Perp and writes *.sol.json: reference.py [FOLDER]. See ../README.md.

Damped Newton steps on Fischer-Burmeister's equations with dense elimination, derivatives by complex steps,
dF/dx_j = Im F(x + i h e_j) / h with h = 1e-30 (exact to rounding): slow, simple, and it shares no line with Perp.
"""

import json
import math
import sys
from pathlib import Path

sys.dont_write_bytecode = True
from make_models import UNDETERMINED, models  # noqa: E402

STEP = 1e-30
SHIFT = 1e-6  # of a singular system's diagonal, where solutions are not unique


def evaluate(variables, rows, x):
    at = dict(zip(variables, x))
    return [row.body.value(at) for row in rows]


def jacobian(variables, rows, x):
    columns = []
    for j in range(len(x)):
        shifted = [complex(value, STEP if i == j else 0) for i, value in enumerate(x)]
        columns.append([complex(F).imag / STEP for F in evaluate(variables, rows, shifted)])
    return [list(row) for row in zip(*columns)]


def fischer(a, b):
    """(phi, d phi / da, d phi / db) of phi = a + b - sqrt(a^2 + b^2)."""
    r = math.hypot(a, b)
    if r == 0:
        return 0.0, 1 - math.sqrt(0.5), 1 - math.sqrt(0.5)
    return a + b - r, 1 - a / r, 1 - b / r


def reformulated(v, x, F):
    """(Phi, dPhi/dx, dPhi/dF) of one pair."""
    if v.lower == v.upper:
        return x - v.lower, 1.0, 0.0
    if v.lower == -math.inf and v.upper == math.inf:
        return F, 0.0, 1.0
    if v.upper == math.inf:
        return fischer(x - v.lower, F)
    phi, da, db = fischer(v.upper - x, -F)
    if v.lower == -math.inf:
        return -phi, da, db
    outer, oa, ob = fischer(x - v.lower, -phi)
    return outer, oa + ob * da, ob * db


def eliminate(A, b):
    """Solves A x = b by Gaussian elimination with row pivoting; A and b are used up."""
    n = len(b)
    for k in range(n):
        pivot = max(range(k, n), key=lambda i: abs(A[i][k]))
        A[k], A[pivot], b[k], b[pivot] = A[pivot], A[k], b[pivot], b[k]
        for i in range(k + 1, n):
            factor = A[i][k] / A[k][k]
            if factor != 0:
                A[i] = [x - factor * y for x, y in zip(A[i], A[k])]
                b[i] -= factor * b[k]
    x = [0.0] * n
    for k in reversed(range(n)):
        x[k] = (b[k] - sum(A[k][j] * x[j] for j in range(k + 1, n))) / A[k][k]
    return x


def natural_residual(variables, rows, x):
    """max_i |x_i - mid(l_i, x_i - F_i, u_i)|."""
    F = evaluate(variables, rows, x)
    return max(abs(t - min(max(t - f, v.lower), v.upper)) for v, t, f in zip(variables, x, F))


def merit_and_system(variables, rows, x):
    try:
        F = evaluate(variables, rows, x)
        triples = [reformulated(v, t, f) for v, t, f in zip(variables, x, F)]
    except (ValueError, OverflowError, ZeroDivisionError, TypeError):  # not defined at x
        return math.inf, []
    return sum(phi * phi for phi, _, _ in triples), triples


def solve(model, tolerance=1e-13):
    """The solution as a list in the file's order of variables; RuntimeError if there is none to be found."""
    variables, rows = model.ordered()[0], model.pairs()
    x = [min(max(v.start or 0.0, v.lower), v.upper) for v in variables]
    merit, triples = merit_and_system(variables, rows, x)
    for _ in range(200):
        if math.sqrt(merit) < tolerance:
            break
        J = jacobian(variables, rows, x)
        H = [[db * entry for entry in J[i]] for i, (_, _, db) in enumerate(triples)]
        for i, (_, da, _) in enumerate(triples):
            H[i][i] += da
        right = [-phi for phi, _, _ in triples]
        try:
            d = eliminate([list(row) for row in H], list(right))
        except ZeroDivisionError:
            d = eliminate([[h + SHIFT * (i == j) for j, h in enumerate(row)] for i, row in enumerate(H)], right)
        t = 1.0
        while True:
            trial = [a + t * b for a, b in zip(x, d)]
            new_merit, new_triples = merit_and_system(variables, rows, trial)
            if new_merit <= (1 - 1e-4 * t) * merit or t < 1e-10:
                break
            t /= 2
        if new_merit >= merit:
            break  # rounding
        x, merit, triples = trial, new_merit, new_triples
    x = [min(max(value, v.lower), v.upper) for v, value in zip(variables, x)]
    residual = natural_residual(variables, rows, x)
    if not residual < 1e-10:
        raise RuntimeError(f"{model.name}: natural residual {residual}")
    return x


def main():
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent
    for model in models():
        x = solve(model)
        skipped = UNDETERMINED.get(model.name, "/")  # no name begins so
        values = {
            v.name: float(f"{value:.10g}") if abs(value) > 1e-12 else 0.0
            for v, value in zip(model.ordered()[0], x)
            if not v.name.startswith(skipped)
        }
        (folder / f"{model.name}.sol.json").write_text(json.dumps(values, indent=1) + "\n", encoding="ascii")


if __name__ == "__main__":
    main()
