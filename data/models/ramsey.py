# SPDX-License-Identifier: Apache-2.0
"""Ramsey growth with an exhaustible resource, a backstop and an emission cap, in Mathiesen's format over time. See
../README.md."""

import itertools
import operator

from nlwriter import Model, exp, log, total

GROWTH, INTEREST, DECAY = 0.02, 0.05, 0.07
OUTPUT, CAPITAL, LABOUR, ENERGY = 100.0, 34.0, 60.0, 6.0  # of period 0 on the benchmark path
ENERGY_ELASTICITY, TIME_ELASTICITY = 0.4, 0.5
BACKSTOP = 1.8  # its cost in units of output, falling by 1 % a period


def ramsey(name, periods, stock=0.6, cap_from=None, cap=0.5, capital=1.0, lowest=1e-4, ones=False):
    """A fraction `stock` of the benchmark's extraction is in the ground, emissions are capped at `cap` of the first
    period's from period `cap_from` on, the first capital is `capital` times the benchmark's. The start is the benchmark
    path, or all ones."""
    m = Model(name)
    T = range(periods)
    # Products, not powers: the same on every machine.
    size = list(itertools.accumulate([1.0] + [1 + GROWTH] * (periods - 1), operator.mul))
    present = list(itertools.accumulate([1.0] + [1 + INTEREST] * (periods - 1), operator.truediv))
    backstop = list(itertools.accumulate([BACKSTOP] + [0.99] * (periods - 1), operator.mul))
    capital0 = CAPITAL / (INTEREST + DECAY)
    invested0 = (GROWTH + DECAY) * capital0
    consumed0 = OUTPUT - invested0 - ENERGY
    lifetime = sum(consumed0 * size[t] * present[t] for t in T)

    def variable(label, value, lower=0.0, upper=None):
        start = 1 if ones and upper is None else value
        return m.variable(label, lower, float("inf") if upper is None else upper, start)

    def path(label, level, lower=0.0):
        return [variable(f"{label}[{t}]", level(t), lower) for t in T]

    Y = path("output", lambda t: size[t])  # in units of the first period's benchmark, as are I, X, B
    I = path("investment", lambda t: size[t])
    K = path("capital", lambda t: size[t])
    X = path("fossil", lambda t: size[t])
    B = path("backstop", lambda t: 0)
    p = [variable("price[0]", 1, 1, 1)] + [variable(f"price[{t}]", present[t], lowest) for t in T if t > 0]
    w = path("wage", lambda t: present[t], lowest)
    rent = path("rental", lambda t: present[t], lowest)
    q = path("price_of_capital", lambda t: (1 + INTEREST) * present[t], lowest)
    e = path("price_of_energy", lambda t: present[t], lowest)
    capped = [t for t in T if cap_from is not None and t >= cap_from]
    permit = {t: variable(f"permit[{t}]", 0) for t in capped}
    last_q = variable("price_of_capital[end]", present[-1], lowest)
    last_K = variable("capital[end]", size[-1] * (1 + GROWTH), 0.01)
    in_ground = variable("resource_rent", 0)
    living = variable("price_of_utility", 1, lowest)
    wealth = variable("wealth", lifetime, 1.0 if not ones else lowest)

    value_added = CAPITAL + LABOUR
    unit, energy, labour, services = [], [], [], []
    for t in T:  # CES of energy and a Cobb-Douglas of capital and labour; uses are of an output of 1, in benchmark units
        inner = exp(CAPITAL / value_added * log(rent[t]) + LABOUR / value_added * log(w[t]))
        power = 1 - ENERGY_ELASTICITY
        cost = (value_added / OUTPUT * inner**power + ENERGY / OUTPUT * e[t] ** power) ** (1 / power)
        unit.append(cost)
        energy.append((cost / e[t]) ** ENERGY_ELASTICITY)
        labour.append((cost / inner) ** ENERGY_ELASTICITY * inner / w[t])
        services.append((cost / inner) ** ENERGY_ELASTICITY * inner / rent[t])
    after = q[1:] + [last_q]  # price of capital in the next period
    for t in T:
        m.complement(f"profit[{t}]", unit[t] - p[t], Y[t])
        m.complement(f"investing[{t}]", p[t] - after[t], I[t])
        m.complement(f"holding[{t}]", q[t] - (INTEREST + DECAY) * rent[t] - (1 - DECAY) * after[t], K[t])
        m.complement(f"extracting[{t}]", p[t] + in_ground + permit.get(t, 0) - e[t], X[t])
        m.complement(f"backstop[{t}]", backstop[t] * p[t] - e[t], B[t])
        consumed = consumed0 * size[t] * wealth / (lifetime * living) * (living * present[t] / p[t]) ** TIME_ELASTICITY
        used = consumed + invested0 * I[t] + ENERGY * (X[t] + backstop[t] * B[t])
        m.complement(f"market[{t}]", OUTPUT * Y[t] - used, p[t])
        m.complement(f"labour[{t}]", LABOUR * (size[t] - labour[t] * Y[t]), w[t])
        m.complement(f"services[{t}]", CAPITAL * (K[t] - services[t] * Y[t]), rent[t])
        m.complement(f"energy[{t}]", ENERGY * (X[t] + B[t] - energy[t] * Y[t]), e[t])
        before = capital0 * capital if t == 0 else (1 - DECAY) * capital0 * K[t - 1] + invested0 * I[t - 1]
        m.complement(f"capital[{t}]", before - capital0 * K[t], q[t])
    for t in capped:
        m.complement(f"emissions[{t}]", ENERGY * (cap - X[t]), permit[t])
    m.complement("capital[end]", (1 - DECAY) * capital0 * K[-1] + invested0 * I[-1] - capital0 * last_K, last_q)
    # Investment grows as output does in the last period (Lau, Pahlke & Rutherford 2002).
    m.complement("terminal", I[-1] / I[-2] - Y[-1] / Y[-2], last_K)
    m.complement("resource", ENERGY * (stock * sum(size) - total(X)), in_ground)
    share = [consumed0 * size[t] * present[t] / lifetime for t in T]
    power = 1 - TIME_ELASTICITY
    index = total(share[t] * (p[t] / present[t]) ** power for t in T) ** (1 / power)
    m.complement("utility", lifetime * (living - index), living)
    earned = total(LABOUR * size[t] * w[t] for t in T) + capital0 * capital * q[0]
    scarce = total(ENERGY * cap * permit[t] for t in capped)
    owned = ENERGY * stock * sum(size) * in_ground
    m.complement("budget", wealth - earned - scarce - owned + capital0 * last_K * last_q, wealth)
    return m
