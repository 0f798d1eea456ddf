# SPDX-License-Identifier: Apache-2.0
"""The solver plug-in perp.pyomo. Skipped where Pyomo is not installed (it is on PyPI), or PERP does not name the program.

Expected values are computed by hand where a comment says no more; tests of laws compare with Pyomo's own value()."""

import io
import logging
import os
import random
import sys
import time

import pytest
from pages import run_examples

pyo = pytest.importorskip("pyomo.environ")
from pyomo.common import Executable  # noqa: E402  (after the check)
from pyomo.common.errors import ApplicationError  # noqa: E402
from pyomo.mpec import Complementarity, ComplementarityList, complements  # noqa: E402
from pyomo.opt import SolverStatus, TerminationCondition  # noqa: E402

pytest.importorskip("perp.pyomo")
from perp.pyomo import ModelError  # noqa: E402
from perp.pyomo._model import _polyhedron  # noqa: E402

PROGRAM = os.environ.get("PERP", "")
if not PROGRAM:
    pytest.skip("PERP does not name the program", allow_module_level=True)

between = pyo.inequality


@pytest.fixture
def solver():
    return pyo.SolverFactory("perp", executable=PROGRAM)


def solved(model, solver, **keywords):
    results = solver.solve(model, **keywords)
    pyo.assert_optimal_termination(results)
    return results


# Spellings of a condition


def demand(condition, bounds=(None, None)):
    """p + 0.1 x = 18 and 10 - p complements 0 <= x <= 40: at x = 40 there is p = 14 and F = -4, and p = 10 asks for x = 80."""
    m = pyo.ConcreteModel()
    m.p, m.x = pyo.Var(initialize=0), pyo.Var(bounds=bounds, initialize=1)
    m.price = pyo.Constraint(expr=m.p + 0.1 * m.x == 18)
    m.c = Complementarity(expr=condition(m))
    return m


DOUBLE_BOUNDED = {
    "F, range": lambda: demand(lambda m: complements(10 - m.p, between(0, m.x, 40))),
    "range, F": lambda: demand(lambda m: complements(between(0, m.x, 40), 10 - m.p)),
    "F >= 0, range": lambda: demand(lambda m: complements(10 - m.p >= 0, between(0, m.x, 40))),
    "range, F >= 0": lambda: demand(lambda m: complements(between(0, m.x, 40), m.p <= 10)),
    "-F <= 0, range": lambda: demand(lambda m: complements(m.p - 10 <= 0, between(0, m.x, 40))),
    "F == 0, range": lambda: demand(lambda m: complements(10 - m.p == 0, between(0, m.x, 40))),
    "F, tuple": lambda: demand(lambda m: complements(10 - m.p, (0, m.x, 40))),
    "F, x in a box": lambda: demand(lambda m: complements(10 - m.p, m.x), (0, 40)),
    "F >= 0, x in a box": lambda: demand(lambda m: complements(10 - m.p >= 0, m.x), (0, 40)),
    "F >= 0, x >= 0 in a box": lambda: demand(lambda m: complements(10 - m.p >= 0, m.x >= 0), (0, 40)),
    "F >= 0, x >= 0, upper bound of the Var": lambda: demand(lambda m: complements(10 - m.p >= 0, m.x >= 0), (None, 40)),
    "F <= 0, x <= 40 in a box": lambda: demand(lambda m: complements(10 - m.p <= 0, m.x <= 40), (0, 40)),
    "F <= 0, x <= 40": lambda: demand(lambda m: complements(10 - m.p <= 0, m.x <= 40)),
    "-F >= 0, x <= 40": lambda: demand(lambda m: complements(m.x <= 40, m.p >= 10)),
    "F, range of an expression": lambda: demand(lambda m: complements(10 - m.p, between(1, m.x + 1, 41))),
    "F, range of a multiple": lambda: demand(lambda m: complements(m.p - 10, between(-80, -2 * m.x, 0))),
    "bounds of parameters": lambda: demand(lambda m: complements(10 - m.p, between(0, m.x, capacity(m)))),
}


def capacity(m):
    m.capacity = pyo.Param(initialize=40, mutable=True)
    return m.capacity


@pytest.mark.parametrize("spelling", DOUBLE_BOUNDED)
def test_double_bounded(spelling, solver):
    """Catches a bound that is lost, and an F with the wrong sign."""
    m = DOUBLE_BOUNDED[spelling]()
    solved(m, solver)
    assert m.x.value == pytest.approx(40) and m.p.value == pytest.approx(14)


@pytest.mark.parametrize("a, x", [(-1, 2), (-5, 4), (3, 0)])
def test_the_users_variable_is_the_one_of_the_pair(a, x, solver, tmp_path):
    """No unknown is added for complements(F >= 0, 0 <= x <= 4): the file has one column and one row of kind 5."""
    m = pyo.ConcreteModel()
    m.x = pyo.Var(initialize=1)
    m.c = Complementarity(expr=complements(0.5 * m.x + a >= 0, between(0, m.x, 4)))
    results = solved(m, solver)
    assert results.problem.number_of_variables == 1
    assert m.x.value == pytest.approx(x)


def test_signs_at_each_bound(solver):
    """MR - MC <= 0 beside q >= 0 is F = MC - MR; rent >= 0 beside q <= 4 is F = -rent (at most 0 at the bound)."""
    m = pyo.ConcreteModel()
    m.q, m.k = pyo.Var(initialize=1, bounds=(0, 100)), pyo.Var(initialize=1)
    m.supply = Complementarity(expr=complements(10 - 2 * m.q - 4 <= 0, m.q >= 0))
    m.rent = Complementarity(expr=complements(7 - m.k >= 0, m.k <= 4))
    solved(m, solver)
    assert (m.q.value, m.k.value) == (pytest.approx(3), pytest.approx(4))


def test_a_variable_of_two_conditions(solver):
    """x is the variable of one condition only; the other gets one of its own. x >= 0 _|_ y >= 0, and x >= 0 _|_ x + y >= 1."""
    m = pyo.ConcreteModel()
    m.x, m.y = pyo.Var(initialize=1), pyo.Var(initialize=1)
    m.a = Complementarity(expr=complements(m.x >= 0, m.y >= 0))
    m.b = Complementarity(expr=complements(m.x >= 0, m.x + m.y >= 1))
    solved(m, solver)
    x, y = m.x.value, m.y.value
    assert min(x, y) == pytest.approx(0, abs=1e-6) and min(x, x + y - 1) == pytest.approx(0, abs=1e-6)


REFUSED = {
    "both have two bounds": (lambda m: complements(between(0, m.x, 1), between(0, m.y, 1)), "two bounds"),
    "no side has a bound": (lambda m: complements(m.x + m.y, m.x - m.y), "bound"),
    "two equations": (lambda m: complements(m.x == 1, m.y == 1), "Constraint"),
    "a sense beside a free variable": (lambda m: complements(m.y >= 0, m.x), "x has no bounds|y has no bounds"),
    "a bound that varies": (lambda m: complements(m.x + m.y, (0, m.x, m.y)), "bound depends"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_conditions_that_say_nothing_are_refused(case, solver):
    condition, words = REFUSED[case]
    m = pyo.ConcreteModel()
    m.x, m.y = pyo.Var(), pyo.Var()
    m.cc = Complementarity(expr=condition(m))
    m.d = pyo.Constraint(expr=m.x == 1)
    with pytest.raises(ModelError, match=words) as refused:
        solver.solve(m)
    assert "cc" in str(refused.value)


# Expressions


def random_expression(r, m, depth):
    """Defined for all x and p in [0.5, 2], the range that the test uses."""

    def sub():
        return random_expression(r, m, depth - 1)

    def leaf():
        return r.choice([m.x[r.randrange(4)], m.x[r.randrange(4)], m.p[r.randrange(3)], m.f, 2.5, -0.75, 0, 3])

    def named():
        expression = sub()
        k = len(m.named) + 1
        m.named[k] = expression
        return r.choice([m.named[k], m.named[k] + sub(), m.named[k] * m.named[r.randint(1, k)]])

    def condition():
        return r.choice([sub() <= sub(), sub() < sub(), between(0.1, sub(), 3.1), sub() == 2.0])

    if depth == 0:
        return leaf()
    return r.choice(
        [
            lambda: sub() + sub(),
            lambda: sub() - sub(),
            lambda: sub() * sub(),
            lambda: -sub(),
            lambda: sub() / (1.5 + sub() ** 2),
            lambda: (1.2 + sub() ** 2) ** r.choice([2, 0.5, -1, 1, 0, m.p[0], m.x[1]]),
            lambda: r.choice([pyo.exp, pyo.cosh, pyo.sinh])(pyo.tanh(sub())),
            lambda: pyo.log(1.1 + sub() ** 2),
            lambda: pyo.log10(1.1 + sub() ** 2),
            lambda: pyo.sqrt(0.3 + sub() ** 2),
            lambda: r.choice([pyo.sin, pyo.cos, pyo.atan, pyo.asinh])(sub()),
            lambda: abs(sub()),
            lambda: pyo.Expr_if(IF=condition(), THEN=sub(), ELSE=sub()),
            lambda: sum(r.choice([1, m.p[1], -2]) * m.x[i] for i in range(4)) + sub(),
            named,
        ]
    )()


@pytest.mark.parametrize("seed", range(40))
def test_expressions_have_pyomos_values(seed, solver):
    """z = e(x) for random e, of all kinds of nodes: Perp's z is Pyomo's value(e); again with other parameters, in the form
    that was compiled before. Catches a wrong operator, a lost term, and a number that is not renewed."""
    r = random.Random(seed)
    m = pyo.ConcreteModel()
    m.x, m.z, m.f = pyo.Var(range(4)), pyo.Var(range(4)), pyo.Var(initialize=1.5)
    m.f.fix()
    m.p = pyo.Param(range(3), initialize=lambda m, i: r.uniform(0.5, 2), mutable=True, within=pyo.Reals)
    m.v = pyo.Param(range(4), initialize=lambda m, i: r.uniform(0.5, 2), mutable=True, within=pyo.Reals)
    m.named = pyo.Expression(pyo.PositiveIntegers)
    m.pins = pyo.Constraint(range(4), rule=lambda m, i: m.x[i] == m.v[i])
    expressions = [random_expression(r, m, 4) for _ in range(4)]
    m.c = pyo.Constraint(range(4), rule=lambda m, i: m.z[i] - expressions[i] == 0)
    for _ in range(3):
        for i in range(4):
            m.x[i] = pyo.value(m.v[i])
        solved(m, solver)
        for i in range(4):
            assert m.z[i].value == pytest.approx(pyo.value(expressions[i]), rel=1e-6, abs=1e-6)
        for parameter in [*m.p.values(), *m.v.values()]:
            parameter.value = r.uniform(0.5, 2)
        m.f.fix(r.uniform(0.5, 2))


def test_deep_and_long_expressions(solver):
    m = pyo.ConcreteModel()
    m.x = pyo.Var(range(2000), initialize=1)
    deep = m.x[0]
    for _ in range(600):
        deep = (deep + 1) * 0.5
    m.first = pyo.Constraint(expr=deep**2 == 1)
    m.rest = pyo.Constraint(range(1, 2000), rule=lambda m, i: m.x[i] - m.x[i - 1] == 0)
    m.total = pyo.Expression(expr=sum(m.x[i] for i in range(2000)))
    m.s = pyo.Var(initialize=0)
    m.square = pyo.Constraint(expr=m.s == m.total**2 + m.total**2)
    solved(m, solver)
    assert m.s.value == pytest.approx(2 * 2000.0**2)


def test_a_large_model_is_compiled_in_linear_time(solver):
    """8000 conditions take about 2 s of the processor; what looks at all variables for each takes more than 30."""
    m = pyo.ConcreteModel()
    m.x = pyo.Var(range(8000), initialize=1)
    m.c = Complementarity(range(8000), rule=lambda m, i: complements(m.x[i] ** 2 + (m.x[i - 1] if i else 1) >= 5, m.x[i] >= 0))
    begun = time.process_time()
    solved(m, solver)
    assert time.process_time() - begun < 10
    assert m.x[0].value == pytest.approx(2) and m.x[1].value == pytest.approx(3**0.5)


# Changes between solves


def market():
    m = pyo.ConcreteModel()
    m.goods = pyo.Set(initialize=["gas", "oil"])
    m.tax = pyo.Param(initialize=0, mutable=True)
    m.cost = pyo.Param(m.goods, initialize={"gas": 2, "oil": 4}, mutable=True)
    m.q = pyo.Var(m.goods, initialize=1, bounds=(0, None))
    m.profit = Complementarity(
        m.goods, rule=lambda m, g: complements((1 + m.tax) * m.cost[g] + m.q[g] >= 10 - m.q[g], m.q[g] >= 0)
    )
    return m


def test_changes_between_solves_are_seen(solver):
    """Each step changes one thing of which the compiled form depends; the answer is that of the changed model."""
    m = market()

    def quantities(**keywords):
        solved(m, solver, **keywords)
        return [pytest.approx(m.q[g].value, abs=1e-6) for g in m.goods]

    assert quantities() == [4, 3]  # q = (10 - cost) / 2
    m.tax = 1
    assert quantities() == [3, 1]
    m.cost["oil"] = 7
    assert quantities() == [3, 0]
    m.q["gas"].setub(2)
    assert quantities() == [2, 0]
    m.q["gas"].setlb(2.5)
    with pytest.raises(ModelError, match=r"q\[gas\] has the bounds \[2.5, 2\]"):
        solver.solve(m)
    m.q["gas"].setlb(0)
    m.q["gas"].setub(None)
    m.q["gas"].fix(1.5)
    assert quantities() == [1.5, 0]
    m.q["gas"].unfix()
    assert quantities() == [3, 0]
    m.profit["oil"].deactivate()
    m.pin = pyo.Constraint(expr=m.q["oil"] == 6)
    assert quantities() == [3, 6]
    m.pin.deactivate()
    m.profit["oil"].activate()
    assert quantities() == [3, 0]
    m.e = pyo.Expression(expr=m.q["gas"] - 1)
    m.profit["gas"].deactivate()
    m.zero = pyo.Constraint(expr=m.e == 0)
    assert quantities() == [1, 0]
    m.e.set_value(m.q["gas"] - 5)
    assert quantities() == [5, 0]
    m.zero.set_value(m.e == 1)
    assert quantities() == [6, 0]
    m.profit["oil"].set_value(complements(m.q["oil"] - 1 >= 0, m.q["oil"] >= 0))
    assert quantities() == [6, 1]


def test_a_loop_is_quiet_and_fast(solver, caplog, capfd):
    """100 solves of 50 conditions in which every number changes: 3 ms of Python's own time each at most, the processor's
    time of this process, and not a word."""
    m = pyo.ConcreteModel()
    m.firms = pyo.RangeSet(50)
    m.a = pyo.Param(initialize=10, mutable=True)
    m.q = pyo.Var(m.firms, initialize=0.1, bounds=(0, 5))
    m.total = pyo.Expression(expr=sum(m.q[i] for i in m.firms))
    m.cc = Complementarity(m.firms, rule=lambda m, i: complements(m.total + m.q[i] ** 2 + m.q[i] >= m.a + i / 50 * m.a, m.q[i] >= 0))
    solved(m, solver)
    begun = time.process_time()
    with caplog.at_level(logging.WARNING):
        for k in range(100):
            m.a = 10 + 0.1 * k
            solved(pyo.SolverFactory("perp", executable=PROGRAM) and m, solver)
    assert (time.process_time() - begun) / 100 < 3e-3
    assert not caplog.records and capfd.readouterr() == ("", "")


def test_clones_and_forks_have_files_of_their_own(solver):
    m = market()
    solved(m, solver)
    other = m.clone()
    other.tax = 1
    solved(other, solver)
    assert other.q["gas"].value == pytest.approx(3) and m.q["gas"].value == pytest.approx(4)
    child = os.fork()
    if child == 0:
        try:
            m.tax = 1
            solver.solve(m)
            os._exit(0 if abs(m.q["gas"].value - 3) < 1e-6 else 1)
        finally:
            os._exit(2)
    for _ in range(5):
        solved(m, solver)
        assert m.q["gas"].value == pytest.approx(4)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


# Fixed variables, suffixes


def exchange():
    """Cobb-Douglas with one consumer: p_g = a_g I / w_g, so that p = (1, 3/4, 5/6) with p_1 = 1."""
    m = pyo.ConcreteModel()
    m.goods = pyo.Set(initialize=[1, 2, 3])
    m.w = pyo.Param(m.goods, initialize={1: 1, 2: 2, 3: 3})
    m.a = pyo.Param(m.goods, initialize={1: 0.2, 2: 0.3, 3: 0.5})
    m.p = pyo.Var(m.goods, initialize=1, bounds=(0, None))
    m.income = pyo.Expression(expr=sum(m.w[g] * m.p[g] for g in m.goods))
    m.market = Complementarity(m.goods, rule=lambda m, g: complements(m.w[g] >= m.a[g] * m.income / m.p[g], m.p[g] >= 0))
    return m


def test_a_numeraire(solver):
    m = exchange()
    m.p[1].fix(1)
    results = solved(m, solver)
    assert [m.p[g].value for g in m.goods] == pytest.approx([1, 0.75, 5 / 6])
    assert "market[1] is left out, because its variable p[1] is fixed" in results.solver.message


def test_a_numeraire_of_equations(solver):
    """complements(F == 0, p) with p fixed is left out as well, so that the model stays square."""
    m = pyo.ConcreteModel()
    m.p = pyo.Var([1, 2], initialize=1)
    m.market = Complementarity([1, 2], rule=lambda m, g: complements(m.p[1] - 0.5 * m.p[2] == 0, m.p[g]))
    m.p[1].fix(1)
    solved(m, solver)
    assert m.p[2].value == pytest.approx(2)


def test_suffixes(solver):
    """min (x - 2)^2 + y^2 subject to x <= 1: multiplier 2 and slack 0; y = 0 within its bounds; z >= 0 with F = 3."""
    m = pyo.ConcreteModel()
    m.dual, m.slack, m.rc = (pyo.Suffix(direction=pyo.Suffix.IMPORT) for _ in range(3))
    m.x, m.y, m.z, m.u = pyo.Var(initialize=0), pyo.Var(), pyo.Var(initialize=5), pyo.Var(initialize=0)
    m.x_opt = pyo.Constraint(expr=2 * (m.x - 2) + m.u == 0)
    m.y_opt = pyo.Constraint(expr=2 * m.y == 0)
    m.z_opt = Complementarity(expr=complements(m.z >= 0, m.z + 3 >= 0))
    m.limit = Complementarity(expr=complements(m.x <= 1, m.u >= 0))
    m.k = pyo.Var(initialize=7)
    m.k.fix()
    m.k_opt = Complementarity(expr=complements(m.k - 3 >= 0, m.k >= 0))
    solved(m, solver)
    assert m.dual[m.limit] == pytest.approx(2) and m.slack[m.limit] == pytest.approx(0, abs=1e-6)
    assert m.slack[m.z_opt] == pytest.approx(3) and m.rc[m.z] == pytest.approx(3) and m.dual[m.z_opt] == pytest.approx(0)
    assert m.slack[m.k_opt] == 4 and m.dual[m.k_opt] == 7
    assert m.x_opt not in m.dual


# What is said


def test_a_polyhedron_by_its_suffix(solver):
    """Facchinei & Pang 2003, proposition 1.2.1: F(x) = A'lambda, of rows of every kind. Would catch a suffix that is not
    written or kept from the solve before, and multipliers of other rows or with other signs."""
    m = pyo.ConcreteModel()
    m.x = pyo.Var([1, 2, 3], initialize=1)
    m.F = pyo.Constraint([1, 2, 3], rule=lambda m, i: m.x[i] + m.x[i] ** 3 == 2)  # x = 1 without C
    m.free = pyo.Constraint(expr=m.x[1] <= 5)
    m.C = pyo.ConstraintList()
    for row in (between(0, m.x[1] - 1, 2), m.x[2] == 2, between(-1, m.x[3], 0), 2 * m.x[1] >= 4):
        m.C.add(row)
    m.polyhedron = pyo.Suffix(direction=pyo.Suffix.EXPORT)
    m.dual = pyo.Suffix(direction=pyo.Suffix.IMPORT)
    m.polyhedron[m.C] = 1
    solved(m, solver)
    assert [m.x[i].value for i in (1, 2, 3)] == pytest.approx([2, 2, 0], abs=1e-8)
    assert [m.dual[m.C[k]] for k in (1, 2, 3, 4)] == pytest.approx([0, 8, -2, 4], abs=1e-8)
    m.polyhedron[m.C[4]] = 0
    m.C[4].deactivate()
    solved(m, solver)
    assert m.x[1].value == pytest.approx(1, abs=1e-8) and m.C[4] not in m.dual
    m.polyhedron[m.C[1]] = 0  # takes one back
    assert id(m.C[1]) not in _polyhedron(m) and id(m.C[2]) in _polyhedron(m)
    m.polyhedron.clear()
    m.polyhedron[None] = 1  # Pyomo's default
    assert id(m.C[1]) in _polyhedron(m)
    m.polyhedron.deactivate()
    assert "not square" in solver.solve(m, load_solutions=False).solver.message


def test_a_row_of_a_polyhedron_that_becomes_an_equation(solver):
    """x = 4, F = x - 1 = 3. Would catch two multipliers that are read where the program has one."""
    m = pyo.ConcreteModel()
    m.p = pyo.Param(initialize=4, mutable=True)
    m.x = pyo.Var(bounds=(0, None), initialize=1)
    m.F = Complementarity(expr=complements(m.x >= 0, m.x - 1))
    m.cap = pyo.Constraint(expr=(m.p, m.x, 4))
    m.polyhedron = pyo.Suffix(direction=pyo.Suffix.EXPORT)
    m.dual = pyo.Suffix(direction=pyo.Suffix.IMPORT)
    m.polyhedron[m.cap] = 1
    for low, multiplier in ((4, 3), (2, 1)):
        m.p = low
        solved(m, solver)
        assert m.dual[m.cap] == pytest.approx(multiplier, abs=1e-8)


def test_where_the_start_is_undefined(solver, caplog):
    """The message speaks of the model's own condition and variable."""
    m = pyo.ConcreteModel()
    m.goods = pyo.Set(initialize=["gas"])
    m.price = pyo.Var(m.goods, initialize=-1)
    m.market = pyo.Constraint(m.goods, rule=lambda m, g: pyo.log(m.price[g]) == -1)
    results = solver.solve(m)
    assert results.solver.status == SolverStatus.warning
    assert results.solver.termination_condition != TerminationCondition.optimal
    assert "market[gas]" in results.solver.message and "price[gas]" in results.solver.message
    assert "market[gas]" in caplog.text


def test_no_solution(solver):
    m = pyo.ConcreteModel()
    m.x = pyo.Var(initialize=0)
    m.cc = Complementarity(expr=complements(m.x >= 0, -m.x >= 1))
    results = solver.solve(m, load_solutions=False)
    assert results.solver.termination_condition == TerminationCondition.infeasible
    assert "cc" in results.solver.message and m.x.value == 0
    assert not pyo.check_optimal_termination(solver.solve(m))


def test_limits(solver):
    m = market()
    results = solver.solve(m, options={"method": "path", "major_iteration_limit": 0, "crash_method": "none", "preprocess": False})
    assert results.solver.termination_condition == TerminationCondition.maxIterations
    assert results.solver.status == SolverStatus.warning


def test_the_objective_of_a_square_model_is_ignored_and_that_is_said(solver, caplog):
    m = market()
    m.welfare = pyo.Objective(expr=m.q["gas"], sense=pyo.maximize)
    for _ in range(3):
        assert "the objective welfare is ignored" in solved(m, solver).solver.message
    assert caplog.text.count("welfare") == 1


def test_a_solution_by_being_small_is_warned_of(solver, caplog):
    """F = 1e-28 x - 3e-28 is below the tolerance at x = 0, where it is not balanced at all."""
    m = pyo.ConcreteModel()
    m.x = pyo.Var(initialize=0)
    m.small = Complementarity(expr=complements(m.x >= 0, 1e-28 * m.x - 3e-28 >= 0))
    results = solver.solve(m)
    if m.x.value < 1:  # else it was solved in spite of the units
        assert "small" in results.solver.message and "small" in caplog.text


def test_an_mpec_is_refused_as_such(solver):
    m = pyo.ConcreteModel()
    m.x, m.y = pyo.Var(bounds=(0, 1)), pyo.Var(bounds=(0, 1))
    m.o = pyo.Objective(expr=m.x + m.y, sense=pyo.maximize)
    m.c = Complementarity(expr=complements(m.x >= 0, m.y >= 0))
    with pytest.raises(ModelError, match="MPEC"):
        solver.solve(m)
    results = solver.solve(m, load_solutions=False)
    assert results.solver.status == SolverStatus.error and "MPEC" in results.solver.message
    assert results.solver.termination_condition == TerminationCondition.invalidProblem


def test_rows_that_contradict_each_other_are_named(solver):
    """x = y + 1 and x = y + 3: the message has the rows of the certificate, not the worst one alone."""
    m = pyo.ConcreteModel()
    m.x, m.y = pyo.Var(initialize=0), pyo.Var(initialize=0)
    m.near, m.far = pyo.Constraint(expr=m.x == m.y + 1), pyo.Constraint(expr=m.x == m.y + 3)
    results = solver.solve(m)
    assert results.solver.termination_condition == TerminationCondition.infeasible
    assert "Proof: rows near and far contradict each other" in results.solver.message


def model_of(**components):
    m = pyo.ConcreteModel()
    for name, make in components.items():
        setattr(m, name, make(m))
    return m


BAD_MODELS = {
    "not square": (dict(x=lambda m: pyo.Var(), y=lambda m: pyo.Var(), c=lambda m: pyo.Constraint(expr=m.x + m.y == 1)), "square"),
    "binary": (dict(x=lambda m: pyo.Var(domain=pyo.Binary), c=lambda m: pyo.Constraint(expr=m.x == 1)), "x is integer"),
    "division by a parameter that is zero": (
        dict(k=lambda m: pyo.Param(initialize=0, mutable=True), x=lambda m: pyo.Var(), c=lambda m: pyo.Constraint(expr=m.x / m.k == 1)),
        r"^c: .*/k has no value, where k = 0 \(.*division by zero",
    ),
    "a logarithm of a variable that is fixed at zero": (
        dict(y=lambda m: fixed(0), x=lambda m: pyo.Var(), c=lambda m: pyo.Constraint(expr=m.x == pyo.log(m.y))),
        r"^c: log\(y\) has no value, where y = 0 is fixed",
    ),
    "a fixed variable whose equation stays": (
        dict(y=lambda m: fixed(1), x=lambda m: pyo.Var(), c=lambda m: pyo.Constraint(expr=m.x + m.y == 3),
             d=lambda m: pyo.Constraint(expr=m.x - m.y == 1)),
        "not square.*fixed are y",
    ),
    "an objective and no conditions": (
        dict(x=lambda m: pyo.Var(), y=lambda m: pyo.Var(), c=lambda m: pyo.Constraint(expr=m.x + m.y == 3),
             o=lambda m: pyo.Objective(expr=m.x**2 + m.y**2)),
        "^this is an optimisation problem: objective o",
    ),
    "a parameter without a value": (
        dict(k=lambda m: pyo.Param(mutable=True), x=lambda m: pyo.Var(), c=lambda m: pyo.Constraint(expr=m.x * m.k == 1)),
        "k",
    ),
    "a fixed variable without a value": (
        dict(y=lambda m: fixed(None), x=lambda m: pyo.Var(), c=lambda m: pyo.Constraint(expr=m.x * m.y == 1)),
        "y is fixed, but has no value",
    ),
    "a constraint of fixed variables that fails": (
        dict(
            y=lambda m: fixed(1), x=lambda m: pyo.Var(), c=lambda m: pyo.Constraint(expr=m.x == 1),
            d=lambda m: pyo.Constraint(expr=m.y >= 2),
        ),
        "d has fixed variables only.*2 <= 1",
    ),
    "nothing": ({}, "no variable"),
    "special ordered sets": (
        dict(x=lambda m: pyo.Var([1, 2]), c=lambda m: pyo.Constraint([1, 2], rule=lambda m, i: m.x[i] == 1),
             s=lambda m: pyo.SOSConstraint(var=m.x, sos=1)),
        "s is a SOSConstraint",
    ),
}  # fmt: skip


def fixed(number):
    variable = pyo.Var(initialize=number)
    variable.construct()
    variable.fixed = True
    return variable


@pytest.mark.parametrize("case", BAD_MODELS)
def test_bad_models_are_refused_by_name(case, solver):
    components, words = BAD_MODELS[case]
    m = model_of(**components)
    with pytest.raises(ModelError, match=words):
        solver.solve(m)
    assert solver.solve(m, load_solutions=False).solver.status == SolverStatus.error


def test_bad_arguments(solver, tmp_path):
    m = market()
    with pytest.raises(ValueError, match="strictly"):
        solver.solve(m, strictly=True)
    with pytest.raises(ModelError, match="convergence_tolerance"):
        solver.solve(m, options={"convergence_tolerance": -1})
    with pytest.raises(ModelError, match="no_such_option"):
        solver.solve(m, options={"no_such_option": 1})
    with pytest.raises(TypeError, match="str"):
        solver.solve("model.nl")
    abstract = pyo.AbstractModel()
    abstract.x = pyo.Var()
    with pytest.raises(ValueError, match="create_instance"):
        solver.solve(abstract)
    broken = tmp_path / "broken"
    broken.write_text("#!/bin/sh\necho libfoo is missing >&2\nexit 3\n")
    broken.chmod(0o755)
    with pytest.raises(ApplicationError, match="code 3.*libfoo is missing"):
        pyo.SolverFactory("perp", executable=str(broken)).solve(m)


def test_the_transformation_mpec_nl_is_recognised(solver):
    m = market()
    pyo.TransformationFactory("mpec.nl").apply_to(m)
    with pytest.raises(ModelError, match="mpec.nl"):
        solver.solve(m)


# The solver's interface


def test_tee_shows_the_log_while_it_runs(tmp_path, monkeypatch):
    """The program begins only after its first line was shown: would end in 10 s with code 4 if that came at the end."""
    seen, waits = tmp_path / "seen", tmp_path / "waits"
    waits.write_text(
        f"#!/bin/sh\necho first\nfor i in $(seq 100); do\n  test -e {seen} && exec {PROGRAM} \"$@\"\n  sleep 0.1\ndone\nexit 4\n"
    )
    waits.chmod(0o755)

    class Screen(io.StringIO):
        def write(self, text):
            seen.touch()
            return super().write(text)

    monkeypatch.setattr(sys, "stdout", Screen())
    solved(market(), pyo.SolverFactory("perp", executable=str(waits)), tee=True)
    shown = sys.stdout.getvalue()
    assert shown.startswith("first\n") and "Major Iteration Log" in shown and "profit[gas]" in shown


def test_examples_of_the_page(monkeypatch, tmp_path):
    """docs/pyomo.md, as a reader would run it, with the program on the PATH."""
    (tmp_path / "perp").symlink_to(os.path.realpath(PROGRAM))
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    Executable("perp").rehash()
    run_examples("docs/pyomo.md", 3)


def test_log_file_and_kept_files(solver, tmp_path, capsys):
    m = market()
    solved(m, solver, logfile=str(tmp_path / "log"), keepfiles=True)
    assert "profit[gas]" in (tmp_path / "log").read_text()
    stub = capsys.readouterr().out.split()[-1].removesuffix(".*")
    assert open(stub + ".row").read().split() == ["profit[gas]", "profit[oil]"]
    assert open(stub + ".col").read().split() == ["q[gas]", "q[oil]"]


def test_load_solutions_later(solver):
    m = market()
    results = solver.solve(m, load_solutions=False)
    assert m.q["gas"].value == 1
    m.solutions.load_from(results)
    assert m.q["gas"].value == pytest.approx(4)


def test_availability():
    assert pyo.SolverFactory("perp", executable=PROGRAM).available()
    assert pyo.SolverFactory("perp", executable=PROGRAM).version()[:2] == (1, 0)


def test_names_of_all_kinds(solver):
    m = pyo.ConcreteModel()
    m.x = pyo.Var(["a b", "c\nd", "Größe", 'e"f'], initialize=-1)
    m.c = pyo.Constraint(m.x.index_set(), rule=lambda m, i: m.x[i] ** 3 == (8 if i != "Größe" else -27))
    solved(m, solver)
    assert [v.value for v in m.x.values()] == pytest.approx([2, 2, -3, 2])


def test_blocks_lists_and_references(solver):
    m = pyo.ConcreteModel()
    m.b = pyo.Block([1, 2], rule=lambda b, i: setattr(b, "x", pyo.Var(initialize=0)))
    for i in (1, 2):
        b = m.b[i]
        b.inner = pyo.Block()
        b.inner.cc = ComplementarityList()
        b.inner.cc.add(complements(b.x >= 0, b.x >= i))
    m.all = pyo.Reference(m.b[:].x)
    m.off = pyo.Block()
    m.off.y = pyo.Var()
    m.off.c = pyo.Constraint(expr=m.off.y == 1)
    m.off.deactivate()
    solved(m, solver)
    assert [m.b[i].x.value for i in (1, 2)] == pytest.approx([1, 2]) and m.off.y.value is None
    m.b[2].x.value = 0
    solved(m.b[2], solver)  # a block by itself
    assert m.b[2].x.value == pytest.approx(2)


def test_side_inequalities(solver):
    """An inequality that holds changes nothing; one that cannot hold makes the model infeasible."""
    m = pyo.ConcreteModel()
    m.x = pyo.Var(initialize=1, bounds=(0, 10))
    m.c = pyo.Constraint(expr=m.x == 3)
    m.d = pyo.Constraint(expr=between(1, m.x, 5))
    solved(m, solver)
    assert m.x.value == pytest.approx(3)
    m.e = pyo.Constraint(expr=m.x >= 4)
    assert solver.solve(m).solver.termination_condition == TerminationCondition.infeasible


# Why there is no solution


def test_explain_speaks_in_components(solver):
    """Demand 30 of b is above both capacities, 4 and 5, by 21, and a needs another 3: computed by hand."""
    m = pyo.ConcreteModel()
    m.P, m.T = pyo.Set(initialize=["n", "s"]), pyo.Set(initialize=["a", "b"])
    capacity, demand = {"n": 4, "s": 5}, {"a": 3, "b": 30}
    m.ship, m.price, m.rent = pyo.Var(m.P, m.T, initialize=1), pyo.Var(m.T, initialize=1), pyo.Var(m.P, initialize=0)
    m.profit = Complementarity(m.P, m.T, rule=lambda m, p, t: complements(2 + m.rent[p] - m.price[t] >= 0, m.ship[p, t] >= 0))
    m.market = Complementarity(m.T, rule=lambda m, t: complements(sum(m.ship[p, t] for p in m.P) >= demand[t], m.price[t] >= 0))
    m.capacity = Complementarity(
        m.P, rule=lambda m, p: complements(sum(m.ship[p, t] for t in m.T) <= capacity[p], m.rent[p] >= 0)
    )
    why = solver.explain(m)
    assert why.status == "Infeasible" and why.answers[0].proven
    assert {id(c) for c in why.constraints} == {id(c) for c in (m.market["b"], m.capacity["n"], m.capacity["s"])}
    assert {id(v) for v in why.variables} == {id(v) for v in (m.ship["n", "a"], m.ship["s", "a"])}
    assert "add 24" in str(why)
    m.market["b"].deactivate(), m.price["b"].fix(1)
    assert not solver.explain(m).answers
