#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Convex programs beside PIQP and HiGHS, in one process: convex_programs.py METHOD,METHOD... FILE.mat...

A file holds P, q, A, l, u of min x'P x / 2 + q'x with l <= A x <= u (the Maros-Meszaros set of qpsolvers), or PIQP's
form with c, A x = b, h_l <= G x <= h_u, x_l <= x <= x_u (its netlib programs). Perp solves the first-order conditions as an
affine MCP by each METHOD, to a natural residual of 1e-8. PIQP solves those with P, HiGHS those without, to 1e-9. Prints
seconds of processor time, the least of three runs, and the geometric mean of their ratios where both solve."""

import math
import sys
import time
import warnings
from pathlib import Path

import highspy
import numpy as np
import perp
import piqp
import scipy.io
import scipy.sparse as sp

TOLERANCE = 1e-8
PEERS_TOLERANCE = 1e-9
LIMIT = 60  # seconds
INFINITE = 1e19


def read(path):
    """P, q, A, l, u, and the bounds that rows with one entry make."""
    data = scipy.io.loadmat(path)
    vector = lambda key: data[key].astype(float).ravel()
    if "c" in data:
        q = vector("c")
        rows = [sp.csr_matrix(data[k].astype(float)).reshape((-1, len(q))) for k in ("A", "G")]
        A = sp.vstack([*rows, sp.eye(len(q))]).tocsr()
        l, u = (np.concatenate([vector(k) for k in keys]) for keys in (("b", "h_l", "x_l"), ("b", "h_u", "x_u")))
    else:
        q, A, l, u = vector("q"), sp.csr_matrix(data["A"].astype(float)), vector("l"), vector("u")
    P = sp.csc_matrix(data["P"].astype(float)) if data["P"].size else sp.csc_matrix((len(q), len(q)))
    l, u = np.where(l <= -INFINITE, -np.inf, l), np.where(u >= INFINITE, np.inf, u)
    lower, upper = np.full(len(q), -np.inf), np.full(len(q), np.inf)
    entries = np.diff(A.indptr)
    single = (entries == 1) & (np.asarray(abs(A).sum(axis=1)).ravel() == 1) & (np.asarray(A.sum(axis=1)).ravel() == 1)
    for i in np.flatnonzero(single):
        j = A.indices[A.indptr[i]]
        lower[j], upper[j] = max(lower[j], l[i]), min(upper[j], u[i])
    keep = ~single & (entries > 0)
    return P, q, A[keep].tocsr(), l[keep], u[keep], lower, upper


def first_order(P, q, A, l, u, lower, upper):
    """M, q and bounds of (x, y, s): s are the rows with two different finite bounds."""
    m = len(l)
    ranges = np.flatnonzero((l != u) & np.isfinite(l) & np.isfinite(u))
    S = sp.csr_matrix((np.ones(len(ranges)), (ranges, np.arange(len(ranges)))), shape=(m, len(ranges)))
    M = sp.bmat([[P, -A.T, None], [A, sp.csr_matrix((m, m)), -S], [None, S.T, sp.csr_matrix((len(ranges),) * 2)]])
    b = np.where(np.isfinite(l), l, np.where(np.isfinite(u), u, 0))
    b[ranges] = 0
    free = ~np.isfinite(l) & ~np.isfinite(u)
    y_lower = np.where(np.isfinite(u) | (l == u), -np.inf, 0)
    y_upper = np.where(np.isfinite(l) | (l == u), np.inf, 0)
    y_lower[free] = y_upper[free] = 0
    return (
        M.tocsc(),
        np.concatenate([q, -b, np.zeros(len(ranges))]),
        np.concatenate([lower, y_lower, l[ranges]]),
        np.concatenate([upper, y_upper, u[ranges]]),
    )


def by_perp(program, method):
    mcp = first_order(*program)
    return lambda: perp.mcp_affine(*mcp, method=method, tol=TOLERANCE, time_limit=LIMIT).success


def by_piqp(program):
    P, q, A, l, u, lower, upper = program
    equal = l == u
    finite = lambda v: np.clip(v, -1e30, 1e30)

    def run():
        solver = piqp.SparseSolver()
        solver.settings.eps_abs, solver.settings.eps_rel = PEERS_TOLERANCE, 0
        solver.settings.max_iter, solver.settings.check_duality_gap = 1000, False
        rows = A[~equal].tocsc(), finite(l[~equal]), finite(u[~equal])
        solver.setup(P, q, A[equal].tocsc(), l[equal], *rows, finite(lower), finite(upper))
        return solver.solve() == piqp.PIQP_SOLVED

    return run


def by_highs(program):
    _, q, A, l, u, lower, upper = program
    columns = A.tocsc()

    def run():
        highs, lp = highspy.Highs(), highspy.HighsLp()
        highs.silent()
        for key, value in (("threads", 1), ("time_limit", float(LIMIT))):
            highs.setOptionValue(key, value)
        for key in ("primal_feasibility_tolerance", "dual_feasibility_tolerance"):
            highs.setOptionValue(key, PEERS_TOLERANCE)
        lp.num_col_, lp.num_row_ = len(q), len(l)
        lp.col_cost_, lp.col_lower_, lp.col_upper_, lp.row_lower_, lp.row_upper_ = q, lower, upper, l, u
        lp.a_matrix_.format_ = highspy.MatrixFormat.kColwise
        lp.a_matrix_.start_, lp.a_matrix_.index_, lp.a_matrix_.value_ = columns.indptr, columns.indices, columns.data
        highs.passModel(lp)
        highs.run()
        return highs.getModelStatus() == highspy.HighsModelStatus.kOptimal

    return run


def seconds(run):
    """The least of three runs; infinite if it does not solve."""
    least = math.inf
    for _ in range(3):
        began = time.process_time()
        if not run():
            return math.inf
        took = time.process_time() - began
        least = min(least, took)
        if took > 1:
            break
    return least


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    warnings.simplefilter("ignore", perp.SolutionWarning)  # optima of programs are often not the only ones
    methods = sys.argv[1].split(",")
    logs = {method: [] for method in methods}
    print(f"{'problem':12} {'rows':>7} {'peer':>9}", *(f"{m:>16}" for m in methods))
    for path in sys.argv[2:]:
        program = read(path)
        peer = seconds(by_piqp(program) if program[0].nnz else by_highs(program))
        times = {method: seconds(by_perp(program, method)) for method in methods}
        rows = len(first_order(*program)[1])
        print(f"{Path(path).stem:12} {rows:7} {peer:9.4f}", *(f"{times[m]:16.4f}" for m in methods), flush=True)
        for method, took in times.items():
            if math.isfinite(took) and math.isfinite(peer):
                logs[method].append(math.log(took / peer))
    for method, log in logs.items():
        if log:
            mean = math.exp(sum(log) / len(log))
            print(f"{method}: {len(log)} that both solve, geometric mean of the ratios {mean:.2f}")


if __name__ == "__main__":
    main()
