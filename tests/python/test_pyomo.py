# SPDX-License-Identifier: Apache-2.0
"""Pyomo's models with complementarity, through SolverFactory('perp') and ('path'): the program perp, under its own name
and as pathampl, gets an .nl file and its .sol file is loaded back. Skipped where Pyomo is not installed (it is on PyPI).

The forms are those of Pyomo's own tests (pyomo/mpec/tests/test_complementarity.py) and examples (examples/mpec,
munson1), made square and given a solution that is known in closed form."""

import math
import os
from pathlib import Path

import pytest

pyo = pytest.importorskip("pyomo.environ")
from pyomo.mpec import Complementarity, ComplementarityList, complements  # noqa: E402  (after the check)

PROGRAM = os.environ.get("PERP", "")


def model(**pinned):
    """Free y, x1, x2, x3, of which those given are pinned by an equation each; others appear as the form has them."""
    M = pyo.ConcreteModel()
    for name in ("y", "x1", "x2", "x3"):
        setattr(M, name, pyo.Var(initialize=0))
    M.pins = pyo.ConstraintList()
    for name, value in pinned.items():
        M.pins.add(getattr(M, name) == value)
    return M


def one(expression, solution, **pinned):
    """A model of one condition."""
    M = model(**pinned)
    M.cc = Complementarity(expr=expression(M))
    return M, {**pinned, **solution}


def t9():
    M = model()
    M.cc = Complementarity(expr=complements(M.y + M.x3, M.x1 + 2 * M.x2 == 1))
    M.cc.deactivate()
    M.keep = pyo.Constraint(expr=M.x1 == 0.5)
    return M, {"x1": 0.5}


def t10():
    M = model(y=1, x3=0)
    M.cc = Complementarity([0, 1, 2], rule=lambda m, i: complements(m.y + m.x3, m.x1 + i * m.x2 == i))
    M.cc[1].deactivate()
    return M, {"x1": 0, "x2": 1, "y": 1, "x3": 0}


def t13():
    M = model(y=1, x3=0)

    def rule(m, i):
        return Complementarity.Skip if i == 1 else complements(m.y + m.x3, m.x1 + i * m.x2 == i)

    M.cc = Complementarity([0, 1, 2], rule=rule)
    return M, {"x1": 0, "x2": 1}


def cov4():
    M = model(y=0, x3=0, x2=2)
    M.cc = Complementarity(rule=lambda m: complements(m.y + m.x3, m.x1 + 2 * m.x2 == 1))
    return M, {"x1": -3}


def cov8():
    M = model(y=0, x3=0, x2=2)
    M.cc = Complementarity(rule=lambda m: (m.y + m.x3, m.x1 + 2 * m.x2 == 1))
    return M, {"x1": -3}


def list1():
    M = model(x2=0, x3=0)
    M.cc = ComplementarityList()
    M.cc.add(complements(M.x1 >= 0, M.x1 - 2 >= 0))
    M.cc.add(complements(M.y >= 0, M.y + M.x1 - 5 >= 0))
    return M, {"x1": 2, "y": 3}


def munson1():
    M = model()
    M.del_component(M.y)
    M.f1 = Complementarity(expr=complements(M.x1 >= 0, M.x1 + 2 * M.x2 + 3 * M.x3 >= 1))
    M.f2 = Complementarity(expr=complements(M.x2 >= 0, M.x2 - M.x3 >= -1))
    M.f3 = Complementarity(expr=complements(M.x3 >= 0, M.x1 + M.x2 >= -1))
    return M, {"x1": 1, "x2": 0, "x3": 0}


def bounded_above():
    """0 <= x1 <= 1 with a multiplier, for Pyomo 6.10 writes inequality(0, x1, 1) without its bounds."""
    M = pyo.ConcreteModel()
    M.x1, M.w = pyo.Var(initialize=0.5), pyo.Var(initialize=0)
    M.low = Complementarity(expr=complements(M.x1 >= 0, M.x1 - 2 + M.w >= 0))
    M.high = Complementarity(expr=complements(M.w >= 0, 1 - M.x1 >= 0))
    return M, {"x1": 1, "w": 1}


def cournot():
    M = pyo.ConcreteModel()
    M.firms = pyo.Set(initialize=["a", "b", "c"])
    M.q = pyo.Var(M.firms, initialize=1)
    cost = {"a": 1, "b": 1, "c": 20}
    M.cc = Complementarity(
        M.firms, rule=lambda m, f: complements(m.q[f] >= 0, cost[f] + m.q[f] + sum(m.q[g] for g in m.firms) - 10 >= 0)
    )
    return M, {"q[a]": 3, "q[b]": 3, "q[c]": 0}


def nonlinear():
    M = pyo.ConcreteModel()
    M.x1 = pyo.Var(initialize=1.0)
    M.x2 = pyo.Var(initialize=1.0)
    M.cc1 = Complementarity(expr=complements(M.x1 >= 0, pyo.exp(M.x1) - 2 >= 0))
    M.cc2 = Complementarity(expr=complements(M.x2 >= 0, M.x2**2 + M.x1 >= 0.25))
    return M, {"x1": math.log(2), "x2": 0}


def blocks():
    M = pyo.ConcreteModel()
    M.b = pyo.Block([1, 2], rule=lambda b, i: setattr(b, "x", pyo.Var(initialize=0)))
    M.b1 = Complementarity(expr=complements(M.b[1].x >= 0, M.b[1].x + M.b[2].x - 4 >= 0))
    M.b2 = Complementarity(expr=complements(M.b[2].x >= 0, M.b[2].x - M.b[1].x + 2 >= 0))
    return M, {"b[1].x": 3, "b[2].x": 1}


CASES = {
    "t1a": lambda: one(lambda m: complements(m.y + m.x1 >= 0, m.x1 + 2 * m.x2 + 3 * m.x3 >= 1), {"x1": 1}, y=0, x2=0, x3=0),
    "t1b": lambda: one(lambda m: complements(m.x1 + 2 * m.x2 + 3 * m.x3 >= 1, m.y + m.x1 >= 0), {"x1": 5}, y=-5, x2=0, x3=0),
    "t1c": lambda: one(lambda m: complements(m.y >= -m.x1, m.x1 + 2 * m.x2 >= 1 - 3 * m.x3), {"x1": 1}, y=2, x2=0, x3=0),
    "t2a": lambda: one(lambda m: complements(m.y + m.x2 >= 0, m.x2 - m.x3 <= -1), {"x3": 2}, y=0, x2=1),
    "t2b": lambda: one(lambda m: complements(m.x2 - m.x3 <= -1, m.y + m.x2 >= 0), {"x3": 3}, y=1, x2=2),
    "t3a": lambda: one(lambda m: complements(m.y + m.x3 >= 0, m.x1 + m.x2 >= -1), {"y": -1}, x1=4, x2=0, x3=1),
    "t3b": lambda: one(lambda m: complements(m.x1 + m.x2 >= -1, m.y + m.x3 >= 0), {"x1": -1}, y=0, x2=0, x3=1),
    "t4a": lambda: one(lambda m: complements(m.x1 + 2 * m.x2 + 3 * m.x3 == 1, m.y + m.x3), {"x1": 0.5}, y=0, x2=0.25, x3=0),
    "t4b": lambda: one(lambda m: complements(m.y + m.x3, m.x1 + 2 * m.x2 + 3 * m.x3 == 1), {"x1": 3}, y=0, x2=0.5, x3=-1),
    "t4c": lambda: one(lambda m: complements(1 == m.x1 + 2 * m.x2 + 3 * m.x3, m.y + m.x3), {"x1": 0.5}, y=0, x2=0.25, x3=0),
    "t4d": lambda: one(lambda m: complements(m.x1 + 2 * m.x2 == 1 - 3 * m.x3, m.y + m.x3), {"x1": -2}, y=0, x2=0, x3=1),
    "t9": t9,
    "t10": t10,
    "t11": lambda: one(lambda m: complements(pyo.inequality(2, m.y + m.x1, 3), m.x1), {"x1": 2}, y=0),
    "t12": lambda: one(lambda m: complements(m.x1, pyo.inequality(2, m.y + m.x1, 3)), {"x1": 2}, y=0),
    "t13": t13,
    "cov4": cov4,
    "cov8": cov8,
    "list1": list1,
    "munson1": munson1,
    "bounded above": bounded_above,
    "cournot": cournot,
    "nonlinear": nonlinear,
    "blocks": blocks,
}


@pytest.fixture(params=["perp", "path"])
def solver(request, tmp_path, monkeypatch):
    """Pyomo finds both on the PATH, where they have the names under which perp is installed."""
    if not PROGRAM:
        pytest.skip("PERP does not name the program")
    for name in ("perp", "pathampl"):
        (tmp_path / name).symlink_to(Path(PROGRAM).resolve())
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    from pyomo.common import Executable

    for name in ("perp", "pathampl"):
        Executable(name).rehash()
    return pyo.SolverFactory(request.param)


@pytest.mark.parametrize("case", CASES)
def test_models(case, solver):
    """Catches an .nl file misread, and a .sol file whose values go to other variables."""
    M, solution = CASES[case]()
    results = solver.solve(M)
    assert results.solver.termination_condition == pyo.TerminationCondition.optimal
    for name, value in solution.items():
        assert pyo.value(M.find_component(name)) == pytest.approx(value, abs=1e-6), name


def test_no_solution_is_said(solver):
    M = pyo.ConcreteModel()
    M.x = pyo.Var(initialize=0)
    M.cc = Complementarity(expr=complements(M.x >= 0, -M.x >= 1))
    results = solver.solve(M, load_solutions=False)
    assert results.solver.termination_condition != pyo.TerminationCondition.optimal
    assert str(results.solver.message)


def test_options_reach_the_program(solver):
    """A value out of range is refused by the program, and Pyomo says so."""
    from pyomo.common.errors import ApplicationError

    with pytest.raises(ApplicationError):
        solver.solve(munson1()[0], options={"convergence_tolerance": "-1"})
    assert solver.solve(munson1()[0], options={"convergence_tolerance": "1e-10"}).solver.status == pyo.SolverStatus.ok
