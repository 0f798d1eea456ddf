# SPDX-License-Identifier: Apache-2.0
"""Unilateral contact with Coulomb friction at k contacts.

    u = W r + q,   K*_mu > u + mu |u_T| e_N  _|_  r in K_mu,   K_mu = {r : |r_T| <= mu r_N}

contact by contact. Block a of r, u, q has d = 2 or 3 entries, the normal one first. Impulses r [N s], velocities
u [m/s], W [1/kg].
"""

from __future__ import annotations

import numbers
import os
from dataclasses import dataclass
from typing import Any

import numpy.typing as npt

from perp import _core
from perp._problem import asked, path_text, text
from perp._result import Interrupted
from perp._types import Array, Matrix, Options, Path

__all__ = ["Problem", "Result", "problem", "read", "solve"]


@dataclass(eq=False)
class Result:
    """How a solve ended; r and u are those of the accepted point, or of the best one met."""

    r: Array
    """Shape (d k,): impulses."""
    u: Array
    """Shape (d k,): velocities."""
    status: str
    success: bool
    """Whether the variant's law is solved to the tolerance."""
    message: str
    solved_by: str
    """The step that made the point; empty if unsolved."""
    residual: dict[str, float]
    """Measures of Coulomb's law, "siconos", "natural", ..., "largest", and "own" of other laws' problems."""
    states: list[str]
    """Of each contact: "open", "stick" or "slip"."""
    stats: dict[str, float]
    """time_s, and what the method counted."""


class Problem:
    """A contact problem."""

    def __init__(self, core: _core.ContactProblem) -> None:
        self._core = core

    @property
    def dimension(self) -> int:
        """d."""
        return self._core.dimension

    @property
    def contacts(self) -> int:
        """k."""
        return self._core.contacts

    @property
    def name(self) -> str:
        return self._core.name

    @property
    def W(self) -> Matrix:
        """scipy.sparse.csc_matrix of shape (d k, d k)."""
        return self._core.W

    @property
    def q(self) -> Array:
        """Shape (d k,)."""
        return self._core.q

    @property
    def mu(self) -> Array:
        """Shape (k,)."""
        return self._core.mu

    def __repr__(self) -> str:
        return f"<perp.contact.Problem {self.name}: {self.contacts} contacts in {self.dimension} dimensions>"

    def solve(self, variant: str = "glocker", *, options: Options | None = None, **more: object) -> Result:
        """Solves by a law and a method in words, as `perp contact` has them: "glocker", "glocker+path", "inner:8+lemke",
        "frictionless". Options: convergence_tolerance, time_limit, and those of the method."""
        *parts, interrupt = self._core.solve(text(variant, "variant"), asked(None, options, more))
        result = Result(*parts)
        if interrupt is not None:
            raise Interrupted(result) from interrupt
        return result

    def judge(self, r: npt.ArrayLike, tolerance: float = 1e-8) -> tuple[bool, dict[str, float]]:
        """Whether impulses r, shape (d k,), solve Coulomb's law to the tolerance, and the measures."""
        if not isinstance(tolerance, numbers.Real):
            raise TypeError(f"tolerance: is of type {type(tolerance).__name__}, and must be a number")
        if not tolerance > 0:
            raise ValueError(f"tolerance: is {tolerance}, and must be positive")
        return self._core.judge(r, float(tolerance))


def problem(W: Matrix, q: npt.ArrayLike, mu: npt.ArrayLike) -> Problem:
    """The problem of W, q and mu, for solving it more than once; arguments as of `solve`."""
    return Problem(_core.ContactProblem(W, q, mu))


def solve(
    W: Matrix, q: npt.ArrayLike, mu: npt.ArrayLike, variant: str = "glocker", *, options: Options | None = None, **more: Any
) -> Result:
    """Solves the contact problem of W, shape (d k, d k), dense or scipy.sparse, q, shape (d k,), and mu, shape (k,)."""
    return problem(W, q, mu).solve(variant, options=options, **more)


def read(path: Path) -> Problem:
    """A problem from a file: FCLIB's HDF5, or Siconos' text."""
    file = path_text(path)
    if not os.path.exists(file):
        raise FileNotFoundError(f"path: there is no file {file}")
    return Problem(_core.read_contact(file))
