# SPDX-License-Identifier: Apache-2.0
"""Dense affine variational inequalities beside DAQP (PyPI daqp, is_avi): `python bench/affine_vi.py`, with perp and daqp to be
imported. CPU seconds, the least of three, one thread. Perp's have the judgement of the solution in them, DAQP judges nothing.

Each of the kinds has 2 n rows a_i x >= b_i of normal numbers about a point inside:
  definite    M = G G'/n + I/10 + (S - S')/sqrt(n), within a box of sides up to 2
  skew        M = G G'/n + I/1000000 + S - S', without a box: hardly symmetric at all"""

import sys
import time

import numpy as np

import perp

try:
    import daqp
except ImportError:
    sys.exit("bench/affine_vi.py needs daqp 0.11 (PyPI)")


def problem(kind, n, seed):
    random = np.random.default_rng(seed)
    G, S, A = random.normal(size=(n, n)), random.normal(size=(n, n)), random.normal(size=(2 * n, n))
    inside = random.normal(size=n)
    b = A @ inside - 0.3 * np.sqrt(n) * random.random(2 * n)
    q = 5 * random.normal(size=n)
    if kind == "definite":
        M = G @ G.T / n + 0.1 * np.eye(n) + (S - S.T) / np.sqrt(n)
        return M, q, A, b, inside - random.random(n), inside + random.random(n)
    return G @ G.T / n + 1e-6 * np.eye(n) + S - S.T, q, A, b, np.full(n, -np.inf), np.full(n, np.inf)


def least(run, times=3):
    best, answer = np.inf, None
    for _ in range(times):
        begin = time.process_time()
        answer = run()
        best = min(best, time.process_time() - begin)
    return best, answer


def by_daqp(M, q, A, b, lower, upper):
    upper_ = np.where(np.isinf(upper), 1e30, upper)
    lower_ = np.where(np.isinf(lower), -1e30, lower)
    above = np.concatenate([upper_, np.full(len(b), 1e30)])
    x, _, flag, _ = daqp.solve(M.copy(), q, A, above, np.concatenate([lower_, b]), is_avi=True, primal_tol=1e-9)
    return x, flag


def main():
    print(f"{'kind':10} {'n':>4} {'perp.vi':>10} {'DAQP':>10} {'ratio':>6} {'lifted':>10} {'ratio':>6}  differ by")
    ratios = []
    for kind in ("definite", "skew"):
        for n in (10, 20, 50, 100, 200):
            rows = []
            for seed in range(5):
                M, q, A, b, lower, upper = problem(kind, n, seed)
                ours, r = least(lambda: perp.vi((M, q), None, A, b, None, lower, upper))
                theirs, (x, flag) = least(lambda: by_daqp(M, q, A, b, lower, upper))
                assert r.success and flag == 1, (kind, n, seed, r.message, flag)
                lifted = np.nan
                if n <= 100 and seed < 2:
                    L = np.block([[M, -A.T], [A, np.zeros((2 * n, 2 * n))]])
                    low, high = np.concatenate([lower, np.zeros(2 * n)]), np.concatenate([upper, np.full(2 * n, np.inf)])
                    lifted, s = least(lambda: perp.mcp_affine(L, np.concatenate([q, -b]), low, high), 1)
                    assert s.success
                rows.append((ours, theirs, lifted, np.abs(r.x - x).max()))
            ours, theirs, lifted, off = np.array(rows).T
            ratio = np.exp(np.mean(np.log(ours / theirs)))
            known = ~np.isnan(lifted)
            beside = np.exp(np.mean(np.log(lifted[known] / ours[known]))) if known.any() else np.nan
            ratios.append(ratio)
            print(f"{kind:10} {n:4} {ours.min():10.5f} {theirs.min():10.5f} {ratio:6.2f} {np.nanmin(lifted, initial=np.inf):10.5f} {beside:6.1f}  {off.max():.0e}", flush=True)
    print(f"geometric mean of perp.vi / DAQP: {np.exp(np.mean(np.log(ratios))):.2f}")


if __name__ == "__main__":
    main()
