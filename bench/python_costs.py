#!/usr/bin/env python3
"""What Python costs beside C++: python_costs.py [SECONDS OF C++ FOR 1000 AFFINE SOLVES].

Prints microseconds: of an evaluation of F and of a sparse J beyond what the functions themselves take, and of a solve of
an affine problem with 4 variables. Each is the smallest of several runs."""

import sys
import time

import numpy as np
import perp
import scipy.sparse as sp

RUNS = 7


def smallest(run):
    return min(run() for _ in range(RUNS))


def clocked(work):
    began = time.perf_counter()
    work()
    return time.perf_counter() - began


class Counted:
    """A function, with the time spent in it."""

    def __init__(self, function):
        self.function, self.calls, self.inside = function, 0, 0.0

    def __call__(self, x):
        began = time.perf_counter()
        value = self.function(x)
        self.inside += time.perf_counter() - began
        self.calls += 1
        return value


def evaluation(method, n, evaluate):
    """Time of Problem.F or Problem.jac beyond the function's own, in us; the way in and out of C++ is in it twice."""
    tridiagonal = sp.diags([-1.0, 2.0, -1.0], [-1, 0, 1], shape=(n, n), format="csc")
    F, jac = Counted(lambda x: x), Counted(lambda x: tridiagonal)
    p = perp.problem(F, np.zeros(n), jac=jac)
    x = np.linspace(0, 1, n)
    asked = getattr(p._core, evaluate)
    counted = {"F": F, "jac": jac}[evaluate]

    def run():
        counted.inside = 0.0
        total = clocked(lambda: [asked(x) for _ in range(1000)])
        return (total - counted.inside) * 1e3

    return smallest(run)


def in_a_solve(n):
    """The same within a solve, where what is not F or jac is linear algebra and the rest of the method: with n = 4 an upper
    bound."""
    A = sp.diags([-1.0, 2.5, -1.0], [-1, 0, 1], shape=(n, n), format="csc")
    F, jac = Counted(lambda x: x), Counted(lambda x: A)
    F.function = lambda x: A @ x + 0.1 * x**3 - 1

    def J(x):
        value = A.copy()
        value.data[1::3] += 0.0
        return value

    jac.function = J
    p = perp.problem(F, np.full(n, 5.0), jac=jac)

    def run():
        F.calls = jac.calls = 0
        F.inside = jac.inside = 0.0
        total = clocked(lambda: [p.solve(method="semismooth") for _ in range(100)])
        return (total - F.inside - jac.inside) * 1e6 / (F.calls + jac.calls)

    return smallest(run)


def affine_solves():
    M = np.array([[4.0, -1, 0, 0], [-1, 4, -1, 0], [0, -1, 4, -1], [0, 0, -1, 4]])
    q = np.array([-1.0, 2, -3, 4])
    S = sp.csc_matrix(M)
    dense = smallest(lambda: clocked(lambda: [perp.lcp(M, q) for _ in range(1000)])) * 1e3
    sparse = smallest(lambda: clocked(lambda: [perp.lcp(S, q) for _ in range(1000)])) * 1e3
    return dense, sparse


def main():
    for n in (4, 1000):
        print(f"F, n = {n}: {evaluation('F', n, 'F'):.2f} us a call of Problem.F beyond F, conversions of its own included")
    print(f"J, n = 1000, sparse: {evaluation('jac', 1000, 'jac'):.2f} us a call of Problem.jac beyond jac, which makes a matrix again")
    print(f"in a solve, n = 4: {in_a_solve(4):.2f} us an evaluation of F or J beyond both, the method included")
    dense, sparse = affine_solves()
    print(f"affine, 4 variables: {dense:.1f} us a solve (dense M), {sparse:.1f} us (csc)")
    if len(sys.argv) > 1:
        own = float(sys.argv[1]) * 1e3
        print(f"C++: {own:.1f} us; allowed {3 * own + 20:.1f} us")


if __name__ == "__main__":
    main()
