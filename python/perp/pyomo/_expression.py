# SPDX-License-Identifier: Apache-2.0
"""Pyomo's expressions as the text of an .nl file, with places for the numbers that change between solves.

A number is a float, or a Slot of the Tape: the value of a mutable Param, of a fixed variable, or of an expression of
these. The Tape computes all slots anew for each solve, so that an expression is walked once only.

A text is a string, a number, a variable (by its id), a Defined, or a list of texts.
"""

from __future__ import annotations

import math
import operator
from typing import Any, Callable, Sequence, Union

from pyomo.core.expr import numeric_expr as numeric
from pyomo.core.expr import relational_expr as relational
from pyomo.core.expr.numvalue import native_logical_types, native_numeric_types, value
from pyomo.core.expr.visitor import StreamBasedExpressionVisitor, identify_mutable_parameters, identify_variables
from pyomo.repn.ampl import TextNLTemplate


class ModelError(ValueError):
    """The model cannot be solved as it is."""


class Slot:
    """A place on the Tape."""

    __slots__ = ("at",)

    def __init__(self, at: int) -> None:
        self.at = at


Number = Union[float, Slot]
Text = Any


class Tape:
    """The numbers that depend on what may change between solves, in the order in which they are computed."""

    def __init__(self) -> None:
        self.values: list[float] = []
        self.leaves: list[Any] = []  # what has a value in the model
        self._places: list[int] = []  # of the leaves
        self._slots: dict[int, Slot] = {}
        self._steps: list[tuple[Callable[[float, float], float], int, int, int]] = []
        self._sources: list[tuple[str, Any]] = []  # of the steps: their row, and their expression if it is one of the model's
        self._read: list[Any] | None = None  # the values of the leaves by which the slots were computed
        self.owner = ""  # the row that is being compiled

    def _new(self, number: float) -> Slot:
        self.values.append(number)
        return Slot(len(self.values) - 1)

    def leaf(self, item: Any) -> Slot:
        slot = self._slots.get(id(item))
        if slot is None:
            slot = self._slots[id(item)] = self._new(0.0)
            self.leaves.append(item)
            self._places.append(slot.at)
        return slot

    def apply(self, function: Callable[[float, float], float], a: Number, b: Number = 0.0, node: Any = None) -> Number:
        if not isinstance(a, Slot) and not isinstance(b, Slot):
            return _checked(function, a, b, (self.owner, node))
        return self.later(function, a, b, node)

    def later(self, function: Callable[[float, float], float], a: Number = 0.0, b: Number = 0.0, node: Any = None) -> Slot:
        places = [number.at if isinstance(number, Slot) else self._new(number).at for number in (a, b)]
        slot = self._new(0.0)
        self._steps.append((function, slot.at, places[0], places[1]))
        self._sources.append((self.owner, node))
        return slot

    def evaluate(self) -> bool:
        """Computes all slots; true if a leaf has another value than before. ModelError names what has none."""
        read = [item.value for item in self.leaves]
        if read == self._read:
            return False
        self._read = None
        values = self.values
        for place, item, number in zip(self._places, self.leaves, read):
            values[place] = _finite(item, number)
        try:
            for function, target, a, b in self._steps:
                values[target] = function(values[a], values[b])
            computed = all(map(math.isfinite, values))
        except (ArithmeticError, ValueError, TypeError):  # a complex number has no size
            computed = False
        if not computed:  # say where
            for k, (function, target, a, b) in enumerate(self._steps):
                values[target] = _checked(function, values[a], values[b], self._sources[k])
        self._read = read
        return True

    def number(self, number: Number) -> float:
        return self.values[number.at] if isinstance(number, Slot) else number


def _finite(item: Any, number: Any) -> float:
    if number is None:
        raise ModelError(f"{item.name} is {'fixed' if item.is_variable_type() else 'used'}, but has no value")
    if not math.isfinite(number):
        raise ModelError(f"{item.name} = {number}: it must be a finite number")
    return float(number)


def _checked(function: Callable[[float, float], float], a: float, b: float, source: tuple[str, Any]) -> float:
    try:
        number = function(a, b)
        if isinstance(number, complex) or not math.isfinite(number):
            raise ValueError(f"a constant is {number}")
        return float(number)
    except (ArithmeticError, ValueError) as error:
        row, node = source
        what = f"{node} has no value{_where(node)}" if node is not None else "an expression of parameters and fixed variables has no value"
        raise ModelError(f"{row}: {what} ({error})") from None


def _where(node: Any) -> str:
    """", where p = 0 is fixed": the numbers that the expression is made of."""
    fixed = [f"{variable.name} = {variable.value} is fixed" for variable in identify_variables(node)]
    told = fixed + [f"{parameter.name} = {parameter.value}" for parameter in identify_mutable_parameters(node)]
    return f", where {' and '.join(told)}" if told else ""


class Defined:
    """A named Expression of the model: a defined variable of the file."""

    __slots__ = ("name", "linear", "constant", "terms", "variables")

    def __init__(self, name: str, form: Form, whole: bool) -> None:
        self.name = name
        self.linear = form.linear if whole else {}
        self.constant = form.constant if whole else 0.0
        self.terms = form.terms
        self.variables = form.all_variables() if whole else form.variables


class Form:
    """constant + sum of linear[v] v + sum of terms; `variables` are those of the terms."""

    __slots__ = ("constant", "linear", "terms", "variables", "whole")

    def __init__(
        self, constant: Number = 0.0, linear: dict[int, Number] | None = None, terms: list[Text] | None = None,
        variables: set[int] | None = None,
    ) -> None:
        self.constant = constant
        self.linear = linear if linear is not None else {}
        self.terms = terms if terms is not None else []
        self.variables = variables if variables is not None else set()
        self.whole: Defined | None = None  # the same, as a defined variable

    def all_variables(self) -> set[int]:
        return self.variables.union(self.linear)

    def plain_variable(self) -> int | None:
        """The variable that this is, if it is no more than that."""
        if self.terms or len(self.linear) != 1 or self.constant != 0.0:
            return None
        ((variable, coefficient),) = self.linear.items()
        return variable if coefficient == 1.0 else None


Value = Union[float, Slot, Form]


def is_number(item: Value) -> bool:
    return not isinstance(item, Form)


def sum_of(texts: list[Text]) -> Text:
    if len(texts) <= 1:
        return texts[0] if texts else 0.0
    return ["o0\n" if len(texts) == 2 else f"o54\n{len(texts)}\n", *texts]


class Walker:
    """Compiles expressions. Remembers the variables and named Expressions that it met."""

    def __init__(self) -> None:
        self.tape = Tape()
        self.variables: dict[int, Any] = {}  # that are not fixed, in the order in which they are met
        self.fixed: dict[int, Any] = {}
        self.expressions: list[tuple[Any, Any]] = []  # the named ones, and what they were
        self._named: dict[int, Value] = {}
        self._visitor = StreamBasedExpressionVisitor(
            initializeWalker=self._begin, beforeChild=self._before, exitNode=self._exit
        )

    def walk(self, expression: Any) -> Value:
        result: Value = self._visitor.walk_expression(expression)
        return result

    # Leaves

    def _begin(self, expression: Any) -> tuple[bool, Any]:
        descend, result = self._before(None, expression, 0)
        return descend, expression if descend else result

    def _before(self, node: Any, child: Any, index: int) -> tuple[bool, Any]:
        kind = child.__class__
        if kind in native_numeric_types or kind in native_logical_types:  # of Expr_if
            return False, self._constant(child)
        if not hasattr(child, "is_expression_type"):
            raise ModelError(f"{self.tape.owner}: {child!r} is no number")
        if child.is_expression_type():
            if id(child) in self._named:
                return False, self._named[id(child)]
            return True, None
        if child.is_variable_type():
            return False, self._variable(child)
        if child.is_constant():
            return False, self._constant(value(child))
        return False, self.tape.leaf(child)

    def _constant(self, number: Any) -> float:
        constant = float(number)
        if not math.isfinite(constant):
            raise ModelError(f"{self.tape.owner}: a constant is {constant}")
        return constant

    def _variable(self, variable: Any) -> Value:
        if variable.fixed:
            self.fixed[id(variable)] = variable
            return self.tape.leaf(variable)
        self.variables[id(variable)] = variable
        return Form(linear={id(variable): 1.0})

    # Arithmetic

    def plus(self, a: Number, b: Number) -> Number:
        if a == 0.0 or b == 0.0:
            return b if a == 0.0 else a
        return self.tape.apply(operator.add, a, b)

    def times(self, a: Number, b: Number) -> Number:
        if a == 0.0 or b == 0.0:
            return 0.0
        if a == 1.0 or b == 1.0:
            return b if a == 1.0 else a
        return self.tape.apply(operator.mul, a, b)

    def add(self, items: list[Value]) -> Value:
        constant: Number = 0.0
        total = Form()
        for item in items:
            if not isinstance(item, Form):
                constant = self.plus(constant, item)
                continue
            constant = self.plus(constant, item.constant)
            for variable, coefficient in item.linear.items():
                total.linear[variable] = self.plus(total.linear.get(variable, 0.0), coefficient)
            total.terms.extend(item.terms)
            total.variables.update(item.variables)
        total.linear = {v: c for v, c in total.linear.items() if c != 0.0}
        total.constant = constant
        return total if total.linear or total.terms else constant

    def scale(self, item: Value, factor: Number) -> Value:
        if not isinstance(item, Form):
            return self.times(item, factor)
        if factor == 0.0 or factor == 1.0:
            return 0.0 if factor == 0.0 else item
        linear = {variable: self.times(coefficient, factor) for variable, coefficient in item.linear.items()}
        terms = [["o16\n", sum_of(item.terms)] if factor == -1.0 else ["o2\n", factor, sum_of(item.terms)]]
        return Form(self.times(item.constant, factor), linear, terms if item.terms else [], item.variables)

    def difference(self, a: Value, b: Value) -> Value:
        return self.add([a, self.scale(b, -1.0)])

    def text(self, item: Value) -> Text:
        if not isinstance(item, Form):
            return item
        if item.whole is not None:
            return item.whole
        texts: list[Text] = [v if c == 1.0 else ["o2\n", c, v] for v, c in item.linear.items()] + item.terms
        if item.constant != 0.0:
            texts.append(item.constant)
        return sum_of(texts)

    def term(self, operation: str, items: Sequence[Value]) -> Form:
        variables = set().union(*(item.all_variables() for item in items if isinstance(item, Form)))
        return Form(terms=[[operation, *(self.text(item) for item in items)]], variables=variables)

    # Nodes

    def _exit(self, node: Any, data: list[Any]) -> Value:
        for kind in node.__class__.__mro__:
            handler = _handlers.get(kind)
            if handler is not None:
                result: Value = handler(self, node, data)
                return result
        if getattr(node, "is_named_expression_type", bool)():
            return self._named_expression(node, data[0])
        if all(is_number(item) for item in data):
            return self.tape.later(lambda a, b: value(node), node=node)
        raise ModelError(f"{self.tape.owner}: {node.getname()} of variables cannot be written to an .nl file")

    def _named_expression(self, node: Any, item: Value) -> Value:
        self.expressions.append((node, node.expr))
        if isinstance(item, Form):
            if item.terms:
                name = Defined(node.name, item, whole=False)
                item = Form(item.constant, item.linear, [name], item.variables)
            elif len(item.linear) > 2:
                whole = Defined(node.name, item, whole=True)
                item = Form(item.constant, item.linear)
                item.whole = whole
        self._named[id(node)] = item
        return item

    def _product(self, node: Any, data: list[Value]) -> Value:
        a, b = data
        if not isinstance(a, Form):
            return self.scale(b, a)
        return self.term("o2\n", data) if isinstance(b, Form) else self.scale(a, b)

    def _division(self, node: Any, data: list[Value]) -> Value:
        a, b = data
        if isinstance(b, Form):
            return 0.0 if a == 0.0 else self.term("o3\n", data)
        if isinstance(a, Form):
            return self.scale(a, self.tape.apply(operator.truediv, 1.0, b, node))
        return self.tape.apply(operator.truediv, a, b, node)

    def _power(self, node: Any, data: list[Value]) -> Value:
        a, b = data
        if not isinstance(a, Form) and not isinstance(b, Form):
            return self.tape.apply(operator.pow, a, b, node)
        if b == 0.0 or b == 1.0:
            return a if b == 1.0 else 1.0
        return self.term("o5\n", data)

    def _unary(self, node: Any, data: list[Value]) -> Value:
        if not isinstance(data[0], Form):
            return self.tape.apply(lambda a, b: node._apply_operation((a,)), data[0], node=node)
        name = node.getname()
        return self.term(TextNLTemplate.abs if name == "abs" else TextNLTemplate.unary[name], data)

    def _relation(self, node: Any, data: list[Value]) -> Value:
        if all(is_number(item) for item in data):
            return self.tape.later(lambda a, b: float(value(node)))
        strict = node.strict if isinstance(node.strict, tuple) else (node.strict,) * (len(data) - 1)
        parts: list[Value] = [self.term("o22\n" if s else "o23\n", [a, b]) for s, a, b in zip(strict, data, data[1:])]
        return parts[0] if len(parts) == 1 else self.term("o21\n", parts)

    def _equality(self, node: Any, data: list[Value]) -> Value:
        if all(is_number(item) for item in data):
            return self.tape.later(lambda a, b: float(value(node)))
        return self.term("o24\n", data)

    def _choice(self, node: Any, data: list[Value]) -> Value:
        if all(is_number(item) for item in data):
            return self.tape.later(lambda a, b: value(node))
        if isinstance(data[0], float):
            chosen: Value = data[1] if data[0] else data[2]
            return chosen
        condition = data[0] if isinstance(data[0], Form) else self.term("o24\n", [data[0], 1.0])
        return self.term("o35\n", [condition, *data[1:]])

    def _extreme(self, node: Any, data: list[Value]) -> Value:
        if all(is_number(item) for item in data):
            return self.tape.later(lambda a, b: value(node))
        return self.term(f"o{11 if isinstance(node, numeric.MinExpression) else 12}\n{len(data)}\n", data)


_handlers: dict[type, Callable[[Walker, Any, list[Any]], Value]] = {
    numeric.SumExpression: lambda walker, node, data: walker.add(data),
    numeric.NegationExpression: lambda walker, node, data: walker.scale(data[0], -1.0),
    numeric.ProductExpression: Walker._product,
    numeric.DivisionExpression: Walker._division,
    numeric.PowExpression: Walker._power,
    numeric.UnaryFunctionExpression: Walker._unary,
    numeric.MinExpression: Walker._extreme,
    numeric.MaxExpression: Walker._extreme,
    numeric.Expr_ifExpression: Walker._choice,
    relational.InequalityExpression: Walker._relation,
    relational.RangedExpression: Walker._relation,
    relational.EqualityExpression: Walker._equality,
}
