#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of data/: the writer of .nl files, the models made with it, and their reference solutions.

The economics are checked against formulas written here a second time, from the tables of make_models.py and not from
its expression trees; the files against AMPL's own reader (gjh_asl_json of the Debian package gjh-asl-json) where it is
installed.
"""

import heapq
import json
import math
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
DATA = Path(__file__).resolve().parent.parent.parent / "data"
sys.path[:0] = [str(DATA), str(DATA / "models")]
import cge  # noqa: E402
import make_large  # noqa: E402
import make_models as mm  # noqa: E402
import nlwriter  # noqa: E402
import ramsey  # noqa: E402
import reference  # noqa: E402

MODELS = {model.name: model for model in mm.models()}


def solution(name):
    return json.loads((DATA / "models" / f"{name}.sol.json").read_text())


def bisect(function, low, high):
    """The zero of an increasing function."""
    assert function(low) < 0 < function(high)
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (middle, high) if function(middle) < 0 else (low, middle)
    return low


class Files(unittest.TestCase):
    def test_committed_files_are_what_the_generator_writes(self):
        """Catches a change of the generator, or of a file, without the other."""
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([sys.executable, DATA / "models" / "make_models.py", folder], check=True)
            written = sorted(Path(folder).iterdir())
            committed = [p for p in (DATA / "models").iterdir() if p.suffix in (".nl", ".col", ".row")]
            self.assertEqual([p.name for p in written], sorted(p.name for p in committed))
            for path in written:
                self.assertEqual(path.read_bytes(), (DATA / "models" / path.name).read_bytes(), path.name)

    @unittest.skipUnless(shutil.which("gjh_asl_json"), "gjh_asl_json is not installed (package gjh-asl-json)")
    def test_ampl_reads_what_was_meant(self):
        """Catches wrong counts, orders, indices or opcodes in either format: AMPL's values of the rows and of the
        Jacobian at the start are those of the trees."""
        for model in mm.models():
            # gjh_asl_json takes no model without an objective.
            model.minimize("none", 1 * model.variables[0])
            for binary in (False, True):
                with self.subTest(model.name, binary=binary), tempfile.TemporaryDirectory() as folder:
                    model.write(Path(folder) / "model.nl", binary)
                    self.compare_with_ampl(model, folder)

    def compare_with_ampl(self, model, folder):
        subprocess.run(["gjh_asl_json", "model.nl"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        read = json.loads((Path(folder) / "model.json").read_text())
        variables, rows = model.ordered()
        supplied = read["supplied starting points"]["primal"]
        starts = {str(i): v.start for i, v in enumerate(variables) if v.start is not None}
        self.assertEqual(set(supplied), set(starts))
        for i, start in starts.items():  # gjh_asl_json writes 6 digits of some
            self.assertAlmostEqual(supplied[i], start, delta=1e-5 * max(1, abs(start)), msg=variables[int(i)].name)
        x = [1.0 if v.start is None else v.start for v in variables]  # gjh_asl_json's default is 1
        bodies = read["initial evaluations"]["constraints"]
        for i, (row, value) in enumerate(zip(rows, reference.evaluate(variables, rows, x))):
            low, high = read["constraint bounds"][str(i)]
            # AMPL moves the constant of a linear row into its bounds.
            moved = next((b for b in (low, high) if row.complement and math.isfinite(b)), 0.0)
            constant = 0.0 if row.complement else row.constant
            delta = 1e-11 + 5e-6 * abs(moved)  # gjh_asl_json writes 6 digits of some
            self.assertAlmostEqual(bodies[str(i)] - moved, value - constant, delta=delta, msg=row.name)
            if row.complement:  # a variable with a lower bound only pairs with a row >= 0, and so on
                sides = (row.complement.upper == math.inf, row.complement.lower == -math.inf)
                self.assertEqual((low > -math.inf, high < math.inf), sides, row.name)
            else:
                self.assertEqual((low, high), (row.lower - constant, row.upper - constant), row.name)
        J = reference.jacobian(variables, rows, x)
        entries = {tuple(map(int, k.split("_"))): v for k, v in read["initial evaluations"]["constraints' jacobian"].items()}
        self.assertEqual(set(entries), {(i, variables.index(v)) for i, row in enumerate(rows) for v in row.linear})
        for i, row in enumerate(J):
            for j, value in enumerate(row):
                self.assertAlmostEqual(entries.get((i, j), 0.0), value, delta=1e-11, msg=f"{rows[i].name} {j}")


class References(unittest.TestCase):
    def test_each_solves_its_model(self):
        """Catches a .sol.json of another version of the model: the natural residual at the 10 digits written."""
        for name, model in MODELS.items():
            variables = model.ordered()[0]
            values = solution(name)
            if name in mm.UNDETERMINED:  # its own test looks at it
                continue
            self.assertEqual(list(values), [v.name for v in variables])
            x = [values[v.name] for v in variables]
            self.assertLess(reference.natural_residual(variables, model.pairs(), x), 1e-6, name)

    def test_each_is_what_the_solver_finds(self):
        for name, model in MODELS.items():
            values = solution(name)
            for v, x in zip(model.ordered()[0], reference.solve(model)):
                if not v.name.startswith(mm.UNDETERMINED.get(name, "/")):
                    self.assertAlmostEqual(values[v.name], x, delta=6e-10 * max(1, abs(x)), msg=f"{name} {v.name}")

    def test_each_is_nondegenerate(self):
        """max(x - l, |F|) is away from 0 in every pair, so that all methods must find the same active set."""
        for name, model in MODELS.items():
            if name in mm.UNDETERMINED:
                continue
            variables = model.ordered()[0]
            x = [solution(name)[v.name] for v in variables]
            for v, t, F in zip(variables, x, reference.evaluate(variables, model.pairs(), x)):
                if math.isfinite(v.lower) or math.isfinite(v.upper):
                    room = min(t - v.lower, v.upper - t)
                    self.assertTrue(room > 1e-3 or abs(F) > 1e-3 or v.lower == v.upper, f"{name} {v.name}: {room}, {F}")


class Cournot(unittest.TestCase):
    def test_best_replies_at_one_price(self):
        """Each firm's reply to a price p is q(p) = mid(0, (p - c) / (d + p/D), cap), increasing in p; the demand
        -D ln(p/A) decreases: one equilibrium, by bisection."""

        def replies(p):
            return {i: min(max((p - c) / (d + p / mm.DECAY), 0), cap) for i, (c, d, cap) in mm.FIRMS.items()}

        p = bisect(lambda p: sum(replies(p).values()) + mm.DECAY * math.log(p / mm.CHOKE_PRICE), 1e-9, mm.CHOKE_PRICE)
        q = replies(p)
        for i, output in q.items():
            self.assertAlmostEqual(solution("cournot")[f"output[{i}]"], output, delta=1e-7, msg=i)
        self.assertEqual(q["peaker"], 0)
        self.assertEqual(q["hydro"], mm.FIRMS["hydro"][2])
        self.assertTrue(0 < q["gas"] < mm.FIRMS["gas"][2])


class Harberger(unittest.TestCase):
    def test_benchmark_is_replicated(self):
        """With the tax at its benchmark all prices and activities are 1: the social accounting matrix of README.md."""
        values = solution("harberger-benchmark")
        for name, value in values.items():
            if name.startswith(("price", "welfare")) or name in ("activity[X]", "activity[Y]"):
                self.assertEqual(value, 1, name)
        self.assertEqual(values["activity[untaxed]"], 0)
        self.assertEqual(values["income[government]"], 12)
        self.assertEqual((values["income[worker]"], values["income[owner]"]), (104, 96))

    def test_counterfactual_by_elimination(self):
        """With both technologies of X in use their costs agree, which gives the price r of capital; all else is linear
        in the tax revenue. The market for capital, not used, clears by Walras' law."""
        tax, tax0 = 0.5, mm.BENCHMARK_TAX
        (lx, kx, sx), (ly, ky, _) = mm.SECTORS["X"], mm.SECTORS["Y"]
        lu, ku, factor = mm.UNTAXED

        def taxed_cost(r):
            share = lx / (lx + kx * (1 + tax0))
            return (share + (1 - share) * (r * (1 + tax) / (1 + tax0)) ** (1 - sx)) ** (1 / (1 - sx))

        def untaxed_cost(r):
            return factor * r ** (ku / 100)

        r = bisect(lambda r: taxed_cost(r) - untaxed_cost(r), 0.1, 2)
        px, py = taxed_cost(r), r ** (ky / 100)
        labour_x, capital_x = lx * px**sx, kx * (px * (1 + tax0) / (r * (1 + tax))) ** sx

        def economy(G):
            wanted_x = wanted_y = 0
            for labour, capital, share, x0, y0, s in mm.HOUSEHOLDS.values():
                index = (x0 * px ** (1 - s) + y0 * py ** (1 - s)) / (x0 + y0)
                income = labour + capital * r + share * G
                wanted_x += income * x0 / (x0 + y0) * px**-s / index
                wanted_y += income * y0 / (x0 + y0) * py**-s / index
            X = G / (tax * r * capital_x)
            U, Y = wanted_x / 100 - X, wanted_y / 100
            return X, Y, U, 100 - labour_x * X - ly * py * Y - lu * px * U

        zero, one = economy(0)[3], economy(1)[3]
        G = zero / (zero - one)
        X, Y, U, _ = economy(G)
        values = solution("harberger")
        for name, value in (
            ("price[capital]", r),
            ("price[X]", px),
            ("price[Y]", py),
            ("income[government]", G),
            ("activity[X]", X),
            ("activity[Y]", Y),
            ("activity[untaxed]", U),
        ):
            self.assertAlmostEqual(values[name], value, delta=2e-9 * max(1, value), msg=name)
        capital = sum(h[1] for h in mm.HOUSEHOLDS.values())
        self.assertAlmostEqual(capital_x * X + ky * py / r * Y + ku * px / r * U, capital, delta=1e-9)


class Energy(unittest.TestCase):
    def test_conditions_of_equilibrium(self):
        """The conditions of README.md, written out on the solution: no profit on what flows, none missed on what does
        not, markets cleared, rents only on full capacities, the emission cap met with a positive price."""
        v = solution("energy")

        def pair(slack, quantity, name):
            self.assertGreater(slack, -1e-7, name)
            self.assertGreaterEqual(quantity, 0, name)
            self.assertLess(min(slack, quantity), 1e-7, name)

        for r in mm.REGIONS:
            for f, g in (("coal", "gas"), ("gas", "coal")):
                level, p0 = mm.DEMAND[r, f]
                own = math.log(v[f"price[{r},{f}]"] / p0)
                cross = math.log(v[f"price[{r},{g}]"] / mm.DEMAND[r, g][1])
                demand = level * math.exp(mm.OWN_ELASTICITY[f] * own + mm.CROSS_ELASTICITY[f] * cross)
                moved = sum(v[f"shipment[{a},{b},{f}]"] * ((b == r) - (a == r)) for a, b in mm.ROUTES)
                self.assertAlmostEqual(v.get(f"production[{r},{f}]", 0) + moved, demand, delta=1e-6)
        for (r, f), (cost, slope, capacity) in mm.PRODUCERS.items():
            x, rent = v[f"production[{r},{f}]"], v[f"rent[{r},{f}]"]
            marginal = cost + slope * x + rent + mm.EMISSION[f] * v["carbon_price"]
            pair(marginal - v[f"price[{r},{f}]"], x, f"production {r} {f}")
            pair(capacity - x, rent, f"capacity {r} {f}")
        for (a, b), costs in mm.ROUTES.items():
            for f, cost, rent in (("coal", costs[0], 0), ("gas", costs[1], v[f"congestion[{a},{b}]"])):
                gap = v[f"price[{a},{f}]"] + cost + rent - v[f"price[{b},{f}]"]
                pair(gap, v[f"shipment[{a},{b},{f}]"], f"shipment {a} {b} {f}")
            pair(costs[2] - v[f"shipment[{a},{b},gas]"], v[f"congestion[{a},{b}]"], f"pipeline {a} {b}")
        emitted = sum(mm.EMISSION[f] * v[f"production[{r},{f}]"] for r, f in mm.PRODUCERS)
        self.assertAlmostEqual(emitted, mm.EMISSION_CAP, delta=1e-7)
        self.assertGreater(v["carbon_price"], 1)


class Cases(unittest.TestCase):
    def test_closed_form(self):
        expected = {
            "free": 1,  # ln(free) = -at_lower = 0
            "at_lower": 0,  # F > 0
            "above_lower": math.sqrt(2),
            "at_upper": 4,  # F = -8
            "below_upper": -2,
            "box_lower": -1,  # F = 6
            "box_inside": 1.5,
            "box_upper": 2,  # F = 2 - e^2
            "fixed": 2.5,  # F = -90
            "bounded": 6,
            "linear": 2.25,
        }
        values = solution("cases")
        self.assertEqual(set(values), set(expected))
        for name, value in expected.items():
            self.assertAlmostEqual(values[name], value, delta=1e-9, msg=name)

    def test_side_inequalities_hold_with_slack(self):
        model = MODELS["cases"]
        at = {v: solution("cases")[v.name] for v in model.variables}
        sides = [row for row in model.rows if not row.complement and row.lower < row.upper]
        self.assertEqual(len(sides), 3)
        for row in sides:
            self.assertTrue(row.lower < row.body.value(at) < row.upper, row.name)


def residual_at_start(model):
    """The natural residual at the start, each row in units of its largest derivative where that is above 1."""
    variables, rows = model.ordered()[0], model.pairs()
    x = [v.start for v in variables]
    F, J = reference.evaluate(variables, rows, x), reference.jacobian(variables, rows, x)
    scaled = [f / max(1, *map(abs, row)) for f, row in zip(F, J)]
    return max(abs(t - min(max(t - f, v.lower), v.upper)) for v, t, f in zip(variables, x, scaled))


class Economy(unittest.TestCase):
    def test_benchmark_is_replicated(self):
        """Without a shock the benchmark is an equilibrium: every market, budget and zero-profit condition holds in the
        social accounting matrix. Catches a tax, a share or a use that one of two rows forgets."""
        for scaled in (True, False):
            for seed in range(1, 6):
                self.assertLess(residual_at_start(cge.cge("benchmark", 7, 4, scaled=scaled, seed=seed)), 1e-12)

    def test_rationing_is_met(self):
        """Each instrument of the shock works: unemployment with the real wage at its floor, a premium where the quota
        binds, a permit price, the other technology in use, the sales taxes moved."""
        values = solution("economy")
        self.assertTrue(0 < values["unemployment"] < 0.9)
        self.assertGreater(values["premium[4]"], 0.1)
        self.assertGreater(values["permit"], 0.1)
        self.assertGreater(max(values["other_output[1]"], values["other_output[2]"]), 0)
        self.assertGreater(abs(values["tax_multiplier"]), 0.01)
        self.assertLess(abs(values["tax_multiplier"]), 10)

    def test_walras_law(self):
        """The row of the numeraire's fixed price, which no solver looks at, is zero all the same."""
        model = MODELS["economy"]
        at = {v: solution("economy")[v.name] for v in model.variables}
        trade = next(row for row in model.rows if row.name == "trade")
        self.assertLess(abs(trade.body.value(at)), 1e-6)


class Spatial(unittest.TestCase):
    def test_prices(self):
        """No price exceeds another by more than the distance, and with prices given supply is (p - c) / slope and total
        demand total supply. Some prices differ by just the distance although no two regions need trade: ties."""
        values, model = solution("spatial"), MODELS["spatial"]
        price = {v.name[6:-1]: values[v.name] for v in model.variables if v.name.startswith("price")}
        gaps = []
        for a in price:
            for b in price:
                (i, j), (k, l) = (map(int, r.split("_")) for r in (a, b))
                gaps.append(price[a] + abs(i - k) + abs(j - l) - price[b])
        self.assertGreater(min(gaps), -1e-7)
        ties = sum(abs(gap) < 1e-7 for gap in gaps) - len(price)
        self.assertGreater(ties, len(price) - 1)  # more than a tree: the flows are not determined
        at = {v: values.get(v.name, 0.0) for v in model.variables}
        excess = sum(row.body.value(at) for row in model.rows if row.name.startswith("market"))
        self.assertAlmostEqual(excess, 0, delta=1e-6)


class Streets(unittest.TestCase):
    def test_everybody_drives_a_shortest_way(self):
        """Wardrop: with the travel times of the flows, Dijkstra's distances are the times of the solution, all trips
        arrive, and the time spent on the streets is trips times distance."""
        model, values = MODELS["streets"], solution("streets")
        at = {v: values[v.name] for v in model.variables}
        streets, spent = {}, 0.0
        for row in model.rows:
            if row.name.startswith("choice"):
                a, b, goal = row.name[7:-1].split(",")
                duration = row.body.value(at) - values.get(f"time[{b},{goal}]", 0) + values.get(f"time[{a},{goal}]", 0)
                streets.setdefault(b, []).append((a, duration))
                spent += duration * values[f"flow[{a},{b},{goal}]"]
        far, queue = {}, [(0.0, goal)]
        while queue:
            d, v = heapq.heappop(queue)
            if v not in far:
                far[v] = d
                for a, duration in streets.get(v, []):
                    heapq.heappush(queue, (d + duration, a))
        trips = {row.name[6:-1].split(",")[0]: -row.constant for row in model.rows if row.name.startswith("trips")}
        for v, number in trips.items():
            self.assertAlmostEqual(values[f"time[{v},{goal}]"], far[v], delta=1e-7)
            self.assertGreater(number, 0)
        self.assertAlmostEqual(spent, sum(trips[v] * far[v] for v in trips), delta=1e-5)


class Growth(unittest.TestCase):
    def test_benchmark_path(self):
        """With the resource, the first capital and the emissions of the benchmark, steady growth is the equilibrium."""
        self.assertLess(residual_at_start(ramsey.ramsey("steady", 12, stock=1.0)), 1e-12)

    def test_scarcity(self):
        """Hotelling: the resource is used up, its rent (in present value) is one number, and energy costs extraction,
        rent and permit in every period in which it is extracted."""
        v = solution("growth")
        extracted = [v[f"fossil[{t}]"] for t in range(6)]
        self.assertAlmostEqual(sum(extracted), 0.6 * sum(1.02**t for t in range(6)), delta=1e-8)
        self.assertGreater(v["resource_rent"], 0.01)
        for t, x in enumerate(extracted):
            gap = v[f"price[{t}]"] + v["resource_rent"] + v.get(f"permit[{t}]", 0) - v[f"price_of_energy[{t}]"]
            self.assertGreater(gap, -1e-8)
            self.assertLess(min(gap, x), 1e-8)


class Large(unittest.TestCase):
    def test_one_of_each_kind(self):
        """Catches a generator that no longer runs, or whose model is not square."""
        kinds = {name.split("-")[0]: name for name in make_large.MODELS}
        with tempfile.TemporaryDirectory() as folder:
            for name in kinds.values():
                smallest = min((n for n in make_large.MODELS if n.split("-")[0] == name.split("-")[0]), key=size)
                make_large.MODELS[smallest](smallest).write(Path(folder) / "model.nl")


def size(name):
    """The first number of a name: how large the model is, for those of one kind."""
    return min(int(part) for part in name.split("-") if part.isdigit())


class Writer(unittest.TestCase):
    def setUp(self):
        self.m = nlwriter.Model("m")
        self.x = self.m.variable("x", lower=0, start=1)
        self.y = self.m.variable("y")

    def refuses(self, pattern, action, *args, **kwargs):
        with self.assertRaisesRegex(ValueError, pattern):
            action(*args, **kwargs)

    def test_refuses_what_is_no_model(self):
        m, x, y = self.m, self.x, self.y
        m.complement("F", x + y - 1, x)
        self.refuses(r"two rows complement x", m.complement, "G", x, x)
        self.refuses(r"y is free", m.complement, "G", x, y)
        self.refuses(r"called x", m.variable, "x")
        self.refuses(r"called F", m.equation, "F", y)
        self.refuses(r"\[2, 1\]", m.variable, "z", 2, 1)
        self.refuses(r"\[nan, inf\]", m.variable, "z", math.nan)
        self.refuses(r"another model: z", m.equation, "G", y + nlwriter.Model("other").variable("z"))
        self.refuses(r"1.5, 1.5", m.inequality, "S", y, 1.5, 1.5)
        self.refuses(r"nonlinear", m.minimize, "o", x * y)
        self.refuses(r"constant .* inf", lambda: x + math.inf)
        self.refuses(r"not square: 0 equations, 1 variables", m.write, "unwritten.nl")

    def test_collects_linear_parts(self):
        """Catches a variable counted as nonlinear, or its coefficient lost, in 2 (x - 3 (x y - y / 4)) + 1."""
        row = nlwriter.Row("r", 2 * (self.x - 3 * (self.x * self.y - self.y / 4)) + 1, 0, 0)
        self.assertEqual((row.constant, row.linear), (1, {self.x: 2, self.y: 1.5}))
        self.assertEqual([factor for factor, _ in row.nonlinear], [-6])

    def test_sums_of_one_and_of_none(self):
        """Catches operator 0, which takes two arguments, before fewer: the reader would run on into the next row."""
        for terms, expected in (([self.x], b"o5\nv0\nn2\n"), ([], b"o5\nn0\nn2\n")):
            out = nlwriter.TextEncoder([self.x, self.y])
            (nlwriter.total(terms) ** 2).prefix(out)
            self.assertEqual(b"".join(out.parts), expected)

    def test_puts_nonlinear_rows_and_variables_first(self):
        m, x, y = self.m, self.x, self.y
        m.complement("linear", x + 1, x)
        m.equation("bent", y**2 - 4)
        variables, rows = m.ordered()
        self.assertEqual([v.name for v in variables], ["y", "x"])
        self.assertEqual([row.name for row in rows], ["bent", "linear"])
        self.assertEqual([row.name for row in m.pairs()], ["bent", "linear"])


if __name__ == "__main__":
    unittest.main()
