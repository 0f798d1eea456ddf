#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How the time of convex programs grows with their size, beside PIQP and one factorization: convex_growth.py ROWS...

Four families, each with about so many first-order conditions: linear-quadratic control with bounded inputs, the obstacle
problem of a square, flow in a network at quadratic costs, and sparse regression. Prints seconds of processor time as
convex_programs.py does. *LU* is one factorization by SuperLU of the first-order matrix, its diagonal raised by one."""

import math
import sys
import time
import warnings

import numpy as np
import perp
import scipy.sparse as sp
import scipy.sparse.linalg
from convex_programs import by_perp, by_piqp, first_order, seconds

STATES, INPUTS = 8, 2  # of a control step
DEGREE = 3  # arcs of a node
ENTRIES = 5  # of a row of data
NEAR = 30  # nodes that an arc spans, coefficients that a row of data spreads over


def program(P, q, A, l, u, lower, upper):
    return sp.csc_matrix(P), q, sp.csr_matrix(A), l, u, lower, upper


def control(rows, random):
    """min sum |x_t|^2 + |u_t|^2 / 10 with x_t+1 = A x_t + B u_t, |u_t| <= 1."""
    steps = max(2, rows // (2 * STATES + INPUTS))
    step = sp.eye(STATES) + 0.1 * sp.random(STATES, STATES, 0.3, random_state=random)
    B = random.standard_normal((STATES, INPUTS))
    stay, go = sp.kron(sp.eye(steps), sp.eye(STATES)), sp.kron(sp.eye(steps, k=-1), step)
    A = sp.hstack([stay - go, -sp.kron(sp.eye(steps), B)])
    b = np.concatenate([step @ (3 * random.standard_normal(STATES)), np.zeros((steps - 1) * STATES)])
    n, m = steps * STATES, steps * INPUTS
    P = sp.diags(np.concatenate([np.ones(n), np.full(m, 0.1)]))
    bound = np.concatenate([np.full(n, np.inf), np.ones(m)])
    return program(P, np.zeros(n + m), A, b, b, -bound, bound)


def obstacle(rows, _):
    """A membrane under load above a bump."""
    side = math.isqrt(rows)
    line = sp.diags([-1.0, 2.0, -1.0], [-1, 0, 1], (side, side))
    x = np.linspace(-1, 1, side)
    bump = (0.3 - np.add.outer(x**2, x**2)).ravel()
    n = side * side
    P = sp.kron(line, sp.eye(side)) + sp.kron(sp.eye(side), line)
    none = np.zeros(0)
    return program(P, np.full(n, 1 / n), sp.csr_matrix((0, n)), none, none, bump, np.full(n, np.inf))


def flow(rows, random):
    """Quadratic costs on arcs, supplies at nodes, capacities."""
    nodes = rows // (DEGREE + 1)
    tails = np.repeat(np.arange(nodes), DEGREE)
    near = (tails + 1 + random.integers(0, NEAR, len(tails))) % nodes
    heads = np.where(np.arange(len(tails)) % DEGREE == 0, (tails + 1) % nodes, near)
    arcs = np.arange(len(tails))
    A = sp.csr_matrix((np.ones(len(arcs)), (tails, arcs))) - sp.csr_matrix((np.ones(len(arcs)), (heads, arcs)))
    feasible = random.uniform(0, 1, len(arcs))
    b = A @ feasible
    P = sp.diags(random.uniform(0.1, 1, len(arcs)))
    return program(P, random.uniform(0, 1, len(arcs)), A, b, b, np.zeros(len(arcs)), np.full(len(arcs), 2.0))


def regression(rows, random):
    """min |r|^2 / 2 + 0.1 sum t with D w - r = y, -t <= w <= t; a row of D sees a few neighbouring coefficients."""
    n = rows // 8
    m = 2 * n
    rows_of = np.repeat(np.arange(m), ENTRIES)
    columns = (rows_of // 2 + random.integers(0, NEAR, len(rows_of))) % n
    D = sp.csr_matrix((random.standard_normal(len(rows_of)), (rows_of, columns)), (m, n))
    y = D @ np.where(random.uniform(size=n) < 0.1, random.standard_normal(n), 0) + 0.1 * random.standard_normal(m)
    eye, none = sp.eye(n), None
    A = sp.bmat([[D, -sp.eye(m), none], [eye, none, eye], [-eye, none, eye]])
    P = sp.diags(np.concatenate([np.zeros(n), np.ones(m), np.zeros(n)]))
    q = np.concatenate([np.zeros(n + m), np.full(n, 0.1)])
    free = np.full(2 * n + m, np.inf)
    zero, up = np.zeros(2 * n), np.full(2 * n, np.inf)
    return program(P, q, A, np.concatenate([y, zero]), np.concatenate([y, up]), -free, free)


def factorization(program):
    M = first_order(*program)[0]

    def run():
        scipy.sparse.linalg.splu(sp.csc_matrix(M + sp.eye(M.shape[0])))
        return True

    return run


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    warnings.simplefilter("ignore", perp.SolutionWarning)
    names = ("auto", "PIQP", "LU")
    print(f"{'problem':12} {'rows':>8}", *(f"{name:>10}" for name in names))
    for family in (control, obstacle, flow, regression):
        sizes, times = [], []
        for rows in map(int, sys.argv[1:]):
            made = family(rows, np.random.default_rng(1))
            sizes.append(len(first_order(*made)[1]))
            times.append([seconds(run) for run in (by_perp(made, "auto"), by_piqp(made), factorization(made))])
            print(f"{family.__name__:12} {sizes[-1]:8}", *(f"{t:10.4f}" for t in times[-1]), flush=True)
        growth = np.log(np.array(times)[-1] / np.array(times)[0]) / math.log(sizes[-1] / sizes[0])
        print(f"{'  exponent':21}", *(f"{g:10.2f}" for g in growth), flush=True)


if __name__ == "__main__":
    main()
