# SPDX-License-Identifier: Apache-2.0
"""Agents in Pyomo: models of the literature, each against its published or hand-derived equilibrium, which the comment of the
model says. A wrong derivative, sign of a multiplier, owner of a variable or sense of an objective moves every one of them."""

import math

import numpy as np
import pytest
from pages import run_examples

pyo = pytest.importorskip("pyomo.environ")
from pyomo.mpec import Complementarity, complements  # noqa: E402  (after the check)

pytest.importorskip("perp.pyomo")
from perp.pyomo import ModelError, equilibrium  # noqa: E402


def model(**variables):
    """A model with a block for each agent: name = objective and bounds are added by `agent`."""
    m = pyo.ConcreteModel()
    for name, (start, bounds) in variables.items():
        block = pyo.Block()
        m.add_component(name, block)
        block.x = pyo.Var(initialize=start, bounds=bounds)
    return m


def objectives(m, sense=pyo.maximize, **expressions):
    for name, expression in expressions.items():
        m.component(name).objective = pyo.Objective(expr=expression, sense=sense)
    return m


POSITIVE = (0, None)
MODELS = {}


def case(expected, proven=True, tolerance=1e-7):
    def register(build):
        MODELS[build.__name__] = (build, expected, proven, tolerance)
        return build

    return register


def xs(m, names):
    return [m.component(name).x.value for name in names]


# Oligopolies


@case([3, 3])
def cournot():
    """Cournot 1838: price 10 - Q, cost 1: q = (10 - 1) / 3."""
    m = model(a=(1, POSITIVE), b=(1, POSITIVE))
    total = m.a.x + m.b.x
    objectives(m, a=(10 - total) * m.a.x - m.a.x, b=(10 - total) * m.b.x - m.b.x)
    return equilibrium(m), xs(m, "ab")


@case([8 / 3, 2, 0])
def cournot_with_quadratic_costs():
    """Price p = 20 - Q, cost c q + d q^2 / 2: q = max(0, (p - c) / (1 + d)). With c = (4, 6, 18) and 1 + d = (17/4, 14/3) it is
    q = (8/3, 2, 0) at p = 46/3, and the third firm's cost is above it."""
    m = model(a=(1, POSITIVE), b=(1, POSITIVE), c=(1, POSITIVE))
    p = 20 - m.a.x - m.b.x - m.c.x
    d = (17 / 4 - 1, 14 / 3 - 1, 1)
    objectives(m, **{f: (p - c) * m.component(f).x - e / 2 * m.component(f).x ** 2 for f, c, e in zip("abc", (4, 6, 18), d)})
    return equilibrium(m), xs(m, "abc")


@case([36.9325, 41.8181, 43.7066, 42.6592, 39.1790], proven=False, tolerance=1e-4)
def murphy_sherali_soyster():
    """Murphy, Sherali & Soyster 1982: five firms, isoelastic demand; the solution as in Harker 1984 and Kolstad & Mathiesen
    1991."""
    m = model(**{f: (10, (0.1, None)) for f in "abcde"})
    total = sum(m.component(f).x for f in "abcde")
    price = (5000 / total) ** (1 / 1.1)
    for f, c, b in zip("abcde", (10, 8, 6, 4, 2), (1.2, 1.1, 1.0, 0.9, 0.8)):
        q = m.component(f).x
        cost = c * q + b / (b + 1) * 5 ** (-1 / b) * q ** ((b + 1) / b)
        objectives(m, **{f: price * q - cost})
    return equilibrium(m), xs(m, "abcde")


@case([0.24, 0.16], proven=False)
def cournot_with_isoelastic_demand():
    """Puu 1991: price 1 / Q: q_1 = c_2 / (c_1 + c_2)^2, and with costs 1 and 3/2 q = (6/25, 4/25)."""
    m = model(a=(0.1, (1e-3, None)), b=(0.1, (1e-3, None)))
    total = m.a.x + m.b.x
    objectives(m, a=m.a.x / total - 1.0 * m.a.x, b=m.b.x / total - 1.5 * m.b.x)
    return equilibrium(m), xs(m, "ab")


@case([8, 8])
def bertrand():
    """Differentiated goods, demand 10 - p_i + p_j / 2, cost 2: p = (10 + 2) / (2 - 1/2)."""
    m = model(a=(1, POSITIVE), b=(2, POSITIVE))
    objectives(m, a=(m.a.x - 2) * (10 - m.a.x + m.b.x / 2), b=(m.b.x - 2) * (10 - m.b.x + m.a.x / 2))
    return equilibrium(m), xs(m, "ab")


@case([4, 4])
def hotelling():
    """d'Aspremont, Gabszewicz & Thisse 1979: firms at the ends of a line, quadratic transport costs: p = c + t = 1 + 3."""
    m = model(a=(1, POSITIVE), b=(2, POSITIVE))
    demand = 0.5 + (m.b.x - m.a.x) / 6
    objectives(m, a=(m.a.x - 1) * demand, b=(m.b.x - 1) * (1 - demand))
    return equilibrium(m), xs(m, "ab")


@case([2, 2, 3])
def cournot_with_a_capacity_market():
    """Two firms rent capacity k >= q at the price r; there are 4 units: 10 - Q - q - 1 = r at q = 2."""
    m = model(a=(1, POSITIVE), b=(1, POSITIVE))
    m.r = pyo.Var(initialize=1)
    for firm in (m.a, m.b):
        firm.k = pyo.Var(initialize=1, bounds=POSITIVE)
        firm.produce = pyo.Constraint(expr=firm.x <= firm.k)
    objectives(m, **{f: (9 - m.a.x - m.b.x) * m.component(f).x - m.r * m.component(f).k for f in "ab"})
    m.capacity = Complementarity(expr=complements(4 - m.a.k - m.b.k >= 0, m.r >= 0))
    return equilibrium(m), [*xs(m, "ab"), m.r.value]


@case([2, 1, 6])
def competitive_firms():
    """Firms take the price p = 12 - 2 Q as given: costs q^2 3/2 and q^2 3, p = 3 q_1 = 6 q_2."""
    m = model(a=(1, POSITIVE), b=(1, POSITIVE))
    m.p = pyo.Var(initialize=1)
    objectives(m, a=m.p * m.a.x - 1.5 * m.a.x**2, b=m.p * m.b.x - 3 * m.b.x**2)
    m.demand = pyo.Constraint(expr=m.p == 12 - 2 * (m.a.x + m.b.x))
    return equilibrium(m), [*xs(m, "ab"), m.p.value]


# Constraints that are shared


def harker():
    m = model(a=(0, (0, 10)), b=(0, (0, 10)))
    objectives(
        m,
        pyo.minimize,
        a=m.a.x**2 + 8 / 3 * m.a.x * m.b.x - 34 * m.a.x,
        b=m.b.x**2 + 5 / 4 * m.a.x * m.b.x - 24.25 * m.b.x,
    )
    m.shared = pyo.Constraint(expr=m.a.x + m.b.x <= 15)
    return m


@case([5, 9, 0])
def harker_variational():
    """Harker 1991: the variational equilibrium is (5, 9), where the constraint is slack."""
    m = harker()
    found = equilibrium(m, variational=[m.shared])
    return found, [*xs(m, "ab"), found.multipliers[m.shared]]


@case([0])
def harker_each():
    """Harker 1991: with multipliers of their own, all of (5, 9) and (t, 15 - t) for 9 <= t <= 10 are equilibria."""
    m = harker()
    m.a.x, m.b.x = 9.4, 5.6
    found = equilibrium(m, each=[m.shared])
    a, b = xs(m, "ab")
    return found, [min(math.hypot(a - 5, b - 9), abs(a + b - 15) + max(9 - a, 0) + max(a - 10, 0))]


def facchinei_kanzow():
    m = model(a=(0, (None, None)), b=(0, (None, None)))
    objectives(m, pyo.minimize, a=(m.a.x - 1) ** 2, b=(m.b.x - 0.5) ** 2)
    m.shared = pyo.Constraint(expr=m.a.x + m.b.x <= 1)
    return m


@case([0.75, 0.25, -0.5])
def facchinei_kanzow_variational():
    """Facchinei & Kanzow 2010, example 1: the variational one is (3/4, 1/4), where one unit of right side lowers costs by 1/2."""
    m = facchinei_kanzow()
    found = equilibrium(m, variational=[m.shared])
    return found, [*xs(m, "ab"), found.multipliers[m.shared]]


@case([0])
def facchinei_kanzow_each():
    """The same: all (t, 1 - t) with 1/2 <= t <= 1, and the multipliers are 2 - 2 t and 2 t - 1."""
    m = facchinei_kanzow()
    found = equilibrium(m, each=[m.shared])
    t, y = m.a.x.value, found.multipliers[m.shared]
    wrong = abs(t + m.b.x.value - 1) + max(0.5 - t, 0) + max(t - 1, 0)
    return found, [wrong + abs(-y[m.a.objective] - (2 - 2 * t)) + abs(-y[m.b.objective] - (2 * t - 1))]


@case([1, 0, 1])
def rosen():
    """Rosen 1965, section 4: x_1^2 / 2 - x_1 x_2 and x_2^2 + x_1 x_2 with x_1 + x_2 >= 1: x = (1, 0), y = 1."""
    m = model(a=(1, POSITIVE), b=(1, POSITIVE))
    objectives(m, pyo.minimize, a=m.a.x**2 / 2 - m.a.x * m.b.x, b=m.b.x**2 + m.a.x * m.b.x)
    m.shared = pyo.Constraint(expr=m.a.x + m.b.x >= 1)
    found = equilibrium(m, variational=[m.shared])
    return found, [*xs(m, "ab"), found.multipliers[m.shared]]


@case([21.1448, 16.0279, 2.7260, 0.5744, 0], tolerance=1e-3)
def river_basin():
    """Krawczyk & Uryasev 2000: x = (21.14, 16.03, 2.73), and 0.574 and 0 the multipliers."""
    m = model(**{f: (1, POSITIVE) for f in "abc"})
    total = sum(m.component(f).x for f in "abc")
    for f, c, d in zip("abc", (0.10, 0.12, 0.15), (0.01, 0.05, 0.01)):
        x = m.component(f).x
        objectives(m, **{f: (3 - 0.01 * total) * x - (c + d * x) * x})
    e = (0.5, 0.25, 0.75)
    m.limits = pyo.ConstraintList()
    for u in ((6.5, 5.0, 5.5), (4.583, 6.25, 3.75)):
        m.limits.add(sum(w * r * m.component(f).x for w, r, f in zip(u, e, "abc")) <= 100)
    found = equilibrium(m, variational=[m.limits])
    return found, [*xs(m, "abc"), *(found.multipliers[limit] for limit in m.limits.values())]


@case([0.3, *[(2.6 + math.sqrt(74.8)) / 162] * 9], proven=False)
def internet_switching():
    """Kesselman, Leonardi & Bonifaci 2005, as A.1 of Facchinei & Kanzow 2009: x_1 = 0.3, and the others solve
    81 x^2 - 2.6 x - 0.21 = 0: (S - x) / S^2 = 1 with S = 0.3 + 9 x."""
    names = "abcdefghij"
    m = model(**{f: (0.1, (0.01, None)) for f in names})
    m.a.x.setlb(0.3)
    m.a.x.setub(0.5)
    m.a.x.value = 0.3
    total = sum(m.component(f).x for f in names)
    objectives(m, **{f: m.component(f).x / total - m.component(f).x for f in names})
    m.capacity = pyo.Constraint(expr=total <= 1)
    return equilibrium(m, variational=[m.capacity]), xs(m, names)


@case([2, 1, 2])
def cournot_with_shared_emissions():
    """Price 12 - Q, costs 0, emissions q_1 + 2 q_2 <= 4, one permit price y: 12 - 2 q_1 - q_2 = y, 12 - q_1 - 2 q_2 = 2 y gives
    y = 4 with q_1 = 4, q_2 = 0; costs (5, 4): 7 - 2 q_1 - q_2 = y, 8 - q_1 - 2 q_2 = 2 y: q = (2, 1), y = 2."""
    m = model(a=(0, POSITIVE), b=(0, POSITIVE))
    total = m.a.x + m.b.x
    objectives(m, a=(12 - total - 5) * m.a.x, b=(12 - total - 4) * m.b.x)
    m.cap = pyo.Constraint(expr=m.a.x + 2 * m.b.x <= 4)
    found = equilibrium(m, variational=[m.cap])
    return found, [*xs(m, "ab"), found.multipliers[m.cap]]


@case([6, 3, 4])
def permits():
    """Abatement costs a (E - e)^2 / 2 with E = 10, 5, a = 1, 2, and a cap of 9: the price 4 = (15 - 9) / (1 + 1/2)."""
    m = model(a=(0, POSITIVE), b=(0, POSITIVE))
    m.p = pyo.Var(initialize=0)
    objectives(m, pyo.minimize, a=(10 - m.a.x) ** 2 / 2 + m.p * m.a.x, b=(5 - m.b.x) ** 2 + m.p * m.b.x)
    m.market = Complementarity(expr=complements(9 - m.a.x - m.b.x >= 0, m.p >= 0))
    return equilibrium(m), [*xs(m, "ab"), m.p.value]


# Markets


def consumer(m, name, shares, prices, income):
    """Cobb & Douglas: spends the share a_g of the income on good g."""
    block = pyo.Block()
    m.add_component(name, block)
    block.x = pyo.Var(range(len(shares)), initialize=1, bounds=(1e-6, None))
    block.utility = pyo.Objective(expr=sum(a * pyo.log(block.x[g]) for g, a in enumerate(shares)), sense=pyo.maximize)
    block.budget = pyo.Constraint(expr=sum(p * block.x[g] for g, p in enumerate(prices)) <= income)
    return block


@case([0.75, 0.4, 0.45, 0.6, 0.55], proven=False)
def exchange():
    """Walras: a consumer of shares (0.4, 0.6) has one unit of good 0, another of shares (0.45, 0.55) one of good 1. The first
    keeps 0.4 and sells 0.6 p_0, on which the second spends 0.45 p_1: p_0 / p_1 = 0.75."""
    m = pyo.ConcreteModel()
    m.p = pyo.Var([0, 1], initialize=1)
    a = consumer(m, "a", (0.4, 0.6), (m.p[0], m.p[1]), m.p[0])
    b = consumer(m, "b", (0.45, 0.55), (m.p[0], m.p[1]), m.p[1])
    m.p[1].fix(1)

    @m.Complementarity([0, 1])
    def market(m, g):
        return complements(1 - a.x[g] - b.x[g] >= 0, m.p[g] >= 0)

    found = equilibrium(m)
    return found, [m.p[0].value, a.x[0].value, a.x[1].value, b.x[0].value, b.x[1].value]


@case([2, 4, 4, 8], proven=False)
def production():
    """A firm y <= 2 sqrt(l), a consumer with 12 hours, half of the income on leisure, wage 1: l = p^2, y = 2 p, profit p^2,
    income 12 + p^2 = 2 p y: p = 2, l = 4, y = 4, leisure 8."""
    m = pyo.ConcreteModel()
    m.p, m.wage = pyo.Var(initialize=1), pyo.Var(initialize=1)
    m.wage.fix(1)
    m.firm = pyo.Block()
    m.firm.y, m.firm.l = pyo.Var(initialize=1, bounds=POSITIVE), pyo.Var(initialize=1, bounds=(1e-6, None))
    m.firm.profit = pyo.Objective(expr=m.p * m.firm.y - m.wage * m.firm.l, sense=pyo.maximize)
    m.firm.technology = pyo.Constraint(expr=m.firm.y <= 2 * pyo.sqrt(m.firm.l))
    c = consumer(m, "household", (0.5, 0.5), (m.p, m.wage), 12 * m.wage + m.p * m.firm.y - m.wage * m.firm.l)
    m.good = Complementarity(expr=complements(m.firm.y - c.x[0] >= 0, m.p >= 0))
    m.labour = Complementarity(expr=complements(12 - c.x[1] - m.firm.l >= 0, m.wage >= 0))
    found = equilibrium(m)
    return found, [m.p.value, m.firm.l.value, m.firm.y.value, c.x[1].value]


@case([3 / 7, 3 / 7, 1], proven=False)
def arrow_debreu():
    """Three consumers with a unit of a good each spend the shares a: p = a' p (Gale 1960). At p = (3/7, 3/7, 1) it reads
    0.5 * 3/7 + 3/14 = 3/7, twice, and 2 * 0.5 * 3/7 + 4/7 = 1."""
    a = np.array([[0.2, 0.3, 0.5], [0.3, 0.2, 0.5], [3 / 14, 3 / 14, 4 / 7]])
    m = pyo.ConcreteModel()
    m.p = pyo.Var([0, 1, 2], initialize=1)
    m.p[2].fix(1)
    prices = [m.p[g] for g in range(3)]
    people = [consumer(m, f"c{k}", a[k], prices, m.p[k]) for k in range(3)]

    @m.Complementarity([0, 1, 2])
    def market(m, g):
        return complements(1 - sum(c.x[g] for c in people) >= 0, m.p[g] >= 0)

    found = equilibrium(m)
    return found, [m.p[g].value for g in range(3)]


@case([5, 8.5, 10.5])
def spatial_prices():
    """Samuelson 1952, two regions: supply p = 2 + s and 6 + s, demand p = 10 - d and 20 - d, transport 2. Exports x make the
    prices 6 + x/2 and 13 - x/2, so x = 5."""
    m = pyo.ConcreteModel()
    m.p = pyo.Var([0, 1], initialize=5)
    m.region = pyo.Block([0, 1])
    for r, (s, d) in enumerate(((2, 10), (6, 20))):
        region = m.region[r]
        region.producer, region.buyer = pyo.Block(), pyo.Block()
        region.producer.s = pyo.Var(initialize=1, bounds=POSITIVE)
        region.producer.profit = pyo.Objective(expr=(m.p[r] - s) * region.producer.s - region.producer.s**2 / 2, sense=pyo.maximize)
        region.buyer.d = pyo.Var(initialize=1, bounds=POSITIVE)
        region.buyer.surplus = pyo.Objective(expr=(d - m.p[r]) * region.buyer.d - region.buyer.d**2 / 2, sense=pyo.maximize)
    m.trader = pyo.Block()
    m.trader.x = pyo.Var([0, 1], initialize=0, bounds=POSITIVE)  # from region r
    m.trader.profit = pyo.Objective(expr=sum((m.p[1 - r] - m.p[r] - 2) * m.trader.x[r] for r in (0, 1)), sense=pyo.maximize)

    @m.Complementarity([0, 1])
    def market(m, r):
        here = m.region[r]
        return complements(here.producer.s + m.trader.x[1 - r] - here.buyer.d - m.trader.x[r] >= 0, m.p[r] >= 0)

    found = equilibrium(m)
    return found, [m.trader.x[0].value, m.p[0].value, m.p[1].value]


@case([5, 27.5, 42.5, 15])
def electricity():
    """Two nodes and a line of capacity 5: generators 10 + g and 30 + g, demand 40 - d and 60 - d. A flow f makes the prices
    25 + f/2 and 45 - f/2; the line is full, and one more unit of it is worth 15."""
    m = pyo.ConcreteModel()
    m.p = pyo.Var([1, 2], initialize=20)
    m.generator, m.buyer = pyo.Block([1, 2]), pyo.Block([1, 2])
    for n, (c, a) in {1: (10, 40), 2: (30, 60)}.items():
        m.generator[n].g = pyo.Var(initialize=1, bounds=POSITIVE)
        m.generator[n].profit = pyo.Objective(expr=(m.p[n] - c) * m.generator[n].g - m.generator[n].g ** 2 / 2, sense=pyo.maximize)
        m.buyer[n].d = pyo.Var(initialize=1, bounds=POSITIVE)
        m.buyer[n].surplus = pyo.Objective(expr=(a - m.p[n]) * m.buyer[n].d - m.buyer[n].d ** 2 / 2, sense=pyo.maximize)
    m.grid = pyo.Block()
    m.grid.f = pyo.Var(initialize=0)
    m.grid.line = pyo.Constraint(expr=pyo.inequality(-5, m.grid.f, 5))
    m.grid.rent = pyo.Objective(expr=(m.p[2] - m.p[1]) * m.grid.f, sense=pyo.maximize)

    @m.Constraint([1, 2])
    def balance(m, n):
        return m.generator[n].g + (m.grid.f if n == 2 else -m.grid.f) == m.buyer[n].d

    found = equilibrium(m)
    return found, [m.grid.f.value, m.p[1].value, m.p[2].value, found.multipliers[m.grid.line]]


# Other games


@case([2.5, 2.5], proven=False)
def public_good():
    """Bergstrom, Blume & Varian 1986, two alike: log(10 - g) + (2/3) log G: 1 / (10 - g) = (2/3) / (2 g): g = 2.5."""
    m = model(a=(1, (0.01, 9.9)), b=(2, (0.01, 9.9)))
    total = m.a.x + m.b.x
    objectives(m, **{f: pyo.log(10 - m.component(f).x) + 2 / 3 * pyo.log(total) for f in "ab"})
    return equilibrium(m), xs(m, "ab")


@case([2, 2, 2], proven=False)
def contest():
    """Tullock 1980: x_i / X of a prize of 9 costs x_i: x = (n - 1) V / n^2 = 2."""
    m = model(**{f: (1, (1e-3, None)) for f in "abc"})
    total = sum(m.component(f).x for f in "abc")
    objectives(m, **{f: 9 * m.component(f).x / total - m.component(f).x for f in "abc"})
    return equilibrium(m), xs(m, "abc")


@case([1 / 3, 1 / 3])
def routing():
    """Orda, Rom & Shimkin 1993: two users split a unit each between a link of cost X per unit and one of cost 1: X + x = 1."""
    m = model(a=(0, (0, 1)), b=(1, (0, 1)))
    total = m.a.x + m.b.x
    objectives(m, pyo.minimize, **{f: m.component(f).x * total + (1 - m.component(f).x) for f in "ab"})
    return equilibrium(m), xs(m, "ab")


@case([1 / 3] * 6)
def rock_paper_scissors():
    """von Neumann 1928: mixed strategies, bilinear payoffs."""
    A = [[0, -1, 1], [1, 0, -1], [-1, 1, 0]]
    m = pyo.ConcreteModel()
    m.a, m.b = pyo.Block(), pyo.Block()
    for k, player in enumerate((m.a, m.b)):
        player.x = pyo.Var(range(3), initialize={0: 0.5, 1: 0.2, 2: 0.3}, bounds=POSITIVE)
        player.sum = pyo.Constraint(expr=sum(player.x.values()) == 1)
    payoff = sum(A[i][j] * m.a.x[i] * m.b.x[j] for i in range(3) for j in range(3))
    objectives(m, a=payoff, b=-payoff)
    return equilibrium(m), [v.value for p in (m.a, m.b) for v in p.x.values()]


@pytest.mark.parametrize("name", MODELS)
def test_model(name):
    build, expected, proven, tolerance = MODELS[name]
    found, values = build()
    assert found.success, found.message
    assert found.proven is proven
    assert np.allclose(values, expected, atol=tolerance, rtol=0), values
    assert found.gain <= 1e-6


def test_there_are_25_models():
    assert len(MODELS) >= 25


# Points that are no equilibria


def test_a_maximum_of_who_minimises_is_refused():
    """x = 0 is stationary for max x^2 within [-1, 1], and the worst there is."""
    m = model(a=(0, (-1, 1)), b=(0, (-1, 1)))
    objectives(m, a=m.a.x**2 + m.a.x * m.b.x, b=-(m.b.x**2) + m.a.x * m.b.x)
    found = equilibrium(m)
    assert found.result.success and not found.success
    assert found.agents[0].curvature == pytest.approx(-2) and not found.agents[1].why_not
    assert found.agents[0].gain == pytest.approx(1)  # at x = 1 or -1, b = 0
    assert "a gains 1 alone" in found.message


def test_a_saddle_of_one_agent_is_refused():
    """u v + (u v)^3 at (0, 0), two variables of one agent, in whose directions alone nothing is gained; at (1, -1) it is -2."""
    m = model(a=(0, (-1, 1)), b=(0, (-1, 1)))
    m.a.v = pyo.Var(initialize=0, bounds=(-1, 1))
    objectives(m, pyo.minimize, a=m.a.x * m.a.v + (m.a.x * m.a.v) ** 3, b=(m.b.x - m.a.x) ** 2)
    found = equilibrium(m)
    assert found.result.success and not found.success
    assert found.agents[0].curvature == pytest.approx(-1)
    assert found.agents[0].gain == pytest.approx(2)


def test_a_local_minimum_is_refused():
    """(x^2 - 1)^2 + x y / 2 at y = 1: the minimum near x = 0.93 is one, with positive curvature, and that near -1.06 is better."""
    m = model(a=(1, (-2, 2)), b=(1, (-2, 2)))
    objectives(m, pyo.minimize, a=(m.a.x**2 - 1) ** 2 + m.a.x * m.b.x / 2, b=(m.b.x - 1) ** 2)
    found = equilibrium(m)
    x = m.a.x.value
    better = min(np.roots([4, 0, -4, 0.5]).real)
    assert found.result.success and not found.success and x > 0.9 and found.agents[0].curvature > 0
    f = lambda t: (t * t - 1) ** 2 + t / 2
    assert found.agents[0].gain == pytest.approx(f(x) - f(better), abs=1e-7)
    assert found.agents[0].response[m.a.x] == pytest.approx(better, abs=1e-6)


# The interface


def test_agents_without_blocks():
    """An indexed objective, a list for each, and a budget of the first's own."""
    m = pyo.ConcreteModel()
    m.q = pyo.Var(["a", "b"], initialize=1, bounds=POSITIVE)
    m.profit = pyo.Objective(["a", "b"], rule=lambda m, f: (9 - m.q["a"] - m.q["b"]) * m.q[f], sense=pyo.maximize)
    m.limit = pyo.Constraint(expr=m.q["a"] <= 1)
    m.dual, m.slack, m.rc = (pyo.Suffix(direction=pyo.Suffix.IMPORT) for _ in range(3))
    owns = [(m.profit["a"], [m.q["a"], m.limit]), (m.profit["b"], [m.q["b"]])]
    found = equilibrium(m, owns)
    assert found.proven and [a.name for a in found.agents] == ["profit[a]", "profit[b]"]
    assert m.q["b"].value == pytest.approx(4) and m.q["a"].value == pytest.approx(1)
    assert m.dual[m.limit] == pytest.approx(9 - 2 - 4) and m.slack[m.limit] == pytest.approx(0)
    assert m.rc[m.q["b"]] == pytest.approx(0)


def test_the_model_is_left_as_it_was():
    m = harker()
    before = [(c.name, c.ctype) for c in m.component_objects()]
    equilibrium(m, variational=[m.shared], load=False)
    assert [(c.name, c.ctype) for c in m.component_objects()] == before
    assert m.a.x.value == 0 and not m.a.x.fixed and m.b.x.value == 0


@pytest.mark.parametrize(
    "spoil, words",
    [
        (lambda m: m.b.x.fix(1) or m.a.objective.deactivate() or m.b.objective.deactivate(), "no active objective"),
        (lambda m: setattr(m.a, "second", pyo.Objective(expr=m.a.x)), "several objectives"),
        (lambda m: setattr(m, "p", pyo.Var(initialize=0)) or setattr(m, "c", pyo.Constraint(expr=m.a.x * m.b.x == 1)), "not square"),
        (lambda m: setattr(m.a, "idle", pyo.Var(initialize=0)), "occurs in nothing"),
    ],
)
def test_refusals(spoil, words):
    m = harker()
    spoil(m)
    with pytest.raises(ModelError, match=words):
        equilibrium(m, variational=[m.shared])


def test_an_inequality_of_nobody_is_refused():
    with pytest.raises(ModelError, match="shared belongs to no agent"):
        equilibrium(harker())


def test_the_page():
    """The examples of docs/equilibria.md, in turn."""
    run_examples("docs/equilibria.md")
