# SPDX-License-Identifier: Apache-2.0
"""Writes complementarity models as AMPL .nl files, text or binary, with .col and .row name files.

    m = Model("example")
    x = m.variable("x", lower=0, start=1)
    y = m.variable("y", start=0.5)
    m.complement("balance", x**2 + y - 2, x)    # l <= x <= u  _|_  x^2 + y - 2
    m.equation("income", y - 3 * x)             # y - 3 x = 0: pairs with a variable that no row complements
    m.inequality("cap", x + y, upper=5)         # side constraint
    m.write("example.nl")

The layout of the format (Gay, "Writing .nl files", 2005): ten header lines with counts; C segments, the nonlinear part
of each row in prefix notation; x, the start; r, the rows' bounds, where "5 k i" says that the row complements variable
i (from 1), k & 1: it has a finite lower bound, k & 2: a finite upper bound; b, the variables' bounds; k, cumulated
column counts of the Jacobian; J, for each row all its variables with their linear coefficients, 0 where the variable
occurs only nonlinearly. Nonlinear rows come before linear ones, variables that are nonlinear somewhere before the rest.
Standard library only; the files written do not depend on the machine.
"""

import cmath
import itertools
import math
import struct
from pathlib import Path

INF = math.inf
SUM, PRODUCT, QUOTIENT, POWER, LONG_SUM = 0, 2, 3, 5, 54
FUNCTIONS = {"sqrt": 39, "sin": 41, "log": 43, "exp": 44, "cos": 46}


# --- expressions -----------------------------------------------------------------------------------------------------


class Expr:
    """A node of an expression tree, made by arithmetic on variables and numbers and by exp, log, sqrt, sin, cos."""

    def __add__(self, other):
        return Sum([self, expr(other)])

    def __radd__(self, other):
        return Sum([expr(other), self])

    def __neg__(self):
        return Product(Constant(-1.0), self)

    def __sub__(self, other):
        return Sum([self, -expr(other)])

    def __rsub__(self, other):
        return Sum([expr(other), -self])

    def __mul__(self, other):
        return Product(self, expr(other))

    def __rmul__(self, other):
        return Product(expr(other), self)

    def __truediv__(self, other):
        return Quotient(self, expr(other))

    def __rtruediv__(self, other):
        return Quotient(expr(other), self)

    def __pow__(self, other):
        return Power(self, expr(other))

    def value(self, x):
        """The value at x, a dict from variables to real or complex numbers."""
        raise NotImplementedError

    def variables(self):
        """The set of variables the tree contains."""
        return set().union(*(arg.variables() for arg in self.args))

    def affine(self):
        """The parts (constant, {variable: coefficient}, [(factor, nonlinear tree)]) whose sum the expression is."""
        return 0.0, {}, [(1.0, self)]

    def prefix(self, out):
        """Writes the tree in prefix notation to an Encoder."""
        out.operator(self.opcode)
        for arg in self.args:
            arg.prefix(out)


class Constant(Expr):
    def __init__(self, number):
        self.number = float(number)
        if not math.isfinite(self.number):
            raise ValueError(f"a constant of an expression is {number}")

    def value(self, x):
        return self.number

    def variables(self):
        return set()

    def affine(self):
        return self.number, {}, []

    def prefix(self, out):
        out.number(self.number)


class Variable(Expr):
    def __init__(self, name, lower, upper, start):
        self.name, self.lower, self.upper, self.start = name, lower, upper, start

    def value(self, x):
        return x[self]

    def variables(self):
        return {self}

    def affine(self):
        return 0.0, {self: 1.0}, []

    def prefix(self, out):
        out.variable(self)


class Sum(Expr):
    def __init__(self, terms):
        flat = ((t.args if isinstance(t, Sum) else [t]) for t in terms)
        self.args = [arg for group in flat for arg in group]

    def value(self, x):
        return sum(arg.value(x) for arg in self.args)

    def affine(self):
        constant, linear, nonlinear = 0.0, {}, []
        for arg in self.args:
            c, part, rest = arg.affine()
            constant += c
            for variable, coefficient in part.items():
                linear[variable] = linear.get(variable, 0.0) + coefficient
            nonlinear += rest
        return constant, linear, nonlinear

    def prefix(self, out):
        if len(self.args) < 2:  # the format has no sums of fewer
            return (self.args or [Constant(0.0)])[0].prefix(out)
        out.sum_of(len(self.args))
        for arg in self.args:
            arg.prefix(out)


class Product(Expr):
    opcode = PRODUCT

    def __init__(self, left, right):
        self.args = [left, right]

    def value(self, x):
        return self.args[0].value(x) * self.args[1].value(x)

    def affine(self):
        parts = [arg.affine() for arg in self.args]
        for (factor, linear, nonlinear), (constant, terms, rest) in (parts, parts[::-1]):
            if not linear and not nonlinear:
                scaled = {variable: factor * coefficient for variable, coefficient in terms.items()}
                return factor * constant, scaled, [(factor * f, tree) for f, tree in rest]
        return super().affine()


class Quotient(Expr):
    opcode = QUOTIENT

    def __init__(self, above, below):
        self.args = [above, below]

    def value(self, x):
        return self.args[0].value(x) / self.args[1].value(x)

    def affine(self):
        if isinstance(self.args[1], Constant):
            return Product(Constant(1.0 / self.args[1].number), self.args[0]).affine()
        return super().affine()


class Power(Expr):
    opcode = POWER

    def __init__(self, base, exponent):
        self.args = [base, exponent]

    def value(self, x):
        return self.args[0].value(x) ** self.args[1].value(x)


class Function(Expr):
    def __init__(self, name, arg):
        self.name, self.opcode, self.args = name, FUNCTIONS[name], [arg]

    def value(self, x):
        arg = self.args[0].value(x)
        return getattr(cmath if isinstance(arg, complex) else math, self.name)(arg)


def expr(thing):
    """The expression itself, or the number as one."""
    return thing if isinstance(thing, Expr) else Constant(thing)


def total(terms):
    """The sum of an iterable of expressions and numbers."""
    return Sum([expr(term) for term in terms])


def exp(arg):
    return Function("exp", expr(arg))


def log(arg):
    return Function("log", expr(arg))


def sqrt(arg):
    return Function("sqrt", expr(arg))


def sin(arg):
    return Function("sin", expr(arg))


def cos(arg):
    return Function("cos", expr(arg))


# --- models ----------------------------------------------------------------------------------------------------------


class Row:
    """lower <= body <= upper, or body _|_ complement; body = constant + linear + sum of factor * tree."""

    def __init__(self, name, body, lower, upper, complement=None):
        self.name, self.body, self.lower, self.upper, self.complement = name, expr(body), lower, upper, complement
        self.constant, linear, self.nonlinear = self.body.affine()
        self.bent = set().union(*(tree.variables() for _, tree in self.nonlinear))  # variables that occur nonlinearly
        self.linear = {v: c for v, c in linear.items() if c != 0 or v in self.bent}
        self.linear.update({v: 0.0 for v in self.bent if v not in self.linear})


class Model:
    def __init__(self, name):
        self.name, self.variables, self.rows, self.objective = name, [], [], None
        self._own, self._complemented, self._names = set(), set(), {"variable": set(), "row": set()}

    def variable(self, name, lower=-INF, upper=INF, start=None):
        if not lower <= upper or lower == INF or upper == -INF:
            raise ValueError(f"{self.name}: variable {name} has bounds [{lower}, {upper}]")
        self._new_name(name, "variable")
        self.variables.append(Variable(name, lower, upper, start))
        self._own.add(self.variables[-1])
        return self.variables[-1]

    def complement(self, name, body, variable):
        """l <= variable <= u  _|_  body: body >= 0 at l, <= 0 at u, = 0 between."""
        if variable.lower == -INF and variable.upper == INF:
            raise ValueError(f"{self.name}: {variable.name} is free: row {name} is an equation")
        if variable in self._complemented:
            raise ValueError(f"{self.name}: two rows complement {variable.name}, the second is {name}")
        self._complemented.add(variable)
        self._add(Row(name, body, -INF, INF, variable))

    def equation(self, name, body):
        """body = 0. In the order of the file the equations pair with the variables that no row complements."""
        self._add(Row(name, body, 0.0, 0.0))

    def inequality(self, name, body, lower=-INF, upper=INF):
        """lower <= body <= upper, a side constraint: it complements no variable of the model."""
        if not lower < upper or (lower == -INF and upper == INF):
            raise ValueError(f"{self.name}: row {name} has bounds [{lower}, {upper}]")
        self._add(Row(name, body, lower, upper))

    def minimize(self, name, body):
        """A linear objective, which solvers for complementarity problems ignore."""
        row = Row(name, body, -INF, INF)
        if row.nonlinear:
            raise ValueError(f"{self.name}: objective {name} is nonlinear")
        self._new_name(name, "row")
        self.objective = row

    def ordered(self):
        """(variables, rows) in the order of the file."""
        bent = set().union(*(row.bent for row in self.rows))
        variables = sorted(self.variables, key=lambda v: v not in bent)
        return variables, sorted(self.rows, key=lambda row: not row.nonlinear)

    def pairs(self):
        """The rows in the order of the variables they belong to: the F of MCP(l, u, F) without side inequalities."""
        variables, rows = self.ordered()
        row_of = {row.complement: row for row in rows if row.complement}
        equations = iter([row for row in rows if not row.complement and row.lower == row.upper])
        return [row_of[v] if v in row_of else next(equations) for v in variables]

    def write(self, path, binary=False):
        """Writes path (ending in .nl) and the names beside it. Throws ValueError if the model is not square."""
        path = Path(path)
        variables, rows = self.ordered()
        path.write_bytes(encode(self, BinaryEncoder(variables) if binary else TextEncoder(variables)))
        objective = [self.objective] if self.objective else []
        for suffix, things in ((".col", variables), (".row", rows + objective)):
            path.with_suffix(suffix).write_text("".join(thing.name + "\n" for thing in things), encoding="ascii")

    def _add(self, row):
        strangers = [v.name for v in row.linear if v not in self._own]
        if strangers:
            raise ValueError(f"{self.name}: row {row.name} uses variables of another model: {', '.join(strangers)}")
        self._new_name(row.name, "row")
        self.rows.append(row)

    def _new_name(self, name, kind):
        if not name or "\n" in name:
            raise ValueError(f"{self.name}: {name!r} is no name")
        if name in self._names[kind]:
            raise ValueError(f"{self.name}: two things are called {name}")
        self._names[kind].add(name)


# --- the file --------------------------------------------------------------------------------------------------------


class TextEncoder:
    kind = "g"
    arithmetic = 0

    def __init__(self, variables):
        self.index = {variable: i for i, variable in enumerate(variables)}
        self.parts = []

    def segment(self, letter, *integers):
        self.line(letter + " ".join(str(i) for i in integers))

    def bound(self, kind, *numbers):
        self.line(" ".join([kind] + [text(n) for n in numbers]))

    def integers(self, *integers):
        self.line(" ".join(str(i) for i in integers))

    def entry(self, index, number):
        self.line(f"{index} {text(number)}")

    def operator(self, opcode):
        self.line(f"o{opcode}")

    def sum_of(self, count):
        self.operator(LONG_SUM if count > 2 else SUM)
        if count > 2:
            self.integers(count)

    def number(self, number):
        self.line("n" + text(number))

    def variable(self, variable):
        self.line(f"v{self.index[variable]}")

    def line(self, line):
        self.parts.append((line + "\n").encode("ascii"))


class BinaryEncoder(TextEncoder):
    """IEEE little-endian: letters as bytes, integers as int32, numbers as double, no line ends after the header."""

    kind = "b"
    arithmetic = 1

    def segment(self, letter, *integers):
        self.parts.append(letter.encode("ascii"))
        self.integers(*integers)

    def bound(self, kind, *numbers):
        self.parts.append(kind.encode("ascii"))
        for n in numbers:
            self.parts.append(struct.pack("<i" if isinstance(n, int) else "<d", n))

    def integers(self, *integers):
        self.parts.append(struct.pack(f"<{len(integers)}i", *integers))

    def entry(self, index, number):
        self.parts.append(struct.pack("<id", index, number))

    def operator(self, opcode):
        self.segment("o", opcode)

    def number(self, number):
        self.bound("n", float(number))

    def variable(self, variable):
        self.segment("v", self.index[variable])


def text(number):
    """The shortest decimal that reads back as the same double; integers without a point."""
    return str(int(number)) if number == int(number) and abs(number) < 1e15 else repr(float(number))


def encode(model, out):
    """The bytes of the .nl file of a model."""
    variables, rows = model.ordered()
    equations = [row for row in rows if row.lower == row.upper]
    unmatched = len(variables) - sum(row.complement is not None for row in rows)
    if len(equations) != unmatched:
        raise ValueError(
            f"{model.name} is not square: {len(equations)} equations, {unmatched} variables without a complement"
        )
    _header(model, variables, rows, out)
    _expressions(model, rows, out)
    starts = [v for v in variables if v.start is not None]
    out.segment("x", len(starts))
    for v in starts:
        out.entry(out.index[v], v.start)
    _bounds(variables, rows, out)
    _jacobian(model, variables, rows, out)
    return b"".join(out.parts)


def _header(model, variables, rows, out):
    equations = sum(row.lower == row.upper for row in rows)
    ranges = sum(-INF < row.lower < row.upper < INF for row in rows)
    nonlinear = sum(bool(row.nonlinear) for row in rows)
    bent = len(set().union(*(row.bent for row in rows)))
    entries = sum(len(row.linear) for row in rows)
    gradient = len(model.objective.linear) if model.objective else 0
    objectives = 1 if model.objective else 0

    matched = [(bool(row.nonlinear), row.complement) for row in rows if row.complement]
    cc_nonlinear = sum(is_nonlinear for is_nonlinear, _ in matched)
    cc_double = sum(v.lower > -INF and v.upper < INF for _, v in matched)
    cc_lower = sum(v.lower not in (0, -INF) for _, v in matched)
    cc = (len(matched) - cc_nonlinear, cc_nonlinear, cc_double, cc_lower)

    names = [max(len(thing.name) for thing in things) for things in (rows, variables)]
    for lead, counts, comment in (
        (out.kind, (3, 1, 1, 0), f"problem {model.name}"),
        (" ", (len(variables), len(rows), objectives, ranges, equations), "vars, rows, objectives, ranges, equations"),
        (" ", (nonlinear, 0, *cc), "nonlinear rows, objectives; complementarities: linear, nonlinear, double, lower != 0"),
        (" ", (0, 0), "network rows: nonlinear, linear"),
        (" ", (bent, 0, 0), "nonlinear variables in rows, objectives, both"),
        (" ", (0, 0, out.arithmetic, 1), "network variables; functions; arithmetic, flags"),
        (" ", (0, 0, 0, 0, 0), "discrete variables: binary, integer, nonlinear in both, rows, objectives"),
        (" ", (entries, gradient), "nonzeros of the Jacobian, of gradients"),
        (" ", names, "longest names of rows, variables"),
        (" ", (0, 0, 0, 0, 0), "common expressions: both, rows, objectives, one row, one objective"),
    ):
        out.line(lead + " ".join(str(count) for count in counts) + f"\t# {comment}")


def _expressions(model, rows, out):
    for i, row in enumerate(rows):
        out.segment("C", i)
        # Equations and inequalities carry their constant in the bounds; a complementarity row has none to carry it.
        trees = [tree if f == 1 else Product(Constant(f), tree) for f, tree in row.nonlinear]
        constant = [Constant(row.constant)] if row.complement and (row.constant != 0 or not trees) else []
        terms = trees + constant or [Constant(0.0)]
        (terms[0] if len(terms) == 1 else Sum(terms)).prefix(out)
    if model.objective:
        out.segment("O", 0, 0)
        out.number(model.objective.constant)


def _bounds(variables, rows, out):
    out.segment("r")
    for row in rows:
        if row.complement:
            v = row.complement
            out.bound("5", (v.lower > -INF) + 2 * (v.upper < INF), out.index[v] + 1)
        else:
            _interval(row.lower - row.constant, row.upper - row.constant, out)
    out.segment("b")
    for v in variables:
        _interval(v.lower, v.upper, out)


def _interval(lower, upper, out):
    if lower == -INF and upper == INF:
        out.bound("3")
    elif lower == -INF:
        out.bound("1", float(upper))
    elif upper == INF:
        out.bound("2", float(lower))
    elif lower == upper:
        out.bound("4", float(lower))
    else:
        out.bound("0", float(lower), float(upper))


def _jacobian(model, variables, rows, out):
    column = [0] * len(variables)
    for row in rows:
        for v in row.linear:
            column[out.index[v]] += 1
    out.segment("k", len(variables) - 1)
    for count in itertools.accumulate(column[:-1]):
        out.integers(count)
    for letter, group in (("J", rows), ("G", [model.objective] if model.objective else [])):
        for i, row in enumerate(group):
            if not row.linear:
                continue
            out.segment(letter, i, len(row.linear))
            for v in sorted(row.linear, key=out.index.get):
                out.entry(out.index[v], row.linear[v])
