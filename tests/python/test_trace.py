# SPDX-License-Identifier: Apache-2.0
"""Solutions as curves in a parameter: kinks, folds and bifurcations that are known by hand."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import perp

NONE = -np.inf


def events(curve, kind):
    return [event.p for event in curve.kinds(kind)]


def economy(x, a):
    """Two firms with marginal costs 1 and 2 and inverse demand a - Q: conditions of first order."""
    total = x.sum()
    return np.array([1 - a + total + x[0], 2 - a + total + x[1]])


def zigzag(x, p):
    """p = x - 2 max(0, x - 1) + 2 max(0, x - 2)."""
    return np.array([x[0] - 2 * x[1] + 2 * x[2] - p, x[1] - x[0] + 1, x[2] - x[0] + 2])


def string(x, p):
    """-u'' = p on (0, 1), u = 0 at its ends, with differences on 19 points: u = p t (1 - t) / 2 at these."""
    n, padded = len(x), np.concatenate([[0], x, [0]])
    return (2 * padded[1:-1] - padded[:-2] - padded[2:]) * (n + 1) ** 2 - p


MODELS = {
    # name: F, x0, interval, lower, upper, kinks, folds, bifurcations, x at the end
    "clipped": (lambda x, p: x - p, [0], (-1, 3), 0, 2, [0, 2], [], [], [2]),
    # x^3 - 3 x has its extremes 2 at -1 and -2 at 1.
    "cubic": (lambda x, p: x**3 - 3 * x - p, [-2.5], (-4, 4), NONE, np.inf, [], [2, -2], [], None),
    "cubic with a stop": (lambda x, p: x**3 - 3 * x - p, [-2.5], (-4, 4), NONE, 1.5, [-1.125], [2, -2], [], [1.5]),
    "circle": (lambda x, p: x**2 + p**2 - 1, [0.5], (-0.9, 2), NONE, np.inf, [], [1], [], [-np.sqrt(0.19)]),
    # x = p e^x: 1 = p e^x at the fold; at the stop x = 5 p turns round again.
    "ignition": (lambda x, p: x - p * np.exp(x), [0], (0, 1), NONE, 5, [5 * np.exp(-5)], [np.exp(-1), 5 * np.exp(-5)], [], [5]),
    # A shallow truss of two bars snaps through where the derivative of w^3 - 3 w^2 + 2 w is 0 (von Mises 1923).
    "truss": (
        lambda w, p: w**3 - 3 * w**2 + 2 * w - p, [-0.2], (-1, 1), NONE, np.inf,
        [], [2 / np.sqrt(27), -2 / np.sqrt(27)], [], None,
    ),  # fmt: skip
    "pitchfork": (lambda x, p: p * x - x**3, [0], (-1, 1), NONE, np.inf, [], [], [0], [0]),
    # A column of one joint and a spring: x = p sin x (Euler 1744, by one degree of freedom).
    "column": (lambda x, p: x - p * np.sin(x), [0], (0.2, 2), NONE, np.inf, [], [], [1], [0]),
    # The first firm begins at a = 1, the second at 3; the first one's capacity 2 = a / 3 at 6.
    "oligopoly": (economy, [0, 0], (0, 9), 0, [2, np.inf], [1, 3, 6], [], [], [2, 2.5]),
    # A tax t of the price P kills a market where (1 + t) 2 = 10: demand 10 - (1 + t) P, supply P - 2.
    "tax": (
        lambda x, t: np.array([x[0] - (10 - (1 + t) * x[1]), x[1] - 2 - x[0]]), [1, 1], (0, 6), [0, NONE], np.inf,
        [4], [], [], [0, 2],
    ),  # fmt: skip
    # Prices 5 and 2 without trade (supply P, demands 10 - P and 4 - P): trade x = 3 - p where transport costs p < 3.
    "transport": (
        lambda x, p: np.array([2 * x[0] - 10 + x[2], 2 * x[1] - 4 - x[2], x[1] + p - x[0]]), [5, 2, 0], (5, 0),
        [NONE, NONE, 0], np.inf, [3], [], [], [3.5, 3.5, 3],
    ),  # fmt: skip
    # Turns round at its kinks: p goes from -1 to 1, to 0, and on.
    "zigzag": (zigzag, [-1, 0, 0], (-1, 3), [NONE, 0, 0], np.inf, [1, 0], [1, 0], [], [5, 4, 3]),
    # In the middle p / 8 reaches the obstacle 1 first, and after it its two neighbours at once, which ends the path.
    "string": (string, np.zeros(19), (0, 8.5), NONE, 1, [8], [], [], None),
    # x = max(0, p), y = max(0, 1 - x): y leaves where x is 1.
    "two in turn": (
        lambda x, p: np.array([x[0] - p, x[1] - 1 + x[0]]), [0, 1], (-1, 2), 0, np.inf, [0, 1], [], [], [2, 0],
    ),  # fmt: skip
    # A trap: x = s(x) + p with s a smooth step; folds where s' = 1.
    "switch": (
        lambda x, p: x - 4 / (1 + np.exp(-2 * x)) + 2 - p, [-3], (-2, 2), NONE, np.inf,
        [], None, [], None,
    ),  # fmt: skip
}


# Kinks to 1e-8, folds and bifurcations to 1e-8, in their order, and each point a solution. Catches a kink that is stepped
# over, a fold at which the curve stops, and tangents that turn back.
@pytest.mark.parametrize("name", MODELS)
def test_known_curves(name):
    F, x0, interval, lower, upper, kinks, folds, bifurcations, end = MODELS[name]
    curve = perp.trace(F, x0, interval, lower, upper)
    assert curve.success, curve.message
    if name == "switch":  # 8 s (1 - s) = 1 with s = 1 / (1 + exp(-2 x))
        s = 0.5 + np.array([-1, 1]) * np.sqrt(1 / 8)
        x = -0.5 * np.log(1 / s - 1)
        folds = x - 4 * s + 2
    for kind, known in (("kink", kinks), ("fold", folds), ("bifurcation", bifurcations)):
        assert len(events(curve, kind)) == len(known), curve.table()
        assert np.allclose(events(curve, kind), known, rtol=0, atol=1e-8), curve.table()
    assert curve.residual.max() <= 1e-8
    if end is not None:
        assert np.allclose(curve.x[-1], end, atol=1e-7)
    assert curve.p[-1] in interval


# The oligopoly between its kinks at 3 and 6, q_1 = a / 3 by hand. Catches slopes of the wrong piece.
def test_slopes_and_elasticities():
    F, x0, interval, lower, upper, *_ = MODELS["oligopoly"]
    curve = perp.trace(F, x0, interval, lower, upper, step=0.1)
    between = (curve.p > 3.01) & (curve.p < 5.99)
    assert np.allclose(curve.slope[between, 0], 1 / 3) and np.allclose(curve.elasticity[between, 0], 1)
    assert json.loads(json.dumps(curve.to_dict()))["events"][0]["kind"] == "kink"
    assert "at its lower bound" in curve.table()


def kehoe(z, s):
    """Kehoe, Quart. J. Econ. 100 (1985) 119: two activities y, four prices, the first one 1; the fourth consumer's endowment
    times s."""
    activity = np.array([[6, -1], [-1, 3], [-4, -1], [-1, -1]])
    share = np.array(
        [[0.52, 0.86, 0.5, 0.06], [0.4, 0.1, 0.2, 0.25], [0.04, 0.02, 0.2975, 0.0025], [0.04, 0.02, 0.0025, 0.6875]]
    )
    endowment, price = np.array([5, 5, 40, 40 * s]), np.concatenate([[1], z[2:]])
    excess = endowment + activity @ z[:2] - share @ (price * endowment) / price
    return np.concatenate([-activity.T @ price, excess[1:]])


# The three equilibria that he found lie on one curve with two folds between them. Catches curves that end at a fold or jump.
def test_three_equilibria_on_one_curve():
    known = [
        [5.2, 6.9, 1, 1, 1],
        [5.3180132497870662, 6.514815149060321, 0.9086408621452301, 1.1218121838063599, 0.60411040262933036],
        [4.2701283145309654, 8.1198034676171282, 1.5681643660527573, 0.24244751192965674, 3.4620455862286157],
    ]
    low = [0, 0, 1e-4, 1e-4, 1e-4]
    curve = perp.trace(kehoe, known[0], (0.5, 2), low)
    assert curve.success and len(events(curve, "fold")) == 2 and len(curve.kinds("kink")) == 0
    met = []
    for k in np.flatnonzero((curve.p[1:] - 1) * (curve.p[:-1] - 1) < 0):
        share = (1 - curve.p[k]) / (curve.p[k + 1] - curve.p[k])
        near = curve.x[k] + share * (curve.x[k + 1] - curve.x[k])
        met.append(perp.solve(lambda z: kehoe(z, 1.0), near, low, convergence_tolerance=1e-12).x)
    assert len(met) == 3
    for equilibrium in known:
        assert min(np.abs(x - equilibrium).max() for x in met) < 1e-8


HOUSEHOLDS = ((90, 8, 54, 50, 0.8), (10, 80, 46, 50, 1.5))  # labour, capital; demand for X and Y at the benchmark; elasticity


def harberger(z, t):
    """data/README.md: a general equilibrium with a tax t on capital in sector X, and an untaxed technology U for the same good.
    Wage 1; z is X, Y, U, welfare of two households, prices of X, Y, capital and of welfare, incomes, revenue."""
    X, Y, U, worker, owner, p_X, p_Y, p_K, *rest = z
    welfare, living, income, revenue = (worker, owner), rest[:2], rest[2:4], rest[4]
    v = p_K * (1 + t) / 1.25
    c_X, c_Y, c_U = (0.4 + 0.6 * v**0.5) ** 2, p_K**0.4, 1.08 * p_K**0.3
    demand_X, demand_Y, profits, markets, budgets = 0, 0, [], [], []
    for (labour, capital, x, y, s), W, q, I in zip(HOUSEHOLDS, welfare, living, income):
        e = ((x * p_X ** (1 - s) + y * p_Y ** (1 - s)) / (x + y)) ** (1 / (1 - s))
        demand_X += x * W * (e / p_X) ** s
        demand_Y += y * W * (e / p_Y) ** s
        profits.append((x + y) * (e - q))
        markets.append((x + y) * W - I / q)
        budgets.append(I - labour - p_K * capital - revenue / 2)
    capital_X = 48 * X * (c_X / v) ** 0.5
    return np.array([
        100 * (c_X - p_X), 100 * (c_Y - p_Y), 100 * (c_U - p_X), *profits, 100 * X + 100 * U - demand_X, 100 * Y - demand_Y,
        88 - capital_X - 40 * Y * c_Y / p_K - 30 * U * c_U / p_K, *markets, *budgets, revenue - t * p_K * capital_X,
    ])  # fmt: skip


def switching_tax(low, high, taxed):
    """The tax at which both technologies for X cost the same while only the taxed one works, or only the other. All but the
    price of capital follows in closed form; it is where the market of capital clears, between low and high."""

    def at(p_K):
        p_X, p_Y = 1.08 * p_K**0.3, p_K**0.4
        v = ((p_X**0.5 - 0.4) / 0.6) ** 2
        t = 1.25 * v / p_K - 1
        use = 48 * (p_X / v) ** 0.5 if taxed else 30 * p_X / p_K  # of capital by 100 units of X
        # Demands are a + b G with the revenue G, which is t p_K use X: 100 X = a + b G.
        demand = np.zeros((2, 2))
        for labour, capital, x, y, s in HOUSEHOLDS:
            e = ((x * p_X ** (1 - s) + y * p_Y ** (1 - s)) / (x + y)) ** (1 / (1 - s))
            of_income = np.array([x * (e / p_X) ** s, y * (e / p_Y) ** s]) / ((x + y) * e)
            demand += np.outer(of_income, [labour + p_K * capital, 0.5])
        revenue_of_X = t * p_K * use if taxed else 0
        X = demand[0, 0] / (100 - demand[0, 1] * revenue_of_X)
        Y = (demand[1, 0] + demand[1, 1] * revenue_of_X * X) / 100
        return 88 - use * X - 40 * Y * p_Y / p_K, t

    below = at(low)[0] > 0
    assert below != (at(high)[0] > 0)
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if (at(middle)[0] > 0) == below else (low, middle)
    return at(low)[1]


# The tax swept from 0 to 3: the untaxed technology enters, and then the taxed one leaves. On its way the curve passes the
# benchmark, where all prices and activities are 1, and the solution at t = 0.5 that data/models/reference.py found by other means.
# Catches kinks of a larger economy that are not located, and a curve that leaves the equilibria.
def test_tax_sweep_of_a_general_equilibrium():
    low = [0, 0, 0, 0, 0, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3, NONE, NONE, NONE]
    start = [1, 1, 0, 1, 1, 1, 1, 1, 1, 1, 104, 96, 12]
    curve = perp.trace(harberger, start, (0, 3), low)
    assert curve.success, curve.message
    known = [switching_tax(0.8, 1, True), switching_tax(0.6, 0.95, False)]
    assert not curve.kinds("fold") and not curve.kinds("bifurcation")
    assert np.allclose(events(curve, "kink"), known, rtol=0, atol=1e-8), curve.table()
    assert curve.residual.max() <= 1e-8

    def on_the_curve(t):
        """The point of the curve beyond t, corrected to t."""
        k = np.flatnonzero(curve.p >= t)[0]
        return perp.solve(lambda z: harberger(z, t), curve.x[k], low, convergence_tolerance=1e-11).x

    assert np.allclose(on_the_curve(0.25), start, atol=1e-9)
    reference = json.loads((Path(__file__).parents[2] / "data/models/harberger.sol.json").read_text())
    expected = [value for name, value in reference.items() if name != "price[labour]"]
    assert np.allclose(on_the_curve(0.5), expected, rtol=1e-8)


# A variable of a problem as the parameter, its condition left out. Catches rows that stay.
def test_variable_of_a_problem():
    problem = perp.problem(
        lambda z: np.array([z[0] - z[1], z[1] - 5]), [0.0, 0.0], [0, NONE], [2, np.inf], variable_names=["x", "p"]
    )
    curve = perp.trace(problem, None, (-1, 3), parameter="p")
    assert curve.success and np.allclose(events(curve, "kink"), [0, 2], atol=1e-8) and curve.names == ["x"]
    with pytest.raises(ValueError, match="parameter"):
        perp.trace(problem, None, (0, 1), parameter="q")


# The program on a model: the others answer what the nuclear firm puts on the market, until the gas firm leaves it. Catches
# a command that fails, and events that are not written.
def test_command(tmp_path):
    model = Path(__file__).parents[2] / "data/models/cournot.nl"
    command = [sys.executable, "-m", "perp", "trace", str(model), "--parameter", "output[nuclear]=0:300"]
    said = subprocess.run([*command, "--json", str(tmp_path / "c.json")], capture_output=True, text=True)
    assert said.returncode == 0, said.stderr
    assert "output[gas] at its lower bound" in said.stdout
    curve = json.loads((tmp_path / "c.json").read_text())
    assert curve["success"] and max(curve["residual"]) <= 1e-8 and curve["events"][-1]["kind"] == "end"
    assert subprocess.run([*command[:-1], "q=0:1"], capture_output=True).returncode == 2


def test_says_why_not():
    nothing = perp.trace(lambda x, p: np.exp(x) + p, [0.0], (1, 2), NONE)
    assert not nothing.success and "p = 1" in nothing.message
    ends = perp.trace(lambda x, p: x - p if p < 1 else x * np.nan, [0.0], (0, 2), NONE)  # not defined from p = 1 on
    assert not ends.success and "followed" in ends.message
