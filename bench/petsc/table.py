#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""SNES type perp beside PETSc's own solvers: table.py BENCH_PETSC RESULTS.jsonl [LIMIT|turns], then table.py RESULTS.jsonl.

The first makes the runs, each in processes of its own, and adds a line of JSON each to RESULTS.jsonl; runs that are
there already are not made again. LIMIT: CPU seconds for a run of PETSc's solvers on the finest grid they are run on
(default 600); a quarter of that on the grid before, and so on. A solver is left out on the next grid if it has not met
the limit, or took more than 8 times what the quickest of PETSc's took. With `turns`, perp
and the quickest of PETSc's on 1025 x 1025 points (Signorini: 705) run in turn. The second writes the tables.
"""

import json
import os
import subprocess
import sys

PROBLEMS = {name: (257, 513, 1025, 2049) for name in ("obstacle", "torsion", "journal-bearing", "bratu")}
PROBLEMS["signorini"] = (177, 353, 705, 1409)  # two unknowns a point
MUMPS = "-ksp_type preonly -pc_type lu -pc_factor_mat_solver_type mumps"
RSLS = "snesvi -snes_type vinewtonrsls"
SSLS = "snesvi -snes_type vinewtonssls"
BNK = "-tao_bnk_pc_type hypre -tao_bnk_ksp_rtol 1e-3"
PEERS = {  # SEQUENCE: through grids of 33 points (signorini: 23) and twice as many, four times, ...
    "SNESVI rsls, MUMPS": f"{RSLS} {MUMPS}",
    "SNESVI rsls, CG + BoomerAMG": f"{RSLS} -ksp_type cg -pc_type hypre -ksp_rtol 1e-3",
    "SNESVI rsls, CG + GAMG": f"{RSLS} -ksp_type cg -pc_type gamg -ksp_rtol 1e-3",
    "SNESVI rsls, grid sequence, CG + BoomerAMG": f"{RSLS} SEQUENCE -ksp_type cg -pc_type hypre -ksp_rtol 1e-3",
    "SNESVI rsls, grid sequence, multigrid": f"{RSLS} SEQUENCE -pc_type mg",
    "SNESVI rsls, grid sequence, MUMPS": f"{RSLS} SEQUENCE {MUMPS}",
    "SNESVI ssls, MUMPS": f"{SSLS} {MUMPS}",
    "SNESVI ssls, GMRES + BoomerAMG": f"{SSLS} -ksp_type gmres -pc_type hypre -ksp_rtol 1e-5",
    "SNESVI ssls, GMRES + GAMG": f"{SSLS} -ksp_type gmres -pc_type gamg -ksp_rtol 1e-5",
    "TAO gpcg, BoomerAMG": "tao -tao_type gpcg -pc_type hypre",
    "TAO tron, BoomerAMG": "tao -tao_type tron -pc_type hypre",
    "TAO bnls, CG + BoomerAMG": f"tao -tao_type bnls -tao_bnk_ksp_type cg {BNK}",
    "TAO bntr, STCG + BoomerAMG": f"tao -tao_type bntr -tao_bnk_ksp_type stcg {BNK}",
}
OWN = "perp"
QUICKEST = {  # of PETSc's at a million unknowns
    "obstacle": "TAO tron, BoomerAMG",
    "torsion": "SNESVI rsls, grid sequence, multigrid",
    "journal-bearing": "TAO tron, BoomerAMG",
    "bratu": "TAO tron, BoomerAMG",
    "signorini": "SNESVI rsls, grid sequence, multigrid",
}
TURNS = 2
KSP = {"CG + BoomerAMG": "ksp -ksp_type cg -pc_type hypre", "CG + GAMG": "ksp -ksp_type cg -pc_type gamg"}


def run(program, results, solver, problem, points, ranks, limit, words):
    key = [solver, problem, points, ranks]
    for line in results:
        if line["key"] == key:
            return line
    command = [program, problem, str(points), str(limit), *words.split()]
    if ranks > 1:
        command = ["mpiexec", "--allow-run-as-root", "--oversubscribe", "-n", str(ranks), *command]
    environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
    line = {"key": key, "solved": False, "seconds": None, "cpu": None, "reason": "stopped"}
    try:
        done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=6 * limit + 60)
        last = done.stdout.strip().splitlines()[-1:] or [""]
        text = last[0].replace("nan,", "NaN,").replace("-NaN", "NaN").replace("inf,", "Infinity,")
        line.update(json.loads(text) if text.startswith("{") else {"reason": "error"})
    except subprocess.TimeoutExpired:
        pass
    print(json.dumps(line), flush=True)
    results.append(line)
    return line


def load(path):
    if not os.path.exists(path):
        return []
    with open(path, encoding="utf-8") as file:
        return [json.loads(line) for line in file]


def recorder(program, path):
    """Makes a run, unless its line is in the file already, and adds the line."""
    results = load(path)

    def one(*arguments):
        known = len(results)
        line = run(program, results, *arguments)
        if len(results) > known:
            with open(path, "a", encoding="utf-8") as file:
                file.write(json.dumps(line) + "\n")
        return line

    return one


def turns(program, path):
    one = recorder(program, path)
    for problem, name in QUICKEST.items():
        words = PEERS[name].replace("SEQUENCE", "-snes_grid_sequence 5")
        for turn in range(TURNS):
            one(f"{OWN}, in turn, {turn}", problem, PROBLEMS[problem][2], 1, 600, "perp")
            one(f"{name}, in turn, {turn}", problem, PROBLEMS[problem][2], 1, 600, words)


def measure(program, path, limit):
    one = recorder(program, path)
    for problem, grids in PROBLEMS.items():
        for points in grids:
            one(OWN, problem, points, 1, 600, "perp")
    for problem in ("obstacle", "torsion"):  # three times in turn, of which the quickest counts
        for turn in range(3):
            for name, words in {OWN: "perp", **KSP}.items():
                for ranks in (1, 2):
                    one(f"{name}, {turn}", problem, 1025, ranks, 600, words)
    for problem, grids in PROBLEMS.items():
        names = list(PEERS)
        for k, points in enumerate(grids[:3]):
            allowed = limit / 4 ** (2 - k)
            lines = {}
            for name in names:
                words = PEERS[name].replace("SEQUENCE", f"-snes_grid_sequence {k + 3}")
                lines[name] = one(name, problem, points, 1, allowed, words)
            took = {name: line["cpu"] for name, line in lines.items() if line["solved"]}
            names = [name for name in took if took[name] <= 8 * min(took.values())]


def cell(line):
    if line is None:
        return ""
    if not line["solved"]:
        limit = line["reason"] in ("DIVERGED_MAX_IT", "DIVERGED_MAXITS")
        return f"> {line['cpu']:.0f} s, {line['steps']}" if limit else "error" if line["reason"] == "error" else line["reason"]
    return f"{line['cpu']:.2f} s, {line['steps']}"


def tables(path):
    results = {tuple(line["key"]): line for line in load(path)}
    print("| problem | unknowns | steps | V-cycles | seconds | residual | MB |\n|---|---|---|---|---|---|---|")
    for problem, grids in PROBLEMS.items():
        for points in grids:
            line = results.get((OWN, problem, points, 1))
            if line and line["solved"]:
                print(f"| {problem} | {line['unknowns']} | {line['steps']} | {line['cycles']} | {line['cpu']:.2f} | "
                      f"{line['residual']:.0e} | {line['megabytes']} |")
    for problem, grids in PROBLEMS.items():
        print(f"\n| {problem}: seconds, steps | " + " | ".join(f"{p} x {p}" for p in grids[:3]) + " |\n|---|---|---|---|")
        for name in (OWN, *PEERS):
            lines = [results.get((name, problem, points, 1)) for points in grids[:3]]
            print(f"| {name} | " + " | ".join(map(cell, lines)) + " |")
    print("\n| in turn | perp | quickest of PETSc's | ratio |\n|---|---|---|---|")
    for problem, name in QUICKEST.items():
        keys = [[(f"{who}, in turn, {turn}", problem, PROBLEMS[problem][2], 1) for turn in range(TURNS)] for who in (OWN, name)]
        runs = [[results[key] for key in some if key in results and results[key]["solved"]] for some in keys]
        if all(runs):
            own, theirs = (min(run["cpu"] for run in some) for some in runs)
            print(f"| {problem}, {PROBLEMS[problem][2]} | {own:.2f} s | {theirs:.2f} s ({name}) | {own / theirs:.2f} |")
    print("\n| 1025 x 1025 | 1 rank | 2 ranks | speed-up | MB a rank |\n|---|---|---|---|---|")
    for problem in ("obstacle", "torsion"):
        for name in (OWN, *KSP):
            times = [[results.get((f"{name}, {turn}", problem, 1025, ranks)) for turn in range(3)] for ranks in (1, 2)]
            if all(map(all, times)):
                one, two = (min(run["seconds"] for run in runs) for runs in times)
                print(f"| {problem}, {name} | {one:.2f} s | {two:.2f} s | {one / two:.2f} | {times[1][0]['megabytes']} |")


if __name__ == "__main__":
    if len(sys.argv) == 2:
        tables(sys.argv[1])
    elif len(sys.argv) == 4 and sys.argv[3] == "turns":
        turns(sys.argv[1], sys.argv[2])
    elif len(sys.argv) in (3, 4):
        measure(sys.argv[1], sys.argv[2], float(sys.argv[3]) if len(sys.argv) == 4 else 600)
    else:
        sys.exit(__doc__)
