# SPDX-License-Identifier: Apache-2.0
"""usage: check_certificates.py PERP

Every Infeasible of the collection's small problems, of chains, parallel rows and linear programs without a solution, by
several methods: the checker, which shares no line with Perp, accepts the certificate, and refuses it after any digit of
it is changed. What is infeasible by less than the tolerance is not called so. Catches a certificate that proves less than
it says, a checker that passes anything, and two methods that contradict each other."""
import json
import random
import re
import subprocess
import sys
import tempfile
from fractions import Fraction
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent.parent / "scripts"))
import check_certificate as checker

COLLECTION = ["infeasible-own", "feasible-unsolvable-own"]
METHODS = ["auto", "path", "lemke", "interior-point", "principal-pivoting"]


def write(folder, name, M, q, lower, upper):
    n = len(q)
    entries = [(i, j, a) for i, row in enumerate(M) for j, a in enumerate(row) if a]
    body = "".join(f"{i + 1} {j + 1} {a!r}\n" for i, j, a in entries)
    (folder / f"{name}.mtx").write_text(f"%%MatrixMarket matrix coordinate real general\n{n} {n} {len(entries)}\n{body}")
    for part, values in (("q", q), ("lower", lower), ("upper", upper)):
        text = "".join(f"{v!r}\n" for v in values)
        (folder / f"{name}-{part}.mtx").write_text(f"%%MatrixMarket matrix array real general\n{n} 1\n{text}")
    return [f"{name}.mtx", f"{name}-q.mtx", "--lower", f"{name}-lower.mtx", "--upper", f"{name}-upper.mtx"]


def systems(folder):
    """(arguments of perp solve, gap or None): chains of equations, parallel rows, KKT systems of linear programs."""
    inf = float("inf")
    for gap in (1e-18, 1e-14, 1e-10, 1e-7, 1e-3, 1.0):
        M = [[1.0, 2.0], [3.0, 6.0]]
        yield write(folder, f"parallel{gap}", M, [-1.0, -3.0 - gap], [-inf] * 2, [inf] * 2), gap / 4
        n = 8
        M = [[0.0] * (n + 1) for _ in range(n + 1)]
        M[0][0], M[n][n - 1] = 3.0, 3.0
        for k in range(1, n):
            M[k][k], M[k][k - 1] = 1.0, -1.0
        yield write(folder, f"chain{gap}", M, [-1.0] + [0.0] * (n - 1) + [-1.0 - gap], [-inf] * (n + 1), [inf] * (n + 1)), gap / 23
    rng = random.Random(3)
    for k in range(12):  # min c'x, A x = b, x >= 0, with y'A <= 0 < y'b for the y of ones
        m, n = rng.randint(2, 4), rng.randint(2, 5)
        A = [[float(rng.randint(-4, 4)) for _ in range(n)] for _ in range(m)]
        for j in range(n):
            A[0][j] -= max(0.0, sum(row[j] for row in A))
        M = [[0.0] * (n + m) for _ in range(n + m)]
        for i in range(m):
            for j in range(n):
                M[n + i][j], M[j][n + i] = A[i][j], -A[i][j]
        q = [float(rng.randint(0, 5)) for _ in range(n)] + [-float(rng.randint(1, 3)) for _ in range(m)]
        yield write(folder, f"lp{k}", M, q, [0.0] * n + [-inf] * m, [inf] * (n + m)), None


def digits_changed(certificate):
    """The certificate with one digit of one number changed, for up to 60 places of the text."""
    text = json.dumps(certificate)
    places = [m.start() for m in re.finditer(r"\d", text)]
    for place in places if len(places) <= 60 else random.Random(1).sample(places, 60):
        other = text[:place] + str((int(text[place]) + 1) % 10) + text[place + 1 :]
        try:
            changed = checker.read(other)
        except ValueError:
            continue  # 01 is no number
        yield other, changed


def refuses(certificate):
    try:
        if certificate["format"] != "perp certificate 1" or certificate["checksum"] != checker.checksum(certificate):
            return True
        checker.Checker(certificate).refute(certificate["proof"])
    except (checker.Refused, KeyError, IndexError, TypeError, ValueError, OverflowError):
        return True
    return False


def main():
    perp = Path(sys.argv[1]).resolve()
    wrong, proven = [], 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for arguments, best in [*(([problem], None) for problem in COLLECTION), *systems(folder)]:
            accepted = []
            for method in METHODS:
                run = subprocess.run([perp, "solve", *arguments, "--method", method, "--time-limit", "20", "--json", "result.json"],
                                     cwd=folder, capture_output=True, text=True, timeout=120)
                what = f"{arguments[0]} by {method}"
                result = checker.read((folder / "result.json").read_text())
                status = result["status"]
                if status.startswith("Solved"):
                    accepted.append(what)
                if status != "Infeasible":
                    continue
                proven += 1
                certificate = result["certificate"]
                if best is not None and result["residual_bound"] > best * (1 + 1e-6):
                    wrong.append(f"{what}: bound {result['residual_bound']}, but a point has {best}")
                if refuses(certificate):
                    wrong.append(f"{what}: the checker refuses the certificate")
                    continue
                if Fraction(result["residual_bound"]) > Fraction(certificate["tolerance"]):
                    wrong.append(f"{what}: the bound is more than what is proven")
                if accepted:
                    wrong.append(f"{what} is Infeasible, but {accepted[0]} is solved")
                for text, changed in digits_changed(certificate):
                    if not refuses(changed):
                        wrong.append(f"{what}: accepted after a digit was changed: {text[:300]}")
            if best is not None and best > 1e-4 and accepted:
                wrong.append(f"{accepted[0]} is solved, but every point has a residual of {best}")
    print("\n".join(wrong), f"{proven} certificates", sep="\n" if wrong else "")
    return 1 if wrong or proven < 30 else 0


if __name__ == "__main__":
    sys.exit(main())
