# SPDX-License-Identifier: Apache-2.0
"""What a solve answers.

Results are those of C (capi/perp.h): fields that have a name. They are read when somebody asks for them; arrays are those
of the library, where they are. A field that the library gets is one line here."""

from __future__ import annotations

import ctypes
import dataclasses
import html
import json
from collections.abc import Callable, Iterator
from typing import Any, Generic, TypeVar, overload

import numpy as np
import numpy.typing as npt

from perp import _library
from perp._functions import array_at, view
from perp._library import Handle
from perp._types import Array

T = TypeVar("T")


def _table(rows: list[tuple[str, str]]) -> str:
    cells = "".join(
        f"<tr><th style='text-align:left'>{html.escape(a)}</th><td style='text-align:left'>{html.escape(b)}</td></tr>"
        for a, b in rows
    )
    return f"<table>{cells}</table>"


class Fields:
    """A result of C, or a part of one, which stays as long as the result."""

    def __init__(self, handle: Handle, pointer: int | None = None) -> None:
        self._handle = handle
        self._pointer = handle.pointer if pointer is None else pointer

    def names(self) -> list[str]:
        names: list[str] = []
        while (name := _library.lib.perp_result_key(self._pointer, len(names))) is not None:
            names.append(name.decode())
        return names

    def read(self, name: str) -> Any:
        """The field's value; None: there is no such field."""
        lib, here, key = _library.lib, self._pointer, name.encode()
        kind = lib.perp_result_kind(here, key)
        if kind == _library.TEXT:
            return lib.perp_result_text(here, key, 0).decode(errors="replace")
        if kind == _library.INTEGER:
            return lib.perp_result_integer(here, key)
        if kind == _library.REAL:
            return lib.perp_result_real(here, key)
        if kind == _library.NONE:
            return None
        count = lib.perp_result_length(here, key)
        if kind == _library.REALS:
            return view(lib.perp_result_reals(here, key), count, self._handle)
        if kind == _library.TEXTS:
            return [lib.perp_result_text(here, key, i).decode(errors="replace") for i in range(count)]
        if kind == _library.PARTS:
            return [Fields(self._handle, lib.perp_result_part(here, key, i)) for i in range(count)]
        if kind == _library.CELLS:
            return self._array(lib.perp_result_cells(here, key), count, np.dtype(np.int8))
        if kind == _library.INTEGERS:
            return self._array(lib.perp_result_integers(here, key), count, np.dtype(np.int64))
        from perp._session import ROW

        return self._array(lib.perp_result_iterations(here, key), count, ROW)

    def _array(self, pointer: int, count: int, dtype: np.dtype[Any]) -> npt.NDArray[Any]:
        return array_at(pointer, count, dtype, self._handle) if count else np.empty(0, dtype)

    def numbers(self) -> dict[str, Any]:
        """Of a part that is a table of numbers."""
        return {name: self.read(name) for name in self.names()}


class Field(Generic[T]):
    """A field of a result: its documentation, and what Python makes of the value of C (None where there is none)."""

    def __init__(self, doc: str, make: Callable[[Any], T] | None = None) -> None:
        self.__doc__ = doc
        self._make = make

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name
        owner._fields = (*owner._fields, name)  # type: ignore[attr-defined]

    @overload
    def __get__(self, result: None, owner: type) -> Field[T]: ...
    @overload
    def __get__(self, result: Any, owner: type) -> T: ...
    def __get__(self, result: Any, owner: type) -> Any:
        if result is None:
            return self
        values = result._values
        if self._name not in values:
            value = result._source.read(self._name)
            values[self._name] = value if self._make is None else self._make(value)
        return values[self._name]

    def __set__(self, result: Any, value: T) -> None:
        result._values[self._name] = value


class Record:
    """What results have in common."""

    _fields: tuple[str, ...] = ()

    def __init__(self, source: Fields) -> None:
        self._source: Any = source
        self._values: dict[str, Any] = {}

    def __getattr__(self, name: str) -> Any:
        """A field of the library's that has no documentation of its own here."""
        source = None if name.startswith("_") else self._source
        if source is None or name not in source.names():
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
        return source.read(name)

    def __getstate__(self) -> dict[str, Any]:
        return {name: getattr(self, name) for name in self._fields}

    def __setstate__(self, values: dict[str, Any]) -> None:
        self._source = None
        self._values = values

    def _facts(self) -> list[tuple[str, str]]:
        """Label and text of each line."""
        return [(name.replace("_", " "), _text(getattr(self, name))) for name in self._fields]

    def __repr__(self) -> str:
        facts = self._facts()
        width = max(len(label) for label, _ in facts)
        return "\n".join(f"{label:>{width}}: {text}" for label, text in facts)

    def _repr_html_(self) -> str:
        return _table(self._facts())


def _text(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.3g}"
    if isinstance(value, np.ndarray):
        return np.array2string(value, threshold=20)
    if isinstance(value, dict):
        return ", ".join(f"{name} {_text(one)}" for name, one in value.items())
    return str(value)


class Shown:
    """A dataclass that notebooks show as a table of its fields."""

    def _repr_html_(self) -> str:
        return _table([(one.name, _text(getattr(self, one.name))) for one in dataclasses.fields(self)])  # type: ignore[arg-type]


class Names:
    """The names of a problem's variables and equations."""

    #: So many are printed with a result, and kept with one that is pickled.
    SHOWN = 20

    def __init__(self, handle: Handle, n: int) -> None:
        self._handle: Handle | None = handle
        self._n = n
        self._known: tuple[list[str], list[str]] = ([], [])

    def _name(self, which: int, i: int) -> str:
        if self._handle is None:
            known = self._known[which]
            return known[i] if i < len(known) else f"{'xF'[which]}[{i}]"
        lib = _library.lib
        function = lib.perp_problem_equation_name if which else lib.perp_problem_variable_name
        size = 256
        while True:
            name = ctypes.create_string_buffer(size)
            _library.call(function, self._handle.pointer, i, name, size)
            if len(name.value) < size - 1:
                return str(name.value.decode(errors="replace"))
            size *= 4  # it was cut off

    def variable(self, i: int) -> str:
        return self._name(0, i)

    def equation(self, i: int) -> str:
        return self._name(1, i)

    def all(self, which: int) -> list[str]:
        return [self._name(which, i) for i in range(self._n)]

    def __getstate__(self) -> dict[str, Any]:
        count = self._n if self._n <= self.SHOWN else 0
        return {"n": self._n, "known": tuple([self._name(which, i) for i in range(count)] for which in (0, 1))}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._handle, self._n, self._known = None, state["n"], state["known"]


class Log:
    """The iterations of a solve, a row each: iteration over its rows, columns by name.

    log["residual"] is an array of shape (rows,), log[-1] the last row, log.array all as a structured array, of which
    pandas.DataFrame makes a frame.
    """

    def __init__(self, array: npt.NDArray[np.void] | None) -> None:
        self.array = np.empty(0, dtype=[("k", "i8"), ("residual", "f8")]) if array is None else array

    @property
    def columns(self) -> tuple[str, ...]:
        """k, residual (natural), worst (row where it is largest), merit, step, prox, mu, pivots, backtracks, F_evals,
        J_evals (both so far), crash, kind (of the step), linear (how its linear problem was solved)."""
        return self.array.dtype.names or ()

    def __len__(self) -> int:
        return len(self.array)

    def __getitem__(self, key: str | int | slice) -> Any:
        return self.array[key]

    def __iter__(self) -> Iterator[Any]:
        return iter(self.array)

    def _cells(self) -> list[list[str]]:
        return [[f"{v:.3g}" if isinstance(v, float) else str(v) for v in row.item()] for row in self.array]

    def __str__(self) -> str:
        lines = [list(self.columns), *self._cells()]
        widths = [max(len(line[c]) for line in lines) for c in range(len(self.columns))]
        return "\n".join("  ".join(cell.rjust(w) for cell, w in zip(line, widths)).rstrip() for line in lines)

    def __repr__(self) -> str:
        return f"<perp.Log: {len(self)} rows of {', '.join(self.columns)}>"

    def _repr_html_(self) -> str:
        head = "".join(f"<th>{html.escape(c)}</th>" for c in self.columns)
        body = "".join(
            "<tr>" + "".join(f"<td>{html.escape(c)}</td>" for c in line) + "</tr>" for line in self._cells()
        )
        return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"

    def __reduce__(self) -> tuple[Any, ...]:
        return Log, (np.array(self.array),)


def numbers_of(parts: list[Fields] | None) -> dict[str, Any]:
    return parts[0].numbers() if parts else {}


def _verified(parts: list[Fields] | None) -> Verified | None:
    return Verified(parts[0]) if parts else None


def _texts(value: list[str] | None) -> list[str]:
    return [] if value is None else value


class Result(Record):
    """How a solve ended, and the best point it met."""

    x: Field[Array] = Field("Shape (n,): the best point met, within the bounds.")
    F: Field[Array] = Field("Shape (n,): F(x).")
    status: Field[str] = Field('"Solved", "SolvedToRounding", "Infeasible", "NoProgress", "TimeLimit", ... (docs/python.md).')
    success: Field[bool] = Field(
        "Whether the natural residual is at most the tolerance. False for SolvedToRounding.", bool
    )
    message: Field[str] = Field("What happened, with names and values.")
    advice: Field[str] = Field("What to try; empty if solved.")
    residual: Field[float] = Field(
        "The natural residual ||x - mid(lower, x - F, upper)||_inf, zero exactly at solutions."
    )
    worst: Field[int] = Field("The row where it is largest; -1: none.")
    relative: Field[float] = Field(
        "The largest residual of a row beside the terms it is the rest of; nan where jac is not defined. Above 1e-3 at a "
        "solution, a SolutionWarning says so."
    )
    relative_row: Field[int] = Field("That row; -1: none.")
    residual_bound: Field[float] = Field("Of Infeasible: no point has a natural residual of at most this. Else nan.")
    certificate: Field[str | None] = Field(
        "Of Infeasible: the proof as JSON, which scripts/check_certificate.py checks; None where the ranges of F are the proof."
    )
    notes: Field[list[str]] = Field("What a solution leaves to be said.", _texts)
    basis: Field[npt.NDArray[np.int8] | None] = Field(
        "Shape (n,): 0 at the lower bound, 1 between, 2 at the upper bound, 3 fixed; for `basis` of a nearby problem. None "
        "where the method has none."
    )
    stats: Field[dict[str, Any]] = Field(
        "iterations, F_evals, J_evals, J_F_evals (for differences), pivots, time_s, ...; F_calls counts all calls of F, "
        "difference_groups the groups of columns of differences.",
        numbers_of,
    )
    log: Field[Log] = Field("The iterations, a row each. Empty for single solutions of `solve_all`.", Log)
    verified: Field[Verified | None] = Field(
        "With the option verify: the proof that a solution is near, or why there is none; else None.", _verified
    )
    computed: Field[dict[str, Any]] = Field(
        "Of models from .nl files: the variables that are no unknowns, as each stands for the expression of a condition, and "
        "their values.",
        numbers_of,
    )
    kept_by: Field[str | None] = Field(
        'Of KeptSolver: what the solve took, "kept", "exchanges", "path", "anew"; else None.'
    )

    _names: Names | None = None

    def __getstate__(self) -> dict[str, Any]:
        return {**super().__getstate__(), "_names": self._names}

    def __setstate__(self, values: dict[str, Any]) -> None:
        self._names = values.pop("_names")
        super().__setstate__(values)

    def _point(self, values: Array, which: int) -> str:
        if self._names is None or len(values) > Names.SHOWN:
            return np.array2string(values, threshold=20)
        return ", ".join(f"{self._names._name(which, i)} = {value:.6g}" for i, value in enumerate(values))

    def _facts(self) -> list[tuple[str, str]]:
        worst = f" in {self._names.equation(self.worst)}" if self._names is not None and self.worst >= 0 else ""
        facts = [
            ("status", self.status),
            ("success", str(self.success)),
            ("message", self.message),
            *([("proof", contradiction(json.loads(self.certificate)))] if self.certificate else []),
            *([("advice", self.advice)] if self.advice else []),
            ("residual", f"{self.residual:.3g}" + (worst if self.residual > 0 else "")),
            ("iterations", str(self.stats["iterations"])),
            ("evaluations", f"{self.stats['F_evals']} of F, {self.stats['J_evals']} of J"),
            ("time", f"{self.stats['time_s']:.3g} s"),
            ("x", self._point(self.x, 0)),
            ("F", self._point(self.F, 1)),
            *(("computed", f"{name} = {value:.6g}") for name, value in self.computed.items()),
        ]
        facts += [("note", note) for note in self.notes]
        if self.verified is not None:
            proof = self.verified
            facts.append(("verified", f"within {proof.radius.max():.2g}" if proof.unique else f"not: {proof.why_not}"))
        return facts


def contradiction(certificate: dict[str, Any]) -> str:
    """"rows a, b and c contradict each other"."""
    names = [row["name"] for row in certificate["rows"]]
    if len(names) == 1:
        return f"row {names[0]} and the bounds contradict each other"
    named = names if len(names) <= 5 else [*names[:4], f"{len(names) - 4} others"]
    return f"rows {', '.join(named[:-1])} and {named[-1]} contradict each other"


class SolutionWarning(UserWarning):
    """A solution to the tolerance whose rows are balanced to a thousandth of their terms only, or worse."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a solve. `result` is what it had, with its best point."""

    def __init__(self, result: Any) -> None:
        super().__init__("interrupted; the best point is in .result")
        self.result = result


class FoundSolution(Record):
    """One of several solutions."""

    how: Field[str] = Field("The method, or the kind of deflation, that found it.")
    singular: Field[str] = Field("Why J is singular there, so that it may be one of a continuum; empty: it is regular.")
    result: Field[Result] = Field("As of `solve`.")

    @property
    def x(self) -> Array:
        """Shape (n,)."""
        return self.result.x

    def _facts(self) -> list[tuple[str, str]]:
        return [
            ("how", self.how),
            *([("singular", self.singular)] if self.singular else []),
            *self.result._facts(),
        ]


class AllSolutions(Record):
    """What `solve_all` found: iterates over the solutions. An empty-handed end is no proof that there are no others."""

    found: Field[list[FoundSolution]] = Field("The solutions, in the order in which they were found.")
    first: Field[Result] = Field("Of the method from x0, solved or not.")
    attempts: Field[int] = Field("Attempts of deflation.")
    duplicates: Field[int] = Field("Attempts that came back to a known solution.")
    message: Field[str] = Field("Why the search ended.")
    stats: Field[dict[str, Any]] = Field("Counts of everything, as of Result.", numbers_of)

    def __init__(self, source: Fields, made: Callable[[Fields], Result]) -> None:
        super().__init__(source)
        self.found = [self._one(part, made) for part in source.read("found")]
        self.first = made(source.read("first")[0])

    @staticmethod
    def _one(part: Fields, made: Callable[[Fields], Result]) -> FoundSolution:
        one = FoundSolution(part)
        one.result = made(part)
        return one

    def _facts(self) -> list[tuple[str, str]]:
        facts = [("solutions", f"{len(self.found)}, by {self.attempts} attempts: {self.message}")]
        return facts + [(f"[{k}]", f"{one.result._point(one.x, 0)}; {one.how}") for k, one in enumerate(self.found)]

    def __len__(self) -> int:
        return len(self.found)

    def __getitem__(self, k: int) -> FoundSolution:
        return self.found[k]

    def __iter__(self) -> Iterator[FoundSolution]:
        return iter(self.found)


class Derivatives(Record):
    """How a solution moves with m parameters. Each kind of problem adds the derivatives of its own."""

    _matrices: tuple[str, ...] = ()
    status: Field[str] = Field(
        '"Differentiable", "Directional"; refused: "Degenerate", "Singular", "NotASolution", "NotDefined", "TooLarge".'
    )
    known: Field[bool] = Field("Whether the derivatives are known.", bool)
    message: Field[str] = Field("What was found; of a refusal, why.")
    degenerate: Field[npt.NDArray[np.int64]] = Field("Of the variables at a bound where F is zero, too; contacts at a kink.")
    rcond: Field[float] = Field("About 1 / condition of the equations of the derivatives, equilibrated.")
    strongly_regular: Field[bool] = Field(
        "Whether there is proven to be one derivative in every direction (of complementarity problems: Robinson 1980).", bool
    )

    def __init__(self, source: Fields) -> None:
        super().__init__(source)
        columns = source.read("directions")
        for name in self._matrices:
            entries = source.read(name)
            self._values[name] = entries.reshape(-1, columns) if entries.size else np.empty((0, 0))


class Sensitivity(Derivatives):
    """How a solution of a complementarity problem moves with m parameters."""

    _matrices = ("dx", "dF")
    dx: Field[Array] = Field("Shape (n, m): dx_i/dp_j; (n, 1) in a direction; (0, 0) if refused.")
    dF: Field[Array] = Field("Of the same shape: the total derivative of F_i.")
    states: Field[list[str]] = Field("Of every variable: where it is.", _texts)
    residual: Field[float] = Field("The natural residual of x.")


class Verified(Record):
    """A proof that a solution is near."""

    unique: Field[bool] = Field(
        "Whether exactly one solution y is within the bounds and |y_i - x_i| <= radius_i.", bool
    )
    x: Field[Array] = Field("Shape (n,): the point given, after Newton steps.")
    radius: Field[Array] = Field("Shape (n,); empty if there is no proof.")
    active: Field[int] = Field("Variables at a bound.")
    why_not: Field[str] = Field("Why there is no proof; empty if there is one.")


class JacobianCheck(Record):
    """jac compared with differences of F."""

    worst: Field[float] = Field("The largest |J_ij - D_ij| / max(1, |J_ij|, |D_ij|).")
    row: Field[int] = Field("Where it is.")
    column: Field[int] = Field("Where it is.")
    given: Field[float] = Field("J_ij there.")
    difference: Field[float] = Field("D_ij there.")
    outside_pattern: Field[bool] = Field("Whether F depends there on a variable that the pattern denies.", bool)
    message: Field[str] = Field("One sentence; empty if jac agrees to 1e-4.")

    @property
    def ok(self) -> bool:
        """Whether jac agrees to 1e-4."""
        return not self.message


def _classes(parts: list[Fields]) -> dict[str, bool | None]:
    return {name: None if value < 0 else bool(value) for name, value in parts[0].numbers().items()}


class Inspection(Record):
    """What is known of a problem before it is solved."""

    name: Field[str] = Field("The problem's.")
    size: Field[int] = Field("Variables.")
    nonzeros: Field[int] = Field("Entries of the pattern of J.")
    affine: Field[bool] = Field("Whether F is known to be affine.", bool)
    bounds: Field[dict[str, int]] = Field(
        "How many variables are free, lower (bounded below only), upper, boxed, fixed.", numbers_of
    )
    structural_rank: Field[int] = Field("Of the pattern of J; below `size` J is singular everywhere.")
    residual: Field[float] = Field("Of the start.")
    worst: Field[str] = Field("The equation where it is largest.")
    singular: Field[str] = Field(
        "Why the block of J that Newton's method needs is singular at the start; empty: nothing was found."
    )
    warnings: Field[list[str]] = Field("What deserves a second look, as `perp inspect` marks it.", _texts)
    classes: Field[dict[str, bool | None]] = Field(
        'Of the matrix of an affine problem: "P", "positive semidefinite", ...; None: not decided.', _classes
    )
    guarantees: Field[list[str]] = Field("What follows from them.", _texts)

    def _facts(self) -> list[tuple[str, str]]:
        facts = [
            ("problem", self.name),
            ("size", f"{self.size} variables, {self.nonzeros} nonzeros" + (", affine" if self.affine else "")),
            ("bounds", ", ".join(f"{count} {kind}" for kind, count in self.bounds.items() if count)),
            ("structural rank", str(self.structural_rank)),
            ("start", f"residual {self.residual:.3g}" + (f", worst in {self.worst}" if self.worst else "")),
        ]
        if self.singular:
            facts.append(("singular", self.singular))
        if self.classes:
            facts.append(("matrix", ", ".join(name for name, yes in self.classes.items() if yes) or "none known"))
        return facts + [("guarantee", text) for text in self.guarantees] + [("warning", text) for text in self.warnings]


class Answer(Record):
    """One of the answers to why a model has no solution, or to what in it looks like a slip."""

    kind: Field[str] = Field('"conflict", "repair", "residual", "structure", "mirror", "family" or "start".')
    proven: Field[bool] = Field("Whether it is proven; False: it is likely.", bool)
    text: Field[str] = Field("In a sentence, with names.")
    rows: Field[list[str]] = Field("The rows it is about.", _texts)
    variables: Field[list[str]] = Field("The variables it is about.", _texts)
    row_indices: Field[Array] = Field("The same rows, from 0.")
    variable_indices: Field[Array] = Field("The same variables, from 0.")

    def _facts(self) -> list[tuple[str, str]]:
        return [("proven" if self.proven else "likely", self.text)]


class Demand(Record):
    """A row, or a bound, of a contradiction or of a change."""

    what: Field[str] = Field('"row", "lower bound" or "upper bound".')
    name: Field[str] = Field("Of the row, or of the variable that has the bound.")
    index: Field[int] = Field("Its place, from 0.")

    def _facts(self) -> list[tuple[str, str]]:
        return [(self.what, self.name)]


class Change(Demand):
    """A constant that is added to F in a row, or a bound: from one value to another."""

    to: Field[float] = Field("The new value.")

    def _facts(self) -> list[tuple[str, str]]:
        return [(self.what, f"{self.name}: {self.to:.6g}")]


class Explanation(Record):
    """Why a model has no solution, the likeliest cause first, and what would mend it."""

    status: Field[str] = Field("How the solve ended.")
    success: Field[bool] = Field("Whether it has a solution.", bool)
    message: Field[str] = Field("What the solve says.")
    answers: Field[list[Answer]] = Field("The first one first.", lambda parts: [Answer(part) for part in parts or []])
    conflict: Field[list[Demand]] = Field(
        "Rows and bounds that contradict each other; empty: none were found.",
        lambda parts: [Demand(part) for part in parts[0].read("demands")] if parts else [],
    )
    repair: Field[list[Change]] = Field(
        "The changes that would mend the model; empty: none were found.",
        lambda parts: [Change(part) for part in parts[0].read("changes")] if parts else [],
    )
    notes: Field[list[str]] = Field("What a solution leaves to be said.", _texts)

    def _facts(self) -> list[tuple[str, str]]:
        facts = [("status", self.status)]
        facts += [("proven" if a.proven else "likely", a.text) for a in self.answers]
        return facts + [("note", text) for text in self.notes]
