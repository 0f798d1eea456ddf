# SPDX-License-Identifier: Apache-2.0
"""Derivatives of a solution x(p) of MCP(l, u, F(.; p)), for perp.jax and perp.torch.

At a solution with strict complementarity, with I the variables between their bounds (Robinson 1980):

    J_II dx_I = -(dF/dp)_I dp,   dx = 0 elsewhere;   v' dx/dp = -w' dF/dp  with  J_II' w_I = v_I,  w = 0 elsewhere.

Where it fails, at a kink, x has one-sided derivatives only, a small problem of its own for each direction.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from perp._problem import Problem
from perp._types import Array


class KinkWarning(UserWarning):
    """A solution at which a variable is at a bound and F is zero, too: each entry of the gradient is the one-sided derivative for
    a parameter that grows."""


def solved(problem: Problem, options: Any) -> Array:
    """The solution; RuntimeError if none was found."""
    r = problem.solve(**options)
    if not r.success:
        raise RuntimeError(f"F: no solution was found: {r.status}: {r.message}")
    return np.array(r.x)


def adjoint(problem: Problem, x: Array, v: Array) -> Array | None:
    """w; None at a kink."""
    from scipy.sparse.linalg import splu

    looked = problem.sensitivity(x, np.zeros((len(x), 1)), direction=[1.0])
    if len(looked.degenerate):
        return None
    if not looked.known:
        raise RuntimeError(f"F: the solution has no derivative: {looked.message}")
    inside = np.flatnonzero([state == "inside" for state in looked.states])
    w = np.zeros(len(x))
    if inside.size:
        w[inside] = splu(problem.jac(x)[inside][:, inside].T.tocsc()).solve(v[inside])
    return w


def one_sided(problem: Problem, x: Array, v: Array, dF: Array) -> Array:
    """The derivative of v' x for each parameter that grows; dF has shape (n, m)."""
    slopes = np.zeros(dF.shape[1])
    for j, direction in enumerate(np.eye(dF.shape[1])):
        looked = problem.sensitivity(x, dF, direction=direction)
        if not looked.known:
            raise RuntimeError(f"F: the solution has no derivative: {looked.message}")
        slopes[j] = v @ looked.dx[:, 0]
    return slopes
