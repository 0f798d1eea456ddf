# SPDX-License-Identifier: Apache-2.0
"""Solutions as functions of parameters that PyTorch differentiates.

    from perp.torch import solution
    x = solution(F, x0=np.ones(2))               # F(x, p), of torch
    x(p).sum().backward()
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import numpy.typing as npt
import torch

from perp._implicit import KinkWarning, adjoint, one_sided, solved
from perp._problem import function_problem
from perp._types import Array, Bound

__all__ = ["KinkWarning", "solution"]


def solution(F: Any, x0: npt.ArrayLike, lower: Bound = 0, upper: Bound = np.inf, **options: object) -> Any:
    """The function p -> x that solves MCP(lower, upper, F(.; p)) from x0, and has derivatives by p (backward).

    F       (x, p) -> F, shape (n,), of torch; both arguments are tensors of float64.
    x0, lower, upper
            as of `perp.solve`; they do not depend on p.
    options of `perp.solve`, among them `pattern`.

    x is a tensor of float64, and its gradient has the type of p. RuntimeError where there is no solution, or no derivative.
    At kinks, a KinkWarning. J is dense: by forward derivatives, one for each x.
    """
    pattern = options.pop("pattern", None)

    def problem_at(p: Any) -> Any:
        q = p.detach().to(torch.float64)

        def numbers(x: Array) -> Array:
            return np.asarray(F(torch.from_numpy(x), q).detach().numpy(), dtype=np.float64)

        def jac(x: Array) -> Array:
            return np.asarray(torch.func.jacfwd(lambda y: F(y, q))(torch.from_numpy(x)).detach().numpy(), dtype=np.float64)

        return function_problem(numbers, x0, lower, upper, jac, pattern)

    class Solution(torch.autograd.Function):
        @staticmethod
        def forward(ctx: Any, p: Any) -> Any:
            ctx.problem = problem_at(p)
            x = torch.from_numpy(solved(ctx.problem, options))
            ctx.save_for_backward(p, x)
            return x

        @staticmethod
        @torch.autograd.function.once_differentiable
        def backward(ctx: Any, v: Any) -> Any:
            p, x = ctx.saved_tensors
            q = p.detach().to(torch.float64)
            at, side = x.numpy(), np.asarray(v.detach().numpy(), dtype=np.float64)
            w = adjoint(ctx.problem, at, side)
            if w is not None:
                slopes = torch.func.vjp(lambda one: F(x, one), q)[1](torch.from_numpy(-w))[0]
            else:
                warnings.warn("the solution is at a kink: the gradient is that for growing parameters", KinkWarning, stacklevel=2)
                dF = torch.func.jacfwd(lambda one: F(x, one))(q).detach().numpy().reshape(len(at), -1)
                slopes = torch.from_numpy(one_sided(ctx.problem, at, side, dF)).reshape(q.shape)
            return slopes.to(p.dtype)

    return lambda p: Solution.apply(torch.as_tensor(p))
