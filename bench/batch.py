# SPDX-License-Identifier: Apache-2.0
"""10,000 problems of a kind by perp.batch and perp.contact.Batch, beside a loop of single solves: `python bench/batch.py
[COUNT]`, with perp to be imported. The loop solves every 20th problem, or steps all of every 20th step, and its time is scaled
up; the answers of both are compared."""

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


class Towers:
    """Towers of five cubes of 1 m on a ground that shakes, one step after the other: 20 contacts, four in each gap."""

    H, CUBES = 0.005, 5

    def __init__(self, count):
        random = np.random.default_rng(3)
        mass = random.uniform(0.5, 2, (count, self.CUBES))  # kg
        self.mu = np.repeat(random.uniform(0.2, 0.8, (count, 1)), 4 * self.CUBES, axis=1)
        self.shake = random.uniform(0, 3, count), random.uniform(1, 3, count), random.uniform(0, 6, count)  # m/s^2, Hz, -
        self.G = np.zeros((12 * self.CUBES, 6 * self.CUBES))  # from velocities of the cubes to those of the contacts
        corners = [(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)]
        for i, (c, (x, y)) in ((i, corner) for i in range(self.CUBES) for corner in enumerate(corners)):
            for cube, z, sign in ((i, -0.5, 1), (i - 1, 0.5, -1))[: 1 + (i > 0)]:
                for e, axis in enumerate(np.eye(3)[[2, 0, 1]]):
                    row = sign * np.concatenate([axis, np.cross([x, y, z], axis)])
                    self.G[12 * i + 3 * c + e, 6 * cube : 6 * cube + 6] = row
        self.inverse = np.kron(1 / mass, [1, 1, 1, 6, 6, 6])  # of masses and moments of inertia
        self.W = np.einsum("ij,kj,lj->kil", self.G, self.inverse, self.G)
        self.v, self.time = np.zeros_like(self.inverse), 0

    def q(self):
        size, frequency, phase = self.shake
        push = size * np.sin(2 * np.pi * frequency * self.time + phase)
        self.free = self.v + self.H * (push[:, None] * np.tile([1.0, 0, 0, 0, 0, 0], self.CUBES))
        self.free += self.H * np.tile([0, 0, -9.81, 0, 0, 0], self.CUBES)
        return self.free @ self.G.T

    def advance(self, r):
        self.v, self.time = self.free + (r @ self.G) * self.inverse, self.time + self.H


def towers(count, simulations=100):
    """Seconds of the batch and of loops of single solves, cold and from the impulses before, and the largest difference of
    velocities."""
    one, batch, r = Towers(simulations), perp.contact.Batch(simulations), None
    seconds, cold, warm, off = 0.0, 0.0, 0.0, 0.0
    for t in range(max(count // simulations, EVERY)):
        q = one.q()
        took, step = timed(lambda: batch.step(one.W, q, one.mu))
        assert step.success.all()
        seconds += took
        if t % EVERY == EVERY // 2:
            each = range(simulations)
            took, ones = timed(lambda: [perp.contact.solve(one.W[k], q[k], one.mu[k]) for k in each])
            cold, off = cold + EVERY * took, max(off, *(np.abs(x.u - step.u[k]).max() for k, x in zip(each, ones)))
            took, ones = timed(lambda: [perp.contact.solve(one.W[k], q[k], one.mu[k], r0=r[k]) for k in each])
            warm += EVERY * took
        one.advance(step.r)
        r = step.r
    return seconds, cold, warm, off


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

    seconds, cold, warm, off = towers(COUNT)
    show("20 contacts, cold", seconds, cold, off)
    show("20 contacts, from r0", seconds, warm, off)


if __name__ == "__main__":
    main()
