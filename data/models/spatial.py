# SPDX-License-Identifier: Apache-2.0
"""Spatial price equilibria with exact ties: regions on a grid, the cost of a route its Manhattan distance. See
../README.md."""

from draw import Draw
from nlwriter import Model, total


def spatial(name, rows, columns, demand, neighbours_only=False, lowest=0.0, seed=1):
    """rows x columns regions; demand "linear" or "isoelastic"; routes between all pairs or between neighbours only;
    prices at least `lowest`. Regions of three kinds repeat, so that equal prices are common."""
    draw = Draw(seed)
    m = Model(name)
    places = [(i, j) for i in range(rows) for j in range(columns)]
    label = {r: f"{r[0] + 1}_{r[1] + 1}" for r in places}

    def distance(a, b):
        return abs(a[0] - b[0]) + abs(a[1] - b[1])

    reach = 1 if neighbours_only else rows + columns
    routes = [(a, b) for a in places for b in places if 0 < distance(a, b) <= reach]
    #        kind: marginal cost at 0, its slope; demand at the price 10; elasticity
    kinds = [(4, 1, 20, 0.5), (7, 0.5, 30, 0.8), (12, 0.25, 25, 1.5)]
    kind = {r: draw.pick(kinds) for r in places}

    price = {r: m.variable(f"price[{label[r]}]", lower=lowest, start=1) for r in places}
    output = {r: m.variable(f"supply[{label[r]}]", lower=0, start=0) for r in places}
    flow = {(a, b): m.variable(f"flow[{label[a]},{label[b]}]", lower=0, start=0) for a, b in routes}
    arrivals, departures = {r: [] for r in places}, {r: [] for r in places}
    for a, b in routes:
        arrivals[b].append(flow[a, b])
        departures[a].append(flow[a, b])
    for r in places:
        cost, slope, level, elasticity = kind[r]
        if demand == "linear":
            wanted = level * (1 + elasticity) - level * elasticity / 10 * price[r]
        else:
            wanted = level * (price[r] / 10) ** -elasticity
        m.complement(f"market[{label[r]}]", output[r] + total(arrivals[r]) - total(departures[r]) - wanted, price[r])
        m.complement(f"profit[{label[r]}]", cost + slope * output[r] - price[r], output[r])
    for a, b in routes:
        m.complement(f"arbitrage[{label[a]},{label[b]}]", price[a] + distance(a, b) - price[b], flow[a, b])
    return m
