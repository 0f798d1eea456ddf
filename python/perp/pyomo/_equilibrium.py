# SPDX-License-Identifier: Apache-2.0
"""Equilibria of agents, each with an optimisation problem of its own, and of markets beside them.

Agent i chooses its own variables x_i, the others' x_-i and the market's p given:

    min f_i(x_i; x_-i, p)   subject to   g_i(x_i; x_-i, p) >= 0,   l_i <= x_i <= u_i.

Its conditions of first order, with L_i = f_i - y_i' g_i, and the market's own conditions are one complementarity problem
(Facchinei & Kanzow 2010, "Generalized Nash equilibrium problems", section 4):

    l_i <= x_i <= u_i  _|_  dL_i/dx_i,      0 <= y_i  _|_  g_i.

A constraint that agents share has one multiplier (a variational equilibrium, Rosen 1965 with equal weights), or one for each
agent. A point that solves this need be no equilibrium: each agent's curvature on its active face and its best response to
the others are looked at afterwards.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from pyomo.common.collections import ComponentMap
from pyomo.core.base import ConcreteModel, Constraint, Objective, Suffix, Var, maximize
from pyomo.core.expr.calculus.derivatives import Modes, differentiate
from pyomo.core.expr.numvalue import value
from pyomo.core.expr.visitor import identify_variables
from pyomo.core.staleflag import StaleFlagManager
from pyomo.mpec import Complementarity, complements
from pyomo.repn import generate_standard_repn

import perp
from perp._result import Result
from perp.pyomo._expression import ModelError
from perp.pyomo._model import CompiledModel, Contents
from perp.pyomo._solver import Files

#: What counts as no gain and as no curvature, beside the size of the objective and of the Hessian: the square root of the
#: precision, to which a point with the residual of that size is known.
_SMALL = float(np.sqrt(np.finfo(float).eps))


@dataclass
class Agent:
    """An agent at the point that was found."""

    name: str
    """Of its block or objective."""
    objective: Any
    """Its Objective."""
    variables: list[Any]
    """Its own that are not fixed."""
    value: float = np.nan
    """Of the objective."""
    convex: bool = False
    """Whether its problem is convex, the others' variables fixed: a quadratic objective with eigenvalues that are at least 0, up to
    their rounding, and linear constraints."""
    curvature: float = np.nan
    """The least eigenvalue of the Hessian of the Lagrangian on the face of all active bounds and constraints; inf: the face is
    a point."""
    gain: float = np.nan
    """How much better its best response that was found is. Where `convex`, no response gains more than 0."""
    response: ComponentMap = field(default_factory=ComponentMap)
    """That response: a value for each variable; empty if nothing better was found."""
    why_not: str = ""
    """Why this is no equilibrium for the agent; empty: nothing speaks against it."""

    @property
    def sign(self) -> float:
        """-1 of an agent that maximises."""
        return -1.0 if self.objective.sense == maximize else 1.0


@dataclass
class Equilibrium:
    """What `equilibrium` found."""

    result: Result
    """Of the complementarity problem; its x has the variables of the model, then the multipliers."""
    agents: list[Agent]
    multipliers: ComponentMap
    """By how much the objective, as it is written, grows for each unit that is added to the right side of a constraint, as
    duals in Pyomo: of each constraint of an agent and each variational one (of agents with different senses: of what is
    minimised). Of one shared with a multiplier for each agent: a ComponentMap, by their objectives."""

    @property
    def success(self) -> bool:
        """Whether the conditions are solved, and nothing speaks against the point for any agent."""
        return self.result.success and not any(agent.why_not for agent in self.agents)

    @property
    def proven(self) -> bool:
        """Whether, besides, every agent's problem is convex: then the point is an equilibrium."""
        return self.success and all(agent.convex for agent in self.agents)

    @property
    def gain(self) -> float:
        """The largest gain of an agent that deviates alone."""
        return max((agent.gain for agent in self.agents), default=0.0)

    @property
    def message(self) -> str:
        """What was found, in a sentence for each agent that refuses the point."""
        if not self.result.success:
            return f"{self.result.status}: {self.result.message}"
        refused = [f"{agent.name} {agent.why_not}" for agent in self.agents if agent.why_not]
        if refused:
            return "No equilibrium: " + "; ".join(refused)
        return "An equilibrium" + ("" if self.proven else ", as far as was looked: not every agent's problem is proven convex")


def equilibrium(
    model: Any,
    owns: Iterable[tuple[Any, Iterable[Any]]] = (),
    *,
    variational: Iterable[Any] = (),
    each: Iterable[Any] = (),
    load: bool = True,
    **options: object,
) -> Equilibrium:
    """Finds an equilibrium of the model's agents and markets, from the values that the variables have.

    An agent is a block with an objective. It owns the variables declared in the block, and the constraints there are its
    own. Other agents' variables are given to it. Constraints and Complementarity conditions in no agent's block are the
    market's: they determine the variables that no agent owns.

    owns    pairs of an objective and components, for agents without a block: the variables and constraints that are the agent's.
    variational, each
            constraints that agents share, those whose variables occur in it: with one multiplier for all of them, or with
            one for each.
    load    whether the variables get the values found, and the suffixes dual, slack and rc theirs.
    options of `perp.solve`.

    ModelError says what is not square or belongs to nobody.
    """
    game = _Game(model, owns, list(_data(variational)), list(_data(each)))
    return game.solve(load, options)


def _data(components: Iterable[Any]) -> Iterable[Any]:
    for component in components:
        if getattr(component, "is_indexed", bool)():
            yield from component.values()
        else:
            yield component


def _inequalities(constraint: Any) -> list[tuple[Any, float, bool]]:
    """g and its direction for each side of a constraint: g = 0, or g >= 0."""
    body, lower, upper = constraint.body, constraint.lower, constraint.upper
    if constraint.equality:
        return [(body - upper, 1.0, True)]
    sides: list[tuple[Any, float, bool]] = [] if lower is None else [(body - lower, 1.0, False)]
    return sides + ([] if upper is None else [(upper - body, -1.0, False)])


@dataclass
class _Side:
    """A side of a constraint with its multiplier, in the Lagrangians of `agents`."""

    constraint: Any
    g: Any
    direction: float
    multiplier: Any
    agents: list[int]
    shared: bool


class _Game:
    def __init__(self, model: Any, owns: Iterable[tuple[Any, Iterable[Any]]], variational: list[Any], each: list[Any]) -> None:
        self.model = model
        self._read_agents(owns)
        self._read_constraints(variational, each)
        self._write_conditions()

    # Who owns what

    def _read_agents(self, owns: Iterable[tuple[Any, Iterable[Any]]]) -> None:
        objectives = list(self.model.component_data_objects(Objective, active=True))
        if not objectives:
            raise ModelError(f"{self.model.name} has no active objective: an agent is a block with one")
        known = {id(objective): k for k, objective in enumerate(objectives)}
        self.owner: dict[int, int] = {}  # of variables and constraints
        told: set[int] = set()
        for objective, items in owns:
            if id(objective) not in known:
                raise ModelError(f"owns: {getattr(objective, 'name', objective)} is no active objective of the model")
            told.add(known[id(objective)])
            for item in _data(items):
                if self.owner.setdefault(id(item), known[id(objective)]) != known[id(objective)]:
                    raise ModelError(f"owns: {item.name} is given to two agents")
        self._blocks: dict[int, int] = {}
        for k, objective in enumerate(objectives):
            if k not in told and self._blocks.setdefault(id(objective.parent_block()), k) != k:
                raise ModelError(f"the block {objective.parent_block().name} has several objectives: say what each `owns`")
        self.agents = [Agent(self._agent_name(k, objective, k in told), objective, []) for k, objective in enumerate(objectives)]
        for variable in self.model.component_data_objects(Var, active=True, descend_into=True):
            k = self._owner_of(variable)
            if k is not None and not variable.fixed:
                self.agents[k].variables.append(variable)

    def _agent_name(self, k: int, objective: Any, told: bool) -> str:
        block = objective.parent_block()
        return objective.name if told or block is self.model else block.name

    def _owner_of(self, item: Any) -> int | None:
        """The agent of a variable or constraint: that which was told, else that of the nearest block around it."""
        if id(item) not in self.owner:
            block, found = item.parent_block(), None
            while block is not None and found is None:
                found = self._blocks.get(id(block))
                block = block.parent_block()
            self.owner[id(item)] = -1 if found is None else found
        k = self.owner[id(item)]
        return None if k < 0 else k

    def _agents_in(self, expression: Any) -> list[int]:
        owners = {self._owner_of(variable) for variable in identify_variables(expression, include_fixed=False)}
        return sorted(k for k in owners if k is not None)

    # The conditions

    def _read_constraints(self, variational: list[Any], each: list[Any]) -> None:
        self.scratch = ConcreteModel(name="multipliers")
        self.sides: list[_Side] = []
        self.equations: list[Any] = []
        one, own = ({id(constraint) for constraint in told} for told in (variational, each))
        if one & own:
            raise ModelError("a constraint is both in `variational` and in `each`")
        for constraint in self.model.component_data_objects(Constraint, active=True):
            shared = id(constraint) in one or id(constraint) in own
            k = self._owner_of(constraint)
            if not shared and k is None:
                if not constraint.equality:
                    raise ModelError(
                        f"the inequality {constraint.name} belongs to no agent: say in `variational` or `each` that agents share "
                        "it, in `owns` whose it is, or write it as a Complementarity condition of the market"
                    )
                self.equations.append(constraint)
                continue
            for g, direction, equal in _inequalities(constraint):
                involved = self._agents_in(constraint.body) if shared else [k]
                for group in [involved] if id(constraint) not in own else [[j] for j in involved]:
                    name = f"multiplier of {constraint.name}"
                    name += f" for {self.agents[group[0]].name}" if len(group) < len(involved) else ""
                    name += " (upper)" if direction < 0 and constraint.lower is not None else ""
                    multiplier = Var(initialize=0.0, bounds=(None if equal else 0.0, None))
                    self.scratch.add_component(name, multiplier)
                    self.sides.append(_Side(constraint, g, direction, multiplier, group, shared))  # type: ignore[arg-type]

    def _write_conditions(self) -> None:
        conditions: list[Any] = []

        def add(F: Any, variable: Any, name: str) -> None:
            condition = Complementarity(expr=complements(F, variable))
            self.scratch.add_component(name, condition)
            conditions.append(condition)

        for k, agent in enumerate(self.agents):
            gradient = ComponentMap((variable, 0.0) for variable in agent.variables)
            terms = [(agent.sign, agent.objective.expr)]
            terms += [(-side.multiplier, side.g) for side in self.sides if k in side.agents]
            for factor, expression in terms:
                used = [v for v in identify_variables(expression, include_fixed=False) if v in gradient]
                for v, slope in zip(used, differentiate(expression, wrt_list=used, mode=Modes.reverse_symbolic)) if used else ():
                    gradient[v] = gradient[v] + factor * slope
            for variable, slope in gradient.items():
                if slope.__class__ is float:
                    raise ModelError(f"{variable.name} of the agent {agent.name} occurs in nothing of the agent's")
                add(slope, variable, f"{agent.name} by {variable.name}")
        for side in self.sides:
            add(side.g, side.multiplier, f"g of {side.multiplier.name}")
        markets = list(self.model.component_data_objects(Complementarity, active=True))
        self._compile(markets + conditions)

    def _compile(self, conditions: list[Any]) -> None:
        contents = Contents(self.scratch)
        contents.constraints, contents.conditions = self.equations, conditions
        self.compiled = CompiledModel(contents)
        self.columns = self.compiled.columns
        text = self.compiled.nl()
        mine = {id(side.multiplier) for side in self.sides}
        mine.update(id(variable) for agent in self.agents for variable in agent.variables)
        market = [variable for variable in self.columns if id(variable) not in mine]
        rows = self.compiled.count() - len(mine)
        if rows != len(market):
            raise ModelError(
                f"not square: the market has {rows} equations and conditions, and {len(market)} variables: "
                f"{', '.join(variable.name for variable in market[:5])}{', ...' if len(market) > 5 else ''}"
            )
        for variable in market:
            if id(variable) not in self.compiled.pairs and variable.bounds != (None, None):
                raise ModelError(f"{variable.name} has bounds, and no Complementarity condition says what holds at them")
        self.files = Files()
        self.problem = perp.read_nl(self.files.write(self.compiled, text))

    # The point

    def solve(self, load: bool, options: Mapping[str, Any]) -> Equilibrium:
        real = [(k, v) for k, v in enumerate(self.columns) if hasattr(v, "set_value")]
        before = [(v, v.value, v.stale) for _, v in real]
        result = self.problem.solve(**options)
        x = np.array(result.x)

        def put(point: Any) -> None:
            for k, variable in real:
                variable.set_value(float(point[k]), skip_validation=True)

        found = False
        try:
            put(x)
            for k, agent in enumerate(self.agents):
                agent.value = value(agent.objective.expr)
                if result.success:
                    self._judge(k, agent, x, put)
            found = True
        finally:
            if not (found and load):
                for variable, number, stale in before:
                    variable.set_value(number, skip_validation=True)
                    variable.stale = stale
        if load:
            StaleFlagManager.mark_all_as_stale()
            put(x)
        multipliers = self._multipliers(x)
        if load:
            self._load_suffixes(multipliers, np.array(result.F))
        return Equilibrium(result, self.agents, multipliers)

    def _judge(self, k: int, agent: Agent, x: Any, put: Any) -> None:
        column = self.compiled.column
        own = np.array([column[id(variable)] for variable in agent.variables], dtype=int)
        duals = np.array([column[id(side.multiplier)] for side in self.sides if k in side.agents], dtype=int)
        if own.size == 0:
            agent.convex, agent.gain = True, 0.0
            return
        agent.curvature, scale, direction = self._curvature(own, duals, x)
        agent.convex = self._is_convex(k, agent)
        small = _SMALL * max(1.0, scale)
        if agent.curvature < -small:
            agent.why_not = f"could deviate: the curvature on its active face is {agent.curvature:.3g}, and the point no optimum"
        self._respond(agent, own, duals, x, direction, put)
        if agent.gain > _SMALL * max(1.0, abs(agent.value)):
            changes = ", ".join(f"{v.name} = {number:.4g}" for v, number in list(agent.response.items())[:3])
            agent.why_not = f"gains {agent.gain:.4g} alone with {changes}"

    def _curvature(self, own: Any, duals: Any, x: Any) -> tuple[float, float, Any]:
        """The least eigenvalue of the Hessian on the active face, the largest size of one of its entries, and the direction of
        the agent's variables that has this curvature."""
        J, F = self.problem.jac(x).tocsc(), self.problem.F(x)
        lower, upper = self.problem.lower, self.problem.upper
        tolerance = _SMALL * np.maximum(1.0, np.abs(x))
        inside = (x - lower > tolerance) & (upper - x > tolerance)
        free = own[inside[own]]
        active = duals[np.abs(F[duals]) <= _SMALL * np.maximum(1.0, np.abs(x[duals]))]
        H = J[free][:, free].toarray()
        H = 0.5 * (H + H.T)
        direction = np.zeros(len(own))
        if free.size == 0:
            return np.inf, 0.0, direction
        G, Z = J[active][:, free].toarray(), np.eye(len(free))
        if len(G):
            _, singular, V = np.linalg.svd(G)
            Z = V[int((singular > _SMALL * max(1.0, singular[0])).sum()) :].T
        least = np.inf
        if Z.size:
            values, vectors = np.linalg.eigh(Z.T @ H @ Z)
            least, direction[inside[own]] = float(values[0]), Z @ vectors[:, 0]
        return least, float(np.abs(J[own][:, own]).max()), direction

    def _is_convex(self, k: int, agent: Agent) -> bool:
        """Whether, all but the agent's variables fixed, the objective is a convex quadratic and the constraints are linear."""
        mine = {id(variable) for variable in agent.variables}
        others = [v for v in self.columns if hasattr(v, "set_value") and id(v) not in mine and not v.fixed]
        try:
            for variable in others:
                variable.fix()
            for side in self.sides:
                if k in side.agents and not generate_standard_repn(side.g, compute_values=True).is_linear():
                    return False
            form = generate_standard_repn(agent.objective.expr, compute_values=True, quadratic=True)
        finally:
            for variable in others:
                variable.unfix()
        if form.nonlinear_expr is not None:
            return False
        place = {id(variable): i for i, variable in enumerate(agent.variables)}
        H = np.zeros((len(place), len(place)))
        for (a, b), coefficient in zip(form.quadratic_vars, form.quadratic_coefs):
            i, j = place[id(a)], place[id(b)]
            H[i, j] += agent.sign * coefficient
            H[j, i] += agent.sign * coefficient
        # The error of an eigenvalue of a symmetric matrix: n eps ||H||, and the coefficients' own rounding.
        return bool(np.linalg.eigvalsh(H)[0] >= -4 * len(H) * np.finfo(float).eps * np.abs(H).sum(axis=0).max())

    def _respond(self, agent: Agent, own: Any, duals: Any, x: Any, direction: Any, put: Any) -> None:
        """The agent's conditions alone, solved again from several starts, all else as it is."""
        agent.gain = 0.0
        if agent.convex:
            return
        mine = np.concatenate([own, duals])
        lower, upper = self.problem.lower[mine], self.problem.upper[mine]

        def at(part: Any) -> Any:
            point = x.copy()
            point[mine] = part
            return point

        def F(part: Any) -> Any:
            return self.problem.F(at(part))[mine]

        def jac(part: Any) -> Any:
            return self.problem.jac(at(part))[mine][:, mine]

        for start in _starts(x[mine], lower, upper, direction):
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")  # of points that only the objective is asked about
                    answer = perp.solve(F, start, lower, upper, jac, time_limit=5)
            except (ValueError, ArithmeticError):  # F is not defined at this start
                continue
            if not answer.success:
                continue
            try:
                put(at(answer.x))
                gain = agent.sign * (agent.value - value(agent.objective.expr))
            except (ValueError, ArithmeticError, OverflowError):
                continue
            finally:
                put(x)
            if gain > agent.gain:
                agent.gain = float(gain)
                agent.response = ComponentMap(zip(agent.variables, answer.x[: len(own)].tolist()))

    # What the model gets

    def _multipliers(self, x: Any) -> ComponentMap:
        found = ComponentMap()
        for side in self.sides:
            senses = {self.agents[k].sign for k in side.agents}
            y = (senses.pop() if len(senses) == 1 else 1.0) * side.direction * float(x[self.compiled.column[id(side.multiplier)]])
            if self._is_each(side):
                by_agent, objective = found.setdefault(side.constraint, ComponentMap()), self.agents[side.agents[0]].objective
                by_agent[objective] = by_agent.get(objective, 0.0) + y
            else:
                found[side.constraint] = found.get(side.constraint, 0.0) + y
        return found

    def _is_each(self, side: _Side) -> bool:
        """Whether its constraint has a multiplier for each of several agents."""
        return side.shared and len(side.agents) == 1 and len(self._agents_in(side.constraint.body)) > 1

    def _load_suffixes(self, multipliers: ComponentMap, F: Any) -> None:
        suffixes = {
            suffix.local_name: suffix
            for suffix in self.model.component_objects(Suffix, active=True, descend_into=False)
            if suffix.import_enabled() and suffix.local_name in ("dual", "slack", "rc")
        }
        for suffix in suffixes.values():
            suffix.clear()
        if "dual" in suffixes:
            numbers = ((constraint, y) for constraint, y in multipliers.items() if not isinstance(y, ComponentMap))
            suffixes["dual"].update(numbers)
        if "slack" in suffixes:
            for side in self.sides:
                suffixes["slack"][side.constraint] = min(value(g) for g, _, _ in _inequalities(side.constraint))
        if "rc" in suffixes:
            for agent in self.agents:
                for variable in agent.variables:
                    suffixes["rc"][variable] = agent.sign * float(F[self.compiled.column[id(variable)]])
        for i, row in self.compiled.pairs.items():
            if row.component.parent_block().model() is self.scratch:
                continue
            k = self.compiled.column[i]
            for name, number in (("dual", value(self.columns[k])), ("slack", float(F[k]))):
                if name in suffixes:
                    suffixes[name][row.component] = number


def _starts(x: Any, lower: Any, upper: Any, direction: Any) -> list[Any]:
    """The ends of the line through the point in the direction of least curvature, the middle of the variables' bounds, corners
    and points between; the multipliers begin at 0."""
    count = len(direction)
    low = np.where(np.isfinite(lower), lower, np.minimum(x, upper) - 10 * (1 + np.abs(x)))
    high = np.where(np.isfinite(upper), upper, np.maximum(x, low) + 10 * (1 + np.abs(x)))
    random = np.random.default_rng(0)  # the same starts every time
    points = [low + s * (high - low) for s in (0.0, 1e-3, 0.5, 1.0)]
    points += [low + random.random(len(x)) * (high - low) for _ in range(3)]
    points += [np.where(random.random(len(x)) < 0.5, low, high)]
    moving = direction != 0
    for d in (direction, -direction):
        room = np.where(d > 0, high[:count] - x[:count], x[:count] - low[:count])[moving] / np.abs(d[moving])
        points.append(x.copy())
        points[-1][:count] += room.min(initial=np.inf if moving.any() else 0.0) * d
    for point in points:
        point[count:] = np.clip(0.0, lower[count:], upper[count:])
    return points
