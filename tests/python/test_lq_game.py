# SPDX-License-Identifier: Apache-2.0
"""LQ games as arrays, against equilibria by hand and the players' own conditions, which are computed here."""

import numpy as np
import perp
import pytest
from pages import run_examples


def generated(N, seed, equalities=0):
    """Strongly monotone games of N players of two variables: Q_i = B_i' B_i / (2 N) beside 5 on the diagonal of the player's own
    block, with 2 N shared rows, a box, and equalities. 0 is feasible."""
    random = np.random.default_rng(seed)
    n = 2 * N
    Q = []
    for i in range(N):
        B = random.normal(size=(n, n))
        Q.append(B.T @ B / n)
        Q[i][2 * i : 2 * i + 2, 2 * i : 2 * i + 2] += 5 * np.eye(2)
    c = [5 * random.normal(size=n) for _ in range(N)]
    A, b = random.normal(size=(n, n)), random.uniform(0.1, 0.5, n)
    Aeq = random.normal(size=(equalities, n))
    return [2] * N, Q, c, A, b, Aeq, np.zeros(equalities)


@pytest.mark.parametrize("equalities", [0, 1])
@pytest.mark.parametrize("N", [2, 10, 30])
def test_conditions_of_every_player(N, equalities):
    sizes, Q, c, A, b, Aeq, beq = generated(N, N, equalities)
    found = perp.lq_game(sizes, Q, c, A, b, Aeq, beq, lower=-1, upper=1)
    assert found.success and all(found.convex)
    x, y, z = found.x, found.multipliers, found.equality_multipliers
    assert (A @ x <= b + 1e-6).all() and np.abs(Aeq @ x).max(initial=0) < 1e-6 and (np.abs(x) <= 1).all()
    assert (y >= 0).all() and np.abs(y * (b - A @ x)).max() < 1e-5
    assert N == 2 or (y > 1e-6).any()  # the shared rows matter
    for i in range(N):
        own = slice(2 * i, 2 * i + 2)
        slope = (Q[i] @ x + c[i] + A.T @ y + Aeq.T @ z)[own]
        assert np.abs(x[own] - np.clip(x[own] - slope, -1, 1)).max() < 1e-6


def test_by_hand():
    """(x_1 - 1)^2 and (x_2 - 1/2)^2 with x_1 + x_2 <= 1: (3/4, 1/4) and y = 1/2 (Facchinei & Kanzow 2010, example 1)."""
    found = perp.lq_game([1, 1], [2 * np.eye(2)] * 2, [[-2, 0], [0, -1]], [[1, 1]], [1])
    assert np.allclose(found.x, [0.75, 0.25]) and np.allclose(found.multipliers, [0.5])


def test_only_own_rows_count_and_q_is_made_symmetric():
    """The cost x_1^2 + x_1 x_2 - 3 x_1 of player 1, its Q as an upper triangle, and the same of player 2: x = 1."""
    found = perp.lq_game([1, 1], [[[2, 2], [0, 7]], [[9, 0], [2, 2]]], [[-3, 8], [8, -3]])
    assert found.success and np.allclose(found.x, [1, 1])


def test_a_player_who_is_not_convex_is_told():
    """-x_1^2 within [-1, 1]: 0 is stationary, and -1 and 1 are the optima; success asks for convex players."""
    found = perp.lq_game([1, 1], [np.diag([-2.0, 0]), np.diag([0, 2.0])], np.zeros((2, 2)), lower=-1, upper=1)
    assert found.convex == [False, True] and not found.success


@pytest.mark.parametrize(
    "change, words",
    [
        ({"sizes": [1]}, "^sizes: has 1 players"),
        ({"c": [[0], [0]]}, r"^c\[0\]: has shape \(1,\)"),
        ({"A": [[1, 1]]}, "^A: goes with b"),
        ({"A": [[1]], "b": [1]}, "^A: has shape"),
        ({"A": [[1, 1]], "b": [1, 2]}, "^b: has shape"),
    ],
)
def test_refusals(change, words):
    arguments = {"sizes": [1, 1], "Q": [np.eye(2)] * 2, "c": [[0, 0]] * 2, **change}
    with pytest.raises(ValueError, match=words):
        perp.lq_game(**arguments)


def test_the_page():
    """The examples of docs/lq-games.md, in turn."""
    run_examples("docs/lq-games.md")
