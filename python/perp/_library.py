# SPDX-License-Identifier: Apache-2.0
"""libperp, which all of this stands on, by ctypes: capi/perp.h has the meaning of each function.

The library is loaded when it is first used: `lib` of this module."""

from __future__ import annotations

import ctypes
import functools
import os
import sys
from ctypes import POINTER, c_char, c_char_p, c_double, c_int32, c_int64, c_void_p
from pathlib import Path
from typing import Any

#: PERP_INTERFACE of the header that this file follows.
INTERFACE = 1000


class OptionError(ValueError):
    """An option that does not exist, or a value that it does not take."""


class FileError(ValueError):
    """A file that makes no sense; the text names the place."""


class Error(ctypes.Structure):
    _fields_ = [("code", c_int32), ("message", c_char * 1020)]


class Matrix(ctypes.Structure):
    _fields_ = [
        ("form", c_int32),
        ("lent", c_int32),
        ("rows", c_int64),
        ("columns", c_int64),
        ("start", c_void_p),
        ("index", c_void_p),
        ("value", c_void_p),
    ]


COLUMNS_INT32, COLUMNS_INT64, ROWS_INT32, ROWS_INT64, DENSE_COLUMNS, DENSE_ROWS = range(6)


class Iteration(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_int64),
        ("k", c_int64),
        ("residual", c_double),
        ("worst", c_int64),
        ("merit", c_double),
        ("step", c_double),
        ("prox", c_double),
        ("mu", c_double),
        ("pivots", c_int64),
        ("backtracks", c_int64),
        ("F_evals", c_int64),
        ("J_evals", c_int64),
        ("kind", c_int32),
        ("linear", c_int32),
        ("crash", c_int32),
        ("attempt", c_char_p),
        ("n", c_int64),
        ("x", c_void_p),
    ]


(NONE, INTEGER, REAL, TEXT, TEXTS, REALS, INTEGERS, CELLS, PARTS, ITERATIONS) = range(10)
DEFINED, UNDEFINED, STOP = range(3)

F_callback = ctypes.CFUNCTYPE(c_int32, c_int64, c_void_p, c_void_p, c_void_p)
J_callback = ctypes.CFUNCTYPE(c_int32, c_int64, c_int64, c_void_p, c_void_p, c_void_p)
log_callback = ctypes.CFUNCTYPE(None, c_char_p, c_void_p)
progress_callback = ctypes.CFUNCTYPE(c_int32, c_void_p, c_void_p)

_V, _T, _I, _N = c_void_p, c_char_p, c_int32, c_int64
#: Functions that look at what is there, and are called with the GIL: it costs more than they do.
_QUICK = {
    "perp_interface": (_I, []),
    "perp_version": (_T, []),
    "perp_problem_free": (None, [_V]),
    "perp_problem_size": (_N, [_V]),
    "perp_problem_nonzeros": (_N, [_V]),
    "perp_problem_is_affine": (_I, [_V]),
    "perp_problem_bounds": (_I, [_V, _V, _V, _V]),
    "perp_problem_starts": (_N, [_V]),
    "perp_problem_start": (_I, [_V, _N, _V, _V]),
    "perp_problem_pattern": (_I, [_V, _V, _V]),
    "perp_problem_name": (_T, [_V]),
    "perp_problem_source": (_T, [_V]),
    "perp_problem_set_linear": (_I, [_V, _V, _V]),
    "perp_problem_set_name": (_I, [_V, _T, _V]),
    "perp_problem_set_names": (_I, [_V, POINTER(_T), POINTER(_T), _V]),
    "perp_problem_variable_name": (_I, [_V, _N, _T, _N, _V]),
    "perp_problem_equation_name": (_I, [_V, _N, _T, _N, _V]),
    "perp_solver_create": (_I, [_I, _V, _V]),
    "perp_solver_free": (None, [_V]),
    "perp_solver_set": (_I, [_V, _T, _T, _V]),
    "perp_solver_get": (_I, [_V, _T, _T, _N, _V]),
    "perp_solver_set_basis": (_I, [_V, _N, _V, _V]),
    "perp_solver_set_log": (_I, [_V, log_callback, _V, _V]),
    "perp_solver_set_progress": (_I, [_V, progress_callback, _V, _V]),
    "perp_solver_heed_sigint": (_I, [_V, _I, _V]),
    "perp_solver_interrupt": (None, [_V]),
    "perp_dense_create": (_I, [_I, _V, _V]),
    "perp_dense_free": (None, [_V]),
    "perp_dense_forget": (None, [_V]),
    "perp_status_name": (_T, [_I]),
    "perp_list": (_I, [_I, _T, _V, _V]),
    "perp_result_free": (None, [_V]),
    "perp_result_key": (_T, [_V, _N]),
    "perp_result_kind": (_I, [_V, _T]),
    "perp_result_length": (_N, [_V, _T]),
    "perp_result_integer": (_N, [_V, _T]),
    "perp_result_real": (c_double, [_V, _T]),
    "perp_result_text": (_T, [_V, _T, _N]),
    "perp_result_reals": (_V, [_V, _T]),
    "perp_result_integers": (_V, [_V, _T]),
    "perp_result_cells": (_V, [_V, _T]),
    "perp_result_part": (_V, [_V, _T, _N]),
    "perp_result_iterations": (_V, [_V, _T]),
    "perp_contact_free": (None, [_V]),
    "perp_contact_batch_create": (_I, [_I, _V, _N, _T, _V, _V]),
    "perp_contact_batch_free": (None, [_V]),
    "perp_contact_dimension": (_I, [_V]),
    "perp_contact_contacts": (_N, [_V]),
    "perp_contact_name": (_T, [_V]),
    "perp_contact_q": (_V, [_V]),
    "perp_contact_mu": (_V, [_V]),
    "perp_contact_mu_r": (_V, [_V]),
}
#: Functions that work: other threads of Python go on.
_LONG = {
    "perp_problem_create": (_I, [_I, _N, _V, _V, _V, F_callback, J_callback, _V, _V, _V]),
    "perp_problem_affine": (_I, [_I, _V, _V, _V, _V, _V, _V]),
    "perp_problem_read_nl": (_I, [_I, _T, _V, _V]),
    "perp_problem_read_matrix": (_I, [_I, _T, _T, _T, _T, _V, _V]),
    "perp_problem_collection": (_I, [_I, _T, _V, _V]),
    "perp_problem_evaluate": (_I, [_V, _V, _V, _V, _V]),
    "perp_problem_residual": (_I, [_V, _V, _V, _V, _V]),
    "perp_solve": (_I, [_V, _V, _V, _V, _V]),
    "perp_solve_kept": (_I, [_V, _V, _V, _V, _V]),
    "perp_vi": (_I, [_V, _V, _V, _V, _V, _V, _V, _V]),
    "perp_batch_vi": (_I, [_I, _N, _N, _N, _V, _V, _V, _V, _V, _V, _V, c_double, _I, _V, _V, _V, _V, _V]),
    "perp_solve_all": (_I, [_V, _V, _V, _N, _V, _V]),
    "perp_verify": (_I, [_V, _V, _V, _V, _V]),
    "perp_sensitivity": (_I, [_V, _V, _V, _V, _V, _V, _V, _V, _V]),
    "perp_check_jacobian": (_I, [_V, _V, _V, _V, _V]),
    "perp_inspect": (_I, [_V, _V, _V, _V, _V]),
    "perp_dense_solve": (_I, [_V, _N, _V, _V, _V, _V, c_double, _V, _V, _V, _V]),
    "perp_explain": (_I, [_V, _V, _V, c_double, _V, _V]),
    "perp_contact_create": (_I, [_I, _I, _N, _V, _V, _V, _V, _V]),
    "perp_contact_create_rolling": (_I, [_I, _I, _N, _V, _V, _V, _V, _V, _V]),
    "perp_contact_condense": (_I, [_I, _I, _N, _V, _V, _V, _V, _V, _V, _V]),
    "perp_contact_read": (_I, [_I, _T, _V, _V]),
    "perp_contact_scene": (_I, [_I, _T, _N, _N, _V, _V]),
    "perp_contact_W": (_I, [_V, _V, _V]),
    "perp_contact_judge": (_I, [_V, _V, c_double, _V, _V]),
    "perp_contact_existence": (_I, [_V, _V, _V, _V]),
    "perp_contact_solve": (_I, [_V, _V, _T, _V, _V, _V]),
    "perp_contact_batch_step": (_I, [_V, _I, _N, _V, _V, _V, _I, _V, _V, _V, _V, _V]),
    "perp_contact_sensitivity": (_I, [_V, _V, _V, _N, _V, _V, _V, _V, _V, _V]),
}

_FILE = {"win32": "perp.dll", "darwin": "libperp.dylib"}.get(sys.platform, "libperp.so")
_SYSTEM = {"win32": "perp.dll", "darwin": f"libperp.{INTERFACE // 1000}.dylib"}.get(
    sys.platform, f"libperp.so.{INTERFACE // 1000}"
)


class LibraryError(ImportError):
    """libperp was not found, or is of another version."""


def _load() -> tuple[Any, Any, str]:
    """The library beside the package, that of PERP_LIBRARY, or the system's; with the GIL and without."""
    beside = Path(__file__).with_name(_FILE)
    named = os.environ.get("PERP_LIBRARY")
    tried = []
    for path in (str(beside) if beside.exists() else None, named, _SYSTEM):
        if not path:
            continue
        try:
            return ctypes.PyDLL(path), ctypes.CDLL(path), path
        except OSError as error:
            tried.append(f"  {path}: {error}")
            if path == named:
                break  # whoever names a library wants no other
    raise LibraryError(
        "perp needs its library, libperp, which was not found: `pip install .` builds it into the package, Debian has it "
        "in the package libperp, and the environment variable PERP_LIBRARY names one that lies elsewhere. Tried:\n"
        f"  {beside}\n" * (not beside.exists()) + "\n".join(tried)
    )


class Library:
    """The functions, with the types of their arguments."""

    def __init__(self) -> None:
        quick, long, self.path = _load()
        found = quick.perp_interface()
        if found // 1000 != INTERFACE // 1000 or found < INTERFACE:
            raise LibraryError(
                f"the library {self.path} has the interface {found}, and this package perp needs {INTERFACE}: they are of "
                "different versions of Perp"
            )
        for dll, functions in ((quick, _QUICK), (long, _LONG)):
            for name, (answer, arguments) in functions.items():
                function = getattr(dll, name)
                function.restype, function.argtypes = answer, arguments
                setattr(self, name, function)
        self.Problem = _handle_class("Problem", self.perp_problem_free)
        self.Solver = _handle_class("Solver", self.perp_solver_free)
        self.Result = _handle_class("Result", self.perp_result_free)
        self.Dense = _handle_class("Dense", self.perp_dense_free)
        self.Contact = _handle_class("Contact", self.perp_contact_free)
        self.ContactBatch = _handle_class("ContactBatch", self.perp_contact_batch_free)

    def __getattr__(self, name: str) -> Any:  # for what reads types: every name is a function of C
        raise AttributeError(f"libperp has no function {name}")


lib: Library


def __getattr__(name: str) -> Any:
    """`lib`, at its first use."""
    if name != "lib":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()["lib"] = loaded = Library()
    return loaded


_KINDS: dict[int, type[Exception]] = {1: ValueError, 2: OptionError, 3: FileError, 5: MemoryError, 6: LibraryError}


def check(code: int, error: Error) -> None:
    """Raises what the code stands for."""
    if code:
        raise _KINDS.get(code, RuntimeError)(error.message.decode(errors="replace"))


def call(function: Any, *arguments: Any) -> None:
    """A function of C whose last argument is the error."""
    error = Error()
    check(function(*arguments, ctypes.byref(error)), error)


class Handle:
    """A handle of C; what it stands on stays as long as it does. The classes are lib.Problem, lib.Result, ..."""

    __slots__ = ("pointer", "_as_parameter_", "kept", "__weakref__")

    def __init__(self, pointer: int, kept: Any = None) -> None:
        self.pointer = self._as_parameter_ = pointer
        self.kept = kept


def _handle_class(name: str, free: Any) -> type[Handle]:
    """Handles that are freed without a line of Python: what a handler of signals raises in a __del__ is lost. Python asks
    for the attribute __del__, which frees, and calls what it gets, which does nothing."""
    free.restype = functools.partial(functools.partial, int)
    return type(name, (Handle,), {"__slots__": (), "__del__": property(free)})


def made(function: Any, kind: type[Handle], *arguments: Any, kept: Any = None) -> Handle:
    """The handle that a function makes."""
    pointer = c_void_p()
    call(function, *arguments, ctypes.byref(pointer))
    assert pointer.value is not None
    return kind(pointer.value, kept)
