# SPDX-License-Identifier: Apache-2.0
"""Work of the library asked for by Python: options, listeners, Ctrl-C, exceptions, and the end of the interpreter."""

from __future__ import annotations

import atexit
import ctypes
import sys
import threading
import time
from collections.abc import Iterable
from ctypes import byref, c_void_p, string_at
from typing import Any

import numpy as np

from perp import _library
from perp._functions import Functions, live, numbers, view
from perp._library import INTERFACE, Handle, Iteration, check, made

_field = {name: getattr(Iteration, name).offset for name, *_ in Iteration._fields_}
_FORMATS = {"k": "i8", "residual": "f8", "worst": "i8", "merit": "f8", "step": "f8", "prox": "f8", "mu": "f8",
            "pivots": "i8", "backtracks": "i8", "F_evals": "i8", "J_evals": "i8", "crash": "?", "kind": "U1",
            "linear": "U1"}  # fmt: skip
#: Of a row of the log: the fields of perp_iteration, where they are.
ROW = np.dtype(
    {
        "names": list(_FORMATS),
        "formats": list(_FORMATS.values()),
        "offsets": [_field[name] for name in _FORMATS],
        "itemsize": ctypes.sizeof(Iteration),
    }
)

_check_signals = ctypes.pythonapi.PyErr_CheckSignals


def _on_main_thread() -> bool:
    return threading.get_ident() == threading.main_thread().ident


class _Lost:
    """Catches, while it lives, what a handler of signals raises where a callback begins, before the callback can catch it:
    ctypes hands it to sys.unraisablehook. Handlers run on the main thread."""

    __slots__ = ("exception", "_before")

    def __init__(self) -> None:
        self.exception: BaseException | None = None
        self._before = sys.unraisablehook
        sys.unraisablehook = self

    def __call__(self, unraisable: Any) -> None:
        if "ctypes callback" in (unraisable.err_msg or ""):
            self.exception = unraisable.exc_value or unraisable.exc_type()
        else:
            self._before(unraisable)

    def end(self) -> None:
        if sys.unraisablehook is self:
            sys.unraisablehook = self._before


class Solver:
    """A solver of C with its options: of one thread at a time."""

    __slots__ = ("_handle", "pointer", "error", "error_at", "answer", "answer_at", "heeds")

    def __init__(self, options: Iterable[tuple[str, str]] = ()) -> None:
        lib = _library.lib
        self._handle = made(lib.perp_solver_create, lib.Solver, INTERFACE)
        self.pointer = self._handle.pointer
        self.error = _library.Error()
        self.error_at = byref(self.error)
        self.answer = c_void_p()
        self.answer_at = byref(self.answer)
        self.heeds = False
        for key, value in options:
            self.set(key, value)

    def set(self, key: str, value: str) -> None:
        code = _library.lib.perp_solver_set(self.pointer, key.encode(), value.encode(), self.error_at)
        check(code, self.error)


#: Solvers without options, to be used again: a new one costs more than a small solve.
_idle: list[Solver] = []


class Listeners:
    """What hears of the iterations: a function of row and x, and one of lines."""

    def __init__(self, callback: Any, log: Any) -> None:
        self.callback, self.log = callback, log
        self.failure: BaseException | None = None
        self.solver: Any = None
        self.number = next(numbers)

    def heard(self, at: int) -> bool:
        iteration = Iteration.from_address(at)
        row = np.frombuffer(string_at(at, ROW.itemsize), ROW)[0]
        x = view(iteration.x, iteration.n).copy() if iteration.x else None
        try:
            return bool(self.callback(row, x))
        except StopIteration:
            return True


def _hear_progress(iteration: int, number: int) -> int:
    listeners = live[number]
    try:
        return 1 if listeners.failure or listeners.heard(iteration) else 0
    except BaseException as error:
        listeners.failure = error
        return 1


def _hear_line(line: bytes, number: int) -> None:
    listeners = live[number]
    if listeners.failure:
        return
    try:
        listeners.log(line.decode(errors="replace"))
    except BaseException as error:
        listeners.failure = error
        _library.lib.perp_solver_interrupt(listeners.solver.pointer)


_on_progress, _on_log = _library.progress_callback(_hear_progress), _library.log_callback(_hear_line)
_NO_LOG = _library.log_callback(0)
_NO_PROGRESS = _library.progress_callback(0)

_running: set[Solver] = set()
_over = False


@atexit.register
def _stop_everything() -> None:
    """At its end Python stops what runs in other threads and waits for it, ten seconds at most: a thread that asks for the
    lock of an interpreter that is gone is ended where it stands, and C++ does not survive that."""
    global _over
    _over = True
    for solver in tuple(_running):
        _library.lib.perp_solver_interrupt(solver.pointer)
    until = time.monotonic() + 10
    while _running and time.monotonic() < until:
        time.sleep(0.01)


def work(
    function: Any,
    *arguments: Any,
    solver: Solver | None = None,
    functions: Functions | None = None,
    listeners: Listeners | None = None,
    basis: Any = None,
) -> tuple[Handle, BaseException | None]:
    """Calls function(solver, *arguments, &result, &error). The result, and the KeyboardInterrupt that has ended it. Raises
    what the problem's functions or a listener have raised."""
    if _over:
        raise RuntimeError("the interpreter is at its end")
    lib = _library.lib
    ours = solver is None
    if solver is None:
        try:
            solver = _idle.pop()
        except IndexError:
            solver = Solver()
    main = _on_main_thread()
    if solver.heeds != main:
        lib.perp_solver_heed_sigint(solver.pointer, main, None)
        solver.heeds = main
    if listeners is not None:
        listeners.solver = solver
        live[listeners.number] = listeners
        if listeners.log is not None:
            lib.perp_solver_set_log(solver.pointer, _on_log, listeners.number, None)
        if listeners.callback is not None:
            lib.perp_solver_set_progress(solver.pointer, _on_progress, listeners.number, None)
    if basis is not None:
        check(lib.perp_solver_set_basis(solver.pointer, len(basis), basis.ctypes.data, solver.error_at), solver.error)
    interrupt: BaseException | None = None
    code = 0
    lost = _Lost() if main and (functions is not None or listeners is not None) else None
    _running.add(solver)
    solver.answer.value = None
    try:
        code = function(solver.pointer, *arguments, solver.answer_at, solver.error_at)
        if main:
            _check_signals()
    except KeyboardInterrupt as error:
        interrupt = error
    except BaseException:  # of another handler of signals
        if solver.answer.value is not None:
            lib.Result(solver.answer.value)
        raise
    finally:
        _running.discard(solver)
        if lost is not None:
            lost.end()
        if listeners is not None:
            del live[listeners.number]
            lib.perp_solver_set_log(solver.pointer, _NO_LOG, None, None)
            lib.perp_solver_set_progress(solver.pointer, _NO_PROGRESS, None, None)
        if basis is not None:
            lib.perp_solver_set_basis(solver.pointer, 0, None, None)
    pointer = solver.answer.value
    result = None if pointer is None else lib.Result(pointer)
    failure = next((one.failure for one in (listeners, functions) if one is not None and one.failure is not None), None)
    if lost is not None and lost.exception is not None:
        failure = lost.exception
    if failure is not None:
        if not isinstance(failure, KeyboardInterrupt):
            raise failure
        interrupt = failure
    if result is None:
        if interrupt is not None:
            raise interrupt
        check(code, solver.error)
        raise RuntimeError("the library made no result")
    if ours and len(_idle) < 8:
        _idle.append(solver)
    return result, interrupt


def print_line(line: str) -> None:
    sys.stdout.write(line + "\n")
