# SPDX-License-Identifier: Apache-2.0
"""10,000 problems of a kind by perp.batch, beside a loop of single solves: `python bench/batch.py [COUNT]`, with perp to be
imported. The loop solves every 20th problem, and its time is scaled up; the answers of both are compared."""

import sys
import time

import numpy as np

import perp

COUNT = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
EVERY = 20


def lq_games(count):
    """Ten players of five variables, 100 shared rows; costs and right sides differ."""
    random = np.random.default_rng(1)
    n, m = 50, 100
    G = np.empty((n, n))
    for i in range(10):
        H = random.normal(size=(n, n))
        G[5 * i : 5 * i + 5] = (H @ H.T / n + np.eye(n))[5 * i : 5 * i + 5]
    A = random.normal(size=(m, n))
    q, b = 3 * random.normal(size=(count, n)), -random.random((count, m))
    return G, q, A, b


def timed(run):
    begin = time.perf_counter()
    answer = run()
    return time.perf_counter() - begin, answer


def show(name, seconds, loop, off):
    print(f"{name:32} {seconds:8.2f} s {loop:9.2f} s {loop / seconds:7.1f}  {off:.0e}", flush=True)


def main():
    some = range(0, COUNT, EVERY)
    print(f"{COUNT} of each{'':24} batch       loop   ratio  largest difference")
    G, q, A, b = lq_games(COUNT)
    seconds, many = timed(lambda: perp.batch((G, q), lower=-np.inf, A=A, b=b))
    assert many.success.all()
    loop, ones = timed(lambda: [perp.vi((G, q[k]), A=A, b=b[k]).x for k in some])
    show("LQ games, 100 rows, vi", seconds, loop * EVERY, max(np.abs(x - many.x[k]).max() for k, x in zip(some, ones)))
    Q = [G] * 10

    def game(k):
        return perp.lq_game([5] * 10, Q, [q[k]] * 10, -A, -b[k]).x

    loop, _ = timed(lambda: [game(k) for k in list(some)[::10]])
    show("LQ games, 100 rows, lq_game", seconds, loop * EVERY * 10, np.nan)

    random = np.random.default_rng(2)
    p = random.uniform(-2, 2, size=(COUNT, 2))

    def F(x, p):
        return np.stack([x[:, 0] ** 3 + x[:, 1] - p[:, 0], np.exp(x[:, 1]) - 1 - x[:, 0] + p[:, 1]], axis=1)

    def J(x, p):
        D = np.zeros((len(x), 2, 2))
        D[:, 0, 0], D[:, 0, 1], D[:, 1, 0], D[:, 1, 1] = 3 * x[:, 0] ** 2, 1, -1, np.exp(x[:, 1])
        return D

    def one(k):
        a, b = p[k]
        f = lambda x: np.array([x[0] ** 3 + x[1] - a, np.exp(x[1]) - 1 - x[0] + b])  # noqa: E731
        j = lambda x: np.array([[3 * x[0] ** 2, 1], [-1, np.exp(x[1])]])  # noqa: E731
        return perp.solve(f, np.zeros(2), jac=j).x

    seconds, many = timed(lambda: perp.batch(F, np.zeros(2), parameters=p, jac=J))
    assert many.success.all()
    loop, ones = timed(lambda: [np.array(one(k)) for k in some])
    show("2 x 2 NCPs", seconds, loop * EVERY, max(np.abs(x - many.x[k]).max() for k, x in zip(some, ones)))

    M = np.array([[2.0, 1.0], [0.5, 3.0]])
    q = random.normal(size=(COUNT, 2))
    seconds, many = timed(lambda: perp.batch((M, q)))
    loop, ones = timed(lambda: [np.array(perp.lcp(M, q[k]).x) for k in some])
    show("2 x 2 LCPs", seconds, loop * EVERY, max(np.abs(x - many.x[k]).max() for k, x in zip(some, ones)))


if __name__ == "__main__":
    main()
