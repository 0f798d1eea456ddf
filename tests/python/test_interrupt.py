# SPDX-License-Identifier: Apache-2.0
"""Exceptions, Ctrl-C, and threads."""

import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import perp
import pytest
import scipy.sparse as sp
from problems import is_kojima_solution, kojima, kojima_jac


class Mine(Exception):
    pass


def raises_after(count, error):
    calls = []

    def F(x):
        calls.append(0)
        if len(calls) == count:
            raise error
        assert len(calls) < count, "called again after the exception"
        return kojima(x)

    return F


@pytest.mark.parametrize("count", [1, 2, 7])
@pytest.mark.parametrize("error", [Mine("of F"), SystemExit(3), MemoryError(), GeneratorExit()], ids=repr)
def test_exceptions_of_F_come_out_as_themselves(count, error):
    with pytest.raises(type(error)) as raised:
        perp.solve(raises_after(count, error), np.full(4, 7.0), jac=kojima_jac)
    assert raised.value is error
    assert raised.traceback[-1].name == "F"


def test_exceptions_of_jac_callback_and_log():
    def fail(*_):
        raise Mine

    for where in ({"jac": fail}, {"callback": fail}, {"log": fail}):
        with pytest.raises(Mine):
            perp.solve(kojima, np.ones(4), **where)
    # And the next solve is as if nothing had been.
    assert perp.solve(kojima, np.ones(4)).success


def test_ctrl_c_in_F_brings_the_best_point():
    def F(x):
        if len(seen) == 6:
            os.kill(os.getpid(), signal.SIGINT)
        seen.append(x)
        return kojima(x)

    seen = []
    with pytest.raises(KeyboardInterrupt) as raised:
        perp.solve(F, np.full(4, 7.0), jac=kojima_jac)
    assert isinstance(raised.value, perp.Interrupted)
    r = raised.value.result
    assert r.x.shape == (4,) and np.isfinite(r.residual) and not r.success
    assert r.residual <= np.abs(np.minimum(np.full(4, 7.0), kojima(np.full(4, 7.0)))).max()
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def hard():
    """Murty's example (1978): the least-index method takes a number of pivots exponential in n, in one call of C++."""
    n = 40
    return sp.csc_matrix(np.eye(n) + 2 * np.triu(np.ones((n, n)), 1)), -np.ones(n)


def test_ctrl_c_in_linear_algebra():
    """Python's own handler would not run before the end: the solve is stopped by ours, within a second."""
    M, q = hard()
    threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    began = time.monotonic()
    with pytest.raises(perp.Interrupted) as raised:
        perp.lcp(M, q, method="least-index", affine_iteration_limit=10**9, time_limit=60)
    assert time.monotonic() - began < 5
    assert raised.value.result.status == "Interrupted"


def test_a_handler_that_raises_nothing_gets_the_result():
    M, q = hard()
    heard = []
    before = signal.signal(signal.SIGINT, lambda *_: heard.append(0))
    try:
        threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        r = perp.lcp(M, q, method="least-index", affine_iteration_limit=10**9, time_limit=60)
    finally:
        signal.signal(signal.SIGINT, before)
    assert heard and r.status == "Interrupted"


def test_a_solve_within_F():
    def F(x):
        inner = perp.lcp([[2.0]], [-x[0]])  # max(0, x / 2)
        return x - 1 - inner.x / 2

    assert perp.solve(F, [3.0]).x[0] == pytest.approx(4 / 3)


def test_a_problem_is_for_one_thread_at_a_time():
    """A race of two solves in one object would be memory read while it is written."""
    p = perp.problem(lambda x: p.F(x), [1.0])
    with pytest.raises(RuntimeError, match="in use"):
        p.solve()


def test_threads_solve_at_once():
    """200 solves in 8 threads: results are those of one thread, to the bit."""
    M, q = sp.random(30, 30, 0.2, random_state=2, format="csc") + 5 * sp.eye(30), np.linspace(-1, 1, 30)
    alone = perp.lcp(M, q).x.tobytes(), perp.solve(kojima, np.full(4, 5.0), jac=kojima_jac).x.tobytes()
    wrong = []

    def work():
        for _ in range(25):
            r = perp.lcp(M, q).x.tobytes(), perp.solve(kojima, np.full(4, 5.0), jac=kojima_jac).x.tobytes()
            if r != alone:
                wrong.append(r)

    threads = [threading.Thread(target=work) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_the_gil_is_released():
    """While C++ pivots, another thread of Python counts; with the GIL held it would count nothing."""
    M, q = hard()
    ticks = []
    over = threading.Event()

    def tick():
        while not over.wait(0.005):
            ticks.append(time.monotonic())

    thread = threading.Thread(target=tick)
    thread.start()
    perp.lcp(M, q, method="least-index", affine_iteration_limit=10**9, time_limit=0.5)
    over.set()
    thread.join()
    assert len(ticks) > 10


def test_an_exception_in_a_thread_of_its_own():
    errors = []

    def work():
        try:
            perp.solve(raises_after(3, Mine()), np.full(4, 7.0), jac=kojima_jac)
        except Mine as error:
            errors.append(error)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert len(errors) == 1


def test_the_interpreter_ends_while_a_daemon_solves():
    """A callback that wants the GIL of an interpreter that is gone must not crash the process."""
    code = (
        "import threading, time, numpy as np, perp\n"
        "F = lambda x: (time.sleep(0.01), x**2 + 1)[1]\n"
        "threading.Thread(target=lambda: perp.solve(F, np.ones(3), -np.inf), daemon=True).start()\n"
        "time.sleep(0.1)\n"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert run.returncode == 0, run.stderr


def test_no_references_are_lost():
    """F, jac and results are gone afterwards, with exceptions and without."""
    import gc
    import weakref

    class Function:
        def __call__(self, x):
            if x[0] > 100:
                raise Mine
            return kojima(x)

    alive = []
    for start in (1.0, 200.0):
        F = Function()
        alive.append(weakref.ref(F))
        try:
            perp.solve(F, np.full(4, start))
        except Mine:
            pass
        del F
    gc.collect()
    assert [ref() for ref in alive] == [None, None]
    assert is_kojima_solution(perp.solve(kojima, np.ones(4)).x)


@pytest.mark.parametrize("kind", [signal.SIGALRM, signal.SIGINT], ids=["alarm", "ctrl-c"])
def test_what_a_handler_of_signals_raises_comes_out(kind):
    """At any time: within F, in the library, where the library is about to call F, where Python's handler raises before
    anybody can catch it, and while something is freed."""
    def handler(*_):
        raise Mine if kind == signal.SIGALRM else KeyboardInterrupt

    def F(x):
        return x**2 + 1 + 0.1 * np.sin(50 * x)

    before = signal.signal(kind, handler)
    wanted = Mine if kind == signal.SIGALRM else KeyboardInterrupt
    try:
        for k in range(25):
            threading.Timer(0.01 + 0.0007 * k, os.kill, (os.getpid(), kind)).start()
            with pytest.raises(wanted):
                for _ in range(2000):
                    perp.solve(F, np.ones(3), -np.inf, method="semismooth")
                pytest.fail("the signal was lost")
    finally:
        signal.signal(kind, before)
