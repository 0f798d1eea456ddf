#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""perp-mpi solve on 1 and 3 ranks: perp_mpi.py PERP_MPI MPIEXEC [FLAGS...].

A membrane over an obstacle, from PETSc's binary files and from Matrix Market: the same solution, whose natural residual
is computed here; what is wrong with input is said, with exit code 2 and no rank left behind (time limits); a signal ends the run.
"""

import array
import json
import os
import subprocess
import sys
import tempfile

N = 20
H = 1 / (N + 1)
SECONDS = 60


def number(i, j):
    return i * N + j


def problem():
    """Rows of (column, value), q and the obstacle."""
    rows, q, lower = [], [], []
    for i in range(N):
        for j in range(N):
            near = [(i - 1, j), (i, j - 1), (i, j + 1), (i + 1, j)]
            row = [(number(*p), -1.0) for p in near if 0 <= p[0] < N and 0 <= p[1] < N] + [(number(i, j), 4.0)]
            rows.append(sorted(row))
            q.append(4 * H * H)
            lower.append(0.25 - 8 * (((i + 1) * H - 0.4) ** 2 + ((j + 1) * H - 0.45) ** 2))
    return rows, q, lower


def binary(kind, values):
    packed = array.array(kind, values)
    packed.byteswap()
    return packed.tobytes()


def write(rows, q, lower):
    n, entries = len(rows), [entry for row in rows for entry in row]
    with open("M.petsc", "wb") as file:
        file.write(binary("i", [1211216, n, n, len(entries)]) + binary("i", [len(row) for row in rows]))
        file.write(binary("i", [j for j, _ in entries]) + binary("d", [value for _, value in entries]))
    with open("nan.petsc", "wb") as file:
        file.write(binary("i", [1211216, n, n, len(entries)]) + binary("i", [len(row) for row in rows]))
        file.write(binary("i", [j for j, _ in entries]) + binary("d", [float("nan")] * len(entries)))
    with open("M.mtx", "w", encoding="utf-8") as file:  # the lower triangle
        below = [f"{i + 1} {j + 1} {value!r}\n" for i, row in enumerate(rows) for j, value in row if j <= i]
        file.write(f"%%MatrixMarket matrix coordinate real symmetric\n% a comment\n{n} {n} {len(below)}\n{''.join(below)}")
    for name, values in (("q", q), ("l", lower)):
        with open(f"{name}.petsc", "wb") as file:
            file.write(binary("i", [1211214, n]) + binary("d", values))
        with open(f"{name}.mtx", "w", encoding="utf-8") as file:
            file.write(f"%%MatrixMarket matrix array real general\n{n} 1\n" + "".join(f"{v!r}\n" for v in values))
    with open("short.petsc", "wb") as file:
        file.write(binary("i", [1211214, n]) + binary("d", q[1:]))
    with open("wrong.mtx", "w", encoding="utf-8") as file:
        file.write("%%MatrixMarket matrix coordinate real general\n3 3 2\n1 1 1\n4 1 1\n")
    head = "%%MatrixMarket matrix coordinate real general\n"
    for name, text in (("infinite", "2 2 2\n1 1 inf\n2 2 1\n"), ("junk", "2 2 2\n1 1 1\n2 2 1abc\n"),
                       ("large", "3000000000 3000000000 1\n1 1 1\n")):
        with open(f"{name}.mtx", "w", encoding="utf-8") as file:
            file.write(head + text)
    with open("swap.petsc", "wb") as file:  # nothing on the diagonal
        file.write(binary("i", [1211216, 2, 2, 2, 1, 1, 1, 0]) + binary("d", [1, -1]))
    with open("two.mtx", "w", encoding="utf-8") as file:
        file.write("%%MatrixMarket matrix coordinate real general\n2 2 4\n1 1 2\n1 2 1\n2 1 1\n2 2 2\n")
    with open("two_q.mtx", "w", encoding="utf-8") as file:
        file.write("%%MatrixMarket matrix array real general\n2 1\n-1\n-1\n")


def natural_residual(rows, q, lower, x):
    F = [sum(value * x[j] for j, value in row) + b for row, b in zip(rows, q)]
    return max(abs(v - max(l, v - f)) for v, l, f in zip(x, lower, F))


def check(program, mpiexec):
    """Yields what is wrong."""

    def run(ranks, *words):
        environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
        command = [*mpiexec, "-n", str(ranks), program, "solve", *words]
        return subprocess.run(command, capture_output=True, text=True, timeout=SECONDS, env=environment)

    rows, q, lower = problem()
    write(rows, q, lower)
    for ranks in (1, 3):
        for kind in ("petsc", "mtx"):
            files = [f"{name}.{kind}" for name in ("M", "q", "l")]
            done = run(ranks, *files[:2], "--lower", files[2], "--tol", "1e-11", "--json", "-", "--solution", "x")
            if done.returncode != 0:
                yield f"{files} on {ranks}: exit code {done.returncode}\n{done.stderr}"
                continue
            document = json.loads(done.stdout)
            with open("x", "rb") as file:
                x = array.array("d", file.read()[8:])
            x.byteswap()
            residual = natural_residual(rows, q, lower, x)
            if (document["status"], document["ranks"], document["size"]) != ("Solved", ranks, len(q)) or not residual <= 2e-11:
                yield f"{files} on {ranks}: {document['status']}, {document['ranks']} ranks, residual {residual}"
            if sum(v == l for v, l in zip(x, lower)) < 5:
                yield f"{files} on {ranks}: the obstacle is not touched"
            if document["residual"]["natural"] > 1e-11 or "Solved: the natural residual is" not in done.stderr:
                yield f"{files} on {ranks}: the residual is not told"
        done = run(ranks, "two.mtx", "two_q.mtx", "--json", "-", "--quiet")  # a rank of three has no row
        if done.returncode != 0:
            yield f"two rows on {ranks}: exit code {done.returncode}\n{done.stderr}"
        done = run(ranks, "swap.petsc", "two_q.mtx", "--lower", "-1", "--upper", "1", "--json", "-", "--quiet")
        if done.returncode != 0:  # x_2 = 1, any x_1
            yield f"no diagonal on {ranks}: exit code {done.returncode}\n{done.stdout}{done.stderr}"
        for words, said in (
            (("nowhere.petsc", "q.petsc"), "nowhere.petsc"),
            (("q.petsc", "q.petsc"), "ot a matrix"),
            (("nan.petsc", "q.petsc"), "nan.petsc: an entry is not a number"),
            (("M.petsc", "short.petsc"), "Read past end of file"),
            (("M.petsc", "two_q.mtx"), "the matrix 400 rows"),
            (("wrong.mtx", "q.petsc"), "wrong.mtx:4: the place (4, 1)"),
            (("M.petsc", "q.petsc", "--lower", "1", "--upper", "0"), "the bounds of variable 0 cross"),
            (("M.petsc", "q.petsc", "--tol", "nowhere"), "nowhere"),
            (("M.petsc", "q.petsc", "--time-limit", "nan"), "nan"),
            (("infinite.mtx", "two_q.mtx"), "infinite.mtx:3: the value is inf"),
            (("junk.mtx", "two_q.mtx"), "junk.mtx:4: '1abc' is not a number"),
        ):
            done = run(ranks, *words)
            if done.returncode != 2 or said not in done.stderr:
                yield f"{words} on {ranks}: exit code {done.returncode}, no {said!r} in\n{done.stderr}"
        done = run(ranks, "M.petsc", "q.petsc", "--lower", "l.petsc", "--max-iterations", "1", "--json", "-")
        if done.returncode != 1 or json.loads(done.stdout)["status"] != "IterationLimit":
            yield f"one iteration on {ranks}: exit code {done.returncode}"
    os.mkfifo("pipe.mtx")  # the signal comes before the first step
    stopped = subprocess.Popen([program, "solve", "M.petsc", "pipe.mtx", "--lower", "l.petsc", "--json", "-"],
                               stdout=subprocess.PIPE, text=True)
    with open("pipe.mtx", "w", encoding="utf-8") as pipe, open("q.mtx", encoding="utf-8") as file:
        stopped.terminate()
        pipe.write(file.read())
    if json.loads(stopped.communicate(timeout=SECONDS)[0])["status"] != "Interrupted" or stopped.returncode != 1:
        yield f"SIGTERM: exit code {stopped.returncode}"


def main():
    program, *mpiexec = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        wrong = list(check(program, mpiexec))
        os.chdir("/")
    print("\n".join(wrong), end="\n" if wrong else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
