# SPDX-License-Identifier: Apache-2.0
"""Solutions as functions of parameters that JAX differentiates.

    from perp.jax import solution
    x = solution(F, x0=np.ones(2))               # F(x, p), of JAX
    jax.grad(lambda p: x(p).sum())(p)
"""

from __future__ import annotations

import warnings
from typing import Any

import jax
import jax.flatten_util
import numpy as np
import numpy.typing as npt

from perp._derivatives import by_jax, double
from perp._functions import Float32Warning
from perp._implicit import KinkWarning, adjoint, one_sided, solved
from perp._problem import function_problem
from perp._types import Bound

__all__ = ["KinkWarning", "solution"]


def solution(F: Any, x0: npt.ArrayLike, lower: Bound = 0, upper: Bound = np.inf, **options: object) -> Any:
    """The function p -> x that solves MCP(lower, upper, F(.; p)) from x0, and has derivatives by p (backward).

    F       (x, p) -> F, shape (n,), of JAX; p is an array, or a tree of arrays with always the same shapes.
    x0, lower, upper
            as of `perp.solve`; they do not depend on p.
    options of `perp.solve`.

    The library computes in float64. x has JAX's own type, float32 unless it is told otherwise; a Float32Warning says so.
    RuntimeError where there is no solution, or no derivative. At kinks, a KinkWarning.
    """
    more: list[Any] = [None]
    kept: list[Any] = []

    def problem_at(p: Any) -> Any:
        more[0] = jax.tree_util.tree_map(lambda one: np.asarray(one, dtype=np.float64), p)
        if not kept:
            numbers, jac, places = by_jax(F, np.asarray(x0, dtype=np.float64), None, more)
            kept.append(function_problem(numbers, x0, lower, upper, jac, places))
        return kept[0]

    def find(p: Any) -> Any:
        return solved(problem_at(p), options).astype(_type())

    def pull(p: Any, x: Any, v: Any) -> Any:
        problem, x, v = problem_at(p), np.asarray(x, np.float64), np.asarray(v, np.float64)
        if _type() == np.float32:  # seven digits are no solution: find the others again
            x = solved(problem, options)
        with double(jax):
            w = adjoint(problem, x, v)
            if w is not None:
                slopes = jax.vjp(lambda q: F(x, q), more[0])[1](-jax.numpy.asarray(w))[0]
            else:
                warnings.warn("the solution is at a kink: the gradient is that for growing parameters", KinkWarning, stacklevel=2)
                flat, shaped = jax.flatten_util.ravel_pytree(more[0])
                dF = np.asarray(jax.jacfwd(lambda q: jax.numpy.asarray(F(x, shaped(q))))(flat))
                slopes = shaped(jax.numpy.asarray(one_sided(problem, x, v, dF)))
        return jax.tree_util.tree_map(lambda one, like: np.asarray(one, dtype=like.dtype), slopes, p)

    def called(function: Any, shapes: Any, *arguments: Any) -> Any:
        """At once, or when what JAX compiles runs."""
        if any(isinstance(one, jax.core.Tracer) for one in jax.tree_util.tree_leaves(arguments)):
            return jax.pure_callback(function, shapes, *arguments, vmap_method="sequential")
        return jax.tree_util.tree_map(jax.numpy.asarray, function(*arguments))

    @jax.custom_vjp
    def x(p: Any) -> Any:
        if _type() == np.float32:
            warnings.warn("x is rounded to float32: set jax_enable_x64 for all its digits", Float32Warning, stacklevel=2)
        p = jax.tree_util.tree_map(jax.numpy.asarray, p)
        return called(find, jax.ShapeDtypeStruct(np.shape(x0), _type()), p)

    def forward(p: Any) -> Any:
        p = jax.tree_util.tree_map(jax.numpy.asarray, p)
        found = x(p)
        return found, (p, found)

    def backward(kept_: Any, v: Any) -> Any:
        p, found = kept_
        shapes = jax.tree_util.tree_map(lambda one: jax.ShapeDtypeStruct(one.shape, one.dtype), p)
        return (called(pull, shapes, p, found, v),)

    x.defvjp(forward, backward)
    return x


def _type() -> Any:
    return np.float64 if jax.config.jax_enable_x64 else np.float32
