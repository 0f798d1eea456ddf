# SPDX-License-Identifier: Apache-2.0
"""Unilateral contact with Coulomb friction at k contacts.

    u = W r + q,   K*_mu > u + mu |u_T| e_N  _|_  r in K_mu,   K_mu = {r : |r_T| <= mu r_N}

contact by contact. Block a of r, u, q has d = 2 or 3 entries, the normal one first; with rolling friction, of
coefficients mu_r [m], d = 3 in 2D and 5 in 3D, the rolling ones last. Impulses r [N s], velocities u [m/s], W [1/kg].
"""

from __future__ import annotations

import ctypes
import numbers
import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from perp import _library, _session
from perp._arrays import address, copies_of, doubles, matrix, refuse, vector
from perp._batch import names_of, varying_of
from perp._functions import view
from perp._library import INTERFACE, Handle, call, made
from perp._problem import _count, _derivative, asked, listed, path_text, solver_of, text
from perp._result import Derivatives, Field, Fields, Interrupted, Record, Shown, _texts, numbers_of
from perp._types import Array, Matrix, Options, Path

__all__ = ["Batch", "BatchResult", "Existence", "Problem", "Result", "Scene", "Sensitivity"]
__all__ += ["problem", "read", "scene", "scenes", "solve"]

_STATES = ("open", "stick", "slip", "roll")


class Existence(Record):
    """Whether a problem has a solution, as far as that is proven."""

    existence: Field[str] = Field('"exists", "none" or "undecided".')
    message: Field[str] = Field("What there is to say of it, with the contacts that show it.")
    certificate: Field[Array | None] = Field('Of "none": weights of the contacts that prove it; else None.')
    radius: Field[float | None] = Field('Of "none": how far W and q may move and leave it so; else None.')
    r: Field[Array | None] = Field('Of "exists": impulses that prove it; else None.')
    margin: Field[float | None] = Field('Of "exists": by how much [m/s]; else None.')


def _states(cells: Any) -> list[str]:
    return [_STATES[cell] for cell in cells]


def _verdict(parts: list[Fields] | None) -> Existence | None:
    return Existence(parts[0]) if parts else None


class Result(Record):
    """How a solve ended; r and u are those of the accepted point, or of the best one met."""

    r: Field[Array] = Field("Shape (d k,): impulses.")
    u: Field[Array] = Field("Shape (d k,): velocities.")
    status: Field[str] = Field('"Solved", "Infeasible", "NoProgress", "TimeLimit", ...')
    success: Field[bool] = Field("Whether the variant's law is solved to the tolerance.", bool)
    message: Field[str] = Field("What happened.")
    solved_by: Field[str] = Field("The step that made the point; empty if unsolved.")
    residual: Field[dict[str, float]] = Field(
        'Measures of Coulomb\'s law, "siconos", "natural", ..., "largest", and "own" of other laws\' problems.', numbers_of
    )
    states: Field[list[str]] = Field('Of each contact: "open", "stick", "slip" or "roll".', _states)
    stats: Field[dict[str, float]] = Field("time_s, and what the method counted.", numbers_of)
    verdict: Field[Existence | None] = Field(
        "Without a solution: what is known of whether there is one; None if nothing is.", _verdict
    )

    def _facts(self) -> list[tuple[str, str]]:
        counts = ", ".join(f"{self.states.count(state)} {state}" for state in _STATES if state in self.states)
        facts = super()._facts()
        return [(label, counts if label == "states" else text) for label, text in facts if text != "None"]


class Sensitivity(Derivatives):
    """How a solution of a contact problem moves with m parameters."""

    _matrices = ("dr", "du")
    dr: Field[Array] = Field("Shape (d k, m): dr_i/dp_j; (d k, 1) in a direction; (0, 0) if refused.")
    du: Field[Array] = Field("Of the same shape: du_i/dp_j.")
    regions: Field[list[str]] = Field(
        'Of each contact: "open", "stick", "slip", "roll"; at a kink "touching", "edge".', _texts
    )
    residual: Field[dict[str, float]] = Field("Measures of r, as of `judge`.", numbers_of)


class Problem:
    """A contact problem."""

    def __init__(self, handle: Handle) -> None:
        self._handle = handle

    @property
    def dimension(self) -> int:
        """d."""
        return int(_library.lib.perp_contact_dimension(self._handle.pointer))

    @property
    def contacts(self) -> int:
        """k."""
        return int(_library.lib.perp_contact_contacts(self._handle.pointer))

    @property
    def name(self) -> str:
        """Of the file or the scene."""
        return str(_library.lib.perp_contact_name(self._handle.pointer).decode(errors="replace"))

    @property
    def W(self) -> Matrix:
        """scipy.sparse.csc_matrix of shape (d k, d k)."""
        from scipy import sparse

        W = _library.Matrix()
        call(_library.lib.perp_contact_W, self._handle.pointer, ctypes.byref(W))
        index, start, value = copies_of(W)
        return sparse.csc_matrix((value, index, start), shape=(W.rows, W.columns))

    @property
    def q(self) -> Array:
        """Shape (d k,)."""
        return view(_library.lib.perp_contact_q(self._handle.pointer), self.dimension * self.contacts).copy()

    @property
    def mu(self) -> Array:
        """Shape (k,)."""
        return view(_library.lib.perp_contact_mu(self._handle.pointer), self.contacts).copy()

    @property
    def mu_r(self) -> Array | None:
        """Shape (k,); None without rolling friction."""
        values = _library.lib.perp_contact_mu_r(self._handle.pointer)
        return view(values, self.contacts).copy() if values else None

    def __repr__(self) -> str:
        return f"<perp.contact.Problem {self.name}: {self.contacts} contacts of {self.dimension} entries>"

    def _impulses(self, r: npt.ArrayLike, name: str) -> Array:
        return vector(r, self.dimension * self.contacts, name)

    def solve(
        self,
        variant: str = "glocker",
        *,
        r0: npt.ArrayLike | None = None,
        options: Options | None = None,
        **more: object,
    ) -> Result:
        """Solves by a law and a method in words, as `perp contact` has them: "glocker", "glocker+path", "inner:8+lemke",
        "frictionless". r0, shape (d k,): impulses of a similar problem to begin near. Options: convergence_tolerance,
        time_limit, and those of the method."""
        words = text(variant, "variant").encode()
        start = None if r0 is None else self._impulses(r0, "r0")
        handle, interrupt = _session.work(
            _library.lib.perp_contact_solve,
            self._handle.pointer,
            words,
            None if start is None else address(start),
            solver=solver_of(asked(None, options, more)),
        )
        result = Result(Fields(handle))
        if interrupt is not None:
            raise Interrupted(result) from interrupt
        return result

    def judge(self, r: npt.ArrayLike, tolerance: float = 1e-8) -> tuple[bool, dict[str, float]]:
        """Whether impulses r, shape (d k,), solve Coulomb's law to the tolerance, and the measures."""
        if not isinstance(tolerance, numbers.Real):
            raise TypeError(f"tolerance: is of type {type(tolerance).__name__}, and must be a number")
        if not tolerance > 0:
            raise ValueError(f"tolerance: is {tolerance}, and must be positive")
        lib, impulses = _library.lib, self._impulses(r, "r")
        judged = made(
            lib.perp_contact_judge, lib.Result, self._handle.pointer, address(impulses), float(tolerance)
        )
        measures = Fields(judged).numbers()
        return bool(measures.pop("accepted")), measures

    def sensitivity(
        self,
        r: npt.ArrayLike,
        *,
        dq: Matrix | None = None,
        dmu: Matrix | None = None,
        dW: Sequence[Matrix] | None = None,
        direction: npt.ArrayLike | None = None,
    ) -> Sensitivity:
        """How the solution r, shape (d k,), moves with m parameters p: dq = dq/dp, shape (d k, m), dmu = dmu/dp, shape
        (k, m), and dW, the m matrices dW/dp_j; vectors for m = 1. Without these by all entries of q and, after them, of
        mu. At a kink, such as a contact between stick and slip, there is only a derivative in a direction of p, with m
        entries. Refused (`known`) where W does not determine the impulses."""
        at, k = self._impulses(r, "r"), self.contacts
        size, m = self.dimension * k, -1
        columns: list[tuple[_library.Matrix, Any] | None] = []
        for one, rows, name in ((dq, size, "dq"), (dmu, k, "dmu")):
            columns.append(None if one is None else _derivative(one, rows, m, name))
            m = m if one is None else columns[-1][0].columns
        matrices = None if dW is None else [matrix(one, "dW", size, size) for one in dW]
        if matrices is not None and m not in (-1, len(matrices)):
            refuse("dW", f"has {len(matrices)} matrices, and must have {m}, as dq or dmu has columns")
        m = max(m, 0) if matrices is None else len(matrices)
        named = any(one is not None for one in (dq, dmu, dW))
        dp = None if direction is None else vector(direction, m if named else size + k, "direction")
        handle, interrupt = _session.work(
            _library.lib.perp_contact_sensitivity,
            self._handle.pointer,
            address(at),
            m,
            *(None if one is None else ctypes.byref(one[0]) for one in columns),
            None if matrices is None else (_library.Matrix * m)(*(one[0] for one in matrices)),
            None if dp is None else address(dp),
        )
        if interrupt is not None:
            raise interrupt
        return Sensitivity(Fields(handle))

    def existence(self, **options: object) -> Existence:
        """Whether there is a solution, with a proof. Option: time_limit."""
        handle, interrupt = _session.work(
            _library.lib.perp_contact_existence, self._handle.pointer, solver=solver_of(asked(None, None, options))
        )
        if interrupt is not None:
            raise interrupt
        return Existence(Fields(handle))


@dataclass(frozen=True, eq=False)
class BatchResult(Shown):
    """A step of a `Batch`, an entry or a row for each simulation."""

    r: Array
    """Shape (count, d k): impulses, as of `Result`."""
    u: Array
    """Shape (count, d k): velocities."""
    success: npt.NDArray[np.bool_]
    """Whether the variant's law is solved to the tolerance."""
    status: list[str]
    """As of `Result`."""
    residual: Array
    """The largest measure of Coulomb's law; of other laws that of their own problem."""


class Batch:
    """Simulations side by side, stepped in threads. Each has a solver that is kept from step to step."""

    def __init__(self, count: int, variant: str = "glocker", options: Options | None = None, **more: object) -> None:
        """So many simulations; variant and options as of `Problem.solve`."""
        self.count = _count(count, "count")
        solver = solver_of(asked(None, options, more))
        words = text(variant, "variant").encode()
        lib, pointer = _library.lib, None if solver is None else solver.pointer
        self._handle = made(lib.perp_contact_batch_create, lib.ContactBatch, INTERFACE, pointer, self.count, words)

    def step(self, W: npt.ArrayLike, q: npt.ArrayLike, mu: npt.ArrayLike, *, threads: int = 0) -> BatchResult:
        """The next step of each: W, shape (d k, d k), dense, q, shape (d k,), and mu, shape (k,), where they are the same
        for all, else with an axis more, the first. Contact a begins near its impulse of the simulation's last solved step.
        threads 0: one for each processor; the results do not depend on it, nor on the order, to the bit."""
        given = {"W": doubles(W, "W"), "q": doubles(q, "q"), "mu": doubles(mu, "mu")}
        size, k = (given[name].shape[-1] if given[name].ndim else 0 for name in ("q", "mu"))
        if not k or size not in (2 * k, 3 * k):
            refuse("q", f"has {size} entries, and must have 2 or 3 for each of the {k} contacts of mu")
        _, varying = varying_of(given, {"W": (size, size), "q": (size,), "mu": (k,)}, self.count)
        for name, array in given.items():
            if not np.isfinite(array).all():
                at = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
                refuse(name, f"entry {list(at)} is {array[at]}")
        r, u = np.empty((self.count, size)), np.empty((self.count, size))
        status, residual = np.empty(self.count, np.int32), np.empty(self.count)
        call(
            _library.lib.perp_contact_batch_step,
            self._handle.pointer,
            size // k,
            k,
            *varying.values(),
            _count(threads, "threads", 0),
            *(address(array) for array in (r, u, status, residual)),
        )
        return BatchResult(r, u, status == 0, names_of(status), residual)


def problem(W: Matrix, q: npt.ArrayLike, mu: npt.ArrayLike, mu_r: npt.ArrayLike | None = None) -> Problem:
    """The problem of W, q and mu, for solving it more than once; arguments as of `solve`. With mu_r, shape (k,), of
    contacts with rolling friction."""
    shift, friction = vector(q, -1, "q"), [vector(mu, -1, "mu")]
    k = len(friction[0])
    if mu_r is not None:
        friction.append(vector(mu_r, k, "mu_r"))
    plane, space = (2, 3) if mu_r is None else (3, 5)
    if len(shift) not in (plane * k, space * k):
        refuse("q", f"has {len(shift)} entries, and must have {plane} or {space} for each of the {k} contacts of mu")
    entries, kept = matrix(W, "W", len(shift), len(shift))
    lib = _library.lib
    handle = made(
        lib.perp_contact_create if mu_r is None else lib.perp_contact_create_rolling,
        lib.Contact,
        INTERFACE,
        len(shift) // k,
        k,
        ctypes.byref(entries),
        address(shift),
        *(address(one) for one in friction),
    )
    del kept
    return Problem(handle)


def solve(
    W: Matrix,
    q: npt.ArrayLike,
    mu: npt.ArrayLike,
    variant: str = "glocker",
    *,
    mu_r: npt.ArrayLike | None = None,
    r0: npt.ArrayLike | None = None,
    options: Options | None = None,
    **more: Any,
) -> Result:
    """Solves the contact problem of W, shape (d k, d k), dense or scipy.sparse, q, shape (d k,), and mu, shape (k,),
    with rolling friction also mu_r, shape (k,)."""
    return problem(W, q, mu, mu_r).solve(variant, r0=r0, options=options, **more)


def read(path: Path) -> Problem:
    """A problem from a file: FCLIB's HDF5, or Siconos' text."""
    file = path_text(path)
    if not os.path.exists(file):
        raise FileNotFoundError(f"path: there is no file {file}")
    lib = _library.lib
    return Problem(made(lib.perp_contact_read, lib.Contact, INTERFACE, os.fsencode(file)))


class Scene(NamedTuple):
    """A kind of scene."""

    name: str
    what: str


def scenes() -> list[Scene]:
    """What `scene` can make."""
    return [Scene(**one) for one in listed("scenes")]


def scene(name: str, contacts: int, seed: int = 1) -> Problem:
    """A step of bodies with about so many contacts, "arch", "wall", ... (`scenes`); the same for the same seed."""
    lib, count = _library.lib, _count(contacts, "contacts")
    name_ = text(name, "scene").encode()
    return Problem(made(lib.perp_contact_scene, lib.Contact, INTERFACE, name_, count, _count(seed, "seed")))
