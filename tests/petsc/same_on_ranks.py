#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs a program that writes its solution to a file, on several numbers of ranks, and compares what it has written:

    same_on_ranks.py [--judge SCRIPT] RANKS,... LIBRARY TYPE[=OTHER] MPIEXEC [FLAGS...] -- PROGRAM... @OUT [OPTIONS...]

@OUT stands for the file: a vector in PETSc's binary format, the same order on any number of ranks. SCRIPT gets this
file, where the program does not judge its solution itself. The program gets LIBRARY and -snes_type TYPE by PETSC_OPTIONS, as a user gives them who does not change the program. With =OTHER it is
also run on one rank with PETSc's own type OTHER. Exit status 1 if a run fails or two solutions differ by more than
1e-8, 77 if the program says that a package is missing (status 77).
"""

import array
import os
import subprocess
import sys
import tempfile

SAME = 1e-8
SECONDS = 240


def read(path):
    with open(path, "rb") as file:
        data = file.read()
    head = array.array("i", data[:8])
    head.byteswap()
    if head[0] != 1211214 or len(data) != 8 + 8 * head[1]:
        sys.exit(f"{path} is no vector of PETSc's")
    values = array.array("d", data[8:])
    values.byteswap()
    return values


def run(command, options, out):
    environment = dict(os.environ, PETSC_OPTIONS=options, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
    done = subprocess.run([word.replace("@OUT", out) for word in command], env=environment, timeout=SECONDS,
                          capture_output=True, text=True)
    print(done.stdout, end="")
    if done.returncode == 77 or "skipped:" in done.stdout:
        sys.exit(77)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}: status {done.returncode}\n{done.stderr}")
    return read(out)


def main():
    judge = None
    if sys.argv[1] == "--judge":
        judge = sys.argv[2]
        del sys.argv[1:3]
    ranks, library, types, *command = sys.argv[1:]
    kind, _, other = types.partition("=")
    split = command.index("--")
    mpiexec, program = command[:split], command[split + 1 :]
    with tempfile.TemporaryDirectory() as folder:
        solutions = {}
        for n in ranks.split(","):
            solutions[f"{kind} on {n} ranks"] = run([*mpiexec, "-n", n, *program], f"-dll_append {library} -snes_type {kind}", f"{folder}/{n}")
            if judge and subprocess.run([sys.executable, judge, f"{folder}/{n}"], timeout=SECONDS).returncode != 0:
                sys.exit(f"{judge} does not accept the solution on {n} ranks")
        if other:
            solutions[other] = run([*mpiexec, "-n", "1", *program], f"-snes_type {other} -pc_type lu", f"{folder}/other")
    first, *rest = solutions
    failed = False
    for name in rest:
        apart = max(abs(a - b) for a, b in zip(solutions[first], solutions[name], strict=True))
        print(f"{first} and {name}: {apart:.1e} apart")
        failed = failed or not apart <= SAME
    if not any(solutions[first]):
        sys.exit("the solution is 0 everywhere")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
