#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks certificates that a complementarity problem has no solution, in rational arithmetic.

    perp solve MODEL --json result.json; scripts/check_certificate.py result.json [...]
    scripts/check_certificate.py --matrix M.mtx q.mtx lower.mtx upper.mtx result.json

The files are certificates, or results of `perp solve --json`. With --matrix the rows and bounds in the certificate are
compared with those of the files. Exit code 0: every certificate proves what it says; 1: one does not.

Let r(z) = max_i |z_i - mid(l_i, z_i - F_i, u_i)|, F = M z + q, and t the certificate's tolerance. Every z with r(z) <= t
has  l - t <= z <= u + t;  z_i > l_i + t implies F_i <= t;  z_i < u_i - t implies F_i >= -t.  A certificate narrows these
bounds X by assumptions. Each is refuted by a proof of its own, within the assumption; its contrary holds from then on. A
proof ends with multipliers y of rows for which  sup over X of y'(M z + q) + t |y|_1 < 0.
"""
import json
import sys
import zlib
from decimal import Decimal
from fractions import Fraction

FIELDS = "index name lower upper constant entries variable above value refuted assumptions multipliers".split()


class Refused(Exception):
    pass


class Number(float):
    """A double, and the digits that it was read from."""

    def __new__(cls, text):
        number = super().__new__(cls, text)
        sign, digits, exponent = Decimal(text).normalize().as_tuple()
        first, *others = map(str, digits)
        number.digits = f"{'-' * sign}{first}{'.' * bool(others)}{''.join(others)}e{exponent + len(others):+03d}"
        return number


def read(text):
    return json.loads(text, parse_float=Number, parse_int=Number)


def checksum(certificate):
    """CRC-32 over all numbers, as d.ddde+xx, and all names, in the order of the text."""
    crc = 0

    def add(value):
        nonlocal crc
        if isinstance(value, str):
            crc = zlib.crc32(value.encode(errors="surrogateescape"), crc)
        elif isinstance(value, list):
            for item in value:
                add(item)
            if not all(isinstance(v, float) for v in value) or not value:
                add(Number(str(len(value))))
        elif isinstance(value, dict):
            for field in (f for f in FIELDS if f in value):
                add(value[field])
        elif isinstance(value, bool):
            add(Number(str(int(value))))
        else:
            add("null" if value is None else value.digits)

    for key in ("tolerance", "radius", "variables", "rows", "proof"):
        add(certificate[key])
    return crc


class Checker:
    def __init__(self, certificate):
        self.t = Fraction(certificate["tolerance"])
        self.radius = certificate["radius"] and Fraction(certificate["radius"])
        exact = lambda bound: None if bound is None else Fraction(bound)
        self.box = {v["index"]: (exact(v["lower"]), exact(v["upper"])) for v in certificate["variables"]}
        self.rows = {r["index"]: (r["constant"], r["entries"]) for r in certificate["rows"]}
        # X: of each variable its least and largest value; None: no bound
        self.low = {j: l if l is None else l - self.t for j, (l, _) in self.box.items()}
        self.high = {j: u if u is None else u + self.t for j, (_, u) in self.box.items()}
        self.off = set()  # (i, above): z_i > l_i + t, or z_i < u_i - t, is assumed

    def refute(self, proof):
        before = [(bounds, a["variable"], bounds[a["variable"]]) for a in proof["assumptions"] for bounds in (self.low, self.high)]
        for a in proof["assumptions"]:
            self.assume(a)
        self.contradiction([(i, Fraction(high) + Fraction(low)) for i, high, low in proof["multipliers"]])
        for bounds, j, value in before:
            bounds[j] = value

    def assume(self, a):
        j, above = a["variable"], a["above"]
        bound = self.box[j][0 if above else 1]
        if a["value"] is None and bound is None:
            raise Refused(f"variable {j} has no bound that it could be off")
        value = Fraction(a["value"]) if a["value"] is not None else bound + self.t if above else bound - self.t
        near, far, tighter, looser = (self.low, self.high, max, min) if above else (self.high, self.low, min, max)
        kept, marked = near[j], (j, above) in self.off
        near[j] = value if kept is None else tighter(kept, value)
        if a["value"] is None:
            self.off.add((j, above))
        self.refute(a["refuted"])
        near[j] = kept
        if not marked:
            self.off.discard((j, above))
        far[j] = value if far[j] is None else looser(far[j], value)

    def at_most(self, i):  # is F_i <= t known?
        l = self.box[i][0]
        return l is None or (i, True) in self.off or (self.low[i] is not None and self.low[i] > l + self.t)

    def at_least(self, i):  # is F_i >= -t known?
        u = self.box[i][1]
        return u is None or (i, False) in self.off or (self.high[i] is not None and self.high[i] < u - self.t)

    def contradiction(self, y):
        total, g = Fraction(0), {}
        for i, yi in y:
            if yi == 0 or not (self.at_least(i) if yi > 0 else self.at_most(i)):
                raise Refused(f"the sign of the multiplier of row {i} is not allowed")
            constant, entries = self.rows[i]
            total += yi * Fraction(constant) + self.t * abs(yi)
            for j, a in entries:
                g[j] = g.get(j, 0) + yi * Fraction(a)
        for j, gj in g.items():
            if gj == 0:
                continue
            end = self.high[j] if gj > 0 else self.low[j]
            if end is None:
                if self.radius is None:
                    raise Refused(f"variable {j} has no bound, and its coefficients do not cancel")
                end = self.radius if gj > 0 else -self.radius
            total += gj * end
        if total >= 0:
            raise Refused(f"a contradiction is none: the sum is {float(total)}")


def read_matrix(path):
    """Entries {(i, j): value} of a Matrix Market file."""
    with open(path) as file:
        header = file.readline().split()
        lines = [line.split() for line in file if line.strip() and not line.startswith("%")]
    if header[2] == "array":
        return {(k, 0): float(line[0]) for k, line in enumerate(lines[1:])}
    entries = {}
    for line in lines[1:]:
        i, j, value = int(line[0]) - 1, int(line[1]) - 1, float(line[2])
        entries[i, j] = entries.get((i, j), 0) + value
        if header[4] in ("symmetric", "skew-symmetric") and i != j:
            entries[j, i] = value if header[4] == "symmetric" else -value
    return entries


def compare(certificate, paths):
    M, q, lower, upper = (read_matrix(path) for path in paths)
    for r in certificate["rows"]:
        i = r["index"]
        row = {j: a for (k, j), a in M.items() if k == i and a != 0}
        if dict(r["entries"]) != row or r["constant"] != q.get((i, 0), 0):
            raise Refused(f"row {i} is not that of {paths[0]} and {paths[1]}")
    for v in certificate["variables"]:
        for side, values, none in (("lower", lower, float("-inf")), ("upper", upper, float("inf"))):
            if (none if v[side] is None else v[side]) != values.get((v["index"], 0), 0):
                raise Refused(f"the {side} bound of variable {v['index']} is not that of the file")


def check(path, matrix):
    with open(path) as file:
        certificate = read(file.read())
    certificate = certificate.get("certificate", certificate)
    if not isinstance(certificate, dict) or certificate.get("format") != "perp certificate 1":
        raise Refused("there is no certificate; a proof by ranges of F is repeated by solving again")
    if certificate["checksum"] != checksum(certificate):
        raise Refused("the checksum is another one")
    if matrix:
        compare(certificate, matrix)
    sys.setrecursionlimit(100_000)
    Checker(certificate).refute(certificate["proof"])
    return certificate


def main(arguments):
    matrix = arguments[1:5] if arguments[:1] == ["--matrix"] else None
    files = arguments[5:] if matrix else arguments or sys.exit(__doc__)
    refused = False
    for path in files:
        try:
            c = check(path, matrix)
            within = f" with entries up to {c['radius']:g}" if c["radius"] else ""
            within += " within the bounds, and its terms within their ranges," if "terms_from" in c else ""
            print(f"{path}: proven: no point{within} has a natural residual of at most {float(c['tolerance'])!r}")
        except (OSError, Refused, KeyError, IndexError, TypeError, ValueError, OverflowError) as error:
            print(f"{path}: refused: {error}")
            refused = True
    return 1 if refused else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
