# SPDX-License-Identifier: Apache-2.0
"""The door for small dense problems."""

import numpy as np
import perp
import pytest


def test_problems_that_follow_each_other():
    """Catches what is kept of the problem before: sizes, bounds, the cell; and a matrix taken transposed."""
    random = np.random.default_rng(1)
    solver = perp.DenseSolver(tol=1e-10)
    for n in (3, 3, 8, 2, 8):
        A, S = random.normal(size=(2, n, n))
        M, q = A @ A.T + 0.1 * np.eye(n) + S - S.T, random.normal(size=n)
        for lower, upper in ((0, np.inf), (-np.ones(n), 0.5), (-np.inf, np.inf)):
            for given in (M, np.asfortranarray(M), M.tolist()):
                r = solver.solve(given, q, lower, upper)
                assert r.success and r.residual <= 1e-10
                F = M @ r.x + q
                assert np.abs(r.x - np.clip(r.x - F, lower, upper)).max() <= 1e-9
        solver.forget()


def test_what_is_no_p_matrix():
    assert perp.DenseSolver().solve([[0, 1], [1, 0]], [-1, -1]).success
    r = perp.DenseSolver().solve([[0, -1], [1, 0]], [-1, -1])
    assert r.status == "Infeasible" and not r.success


def test_bad_input_is_refused():
    solver = perp.DenseSolver()
    for M, q, more in (
        (np.eye(2), [1, 2, 3], {}),
        (np.eye(2) * np.nan, [1, 2], {}),
        (np.eye(2), [1, np.inf], {}),
        (np.eye(2), [1, 2], {"lower": 1, "upper": 0}),
        (np.eye(2), [1, 2], {"lower": [0, 0, 0]}),
    ):
        with pytest.raises(ValueError):
            solver.solve(M, q, **more)
