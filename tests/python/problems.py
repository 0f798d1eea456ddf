# SPDX-License-Identifier: Apache-2.0
"""Problems with known solutions, shared by the tests."""

import numpy as np


def kojima(x):
    """Kojima & Shindoh 1986, as Josephy's with two solutions: (sqrt(6)/2, 0, 0, 1/2) and (1, 0, 3, 0)."""
    a, b, c, d = x
    return np.array(
        [
            3 * a * a + 2 * a * b + 2 * b * b + c + 3 * d - 6,
            2 * a * a + a + b * b + 10 * c + 2 * d - 2,
            3 * a * a + a * b + 2 * b * b + 2 * c + 9 * d - 9,
            a * a + 3 * b * b + 2 * c + 3 * d - 3,
        ]
    )


def kojima_jac(x):
    a, b = x[0], x[1]
    return np.array(
        [
            [6 * a + 2 * b, 2 * a + 4 * b, 1, 3],
            [4 * a + 1, 2 * b, 10, 2],
            [6 * a + b, a + 4 * b, 2, 9],
            [2 * a, 6 * b, 2, 3],
        ]
    )


SOLUTIONS = (np.array([np.sqrt(6) / 2, 0, 0, 0.5]), np.array([1.0, 0, 3, 0]))


def is_kojima_solution(x):
    return min(np.abs(x - s).max() for s in SOLUTIONS) < 1e-7


def natural(x, F, lower=0.0, upper=np.inf):
    """The natural residual, computed here: the tests do not believe the library's own."""
    return float(np.abs(x - np.clip(x - F, lower, upper)).max())
