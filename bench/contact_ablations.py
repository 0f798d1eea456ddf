#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures what each constant and phase of contact's default is worth:

    contact_ablations.py BUILD FOLDER PROBLEMS        a table on standard output, log lines on standard error
    contact_ablations.py BUILD FOLDER PROBLEMS --only NAME=FACTOR[,NAME=FACTOR...] ...

BUILD is a configured release build whose libraries exist. FOLDER receives a copy of contact/ in which every numerical
constant of the .cpp files is read from the environment, PERP_KNOB_FILE_NAME=FACTOR, and a program of it: one build for
all rows. PROBLEMS is a file with a problem a line, as bench_contact_outcomes takes them. A row says how many problems
are solved, the factorizations, and the processor's time of all and in the geometric mean of the problems, relative to
the run with nothing changed. A phase is off where its number of steps is 0 (factor 0).
"""
import argparse
import concurrent.futures
import json
import math
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
CONSTANT = re.compile(r"^constexpr (?P<type>int|long|double|Index|std::size_t|std::array) (?P<name>\w+)"
                      r"(?: = (?P<value>[-0-9.][^;]*)|(?P<list>\{[-0-9.][^;]*\}));", re.M)
KERNELS = ("cone_homotopy",)  # headers with their structs of constants
FOLDERS = ("solvers", "cones", "model", "classics")
KNOB = """#pragma once
#include <array>
#include <cmath>
#include <cstdlib>
#include <type_traits>
inline double knob_factor(const char* name) { const char* f = std::getenv(name); return f ? std::atof(f) : 1; }
template <class T> T knob(const char* name, T value) {
  const double scaled = double(value) * knob_factor(name);
  if constexpr (std::is_integral_v<T>) return T(std::llround(scaled)); else return scaled;
}
template <class T, std::size_t n> std::array<T, n> knobs(const char* name, std::array<T, n> a) {
  for (T& x : a) x = knob(name, x);
  return a;
}
"""

# Where a phase begins, and what follows this line where it is off.
PHASES = {
    "newton_from_nothing": ("auto", "bool Solver<Size>::newton_from_nothing() {", "return false;"),
    "sweeps": ("auto", "bool Solver<Size>::sweep() {", "return false;"),
    "cones": ("cone_homotopy", "bool ConeHomotopy::run() {", "return false;"),
    "openings": ("cone_homotopy", "bool ConeHomotopy::openings() {", "return referee_.over();"),
    "restart_of_splitting": ("splitting", "bool Splitting::restart() {", "return false;"),
    "extrapolation_of_splitting": ("splitting", "void Splitting::extrapolate() {", "return;"),
    "newton_steps": ("newton_steps", "                  const NewtonSteps& steps) {", "return false;"),
    "polish": ("auto", "bool Solver<Size>::polish(const Vec& r, double alpha) {", "return false;"),
    "search": ("auto", "return method_.polish && !referee_.over() &&", ""),
    "groups": ("auto", "bool Solver<Size>::by_groups() {", "return false;"),
    "proximal_loop": ("auto", "bool Solver<Size>::proximal_loop() {", "return referee_.over();"),
    "homotopy_in_proximal_loop": ("auto", "bool Solver<Size>::homotopy_on(In centre, double alpha, Vec& r) {",
                                  "return false;"),
    "held_steps": ("follow", "bool Follower::held_step(Vec& x, double& last, bool first) {", "return false;"),
    "following_centre": ("follow_system", "bool FollowSystem::centre(In r, const FollowStep& step, Vec& d) {",
                         "return true;"),
    "following_sweeps": ("follow", "bool Follower::sweep(Vec& r, const Accept& accept, const Stop& stop) {",
                         "return false;"),
    "following_paths": ("follow", "bool Follower::paths(Vec& r, const Accept& accept, const Stop& stop) {",
                        "return false;"),
}

# Values of such structs.
FIELD_VALUES = re.compile(r"^constexpr(?= [A-Z]\w+ \w+\{\};)", re.M)
FIELD = re.compile(r"^  (?P<type>int|long|double|Index) (?P<name>\w+) = (?P<value>[-0-9.][^;]*);(?= +///<)", re.M)


def switch(text, stem):
    """Phases off by PERP_KNOB_phase_NAME=0."""
    for phase, (of, line, instead) in PHASES.items():
        if of != stem:
            continue
        if line not in text:
            print(f"there is no {line}", file=sys.stderr)
            continue
        is_on = f'(knob_factor("PERP_KNOB_phase_{phase}") != 0)'
        if instead:
            text = text.replace(line, f"{line} if (!{is_on}) {instead}", 1)
        else:
            text = text.replace(line, line.replace("return ", f"return {is_on} && ").replace("if (", f"if ({is_on} && "))
    return text


def instrument(text, stem, names):
    def replaced(match):
        kind, name = match["type"], match["name"]
        names.append(f"{stem}_{name}")
        key = f'"PERP_KNOB_{stem}_{name}"'
        if kind == "std::array":
            return f"const std::array {name} = knobs({key}, std::array{match['list']});"
        if match["value"] is None:
            return match[0]
        return f"const {kind} {name} = knob<{kind}>({key}, {match['value']});"

    def field(match):
        names.append(f"{stem}_{match['name']}")
        return f'  {match["type"]} {match["name"]} = knob<{match["type"]}>("PERP_KNOB_{stem}_{match["name"]}", {match["value"]});'
    text = FIELD.sub(field, text)
    if FIELD_VALUES.search(text):
        text = FIELD_VALUES.sub("const", text)
    return CONSTANT.sub(replaced, text)


def build(build_dir, folder):
    """The program with knobs, and the names of all constants."""
    names = []
    (folder / "contact").mkdir(parents=True, exist_ok=True)
    (folder / "knob.hpp").write_text(KNOB)
    commands = json.loads(subprocess.run(["ninja", "-C", build_dir, "-t", "compdb"], capture_output=True, text=True,
                                         check=True).stdout)
    command = next(c["command"] for c in commands if "perp_contact.dir" in c["output"] and "Unity" in c["output"])
    flags = re.sub(r" -MD .*", "", re.sub(r"^ccache ", "", command)).replace("-Werror", "-w")
    compiler, rest = flags.split(" ", 1)
    compiler = f"{compiler} -I{folder} {rest}".replace("-O3", "-O2")
    units = []
    for sub in sorted(p for p in (ROOT / "contact").iterdir() if p.is_dir()):
        target = folder / "contact" / sub.name
        target.mkdir(exist_ok=True)
        unit = ['#include "knob.hpp"']
        for source in sorted([*sub.glob("*.hpp"), *sub.glob("*.cpp")]):
            text = source.read_text()
            if sub.name in FOLDERS and (source.suffix == ".cpp" or source.stem in KERNELS):
                text = switch(instrument(text, source.stem, names), source.stem)
            (target / source.name).write_text(text)
            if source.suffix == ".cpp":
                unit.append(f'#include "contact/{sub.name}/{source.name}"')
        (folder / f"{sub.name}.cpp").write_text("\n".join(unit) + "\n")
        units.append(folder / f"{sub.name}.cpp")
    units.append(ROOT / "bench/contact_outcomes.cpp")
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        list(pool.map(lambda u: subprocess.run(f"{compiler} -o {folder}/{u.stem}.o -c {u}", shell=True, check=True,
                                               cwd=build_dir), units))
    link = subprocess.run(["ninja", "-C", build_dir, "-t", "commands", "contact_tests"], capture_output=True, text=True,
                          check=True).stdout.splitlines()[-1]
    libraries = " ".join(word for word in link.split(" -o ")[1].split() if not word.endswith(".o")
                         and "gtest" not in word and "gmock" not in word and "libperp_contact" not in word
                         and not word.startswith("tests/"))
    libraries = libraries.split("&&")[0]
    objects = " ".join(f"{folder}/{u.stem}.o" for u in units)
    subprocess.run(f"g++ -o {folder}/outcomes {objects} {libraries}", shell=True, check=True, cwd=build_dir)
    return names


def run(program, limit, problems, knobs):
    env = dict(os.environ, OMP_NUM_THREADS="1", **{f"PERP_KNOB_{k}": str(v) for k, v in knobs})
    out = {}
    for line in subprocess.run([program, str(limit), *problems], capture_output=True, text=True, env=env,
                               check=False).stdout.splitlines():
        name, solved, of, by, factors, seconds = line.split()
        out[name] = (int(solved), int(of), by, int(factors), max(float(seconds), 1e-4))
    return out


def row(label, result, base):
    common = [p for p in base if p in result]
    solved = sum(result[p][0] for p in common)
    factors = sum(result[p][3] for p in common)
    seconds = sum(result[p][4] for p in common) / sum(base[p][4] for p in common)
    mean = math.exp(sum(math.log(result[p][4] / base[p][4]) for p in common) / len(common))
    lost = [p.split("/")[-1] for p in base if p not in result or result[p][0] < base[p][0]]
    return f"| {label} | {solved} | {factors} | {seconds:.2f} | {mean:.2f} | {', '.join(lost)} |"


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("build", type=pathlib.Path)
    arguments.add_argument("folder", type=pathlib.Path)
    arguments.add_argument("problems", type=pathlib.Path)
    arguments.add_argument("--limit", type=float, default=10)
    arguments.add_argument("--only", nargs="*", default=None)
    arguments.add_argument("--kept", action="store_true", help="the program in FOLDER is up to date")
    given = arguments.parse_args()
    folder = given.folder.resolve()
    if not given.kept:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "names").write_text("\n".join(build(given.build.resolve(), folder)))
    names = (folder / "names").read_text().split()
    problems = given.problems.read_text().split()
    program = folder / "outcomes"
    base = run(program, given.limit, problems, [])
    rows = [f"phase_{phase}=0" for phase in PHASES] + [f"{n}={f}" for n in names for f in (0.25, 4)]
    rows = given.only if given.only is not None else rows
    print("| changed | solved | factorizations | time | geometric mean | not solved |\n|---|---|---|---|---|---|")
    print(row("nothing", base, base), flush=True)

    def measured(change):
        knobs = [part.split("=") for part in change.split(",")]
        return row(change.replace("=", " x ").replace(",", ", "), run(program, given.limit, problems, knobs), base)
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        for text in pool.map(measured, rows):
            print(text, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
