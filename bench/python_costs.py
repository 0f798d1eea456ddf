#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What Python costs beside C++: python_costs.py [MICROSECONDS OF C++ FOR AN AFFINE SOLVE].

Prints microseconds of processor time: of an evaluation of F and of a sparse J beyond what the functions themselves take,
and of a solve of an affine problem with 4 variables. Each is the smallest of many runs."""

import sys
import time

import numpy as np
import perp
import scipy.sparse as sp

RUNS = 60


def smallest(run):
    return min(run() for _ in range(RUNS))


def per_call(work, calls):
    began = time.process_time()
    for _ in range(calls):
        work()
    return (time.process_time() - began) / calls * 1e6


def F_cost(n):
    """The check of a Jacobian is 2 n evaluations of F, and a little for each column; that little is counted, too."""
    calls = []

    def F(x):
        calls.append(0)
        return x

    eye = sp.eye(n, format="csc")
    p = perp.problem(F, np.zeros(n), jac=lambda x: eye)
    x = np.linspace(0, 1, n)
    p.check_jacobian(x)
    evaluations = len(calls)
    own = smallest(lambda: per_call(lambda: F(x), 200))
    return smallest(lambda: per_call(lambda: p.check_jacobian(x), 1)) / evaluations - own


def J_cost(n):
    """Problem.jac beyond the matrix that it makes for its caller."""
    A = sp.diags([-1.0, 2.0, -1.0], [-1, 0, 1], shape=(n, n), format="csc")
    p = perp.problem(lambda x: A @ x, np.zeros(n), jac=lambda x: A)
    x = np.linspace(0, 1, n)

    def made():
        return sp.csc_matrix((A.data.copy(), A.indices.copy(), A.indptr.copy()), shape=A.shape)

    p.jac(x)
    return smallest(lambda: per_call(lambda: p.jac(x), 50)) - smallest(lambda: per_call(made, 50))


def affine_cost(wrap):
    M = wrap(np.array([[4.0, -1, 0, 0], [-1, 4, -1, 0], [0, -1, 4, -1], [0, 0, -1, 4]]))
    q = np.array([-1.0, 2, -3, 4])
    return smallest(lambda: per_call(lambda: perp.lcp(M, q), 50))


def main():
    for n in (4, 100):
        print(f"F, n = {n}: {F_cost(n):.2f} us an evaluation")
    for n in (4, 100, 1000):
        print(f"sparse J, n = {n}, tridiagonal: {J_cost(n):.2f} us an evaluation")
    print(f"affine, 4 variables: {affine_cost(np.array):.1f} us a solve with dense M, {affine_cost(sp.csc_matrix):.1f} us with csc")
    if len(sys.argv) > 1:
        own = float(sys.argv[1])
        print(f"C++: {own:.1f} us; three times that and 20: {3 * own + 20:.1f} us")


if __name__ == "__main__":
    main()
