# SPDX-License-Identifier: Apache-2.0
"""A model in the form in which it can be written to an .nl file again and again."""

from __future__ import annotations

import math
import operator
from itertools import groupby
from typing import Any, Iterator

from pyomo.core.base import Block, Constraint, Objective, Suffix
from pyomo.mpec import Complementarity

from perp.pyomo._expression import Defined, Form, ModelError, Number, Slot, Text
from perp.pyomo._rows import Auxiliary, Row, Rows

# Components that restrict a model and have no place in a complementarity problem.
_REFUSED = ("SOSConstraint", "LogicalConstraint", "LogicalConstraintList", "Disjunction", "Disjunct", "Arc", "BooleanVar")


class Template:
    """A text with places for numbers."""

    def __init__(self) -> None:
        self._added: list[str | Slot] = []
        self._parts: list[str] = []
        self._slots: list[tuple[int, int]] = []  # which parts are numbers, and where these are on the tape

    def add(self, *parts: str | Slot) -> None:
        self._added.extend(parts)

    def text(self, values: list[float]) -> str:
        for is_slot, run in groupby(self._added, lambda part: isinstance(part, Slot)):
            if not is_slot:
                self._parts.append("".join(run))  # type: ignore[arg-type]
                continue
            for slot in run:
                self._slots.append((len(self._parts), slot.at))  # type: ignore[union-attr]
                self._parts.append("")
        self._added = []
        for place, at in self._slots:
            self._parts[place] = repr(values[at])
        return "".join(self._parts)


class Contents:
    """What a model is made of, to see whether it is still the same."""

    def __init__(self, model: Any) -> None:
        self.blocks = list(model.block_data_objects(active=True, descend_into=(Block,)))
        self.sizes = [len(block.component_map()) for block in self.blocks]
        self.constraints = list(_unique(model.component_data_objects(Constraint, active=True)))
        self.conditions = list(_unique(model.component_data_objects(Complementarity, active=True)))
        self.objectives = list(_unique(model.component_data_objects(Objective, active=True)))
        self.polyhedron = _polyhedron(model)
        self._expressions = [constraint.expr for constraint in self.constraints]
        for condition in self.conditions:
            self._expressions.extend(getattr(condition, "_args", ()))

    def same_as(self, other: Contents) -> bool:
        mine, theirs = self._objects(), other._objects()
        return self.sizes == other.sizes and self.polyhedron == other.polyhedron and len(mine) == len(theirs) and all(map(operator.is_, mine, theirs))

    def _objects(self) -> list[Any]:
        return self.blocks + self.constraints + self.conditions + self.objectives + self._expressions


def _polyhedron(model: Any) -> set[int]:
    """The constraints with a suffix polyhedron that is not 0: rows of the polyhedron of a variational inequality."""
    found = set()
    for suffix in model.component_objects(Suffix, active=True):
        if suffix.local_name == "polyhedron":
            items = sorted(suffix.items(), key=lambda item: item[0] is not None and not item[0].is_indexed())
            for component, number in items:  # those of all and of families first, of single ones last
                if component is None:
                    data = model.component_data_objects(Constraint, active=True)
                else:
                    data = component.values() if component.is_indexed() else [component]
                (found.update if number else found.difference_update)(map(id, data))
    return found


def _unique(items: Any) -> Any:
    """Without those that a Reference repeats."""
    return {id(item): item for item in items}.values()


class CompiledModel:
    """The rows and columns of a model, and the text of its .nl file but for numbers."""

    def __init__(self, contents: Contents) -> None:
        self.contents = contents
        _refuse_foreign_components(contents)
        self._rows = Rows(contents.constraints, contents.conditions, contents.polyhedron)
        walker = self._rows.walker
        self.tape = walker.tape
        self.dropped = self._rows.dropped
        self._variables = dict(walker.variables)
        self._fixed = list(walker.fixed.values())
        self._expressions = walker.expressions
        self._watched = [(variable, _finite(variable)) for variable in self._rows.watched]
        self.rows = sorted(self._rows.rows, key=lambda row: not _is_nonlinear(row))
        self._order_columns()
        self.pairs = {row.variable: row for row in self.rows if row.variable is not None}
        self._write_static_parts()
        self.warned = False  # of warnings()

    def still_fits(self, contents: Contents) -> bool:
        """Whether the model has the same rows, expressions and fixed variables as when it was compiled."""
        return (
            self.contents.same_as(contents)
            and all(named.expr is expression for named, expression in self._expressions)
            and all(variable.fixed for variable in self._fixed)
            and not any(variable.fixed for variable in self._variables.values())
            and all(_finite(variable) == finite for variable, finite in self._watched)
        )

    # Columns

    def _order_columns(self) -> None:
        nonlinear: set[int] = set()
        used: set[int] = set()
        for row in self.rows:
            if isinstance(row.form, Form):
                nonlinear |= row.form.variables
                used.update(row.form.linear)
            if row.variable is not None:
                used.add(row.variable)
        used -= nonlinear
        ids = [i for i in self._variables if i in nonlinear] + [i for i in self._variables if i in used]
        self.column = {variable: k for k, variable in enumerate(ids)}
        self.columns = [self._variables[i] for i in ids]
        self._boxes = [self._rows.boxes.get(i, (None, None)) for i in ids]
        self._box_slots = any(isinstance(number, Slot) for box in self._boxes for number in box)
        self._bounds: list[Any] = []  # of which the text was written last
        self._bounds_written = ""
        self.n_nonlinear = len(nonlinear)
        for variable in self.columns:
            if not isinstance(variable, Auxiliary) and not variable.is_continuous():
                raise ModelError(f"{variable.name} is integer or binary: a complementarity problem has continuous variables only")

    # The file

    def _write_static_parts(self) -> None:
        self.row_names, self.column_names = _lines(self.rows), _lines(self.columns)
        defined = list(self._defined_in_order())
        self._places: dict[int, str] = {i: f"v{k}\n" for i, k in self.column.items()}
        self._places |= {id(d): f"v{len(self.columns) + k}\n" for k, d in enumerate(defined)}
        self._head, self._ranges, self._tail = Template(), Template(), Template()
        self._head.add(self._header(len(defined)))
        if marked := [f"{k} 1\n" for k, row in enumerate(self.rows) if row.polyhedron]:
            self._head.add(f"S1 {len(marked)} polyhedron\n", *marked)
        for k, d in enumerate(defined):
            self._head.add(f"V{len(self.columns) + k} {len(d.linear)} 0\n")
            self._write_linear(self._head, d.linear)
            self._write_expression(d.terms, d.constant)
        for k, row in enumerate(self.rows):
            self._head.add(f"C{k}\n")
            form = row.form if isinstance(row.form, Form) else Form(row.form)
            self._write_expression(form.terms, form.constant if row.variable is not None else 0.0)
            self._write_range(row, form)
        self._write_jacobian()

    def _header(self, defined: int) -> str:
        nonlinear = [row for row in self.rows if _is_nonlinear(row)]
        pairs = [row.variable is not None for row in self.rows]
        nonlinear_pairs = sum(row.variable is not None for row in nonlinear)
        equations = sum(row.is_equation for row in self.rows)
        ranges = sum(row.variable is None and None not in (row.lower, row.upper) and not row.is_equation for row in self.rows)
        entries = sum(len(_variables_of(row)) for row in self.rows)
        longest = [max((len(item.name) for item in items), default=0) for items in (self.rows, self.columns)]
        return (
            f"g3 1 1 0\n {len(self.columns)} {len(self.rows)} 0 {ranges} {equations}\n"
            f" {len(nonlinear)} 0 {sum(pairs) - nonlinear_pairs} {nonlinear_pairs} 0 0\n 0 0\n"
            f" {self.n_nonlinear} 0 0\n 0 0 0 1\n 0 0 0 0 0\n {entries} 0\n {longest[0]} {longest[1]}\n 0 {defined} 0 0 0\n"
        )

    def _defined_in_order(self) -> Iterator[Defined]:
        """The named Expressions in use, each after those that it uses."""
        seen: set[int] = set()
        stack: list[tuple[Text, bool]] = [(row.form.terms, False) for row in reversed(self.rows) if isinstance(row.form, Form)]
        while stack:
            item, left = stack.pop()
            if isinstance(item, list):
                stack.extend((part, False) for part in reversed(item))
            elif isinstance(item, Defined):
                if left:
                    yield item
                elif id(item) not in seen:
                    seen.add(id(item))
                    stack.append((item, True))
                    stack.append((item.terms, False))

    def _write_expression(self, terms: list[Text], constant: Number) -> None:
        texts = terms if terms and constant == 0.0 else [*terms, constant]
        if len(texts) > 1:
            self._head.add("o0\n" if len(texts) == 2 else f"o54\n{len(texts)}\n")
        stack = list(reversed(texts))
        while stack:
            item = stack.pop()
            if isinstance(item, list):
                stack.extend(reversed(item))
            elif isinstance(item, str):
                self._head.add(item)
            elif isinstance(item, Slot):
                self._head.add("n", item, "\n")
            elif isinstance(item, float):
                self._head.add(f"n{item!r}\n")
            else:
                self._head.add(self._places[id(item) if isinstance(item, Defined) else item])

    def _write_range(self, row: Row, form: Form) -> None:
        if row.variable is not None:
            return self._ranges.add(f"5 3 {self.column[row.variable] + 1}\n")
        walker = self._rows.walker
        self.tape.owner = row.name
        numbers = [n if n is None else walker.plus(n, walker.times(form.constant, -1.0)) for n in (row.lower, row.upper)]
        if row.is_equation:
            kind, numbers = "4", numbers[:1]
        else:
            kind = "1" if row.lower is None else "2" if row.upper is None else "0"
        self._ranges.add(kind)
        for number in numbers:
            if number is not None:
                self._ranges.add(" ", _part(number))
        self._ranges.add("\n")

    def _write_linear(self, template: Template, linear: dict[int, Number]) -> None:
        for column, number in sorted((self.column[i], n) for i, n in linear.items()):
            template.add(f"{column} ", _part(number), "\n")

    def _write_jacobian(self) -> None:
        entries = [{**dict.fromkeys(_variables_of(row), 0.0), **_linear_of(row)} for row in self.rows]
        counts = [0] * len(self.columns)
        for row in entries:
            for i in row:
                counts[self.column[i]] += 1
        self._tail.add(f"k{max(len(counts) - 1, 0)}\n")
        total = 0
        for count in counts[:-1]:
            total += count
            self._tail.add(f"{total}\n")
        for k, row in enumerate(entries):
            if row:
                self._tail.add(f"J{k} {len(row)}\n")
                self._write_linear(self._tail, row)

    def nl(self) -> str:
        """The file for the values that parameters, fixed variables and bounds have now."""
        if self.tape.evaluate():
            values = self.tape.values
            self._texts = [template.text(values) for template in (self._head, self._ranges, self._tail)]
        head, ranges, tail = self._texts
        starts = []
        for k, variable in enumerate(self.columns):
            start = variable.value
            if start is not None:
                starts.append(f"{k} {float(start)!r}\n")
                if not math.isfinite(start):
                    raise ModelError(f"{variable.name} = {start}: a start must be finite")
        return f"{head}x{len(starts)}\n{''.join(starts)}r\n{ranges}b\n{self._bounds_text()}{tail}"

    def _bounds_text(self) -> str:
        bounds = [(variable.bounds, *box) for variable, box in zip(self.columns, self._boxes)]
        if bounds == self._bounds and not self._box_slots:
            return self._bounds_written
        written = []
        for variable, (own, low, high) in zip(self.columns, bounds):
            lower = _stronger(max, own[0], None if low is None else self.tape.number(low))
            upper = _stronger(min, own[1], None if high is None else self.tape.number(high))
            if lower is not None and upper is not None:
                if lower > upper:
                    raise ModelError(f"{variable.name} has the bounds [{lower:g}, {upper:g}], between which there is nothing")
                written.append(f"4 {lower!r}\n" if lower == upper else f"0 {lower!r} {upper!r}\n")
            elif lower is not None:
                written.append(f"2 {lower!r}\n")
            else:
                written.append("3\n" if upper is None else f"1 {upper!r}\n")
        self._bounds, self._bounds_written = bounds, "".join(written)
        return self._bounds_written

    # Checks

    def check(self) -> None:
        """ModelError if a constraint without variables does not hold, or if this is no complementarity problem."""
        for row in self._rows.constants:
            number = self.tape.number(row.form)  # type: ignore[arg-type]
            low, high = (None if n is None else self.tape.number(n) for n in (row.lower, row.upper))
            slack = 1e-8 * max(1.0, abs(number))  # as Pyomo
            if (low is not None and number < low - slack) or (high is not None and number > high + slack):
                bounds = f"{'' if low is None else f'{low:g} <= '}{number:g}{'' if high is None else f' <= {high:g}'}"
                raise ModelError(f"constraint {row.name} has fixed variables only, and does not hold: {bounds}")
        if not self.columns:
            raise ModelError("no variable that is not fixed occurs in the active constraints and conditions")
        if self.contents.objectives and self.count() < len(self.columns):
            kind = " with complementarity conditions (an MPEC)" if self.contents.conditions else ""
            raise ModelError(
                f"this is an optimisation problem{kind}: objective {self.contents.objectives[0].name}, {len(self.columns)} "
                f"variables, and {self.count()} equations and conditions that determine them. Perp solves square models, "
                "which need no objective"
            )

    def fixed_beyond_need(self) -> list[str]:
        """Of a model with more equations and conditions than variables: the variables that are fixed."""
        return [variable.name for variable in self._fixed] if self.count() > len(self.columns) else []

    def count(self) -> int:
        """Equations and conditions; a model is square if these are as many as its variables."""
        return sum(row.variable is not None or (row.is_equation and not row.polyhedron) for row in self.rows)

    def warnings(self, F: list[float]) -> list[str]:
        """What the model says and its solution, with these values of F, does not do."""
        found = []
        if self.contents.objectives:
            names = ", ".join(objective.name for objective in self.contents.objectives)
            found.append(f"the objective {names} is ignored: the equations and conditions determine all variables")
        for i, row in self.pairs.items():
            if row.written_equal and abs(F[self.column[i]]) > 1e-6:
                found.append(
                    f"{row.name} is written as an equation, and does not hold as one: {self._variables[i].name} is at a bound, "
                    f"where F = {F[self.column[i]]:.4g}"
                )
        return found

    def notes(self) -> list[str]:
        """What was left out, and how it looks at the values that the variables have."""
        return [
            f"{dropped.condition.name} is left out, because its variable {dropped.variable.name} is fixed; its F is "
            f"{dropped.F(self.tape):.4g}"
            for dropped in self.dropped
        ]


def _lines(items: list[Any]) -> str:
    return "".join(" ".join(item.name.splitlines()) + "\n" for item in items)


def _stronger(choose: Any, own: Any, of_condition: float | None) -> float | None:
    if own is None:
        return of_condition
    return float(own if of_condition is None else choose(own, of_condition))


def _part(number: Number) -> str | Slot:
    return number if isinstance(number, Slot) else repr(number)


def _is_nonlinear(row: Row) -> bool:
    return isinstance(row.form, Form) and bool(row.form.terms)


def _variables_of(row: Row) -> set[int]:
    """Those with an entry in the file. A condition on one variable has its partner's, too: the program takes a free
    variable that alone makes up a condition for one that a writer has added, and does not answer for it."""
    found = row.form.all_variables() if isinstance(row.form, Form) else set()
    return found | {row.variable} if row.variable is not None and len(found) == 1 else found


def _linear_of(row: Row) -> dict[int, Number]:
    return row.form.linear if isinstance(row.form, Form) else {}


def _finite(variable: Any) -> tuple[bool, bool]:
    lower, upper = variable.bounds
    return lower is not None, upper is not None


def _refuse_foreign_components(contents: Contents) -> None:
    for block in contents.blocks:
        for component in block.component_objects(descend_into=False):
            if component.ctype.__name__ in _REFUSED and getattr(component, "active", True) and len(component):
                raise ModelError(f"{component.name} is a {component.ctype.__name__}, which a complementarity problem has no place for")

