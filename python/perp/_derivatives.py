# SPDX-License-Identifier: Apache-2.0
"""Exact derivatives of functions of Python: jac="jax" and jac="casadi", with the pattern of J found before its values.

JAX: the function is traced once, and each operation of the trace says which entries of its operands an entry of its result
depends on. An operation that is not known here counts as depending on everything. J comes from one forward derivative for
each group of columns that share no row (Curtis, Powell & Reid 1974). CasADi has both of its own.
"""

from __future__ import annotations

import math
import warnings
from typing import Any

import numpy as np

from perp._arrays import pattern_of, refuse, refuse_type
from perp._functions import Float32Warning
from perp._types import Array


def by_name(name: str, F: Any, start: Array, pattern: Any) -> tuple[Any, Any, Any]:
    """F, jac and pattern as arrays of numpy."""
    if not callable(F):
        refuse_type("F", f"is of type {type(F).__name__}, and must be a function of x")
    try:
        return _casadi(F, start, pattern) if name == "casadi" else by_jax(F, start, pattern)
    except ModuleNotFoundError as error:
        if error.name != name:
            raise
        raise ModuleNotFoundError(f"jac: '{name}' needs the package {name}, which is not installed", name=name) from None


# CasADi


def _casadi(F: Any, start: Array, pattern: Any) -> tuple[Any, Any, Any]:
    import casadi
    from scipy import sparse

    n = len(start)
    x = casadi.SX.sym("x", n)
    value = F(x)
    value = value if isinstance(value, (casadi.SX, casadi.DM)) else casadi.vertcat(*value)
    if value.numel() != n:
        refuse("F", f"returned {value.numel()} entries, and must return {n}")
    value = casadi.densify(casadi.reshape(casadi.SX(value), n, 1))
    of_F = casadi.Function("F", [x], [value])
    places = None if pattern is None else pattern_of(pattern, n, "pattern", False)
    J = casadi.jacobian(value, x)
    of_J = casadi.Function("J", [x], [J])
    start_of, index = (np.array(part, dtype=np.int32) for part in J.sparsity().get_ccs())

    def jac(at: Array) -> Any:
        entries = np.array(of_J(at).nonzeros())
        return sparse.csc_matrix((entries, index, start_of), shape=(n, n))

    return lambda at: np.array(of_F(at)).ravel(), jac, places


# JAX


def double(jax: Any) -> Any:
    """A context in which JAX computes in float64, whatever it is set to elsewhere."""
    if hasattr(jax, "enable_x64"):
        return jax.enable_x64(True)
    from jax.experimental import enable_x64

    return enable_x64()


def by_jax(F: Any, start: Array, pattern: Any, more: Any = ()) -> tuple[Any, Any, Any]:
    """F(x, *more), jac and pattern. `more`, a list of what JAX takes, may be changed between calls, but for its shapes."""
    import jax
    import jax.numpy as jnp
    from scipy import sparse

    n = len(start)

    def vector(x: Any, *more: Any) -> Any:
        value = F(x, *more)
        value = jnp.stack([jnp.asarray(one) for one in value]) if isinstance(value, (list, tuple)) else jnp.asarray(value)
        if value.shape != (n,):
            refuse("F", f"returned shape {value.shape}, and must return shape ({n},)")
        return value

    with double(jax):
        trace = jax.make_jaxpr(vector)(np.zeros(n), *more)
        if _has_float32(trace):
            warnings.warn(
                "F has arrays or steps in float32, which have seven digits: F and its derivatives are no better than these. Make "
                "its arrays with dtype float64",
                Float32Warning,
                stacklevel=4,
            )
        if pattern is None:
            places = _Dependence(jax, n).of(trace)
        else:
            places = pattern_of(pattern, n, "pattern", False)
            places = sparse.csc_matrix(np.ones((n, n))) if places is None else places
        colour = colours(places)
        seeds = np.zeros((int(colour.max(initial=-1)) + 1, n))
        seeds[colour, np.arange(n)] = 1.0
        value = jax.jit(vector)

        @jax.jit
        def slopes(x: Any, *more: Any) -> Any:
            return jax.vmap(lambda seed: jax.jvp(lambda x: vector(x, *more), (x,), (seed,))[1])(seeds)

    columns = np.repeat(np.arange(n), np.diff(places.indptr))

    def numbers(x: Array) -> Array:
        with double(jax):
            return np.asarray(value(x, *more), dtype=np.float64)

    def jac(x: Array) -> Any:
        with double(jax):
            entries = np.asarray(slopes(x, *more), dtype=np.float64)[colour[columns], places.indices]
        return sparse.csc_matrix((entries, places.indices, places.indptr), shape=(n, n))

    return numbers, jac, places


def _has_float32(trace: Any) -> bool:
    inner = [one for equation in trace.eqns for one in _inner(equation)]
    variables = [*trace.jaxpr.constvars, *(v for equation in trace.eqns for v in equation.outvars)]
    return any(getattr(v.aval, "dtype", None) == np.float32 for v in variables) or any(map(_has_float32, inner))


def _inner(equation: Any) -> list[Any]:
    """The trace within an operation: of a jitted function, say."""
    found = [equation.params.get(name) for name in ("jaxpr", "call_jaxpr", "fun_jaxpr")]
    return [one for one in found if hasattr(one, "eqns") and hasattr(one, "consts")]


def colours(pattern: Any) -> Any:
    """A group for each column, such that columns of a group share no row: the first that fits."""
    n = pattern.shape[1]
    taken: list[set[int]] = [set() for _ in range(pattern.shape[0])]
    colour = np.zeros(n, dtype=np.int64)
    for j in range(n):
        rows = pattern.indices[pattern.indptr[j] : pattern.indptr[j + 1]]
        used = set().union(*(taken[i] for i in rows))
        group = 0
        while group in used:
            group += 1
        colour[j] = group
        for i in rows:
            taken[i].add(group)
    return colour


# An entry depends on the same entry of each operand, and on scalars.
_BY_ENTRY = frozenset(
    "abs acos acosh add add_any and asin asinh atan atan2 atanh bessel_i0e bessel_i1e cbrt ceil clamp convert_element_type copy "
    "copy_p cos cosh digamma div eq erf erf_inv erfc exp exp2 expm1 floor ge gt igamma igammac integer_pow is_finite le lgamma "
    "log log1p logistic lt max min mul ne neg nextafter not or pow real reduce_precision "
    "regularized_incomplete_beta rem round rsqrt select_n sign sin sinh sqrt square stop_gradient sub tan tanh xor zeta".split()
)
# The result's entries are entries of the operands, as positions show that are sent through the operation.
_MOVES = frozenset(
    "broadcast_in_dim concatenate dynamic_slice dynamic_update_slice expand_dims gather pad reshape rev scatter slice split "
    "squeeze transpose".split()
)
_REDUCTIONS = frozenset("reduce_sum reduce_max reduce_min reduce_prod reduce_and reduce_or argmax argmin".split())


class _Dependence:
    """Which x_j each entry of a value depends on: a matrix with a row for each entry, beside values that do not depend on x."""

    def __init__(self, jax: Any, n: int) -> None:
        from scipy import sparse

        self.jax, self.n, self.sparse = jax, n, sparse

    def of(self, trace: Any) -> Any:
        """The pattern of J, a csc_matrix."""
        x, *more = (v.aval for v in trace.jaxpr.invars)
        none = [_Mark(self.sparse.csr_matrix((math.prod(one.shape), self.n))) for one in more]  # not known, and not of x
        (out,) = self.run(trace, [_Mark(self.sparse.identity(self.n, format="csr")), *none])
        rows = out.rows if isinstance(out, _Mark) else self.sparse.csr_matrix((self.n, self.n))
        return pattern_of(rows.tocsc(), self.n, "jac", True)

    def run(self, trace: Any, arguments: list[Any]) -> list[Any]:
        known: dict[Any, Any] = dict(zip(trace.jaxpr.constvars, trace.consts))
        known.update(zip(trace.jaxpr.invars, arguments))

        def read(v: Any) -> Any:
            return v.val if hasattr(v, "val") else known[v]

        for equation in trace.eqns:
            operands = [read(v) for v in equation.invars]
            known.update(zip(equation.outvars, self.step(equation, operands)))
        return [read(v) for v in trace.jaxpr.outvars]

    def step(self, equation: Any, operands: list[Any]) -> list[Any]:
        name, params = equation.primitive.name, equation.params
        if not any(isinstance(one, _Mark) for one in operands):
            out = equation.primitive.bind(*operands, **params)
            return list(out) if equation.primitive.multiple_results else [out]
        inner = _inner(equation)
        if inner and name not in ("while", "scan", "cond") and len(inner[0].jaxpr.invars) == len(operands):
            return self.run(inner[0], operands)
        shapes = [v.aval.shape for v in equation.outvars]
        maps = self.maps(name, equation, operands, shapes)
        if maps is None:
            return [self.all_of(operands, math.prod(shape)) for shape in shapes]
        return [self.mark(parts, math.prod(shape)) for parts, shape in zip(maps, shapes)]

    def mark(self, parts: list[Any], size: int) -> Any:
        total = sum(parts, self.sparse.csr_matrix((size, self.n)))
        total.data[:] = 1.0
        return _Mark(total.tocsr())

    def all_of(self, operands: list[Any], size: int) -> Any:
        marks = [one.rows for one in operands if isinstance(one, _Mark)]
        columns = np.unique(np.concatenate([rows.indices for rows in marks]))
        row = self.sparse.csr_matrix((np.ones(len(columns)), (np.zeros(len(columns), int), columns)), shape=(1, self.n))
        return _Mark(self.ones(size, 1) @ row)

    def ones(self, rows: int, columns: int) -> Any:
        return self.sparse.csr_matrix(np.ones((rows, columns)))

    def chosen(self, position: Any, rows: Any) -> Any:
        """The rows at these positions; none where the position is negative."""
        position = np.asarray(position).ravel()
        at = np.flatnonzero(position >= 0)
        pick = self.sparse.csr_matrix((np.ones(len(at)), (at, position[at])), shape=(len(position), rows.shape[0]))
        return pick @ rows

    def maps(self, name: str, equation: Any, operands: list[Any], shapes: list[Any]) -> list[list[Any]] | None:
        """For each result what each operand gives its entries; None: nothing is known."""
        given = [v.aval for v in equation.invars]
        marks = [(k, one.rows) for k, one in enumerate(operands) if isinstance(one, _Mark)]
        size = math.prod(shapes[0])
        if name in _BY_ENTRY:
            return [[rows if given[k].shape == shapes[0] else self.ones(size, 1) @ rows for k, rows in marks]]
        if name in _MOVES:
            data = {"gather": 1, "dynamic_slice": 1, "scatter": 3, "dynamic_update_slice": 2, "pad": 2}.get(name, len(given))
            if any(k >= data or (name == "scatter" and k == 1) for k, _ in marks):
                return None  # where entries go depends on x
            return self.moved(equation, operands, given, marks, data)
        if name in _REDUCTIONS:
            kept = [1 if axis in equation.params["axes"] else m for axis, m in enumerate(given[0].shape)]
            target = np.broadcast_to(np.arange(size).reshape(kept), given[0].shape).ravel()
            return [[self.gathered(target, size) @ marks[0][1]]]
        if name == "scatter-add" and all(k != 1 for k, _ in marks):
            return [[rows if k == 0 else self.added(equation, operands, given, size) @ rows for k, rows in marks]]
        if name == "dot_general" and len(marks) == 1 and size * math.prod(given[marks[0][0]].shape) <= 10**7:
            k, rows = marks[0]
            other = np.abs(np.asarray(operands[1 - k], dtype=float)) > 0

            def product(y: Any) -> Any:
                pair = (y, other.astype(float)) if k == 0 else (other.astype(float), y)
                return equation.primitive.bind(*pair, **equation.params).ravel()

            zero = np.zeros(given[k].shape)
            S = np.asarray(self.jax.jacobian(product)(zero)).reshape(size, -1)
            return [[self.sparse.csr_matrix(S) @ rows]]
        return None

    def gathered(self, target: Any, size: int) -> Any:
        """Adds entry k to entry target[k]; nowhere where that is negative."""
        at = np.flatnonzero(target >= 0)
        return self.sparse.csr_matrix((np.ones(len(at)), (target[at], at)), shape=(size, len(target)))

    def added(self, equation: Any, operands: list[Any], given: list[Any], size: int) -> Any:
        """scatter-add: where each entry goes is what its transpose, a gather, brings back."""

        def add(updates: Any) -> Any:
            return equation.primitive.bind(np.zeros(given[0].shape), operands[1], updates, **equation.params)

        _, transpose = self.jax.vjp(add, np.zeros(given[2].shape))
        position = np.asarray(transpose(np.arange(1.0, size + 1).reshape(given[0].shape))[0])
        return self.gathered(position.ravel().astype(np.int64) - 1, size)

    def moved(self, equation: Any, operands: list[Any], given: list[Any], marks: Any, data: int) -> list[list[Any]]:
        """Sends positions in place of values through the operation."""
        sent, first, offset = list(operands), {}, 0
        for k in range(len(given)):
            if k >= data or (equation.primitive.name == "scatter" and k == 1):
                continue
            count = math.prod(given[k].shape)
            first[k] = (offset, count)
            marked = isinstance(operands[k], _Mark)
            place = np.arange(offset, offset + count) if marked else np.full(count, -1)
            sent[k] = place.reshape(given[k].shape)
            offset += count
        out = equation.primitive.bind(*sent, **equation.params)
        results = []
        for position in out if equation.primitive.multiple_results else [out]:
            position = np.asarray(position)
            parts = []
            for k, rows in marks:
                begin, count = first[k]
                mine = (position >= begin) & (position < begin + count)
                parts.append(self.chosen(np.where(mine, position - begin, -1), rows))
            results.append(parts)
        return results


class _Mark:
    """Of a value that depends on x: a row for each of its entries."""

    def __init__(self, rows: Any) -> None:
        self.rows = rows
