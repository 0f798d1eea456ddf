# SPDX-License-Identifier: Apache-2.0
"""Pyomo's Constraints and Complementarity conditions as the rows of a mixed complementarity problem.

A condition complements(a, b) has two sides, of which one is taken as the variable, with the bounds that the condition
and the Var give it, and the other as F:

    l <= x <= u  _|_  F:    F >= 0 at l, F <= 0 at u, F = 0 between them.

`F <= b` beside `x >= l` is F = b - body, and so is `F >= b` beside `x <= u`. Where x has both bounds, the lower one
counts: `F >= b` is F = body - b. Where no side is a variable of its own, the one with bounds becomes one: w = body.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from pyomo.core.expr import relational_expr as relational
from pyomo.core.expr.numvalue import native_types, value

from perp.pyomo._expression import Form, ModelError, Number, Tape, Value, Walker, is_number


@dataclass
class Row:
    """An equation or inequality lower <= form <= upper, or with `variable` the F of that one."""

    name: str
    component: Any
    form: Value
    lower: Number | None = None
    upper: Number | None = None
    variable: int | None = None
    polyhedron: bool = False  # of a variational inequality, by its suffix
    written_equal: bool = False  # the condition says F == 0, which does not hold at a bound

    @property
    def is_equation(self) -> bool:
        same = self.lower is self.upper or (isinstance(self.lower, float) and self.lower == self.upper)
        return self.variable is None and self.lower is not None and same


class Auxiliary:
    """The variable that a condition between two expressions needs: the value of one of them."""

    fixed = False
    bounds = (None, None)

    def __init__(self, name: str, body: Any) -> None:
        self.name = name
        self._body = body

    @property
    def value(self) -> float | None:
        found: float | None = value(self._body, exception=False)
        return found


@dataclass
class Side:
    """One side of a condition."""

    lower: Number | None
    body: Any  # as the model has it
    upper: Number | None
    form: Value

    @property
    def is_equality(self) -> bool:
        return self.lower is not None and self.lower is self.upper

    @property
    def bounds(self) -> int:
        return (self.lower is not None) + (self.upper is not None)


    def bound(self) -> Number | None:
        return self.upper if self.lower is None else self.lower

    def is_reversed(self, at_lower: bool) -> bool:
        """Whether F, which must not be negative at a lower bound, is bound - body."""
        return self.bounds == 1 and (self.lower is not None) != at_lower


@dataclass
class Dropped:
    """A condition whose variable is fixed: F may have any value."""

    condition: Any
    variable: Any
    side: Side
    at_lower: bool

    def F(self, tape: Tape) -> float:
        body = value(self.side.body, exception=False)
        bound = self.side.bound()
        number = math.nan if body is None else float(body) - (0.0 if bound is None else tape.number(bound))
        return -number if self.side.is_reversed(self.at_lower) else number


def _varies(item: Any) -> bool:
    return item.__class__ not in native_types and bool(item.is_potentially_variable())


class Rows:
    """The rows of a model, and what stands for its variables."""

    def __init__(self, constraints: list[Any], conditions: list[Any], polyhedron: set[int]) -> None:
        self.walker = Walker()
        self.rows: list[Row] = []
        self.constants: list[Row] = []  # constraints without a variable, which hold or not
        self.dropped: list[Dropped] = []
        self.boxes: dict[int, tuple[Number | None, Number | None]] = {}  # what a condition adds to a variable's bounds
        self.watched: list[Any] = []  # variables whose infinite bounds decide what a condition says
        self._taken: set[int] = set()
        self._polyhedron = polyhedron
        self._read(constraints, conditions)

    def _read(self, constraints: list[Any], conditions: list[Any]) -> None:
        for constraint in constraints:
            self._add_constraint(constraint)
        pending: list[tuple[Any, list[Side], list[Any]]] = []
        for condition in conditions:
            self.walker.tape.owner = condition.name
            sides = self._sides(condition)
            pending.append((condition, sides, self._candidates(sides)))
        pending.sort(key=lambda entry: len(entry[2]) > 1)  # stable: those that can choose come last
        made = {id(entry[0]): self._add_condition(*entry) for entry in pending}
        for condition in conditions:  # in the order of the model
            self.rows.extend(made.get(id(condition), []))

    def _add_constraint(self, constraint: Any) -> None:
        self.walker.tape.owner = constraint.name
        if hasattr(constraint, "_complementarity"):
            raise ModelError(f"{constraint.name} was made by the transformation mpec.nl: solve the model that it was made from")
        lower, body, upper = constraint.to_bounded_expression()
        row = Row(constraint.name, constraint, self.walker.walk(body), self._bound(lower), self._bound(upper))
        if constraint.equality:
            row.upper = row.lower
        row.polyhedron = id(constraint) in self._polyhedron
        if row.lower is not None or row.upper is not None:
            (self.constants if is_number(row.form) else self.rows).append(row)

    def _bound(self, bound: Any) -> Number | None:
        if bound is None or (bound.__class__ in native_types and bound in (float("inf"), float("-inf"))):
            return None
        number = self.walker.walk(bound)
        if isinstance(number, Form):
            raise ModelError(f"{self.walker.tape.owner}: a bound depends on variables that are not fixed: {bound}")
        return number

    # Sides

    def _sides(self, condition: Any) -> list[Side]:
        arguments = getattr(condition, "_args", None)
        if arguments is None:
            raise ModelError(f"{condition.name} is a Complementarity without a condition")
        return [self._side(argument) for argument in arguments]

    def _side(self, argument: Any) -> Side:
        name = self.walker.tape.owner
        if isinstance(argument, tuple):
            if len(argument) not in (2, 3):
                raise ModelError(f"{name}: a tuple in complements() has 2 or 3 entries, not {len(argument)}")
            if len(argument) == 2:
                return self._equality(*argument)
            return self._ranged(*argument)
        if argument.__class__ is relational.RangedExpression:
            return self._ranged(*argument.args)
        if argument.__class__ is relational.EqualityExpression:
            return self._equality(*argument.args)
        if isinstance(argument, relational.InequalityExpression):
            small, large = argument.args
            return self._inequality(small, large)
        return Side(None, argument, None, self.walker.walk(argument))

    def _ranged(self, lower: Any, body: Any, upper: Any) -> Side:
        return Side(self._bound(lower), body, self._bound(upper), self.walker.walk(body))

    def _equality(self, left: Any, right: Any) -> Side:
        side = self._inequality(left, right)
        bound = side.upper if side.lower is None else side.lower
        return Side(bound, side.body, bound, side.form)

    def _inequality(self, small: Any, large: Any) -> Side:
        walk = self.walker.walk
        if not _varies(large):
            return Side(None, small, self._bound(large), walk(small))
        if not _varies(small):
            return Side(self._bound(small), large, None, walk(large))
        left, right = walk(small), walk(large)
        if is_number(right):
            return Side(None, small, right, left)  # type: ignore[arg-type]
        if is_number(left):
            return Side(left, large, None, right)  # type: ignore[arg-type]
        return Side(0.0, large - small, None, self.walker.difference(right, left))

    # Conditions

    def _candidates(self, sides: list[Side]) -> list[tuple[Any, Side, Side]]:
        """The variables that can be the one of the pair, fixed or not, with their side and F's. A Var with bounds comes
        first, for one without can be that of an equation; else the second side, as with Pyomo."""
        plain = [(self._plain_variable(side), side, F) for side, F in (sides[::-1], sides)]
        able = [
            entry for entry in plain if entry[0] is not None and not entry[1].is_equality and (entry[2].bounds < 2 or entry[2].is_equality)
        ]
        if len(able) == 2:
            self.watched.extend(entry[0] for entry in able)
            able.sort(key=lambda entry: entry[0].bounds == (None, None))
        return able

    def _plain_variable(self, side: Side) -> Any:
        """The variable that this side is, if it is no more than that."""
        if isinstance(side.form, Form):
            variable = side.form.plain_variable()
            return None if variable is None else self.walker.variables[variable]
        body = side.body
        if body.__class__ not in native_types and not body.is_expression_type() and body.is_variable_type():
            return body
        return None

    def _add_condition(self, condition: Any, sides: list[Side], candidates: list[Any]) -> list[Row]:
        name = condition.name
        self.walker.tape.owner = name
        if all(side.is_equality for side in sides):
            raise ModelError(f"{name}: both sides are equations: use two Constraints")
        if all(side.bounds == 2 for side in sides) and not any(side.is_equality for side in sides):
            raise ModelError(f"{name}: both sides have two bounds: only one of them can")
        for variable, side, F in candidates:
            if id(variable) in self._taken or self._is_equation(F, side, variable):
                continue
            self._taken.add(id(variable))
            if variable.fixed:
                self.dropped.append(Dropped(condition, variable, F, self._at_lower(side, variable)))
                return []
            return [self._pair(condition, side, F, variable)]
        for side in sides:
            if side.is_equality:
                return [Row(name, condition, side.form, side.lower, side.lower)]
        return self._pair_with_auxiliary(condition, sides)

    def _is_equation(self, F: Side, side: Side, variable: Any) -> bool:
        """F == 0 beside a free variable is an equation like others."""
        return F.is_equality and not variable.fixed and self._box_now(side, variable) == (False, False)

    def _box_now(self, side: Side, variable: Any) -> tuple[bool, bool]:
        """Which bounds the variable has, from the condition and the Var."""
        self.watched.append(variable)
        lower, upper = variable.bounds
        return side.lower is not None or lower is not None, side.upper is not None or upper is not None

    def _pair(self, condition: Any, side: Side, F: Side, variable: Any) -> Row:
        self.boxes[id(variable)] = (side.lower, side.upper)
        if F.bounds == 1 and self._box_now(side, variable) == (False, False):
            raise ModelError(
                f"{condition.name}: {variable.name} has no bounds, so that the other side must be zero: write an equation, or "
                "give bounds"
            )
        return self._row(condition, F, self._at_lower(side, variable), id(variable))

    def _at_lower(self, side: Side, variable: Any) -> bool:
        """Whether F is that of the lower bound."""
        if side.bounds == 1:
            return side.lower is not None
        has_lower, has_upper = self._box_now(side, variable)
        return has_lower or not has_upper

    def _row(self, condition: Any, F: Side, at_lower: bool, variable: int) -> Row:
        bound = F.bound()
        form = F.form if bound is None else self.walker.difference(F.form, bound)
        if F.is_reversed(at_lower):
            form = self.walker.scale(form, -1.0)
        return Row(condition.name, condition, form, variable=variable, written_equal=F.is_equality)

    def _pair_with_auxiliary(self, condition: Any, sides: list[Side]) -> list[Row]:
        k = max((1, 0), key=lambda k: sides[k].bounds)
        side, F = sides[k], sides[1 - k]
        if side.bounds == 0:
            raise ModelError(f"{condition.name}: neither side has a bound")
        auxiliary = Auxiliary(f"{condition.name}.arg{k}", side.body)
        variable = id(auxiliary)
        self.walker.variables[variable] = auxiliary
        self.boxes[variable] = (side.lower, side.upper)
        definition = self.walker.difference(Form(linear={variable: 1.0}), side.form)
        zero: Number = 0.0
        return [
            self._row(condition, F, side.lower is not None, variable),
            Row(auxiliary.name, None, definition, zero, zero),
        ]

