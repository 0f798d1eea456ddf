#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The natural residual of a solution of PETSc's SNES tutorial ex9, from the equations its text states: ex9_residual.py FILE.

-Laplace u >= 0 and u >= psi on (-2, 2)^2, one of them equal, psi the half sphere of radius 1 that continues as its
tangent beyond 0.9. On the boundary u is the exact solution, -A log r + B beyond the radius a of the contact. FILE is in
PETSc's binary format, in the natural order of a square grid. Exit status 1 if the residual is above 1e-8, or nothing or
everything is in contact.
"""

import array
import math
import sys


def read(path):
    with open(path, "rb") as file:
        values = array.array("d", file.read()[8:])
    values.byteswap()
    return values


def psi(r):
    edge, height = 0.9, math.sqrt(1 - 0.81)
    return math.sqrt(1 - r * r) if r <= edge else height - edge / height * (r - edge)


def contact_radius():
    low, high = 0.5, 0.9  # a^2 log(2 / a) = 1 - a^2
    for _ in range(60):
        a = (low + high) / 2
        low, high = (a, high) if a * a * math.log(2 / a) < 1 - a * a else (low, a)
    return a


def main():
    u = read(sys.argv[1])
    n = math.isqrt(len(u))
    radius = contact_radius()
    slope = radius**2 / math.sqrt(1 - radius**2)
    worst = 0.0
    held = 0
    for j in range(n):
        for i in range(n):
            k = i + n * j
            r = math.hypot(4 * i / (n - 1) - 2, 4 * j / (n - 1) - 2)
            if i in (0, n - 1) or j in (0, n - 1):
                worst = max(worst, abs(u[k] - slope * math.log(2 / r)))
                continue
            F = 4 * u[k] - u[k - 1] - u[k + 1] - u[k - n] - u[k + n]
            worst = max(worst, abs(min(u[k] - psi(r), F)))
            held += u[k] <= psi(r) + 1e-15
    print(f"natural residual {worst:.1e}, {held} of {len(u)} in contact")
    return 0 if n * n == len(u) and worst <= 1e-8 and 0 < held < len(u) / 2 else 1


if __name__ == "__main__":
    sys.exit(main())
