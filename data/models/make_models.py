#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the models of this folder: make_models.py [FOLDER], by default beside this file. See ../README.md."""

import sys
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from cge import Shock, cge  # noqa: E402
from nlwriter import Model, exp, log, total  # noqa: E402
from ramsey import ramsey  # noqa: E402
from spatial import spatial  # noqa: E402
from traffic import traffic  # noqa: E402


# --- energy: spatial price equilibrium of two fuels under an emission cap --------------------------------------------

REGIONS = ("north", "coast", "inland")
FUELS = ("coal", "gas")
#             region, fuel: marginal cost at 0 [EUR/MWh], its slope [EUR/MWh per TWh/a], capacity [TWh/a]
PRODUCERS = {
    ("north", "coal"): (6.0, 0.05, 70.0),
    ("inland", "coal"): (9.0, 0.08, 60.0),
    ("coast", "coal"): (12.0, 0.04, 80.0),
    ("north", "gas"): (14.0, 0.1, 70.0),
    ("coast", "gas"): (24.0, 0.05, 100.0),
    ("inland", "gas"): (18.0, 0.15, 20.0),
}
#        from, to: cost of coal, cost of gas [EUR/MWh], pipeline capacity for gas [TWh/a]
ROUTES = {
    ("north", "coast"): (3.0, 2.0, 25.0),
    ("north", "inland"): (4.0, 2.5, 15.0),
    ("coast", "north"): (3.5, 2.0, 25.0),
    ("coast", "inland"): (5.0, 3.0, 30.0),
    ("inland", "north"): (4.0, 2.5, 15.0),
    ("inland", "coast"): (5.5, 3.0, 30.0),
}
#          region, fuel: demand [TWh/a] at the price [EUR/MWh]
DEMAND = {
    ("north", "coal"): (40.0, 10.0),
    ("north", "gas"): (30.0, 22.0),
    ("coast", "coal"): (35.0, 13.0),
    ("coast", "gas"): (55.0, 25.0),
    ("inland", "coal"): (60.0, 13.0),
    ("inland", "gas"): (40.0, 26.0),
}
OWN_ELASTICITY = {"coal": -0.7, "gas": -0.5}
CROSS_ELASTICITY = {"coal": 0.3, "gas": 0.2}  # of the demand for this fuel to the price of the other
EMISSION = {"coal": 0.34, "gas": 0.2}  # [t CO2/MWh]
EMISSION_CAP = 60.0  # [Mt CO2/a]
LOWEST_PRICE = 0.1  # keeps the demand functions defined


def energy():
    m = Model("energy")
    places = [(r, f) for r in REGIONS for f in FUELS]
    shipments = [(r, s, f) for (r, s) in ROUTES for f in FUELS]
    p = {(r, f): m.variable(f"price[{r},{f}]", lower=LOWEST_PRICE, start=DEMAND[r, f][1]) for r, f in places}
    x = {(r, f): m.variable(f"production[{r},{f}]", lower=0, start=10) for r, f in PRODUCERS}
    s = {(a, b, f): m.variable(f"shipment[{a},{b},{f}]", lower=0, start=0) for a, b, f in shipments}
    mu = {(r, f): m.variable(f"rent[{r},{f}]", lower=0, start=0) for r, f in PRODUCERS}
    nu = {route: m.variable(f"congestion[{route[0]},{route[1]}]", lower=0, start=0) for route in ROUTES}
    sigma = m.variable("carbon_price", lower=0, start=0)

    for r, f in places:
        other = FUELS[1 - FUELS.index(f)]
        quantity, price = DEMAND[r, f]
        demand = (
            quantity
            * (p[r, f] / price) ** OWN_ELASTICITY[f]
            * (p[r, other] / DEMAND[r, other][1]) ** CROSS_ELASTICITY[f]
        )
        arrivals = total(s[a, b, g] for a, b, g in shipments if (b, g) == (r, f))
        departures = total(s[a, b, g] for a, b, g in shipments if (a, g) == (r, f))
        m.complement(f"market[{r},{f}]", x[r, f] + arrivals - departures - demand, p[r, f])
    for (r, f), (cost, slope, capacity) in PRODUCERS.items():
        margin = cost + slope * x[r, f] + EMISSION[f] * sigma + mu[r, f] - p[r, f]
        m.complement(f"profit[{r},{f}]", margin, x[r, f])
        m.complement(f"capacity[{r},{f}]", capacity - x[r, f], mu[r, f])
    for (a, b), (coal_cost, gas_cost, capacity) in ROUTES.items():
        m.complement(f"arbitrage[{a},{b},coal]", p[a, "coal"] + coal_cost - p[b, "coal"], s[a, b, "coal"])
        m.complement(f"arbitrage[{a},{b},gas]", p[a, "gas"] + gas_cost + nu[a, b] - p[b, "gas"], s[a, b, "gas"])
        m.complement(f"pipeline[{a},{b}]", capacity - s[a, b, "gas"], nu[a, b])
    m.complement("emissions", EMISSION_CAP - total(EMISSION[f] * x[r, f] for r, f in PRODUCERS), sigma)
    return m


# --- cournot: Nash-Cournot oligopoly with capacities -----------------------------------------------------------------

CHOKE_PRICE, DECAY = 120.0, 180.0  # inverse demand p(Q) = CHOKE_PRICE exp(-Q / DECAY)
#        firm: marginal cost at 0, its slope, capacity
FIRMS = {
    "hydro": (2.0, 0.02, 18.0),
    "nuclear": (8.0, 0.05, 30.0),
    "coal": (28.0, 0.2, 60.0),
    "gas": (32.0, 0.1, 80.0),
    "peaker": (62.0, 0.4, 25.0),
}


def cournot():
    m = Model("cournot")
    q = {i: m.variable(f"output[{i}]", lower=0, upper=FIRMS[i][2], start=5) for i in FIRMS}
    price = CHOKE_PRICE * exp(-(total(q.values()) / DECAY))
    for i, (cost, slope, _) in FIRMS.items():
        m.complement(f"marginal_profit[{i}]", cost + slope * q[i] - price * (1 - q[i] / DECAY), q[i])
    return m


# --- harberger: general equilibrium with a tax on capital in one sector ----------------------------------------------

BENCHMARK_TAX = 0.25
#           sector: labour, capital net of tax at the benchmark; elasticity of substitution
SECTORS = {"X": (40.0, 48.0, 0.5), "Y": (60.0, 40.0, 1.0)}
UNTAXED = (70.0, 30.0, 1.08)  # second technology for good X: labour, capital for 100 units, cost at the benchmark
#              household: labour, capital owned; share of the tax revenue; demand for X, Y; elasticity of substitution
HOUSEHOLDS = {"worker": (90.0, 8.0, 0.5, 54.0, 50.0, 0.8), "owner": (10.0, 80.0, 0.5, 46.0, 50.0, 1.5)}
LOWEST = 1e-3  # of prices, so that the cost functions stay defined


def ces(prices, shares, elasticity):
    """Unit cost in calibrated share form, 1 at prices 1."""
    if elasticity == 1:
        return exp(total(share * log(price) for price, share in zip(prices, shares)))
    power = 1 - elasticity
    return total(share * price**power for price, share in zip(prices, shares)) ** (1 / power)


def harberger(name, tax):
    """The economy with the ad valorem tax `tax` on the capital that the sector X uses."""
    m = Model(name)
    activity = {a: m.variable(f"activity[{a}]", lower=0, start=1) for a in ("X", "Y")}
    activity["untaxed"] = m.variable("activity[untaxed]", lower=0, start=0)
    welfare = {h: m.variable(f"welfare[{h}]", lower=0, start=1) for h in HOUSEHOLDS}
    p = {g: m.variable(f"price[{g}]", lower=LOWEST, start=1) for g in ("X", "Y", "capital")}
    p["labour"] = m.variable("price[labour]", lower=1, upper=1, start=1)  # numeraire
    living = {h: m.variable(f"price[welfare,{h}]", lower=LOWEST, start=1) for h in HOUSEHOLDS}
    income = {h: m.variable(f"income[{h}]", start=sum(HOUSEHOLDS[h][3:5])) for h in HOUSEHOLDS}
    revenue = m.variable("income[government]", start=BENCHMARK_TAX * SECTORS["X"][1])

    # What a unit of capital costs its user, 1 at the benchmark.
    user_cost = {"X": p["capital"] * ((1 + tax) / (1 + BENCHMARK_TAX)), "Y": p["capital"]}
    labour, capital, cost = {}, {}, {}  # for an activity of 1: Shephard's lemma
    for a, (labour0, capital0, elasticity) in SECTORS.items():
        output = labour0 + capital0 * (1 + (BENCHMARK_TAX if a == "X" else 0))
        cost[a] = ces((p["labour"], user_cost[a]), (labour0 / output, 1 - labour0 / output), elasticity)
        labour[a] = labour0 * (cost[a] / p["labour"]) ** elasticity
        capital[a] = capital0 * (cost[a] / user_cost[a]) ** elasticity
        m.complement(f"profit[{a}]", output * (cost[a] - p[a]), activity[a])
    labour0, capital0, factor = UNTAXED
    cost["untaxed"] = factor * ces((p["labour"], p["capital"]), (labour0 / 100, capital0 / 100), 1)
    labour["untaxed"] = labour0 * (cost["untaxed"] / p["labour"])
    capital["untaxed"] = capital0 * (cost["untaxed"] / p["capital"])
    m.complement("profit[untaxed]", 100 * (cost["untaxed"] - p["X"]), activity["untaxed"])

    demand = {"X": [], "Y": []}
    for h, (labour0, capital0, share, x0, y0, elasticity) in HOUSEHOLDS.items():
        spent = x0 + y0
        unit = ces((p["X"], p["Y"]), (x0 / spent, y0 / spent), elasticity)
        demand["X"].append(x0 * welfare[h] * (unit / p["X"]) ** elasticity)
        demand["Y"].append(y0 * welfare[h] * (unit / p["Y"]) ** elasticity)
        m.complement(f"profit[welfare,{h}]", spent * (unit - living[h]), welfare[h])
        m.complement(f"market[welfare,{h}]", spent * welfare[h] - income[h] / living[h], living[h])
        earned = labour0 * p["labour"] + capital0 * p["capital"] + share * revenue
        m.equation(f"budget[{h}]", income[h] - earned)
    m.equation("budget[government]", revenue - tax * p["capital"] * capital["X"] * activity["X"])

    m.complement("market[X]", 100 * activity["X"] + 100 * activity["untaxed"] - total(demand["X"]), p["X"])
    m.complement("market[Y]", 100 * activity["Y"] - total(demand["Y"]), p["Y"])
    for name, use, owned in (("labour", labour, 0), ("capital", capital, 1)):
        supply = sum(HOUSEHOLDS[h][owned] for h in HOUSEHOLDS)
        m.complement(f"market[{name}]", supply - total(use[a] * activity[a] for a in activity), p[name])
    return m


# --- cases: every kind of row and bound an .nl file can pair ---------------------------------------------------------


def cases():
    m = Model("cases")
    free = m.variable("free", start=1)
    at_lower = m.variable("at_lower", lower=0, start=1)
    above_lower = m.variable("above_lower", lower=0.5, start=1)
    at_upper = m.variable("at_upper", upper=4, start=0)
    below_upper = m.variable("below_upper", upper=10, start=-1)
    box_lower = m.variable("box_lower", lower=-1, upper=1)
    box_inside = m.variable("box_inside", lower=-2, upper=3)
    box_upper = m.variable("box_upper", lower=-1, upper=2)
    fixed = m.variable("fixed", lower=2.5, upper=2.5)
    bounded = m.variable("bounded", lower=0, start=3)
    linear = m.variable("linear")

    m.complement("F_at_lower", exp(at_lower) + above_lower, at_lower)
    m.complement("F_above_lower", above_lower**2 - 2, above_lower)
    m.complement("F_at_upper", 3 * at_upper - 20, at_upper)
    m.complement("F_below_upper", below_upper**3 + 8, below_upper)
    m.complement("F_box_lower", box_lower + 7, box_lower)
    m.complement("F_box_inside", 2 * box_inside - 3, box_inside)
    m.complement("F_box_upper", box_upper - exp(box_upper), box_upper)
    m.complement("F_fixed", fixed * at_upper - 100, fixed)
    m.equation("G_free", log(free) + at_lower)
    m.equation("G_bounded", bounded - 2 * fixed - 1)
    m.equation("G_linear", linear + box_inside - at_upper + 0.25)
    m.inequality("side_lower", linear + bounded, lower=8)
    m.inequality("side_upper", above_lower * below_upper, upper=0)
    m.inequality("side_range", at_upper + free + 1, lower=5, upper=7)
    return m


# --- small instances of the generators, whose large ones make_large.py writes ----------------------------------------

# Variables that the equilibrium does not determine: any plan of shipments of least cost will do.
UNDETERMINED = {"spatial": "flow["}


def economy():
    shock = Shock(
        output_tax=0.5, world_price=0.2, wage_floor=1.02, quota=0.6, carbon=0.6, backstop=1.05, keep_public=True
    )
    return cge("economy", 4, 2, shock)


def models():
    return [
        energy(),
        cournot(),
        harberger("harberger", tax=0.5),
        harberger("harberger-benchmark", tax=BENCHMARK_TAX),
        cases(),
        economy(),
        spatial("spatial", 2, 3, "isoelastic", lowest=0.01),
        traffic("streets", 3, 3, 1),
        ramsey("growth", 6, cap_from=3),
    ]


def main():
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent
    for model in models():
        model.write(folder / f"{model.name}.nl")


if __name__ == "__main__":
    main()
