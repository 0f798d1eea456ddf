# SPDX-License-Identifier: Apache-2.0
"""Traffic equilibria (Wardrop): flows by destination on a grid of streets, travel times of the Bureau of Public Roads.
See ../README.md."""

from draw import Draw
from nlwriter import Model, total


def even_loads(nodes, streets, trips):
    """What every street carries if drivers split evenly over the streets that bring them nearer."""
    load = {s: 0.0 for s in streets}
    exits = leaving(nodes, streets)
    for goal, departures in trips.items():
        far = {v: abs(v[0] - goal[0]) + abs(v[1] - goal[1]) for v in nodes}
        ways = {v: [(a, b) for a, b in ways_out if far[b] < far[a]] for v, ways_out in exits.items()}
        waiting = {v: departures.get(v, 0) for v in nodes}
        for v in sorted(nodes, key=lambda v: (-far[v], v)):
            for s in ways[v]:
                load[s] += waiting[v] / len(ways[v])
                waiting[s[1]] += waiting[v] / len(ways[v])
    return load


def leaving(nodes, streets):
    out = {v: [] for v in nodes}
    for s in streets:
        out[s[0]].append(s)
    return out


def traffic(name, rows, columns, destinations, volumes=True, equal_times=False, origins=None, seed=1):
    """rows x columns junctions, streets both ways between neighbours, trips from every junction (or `origins` of them)
    to each destination. volumes: the flow on a street is a variable of its own, otherwise a sum inside the power.
    equal_times: all streets are alike, so that many ways tie."""
    draw = Draw(seed)
    m = Model(name)
    nodes = [(i, j) for i in range(rows) for j in range(columns)]
    label = {v: f"{v[0] + 1}_{v[1] + 1}" for v in nodes}
    steps = ((0, 1), (1, 0), (0, -1), (-1, 0))
    streets = [(v, (v[0] + di, v[1] + dj)) for v in nodes for di, dj in steps]
    streets = [(a, b) for a, b in streets if b in label]
    goals = draw.sample(nodes, destinations)
    trips = {}
    for goal in goals:
        starts = [v for v in nodes if v != goal] if origins is None else draw.sample([v for v in nodes if v != goal], origins)
        trips[goal] = {v: draw.integer(1, 3) for v in starts}
    load = even_loads(nodes, streets, trips)
    mean = sum(load.values()) / len(streets)
    free_time = {s: 1 if equal_times else draw.integer(1, 3) for s in streets}
    capacity = {s: max(0.5 * mean, load[s]) * (1 if equal_times else draw.real(0.5, 1.5)) for s in streets}
    capacity = {s: max(round(c, 1), 0.1) for s, c in capacity.items()}

    street = {s: f"{label[s[0]]},{label[s[1]]}" for s in streets}
    flow = {(s, k): m.variable(f"flow[{street[s]},{label[k]}]", lower=0, start=0) for s in streets for k in goals}
    time = {(v, k): m.variable(f"time[{label[v]},{label[k]}]", lower=0, start=0) for v in nodes for k in goals if v != k}
    exits, entries = leaving(nodes, streets), {v: [] for v in nodes}
    for s in streets:
        entries[s[1]].append(s)
    for s in streets:
        volume = total(flow[s, k] for k in goals)
        if volumes and len(goals) > 1:
            variable = m.variable(f"volume[{street[s]}]", start=0)
            m.equation(f"volume[{street[s]}]", variable - volume)
            volume = variable
        duration = free_time[s] * (1 + 0.15 * (volume / capacity[s]) ** 4)
        for k in goals:
            after = time[s[1], k] if s[1] != k else 0
            before = time[s[0], k] if s[0] != k else 0
            m.complement(f"choice[{street[s]},{label[k]}]", duration + after - before, flow[s, k])
    for v, k in time:
        out = total(flow[s, k] for s in exits[v]) - total(flow[s, k] for s in entries[v])
        m.complement(f"trips[{label[v]},{label[k]}]", out - trips[k].get(v, 0), time[v, k])
    return m
