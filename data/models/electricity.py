# SPDX-License-Identifier: Apache-2.0
"""Electricity: Cournot firms on a linearised network (affine), and investment in plants under uncertain demand. See
../README.md."""

from draw import Draw
from nlwriter import Model, total


def grid_cournot(name, rows, columns, firms, seed=1):
    """Firms sell at every node of a rows x columns grid; the grid's operator moves power where it pays (Hobbs 2001)."""
    draw = Draw(seed)
    m = Model(name)
    nodes = [(i, j) for i in range(rows) for j in range(columns)]
    label = {v: f"{v[0] + 1}_{v[1] + 1}" for v in nodes}
    lines = [(v, w) for v in nodes for w in ((v[0], v[1] + 1), (v[0] + 1, v[1])) if w in label]
    F = range(1, firms + 1)
    plants = [(f, v) for v in nodes for f in F if draw.chance(1.6 / firms)]
    cost = {p: draw.integer(10, 40) for p in plants}
    capacity = {p: draw.integer(20, 100) for p in plants}
    choke = {v: draw.integer(80, 120) for v in nodes}
    slope = {v: draw.pick((0.5, 1.0, 2.0)) for v in nodes}
    conductance = {e: draw.pick((1, 2, 4)) for e in lines}
    limit = {e: draw.integer(3, 20) for e in lines}

    sales = {(f, v): m.variable(f"sales[{f},{label[v]}]", lower=0, start=0) for f in F for v in nodes}
    output = {p: m.variable(f"output[{p[0]},{label[p[1]]}]", lower=0, upper=capacity[p], start=0) for p in plants}
    margin = {f: m.variable(f"hub_price[{f}]", start=0) for f in F}  # what a further unit is worth to the firm
    at_hub = {v: (0, 0) if v == nodes[0] else () for v in nodes}
    fee = {v: m.variable(f"fee[{label[v]}]", *at_hub[v], start=0) for v in nodes}  # of the operator, from the hub to v
    angle = {v: m.variable(f"angle[{label[v]}]", *at_hub[v], start=0) for v in nodes}
    line = {e: f"{label[e[0]]},{label[e[1]]}" for e in lines}
    load = {e: m.variable(f"load[{line[e]}]", lower=-limit[e], upper=limit[e], start=0) for e in lines}
    voltage = {e: m.variable(f"loop_price[{line[e]}]", start=0) for e in lines}

    # max sum_v (p_v(sum of all sales) - fee_v) s_fv - sum_p (c_p - fee) g_p with total sales = total output
    for f in F:
        for v in nodes:
            everybody = total(sales[g, v] for g in F)
            marginal = choke[v] - slope[v] * everybody - slope[v] * sales[f, v] - fee[v]
            m.complement(f"selling[{f},{label[v]}]", margin[f] - marginal, sales[f, v])
        own = total(output[p] for p in plants if p[0] == f)
        m.equation(f"balance[{f}]", own - total(sales[f, v] for v in nodes))
    for p in plants:
        m.complement(f"generating[{p[0]},{label[p[1]]}]", cost[p] - fee[p[1]] - margin[p[0]], output[p])
    # The operator maximises sum_v fee_v y_v, y = net withdrawals, subject to the laws and limits of the lines.
    for v in nodes:
        withdrawn = total(sales[f, v] for f in F) - total(output[p] for p in plants if p[1] == v)
        carried = total(load[e] for e in lines if e[1] == v) - total(load[e] for e in lines if e[0] == v)
        node = f"node[{label[v]}]"
        m.complement(node, carried - withdrawn, fee[v]) if v == nodes[0] else m.equation(node, carried - withdrawn)
    for v in nodes:
        turn = total(conductance[e] * voltage[e] for e in lines if e[0] == v)
        back = total(conductance[e] * voltage[e] for e in lines if e[1] == v)
        row = f"angle[{label[v]}]"
        m.complement(row, turn - back, angle[v]) if v == nodes[0] else m.equation(row, turn - back)
    for e in lines:
        m.complement(f"congestion[{line[e]}]", fee[e[0]] - fee[e[1]] - voltage[e], load[e])
        m.equation(f"loop[{line[e]}]", load[e] - conductance[e] * (angle[e[0]] - angle[e[1]]))
    return m


def expansion(name, scenarios, blocks=4, seed=1):
    """Capacities are built before demand and the price of fuel are known; competitive dispatch in every scenario and
    load block, isoelastic demand."""
    draw = Draw(seed)
    m = Model(name)
    #        plant: yearly cost of capacity, running cost, fuel per unit
    plants = {"nuclear": (60, 5, 0), "coal": (30, 12, 1.2), "gas": (14, 8, 2.0), "peaker": (6, 20, 3.5), "wind": (28, 0, 0)}
    S, B = range(1, scenarios + 1), range(1, blocks + 1)
    hours = {b: round(2 * b / (blocks * (blocks + 1)), 4) for b in B}
    growth = {s: draw.real(0.7, 1.4) for s in S}
    fuel = {s: draw.real(8, 40, 0) for s in S}
    wind = {(s, b): draw.real(0.05, 0.9) for s in S for b in B}
    carbon_cap = {s: draw.integer(20, 60) for s in S}
    probability = 1 / scenarios

    built = {g: m.variable(f"capacity[{g}]", lower=0, start=1) for g in plants}
    price = {(s, b): m.variable(f"price[{s},{b}]", lower=0.01, start=1) for s in S for b in B}
    output = {(g, s, b): m.variable(f"output[{g},{s},{b}]", lower=0, start=1) for g in plants for s in S for b in B}
    rent = {k: m.variable("rent[{},{},{}]".format(*k), lower=0, start=0) for k in output}
    carbon = {s: m.variable(f"permit[{s}]", lower=0, start=0) for s in S}
    for (g, s, b), x in output.items():
        running = plants[g][1] + plants[g][2] * (fuel[s] + 1.0 * carbon[s])
        m.complement(f"dispatch[{g},{s},{b}]", running + rent[g, s, b] - price[s, b], x)
        available = wind[s, b] if g == "wind" else 1
        m.complement(f"available[{g},{s},{b}]", available * built[g] - x, rent[g, s, b])
    for g in plants:
        earned = total(
            probability * hours[b] * (wind[s, b] if g == "wind" else 1) * rent[g, s, b] for s in S for b in B
        )
        m.complement(f"investment[{g}]", plants[g][0] - earned, built[g])
    for s, b in price:
        wanted = growth[s] * (120 - 12 * b) * (price[s, b] / 60) ** -0.3
        m.complement(f"market[{s},{b}]", total(output[g, s, b] for g in plants) - wanted, price[s, b])
    for s in S:
        emitted = total(hours[b] * plants[g][2] * output[g, s, b] for g in plants for b in B)
        m.complement(f"emissions[{s}]", carbon_cap[s] - emitted, carbon[s])
    return m
