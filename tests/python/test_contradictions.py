# SPDX-License-Identifier: Apache-2.0
"""No two methods contradict each other on one problem: none finds a point that another one proves not to exist, and no
point that any of them returns lies below the residual that another one proves. Over small problems of the collection, and
over systems that are infeasible by 1e-18 to 1e-6, feasible to rounding, or feasible by as much.

PERP_SYSTEMS=2000 makes more of them, PERP_COLLECTION=all takes larger problems; PERP_FILES=FOLDER takes a folder of
NAME.mtx, NAME-q.mtx, NAME-lower.mtx and NAME-upper.mtx, or of NAME.nl. The figures are printed (pytest -s)."""

import collections
import os
import random
import warnings
from pathlib import Path

import numpy as np
import perp
import pytest
import scipy.sparse as sp
from problems import natural

METHODS = ["auto", "path", "lemke", "interior-point", "semismooth", "josephy"]
LIMIT = float(os.environ.get("PERP_LIMIT", "0.1"))  # seconds a solve


def contradiction(problem, counts):
    """The words of a contradiction, or None. Counts what the methods say."""
    points, proofs = [], []
    for method in METHODS:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", perp.SolutionWarning)
                result = problem.solve(method=method, time_limit=LIMIT)
        except ValueError:  # an affine method
            continue
        counts[method, result.status] += 1
        points.append((result.residual, method, result.status))
        if result.status == "Infeasible":
            proofs.append((result.residual_bound, method))
    for bound, proven_by in proofs:
        for residual, method, status in points:
            if status == "Solved" or residual < bound:
                return f"{proven_by}: none below {bound:g}; {method}: {status}, {residual:g}"
    return None


def told(counts):
    for method in METHODS:
        print(method, {status: n for (m, status), n in sorted(counts.items()) if m == method})


def kkt(A, b, c, H):
    m, n = A.shape
    M = np.block([[H, -A.T], [A, np.zeros((m, m))]])
    return M, np.concatenate([c, -b]), np.array([0.0] * n + [-np.inf] * m), np.full(n + m, np.inf)


def edge_system(seed):
    """M, q, lower, upper, and by how much the rows contradict each other (< 0: they do not)."""
    rng = random.Random(seed)
    power = rng.uniform(-18, -6) if rng.random() < 0.6 else rng.uniform(-10, -7)  # the tolerance is 1e-8
    gap = rng.choice([1, 1, 1, -1]) * 10**power if rng.random() < 0.95 else 0.0
    scale = 2.0 ** rng.randint(-8, 8)
    kind = seed % 5
    if kind == 0:  # rows of equations that add up to 0 x = gap
        n = rng.randint(2, 9)
        M = np.array([[float(rng.randint(-9, 9)) for _ in range(n)] for _ in range(n)])
        y = np.array([float(rng.choice([-3, -2, -1, 1, 2, 3])) for _ in range(n - 1)])
        M[-1] = y @ M[:-1]
        q = -M @ np.array([rng.uniform(-2, 2) for _ in range(n)])
        q[-1] += gap
        lower, upper = np.full(n, -np.inf), np.full(n, np.inf)
    elif kind == 1:  # a chain x_k = a_k x_{k-1}, whose end has another value
        n = rng.randint(3, 12)
        a = [rng.choice([1.0, 0.5, 3.0, -1.0, 1 / 3]) for _ in range(n)]
        M = np.eye(n + 1) * 1.0
        M[n, n], x = 0.0, rng.uniform(-2, 2)
        q = np.zeros(n + 1)
        q[0] = -x
        for k in range(1, n):
            M[k, k - 1], x = -a[k], a[k] * x
        M[n, n - 1], q[n] = 1.0, -x - gap
        lower, upper = np.full(n + 1, -np.inf), np.full(n + 1, np.inf)
    elif kind in (2, 3):  # a linear or convex quadratic program: y'A <= 0 <= y'b - gap
        m, n = rng.randint(2, 5), rng.randint(3, 9)
        A = np.array([[float(rng.randint(-4, 4)) for _ in range(n)] for _ in range(m)])
        A[0] -= np.maximum(0, A.sum(0))
        b = np.array([rng.uniform(-2, 2) for _ in range(m)])
        b[0] = gap - b[1:].sum()
        G = np.array([[float(rng.randint(-2, 2)) for _ in range(n)] for _ in range(n)]) * (kind == 3)
        M, q, lower, upper = kkt(A, b, np.array([rng.uniform(0, 3) for _ in range(n)]), G @ G.T)
    else:  # an LCP with a row -a'z - gap >= 0, in a box
        n = rng.randint(2, 8)
        G = np.array([[float(rng.randint(-2, 2)) for _ in range(n)] for _ in range(n)])
        M, q = G @ G.T, np.array([rng.uniform(-1, 1) for _ in range(n)])
        M[0], M[:, 0] = -np.array([float(rng.randint(0, 3)) for _ in range(n)]), 0.0
        M[0, 0], q[0] = 0.0, -gap
        M[1:, 0] = -M[0, 1:]
        lower, upper = np.zeros(n), np.full(n, np.inf)
        upper[1:] = np.where([rng.random() < 0.3 for _ in range(n - 1)], 4.0, np.inf)
    return M * scale, q * scale, lower, upper, gap * scale


def test_systems_at_the_edge():
    counts = collections.Counter()
    said = []
    for seed in range(int(os.environ.get("PERP_SYSTEMS", "150"))):
        M, q, lower, upper, gap = edge_system(seed)
        problem = perp.affine_problem(sp.csc_matrix(M), q, lower, upper)
        if found := contradiction(problem, counts):
            said.append(f"seed {seed} (gap {gap:g}): {found}")
    told(counts)
    assert not said, "\n".join(said)
    assert {status for _, status in counts} >= {"Solved", "Infeasible"}, "the systems are at no edge"


def infeasible_program(seed):
    """Optimality conditions of a linear program whose rows add up to a'x = 1 with a <= 0, and the order of its rows in
    which each equation stands beside the variable of the next one."""
    rng = random.Random(seed)
    m, n = rng.randint(3, 6), rng.randint(4, 10)
    A = np.array([[float(rng.randint(-3, 3)) * (rng.random() < 0.6) for _ in range(n)] for _ in range(m)])
    b = np.array([float(rng.randint(-4, 5)) for _ in range(m)])
    A[-1] = -A[:-1].sum(0) - np.array([float(rng.randint(0, 2)) * (rng.random() < 0.5) for _ in range(n)])
    b[-1] = 1 - b[:-1].sum()
    M, q, lower, _ = kkt(A, b, np.array([float(rng.randint(-3, 3)) for _ in range(n)]), np.zeros((n, n)))
    return M, q, lower, [*range(n), *(n + (i + 1) % m for i in range(m))]


@pytest.mark.parametrize("seed", [0, 68, 202, 1, 2, 3])
def test_another_order_of_the_equations_keeps_the_proof(seed):
    """Of the first three no multipliers alone are found, but all cells are refuted: that certificate is brought back from
    the order of symmetry, too."""
    M, q, lower, order = infeasible_program(seed)
    for rows in (slice(None), order):
        result = perp.mcp_affine(sp.csc_matrix(M[rows]), q[rows], lower)
        assert result.status == "Infeasible" and result.certificate is not None, result.message


def test_the_residuals_are_true():
    """What the two tests rest on: a residual that is reported is that of the point, recomputed here."""
    for seed in range(40):
        M, q, lower, upper, _ = edge_system(seed)
        result = perp.mcp_affine(sp.csc_matrix(M), q, lower, upper, time_limit=LIMIT)
        rounding = len(q) * 2**-52 * (np.abs(M) @ np.abs(result.x) + np.abs(q)).max()
        assert result.residual == pytest.approx(natural(result.x, M @ result.x + q, lower, upper), abs=rounding)


def test_collection():
    counts = collections.Counter()
    said = []
    largest = 10**4 if os.environ.get("PERP_COLLECTION") == "all" else 12
    for entry in perp.collection_entries():
        if entry.size > largest:
            continue
        if found := contradiction(perp.collection(entry.name), counts):
            said.append(f"{entry.name}: {found}")
    told(counts)
    assert not said, "\n".join(said)


def test_files():
    folder = os.environ.get("PERP_FILES")
    if folder is None:
        pytest.skip("PERP_FILES names no folder")
    counts = collections.Counter()
    said = []
    for path in sorted(Path(folder).glob("*-q.mtx")) + sorted(Path(folder).glob("*.nl")):
        stub = str(path).removesuffix("-q.mtx")
        problem = (
            perp.read_nl(path)
            if path.suffix == ".nl"
            else perp.read_matrix(f"{stub}.mtx", path, f"{stub}-lower.mtx", f"{stub}-upper.mtx")
        )
        if found := contradiction(problem, counts):
            said.append(f"{path.name}: {found}")
    told(counts)
    assert not said, "\n".join(said)
