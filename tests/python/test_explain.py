# SPDX-License-Identifier: Apache-2.0
"""The page docs/explain.md, run as a reader would; and models of data/models, each broken in one way."""

import random

import numpy as np
import perp
import pytest
from pages import ROOT, run_examples

MODELS = ["cournot", "energy", "economy", "harberger", "growth", "cases"]


def test_page():
    run_examples("docs/explain.md", 6)


@pytest.mark.parametrize("name", MODELS)
def test_sound_models_raise_no_alarm(name):
    """Would catch a law that models of economies do not keep, and is said to be broken in them."""
    found = perp.explain(ROOT / "data" / "models" / f"{name}.nl")
    assert found.success and not found.answers, found


def conditions(M, q):
    """The optimality conditions of  min c x, A x >= b, x >= 0: M = [0, -A'; A, 0], with a name for each."""
    n = len(q) // 2
    names = [f"x{j}" for j in range(n)], [f"y{i}" for i in range(n)]
    rows = [f"d_x{j}" for j in range(n)] + [f"e{i}" for i in range(n)]
    return perp.problem(
        lambda x: M @ x + q, np.zeros(2 * n), jac=M, affine=True, variable_names=names[0] + names[1], equation_names=rows
    )


@pytest.mark.parametrize("kind", ["sign", "term", "unit", "sense", "pair", "constant"])
def test_broken_rows_are_named_first(kind):
    """Of a random linear program with positive entries: each row that is broken is in the first answer. What the breaks
    are is known by construction. Would catch a law that is read off the wrong entries."""
    chance, hits = random.Random(kind), 0
    for _ in range(10):
        n = 6
        A = np.array([[chance.choice([0, 0, 1, 2, 3]) for _ in range(n)] for _ in range(n)]) + np.diag(np.arange(1.0, n + 1))
        M = np.block([[np.zeros((n, n)), -A.T], [A, np.zeros((n, n))]])
        q = np.concatenate([[chance.uniform(1, 2) for _ in range(n)], [-chance.uniform(1, 2) for _ in range(n)]])
        i, broken = n + chance.randrange(n), []
        j = chance.choice([j for j in range(n) if M[i, j] != 0])
        broken = [f"e{i - n}"]
        if kind == "sign":
            M[i, j] *= -1
        elif kind == "term":
            M[i, j] = 0
        elif kind == "unit":
            M[i] *= 1000
        elif kind == "sense":
            M[i] *= -1
            q[i] *= -1
        elif kind == "pair":
            k = n + (i - n + 1) % n
            M[[i, k]], q[[i, k]] = M[[k, i]], q[[k, i]]
            broken.append(f"e{k - n}")
        else:  # sum_j A_ij x_j <= -1 cannot be
            M[i], q[i] = -np.abs(M[i]), -1
        answers = conditions(M, q).explain(seconds=5).answers
        hits += bool(answers) and bool(set(broken) & set(answers[0].rows))
    assert hits >= 9, hits
