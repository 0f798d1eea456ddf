# SPDX-License-Identifier: Apache-2.0
"""Quadratic games beside the six solvers of NashOpt (PyPI nashopt 1.2.2): `python bench/lq_games.py [INSTANCES [N...]]`, with
perp and nashopt to be imported.

The games are those of NashOpt's script examples/vgne/example_lq_vgne_comparison.py, drawn in its order from its seed 42: N
players of 5 variables in boxes, all with the same 10 N dense rows, and N // 2 equalities or none, made strongly monotone. As
there, lemke gets no equalities and N <= 50, prox_admm and log_ipm N <= 20.

CPU seconds on one thread, median of the instances. Those of perp.lq_game have all in them: matrices, the test of each player's
convexity, the judgement. Those of NashOpt are of solve() alone, as in its script; the last column has its constructor, too. Both
have solved a first game before. A solver has solved a game if it says so and its point is within 1e-4 of Perp's, whose residual
the judge has seen, in the largest norm."""

import sys
import time
import warnings

import numpy as np

import perp

try:
    from nashopt import GNEP_LQ
except ImportError:
    sys.exit("bench/lq_games.py needs nashopt 1.2.2 (PyPI)")

SOLVERS = ("lemke", "lemke_dual", "goldnash", "dr_daqp", "prox_admm", "log_ipm")
SIZES = (2, 3, 5, 10, 20, 30, 50, 100)
n = 5


def game(N, equalities, random):
    """make_instance of the script."""
    total, rows = N * n, 10 * N
    Q = []
    for _ in range(N):
        B = random.standard_normal((total, total))
        Q.append(B.T @ B)
    c = [5.0 * random.standard_normal(total) for _ in range(N)]
    blocks = [slice(i * n, (i + 1) * n) for i in range(N)]
    G = np.vstack([Q[i][block] for i, block in enumerate(blocks)])
    shift = 1e-4 + max(-np.linalg.eigvalsh(0.5 * (G + G.T)).min(), 0.0)
    for i, block in enumerate(blocks):
        Q[i][block, block] += shift * np.eye(n)
    lower, upper = -random.uniform(0.1, 5.0, total), random.uniform(0.1, 5.0, total)
    inside = random.uniform(0, 0.1, total) * upper + lower
    A = random.standard_normal((rows, total))
    b = np.max(A @ inside) + random.uniform(0.1, 0.5, rows)
    Aeq = random.standard_normal((equalities, total)) if equalities else None
    return Q, c, A, b, Aeq, None if Aeq is None else Aeq @ inside, lower, upper


def timed(run):
    begin = time.process_time()
    answer = run()
    return time.process_time() - begin, answer


def by_nashopt(solver, N, Q, c, A, b, Aeq, beq, lower, upper):
    """(seconds of solve(), with the constructor, x or None)."""
    skipped = solver == "lemke" and (Aeq is not None or N > 50) or solver in ("prox_admm", "log_ipm") and N > 20
    if skipped:
        return np.nan, np.nan, None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            words = {"lb": lower, "ub": upper, "Aeq": Aeq, "beq": beq, "variational": True, "solver": solver}
            before, made = timed(lambda: GNEP_LQ(dim=[n] * N, Q=Q, c=c, A=A, b=b, **words))
            seconds, answer = timed(made.solve)
        except Exception as error:  # the script counts whatever its solvers raise as a failure
            print(f"{solver}, N = {N}: {type(error).__name__}: {error}", file=sys.stderr)
            return np.nan, np.nan, None
    said = answer is not None and getattr(answer, "success", getattr(answer, "info", {}).get("converged", True))
    return seconds, before + seconds, np.asarray(answer.x) if said else None


def main(instances=3, sizes=SIZES):
    for solver in SOLVERS:  # what is compiled, is compiled before
        by_nashopt(solver, 2, *(first := game(2, 0, np.random.default_rng(0))))
    Q, c, A, b, Aeq, beq, lower, upper = first
    perp.lq_game([n, n], Q, c, A, b, Aeq, beq, lower, upper)
    for title, equalities in (("no equalities", lambda N: 0), ("N // 2 equalities", lambda N: N // 2)):
        print(f"\n{title}; median seconds (solved of {instances})\n")
        print("| N | lq_game | " + " | ".join(SOLVERS) + " | best / lq_game | with its constructor |")
        print("|---" * (len(SOLVERS) + 4) + "|", flush=True)
        random = np.random.default_rng(42)
        for N in sizes:
            ours, theirs, whole = [], {s: [] for s in SOLVERS}, {s: [] for s in SOLVERS}
            solved = dict.fromkeys(("lq_game", *SOLVERS), 0)
            for _ in range(instances):
                Q, c, A, b, Aeq, beq, lower, upper = one = game(N, equalities(N), random)
                seconds, answer = timed(lambda: perp.lq_game([n] * N, Q, c, A, b, Aeq, beq, lower, upper))
                ours.append(seconds)
                solved["lq_game"] += answer.success
                for solver in SOLVERS:
                    seconds, with_constructor, x = by_nashopt(solver, N, *one)
                    theirs[solver].append(seconds)
                    whole[solver].append(with_constructor)
                    solved[solver] += x is not None and answer.success and np.abs(x - answer.x).max() <= 1e-4
            medians = {s: np.median(times) for s, times in theirs.items()}
            all_solved = [s for s in SOLVERS if solved[s] == instances]
            ratios = [min(np.median(times[s]) for s in all_solved) / np.median(ours) for times in (theirs, whole)]
            cells = [f"{medians[s]:.4f} ({solved[s]})" if np.isfinite(medians[s]) else "-" for s in SOLVERS]
            row = [str(N), f"{np.median(ours):.4f} ({solved['lq_game']})", *cells, *(f"{ratio:.1f}" for ratio in ratios)]
            print("| " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 3, tuple(map(int, sys.argv[2:])) or SIZES)
