# SPDX-License-Identifier: Apache-2.0
"""Linear complementarity problems of QuantEcon.py's tests of lcp_lemke (quantecon/optimize/tests/test_lcp_lemke.py,
MIT), as data: examples of Murty (1988) and Kostreva (1979), and a game."""

import numpy as np
import perp
import pytest
from problems import natural

SOLVABLE = {
    "Murty, example 2.8": ([[1, -1, -1, -1], [-1, 1, -1, -1], [1, 1, 2, 0], [1, 1, 0, 2]], [3, 5, -9, -5]),
    "Kostreva, example 1": ([[1, 2, 0], [0, 1, 2], [2, 0, 1]], [-1, -1, -1]),
    "Murty, example 2.11": ([[-1.5, 2], [-4, 4]], [-5, 17]),
}
RAYS = {
    "Murty, example 2.9": ([[-1, 0, -3], [1, -2, -5], [-2, -1, -2]], [-3, -2, -1]),
    "Kostreva, example 2": ([[1, -1, 3], [2, -1, 3], [-1, -2, 0]], [-1, -1, -1]),
}


@pytest.mark.parametrize("method", ["auto", "lemke", "path"])
@pytest.mark.parametrize("case", SOLVABLE)
def test_solvable(case, method):
    """Kostreva's first example cycles where ties are not broken with care."""
    M, q = (np.array(part, float) for part in SOLVABLE[case])
    r = perp.lcp(M, q, method=method)
    assert r.success and natural(r.x, M @ r.x + q) <= 1e-12


@pytest.mark.parametrize("method", ["auto", "lemke"])
@pytest.mark.parametrize("case", RAYS)
def test_rays(case, method):
    """No method may call these solved unless the point is a solution: a ray alone proves nothing."""
    M, q = (np.array(part, float) for part in RAYS[case])
    r = perp.lcp(M, q, method=method)
    if r.success:
        assert natural(r.x, M @ r.x + q) <= 1e-9
    else:
        assert r.status in ("Infeasible", "Ray", "NoProgress") and r.message


@pytest.mark.parametrize("method", ["auto", "lemke", "path"])
def test_a_bimatrix_game(method):
    """Mixed strategies x, y and their multipliers, with each equation as two inequalities, as QuantEcon's test has it.
    Degenerate: the rays and cycles of careless pivoting show here."""
    A, B = np.array([[3.0, 3], [2, 5], [0, 6]]), np.array([[3.0, 2, 3], [2, 6, 1]])
    m, n = A.shape
    x, y, u, v, s, t = np.split(np.arange(3 * (m + n)), np.cumsum([m, n, m, m, n]))
    M, q = np.zeros((3 * (m + n),) * 2), np.zeros(3 * (m + n))
    M[np.ix_(x, y)], M[np.ix_(y, x)] = A.max() - A, B.max() - B
    for own, plus, minus in ((x, u, v), (y, s, t)):
        M[np.ix_(own, plus)], M[np.ix_(own, minus)] = 1, -1
        M[np.ix_(plus, own)], M[np.ix_(minus, own)] = -1, 1
        q[plus], q[minus] = 1, -1
    r = perp.lcp(M, q, method=method)
    assert r.success and natural(r.x, M @ r.x + q) <= 1e-9
    # An equilibrium: probabilities, and no row or column is a better answer.
    p, w = r.x[x], r.x[y]
    np.testing.assert_allclose([p.sum(), w.sum()], 1, atol=1e-9)
    assert p @ A @ w >= (A @ w).max() - 1e-9 and w @ B @ p >= (B @ p).max() - 1e-9
