#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compiles headers or sources one by one: compile_alone.py headers|sources BUILD [FOLDER...].

In unity builds a file sees what those before it include. Here it sees what the presets give it, which compile file by
file: the options of compile_commands.json in BUILD, and Eigen before everything, as a precompiled header, for speed. Only syntax and types are checked, with assertions and without optimization.

Prints the first errors of each file that does not compile; exit status 1 if there is one, 77 if BUILD has no
compile_commands.json.
"""

import concurrent.futures
import json
import os
import posixpath
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

from check_tree import tracked

ROOT = Path(__file__).resolve().parent.parent.parent
SKIPPED = 77
FOLDERS = ("lcp/", "ncp/", "collection/", "contact/", "capi/", "petsc/", "app/")
KEPT = re.compile(r"-(D(?!NDEBUG)|U|I|W|w|std=|fvisibility)")  # hardly any options of code generation: a precompiled header fits more files
INCLUDED = re.compile(r'^#include "(.+)"$', re.M)


def options(command):
    """The compiler, and what it needs to know of a file but for its name."""
    words = iter(shlex.split(command))
    compiler = next(words)
    if posixpath.basename(compiler) == "ccache":
        compiler = next(words)
    out = []
    for word in words:
        if word in ("-isystem", "-I", "-D"):
            out += [word, next(words)]
        elif word in ("-include", "-o"):
            next(words)
        elif KEPT.match(word):
            out.append(word)
    return (compiler, *out)


def options_of_sources(build):
    """The tracked sources that BUILD compiles, those of its unity files included, and the options of each."""
    found = {}
    for entry in json.loads((build / "compile_commands.json").read_text(encoding="utf-8")):
        file = Path(entry["directory"], entry["file"])
        files = [file]
        if file.name.startswith("unity_") and build in file.parents:
            files = map(Path, INCLUDED.findall(file.read_text(encoding="utf-8")))
        for path in files:
            if path.is_relative_to(ROOT) and build not in path.parents:
                found.setdefault(path.relative_to(ROOT).as_posix(), options(entry["command"]))
    return found


def nearest(header, sources):
    """The C++ source that shares the most folders with the header; its options are the header's. None in other libraries."""
    shared = {name: len(posixpath.commonpath([header, name])) for name in sources if name.endswith(".cpp")}
    best = max(shared, key=shared.get, default=None)
    return best if best and shared[best] else None


class Compiler:
    def __init__(self, scratch):
        self.scratch = Path(scratch)
        self.precompiled = {}

    def precompile(self, every):
        """For each of the options, what comes before a file."""
        for known in every:
            first = self.scratch / str(len(self.precompiled)) / "first.hpp"
            first.parent.mkdir()
            first.write_text("#include <Eigen/Core>\n#include <Eigen/SparseCore>\n")
            self.precompiled[known] = first

        def make(known, first):
            return subprocess.run([*known, "-x", "c++-header", first, "-o", f"{first}.gch"], capture_output=True, text=True, errors="replace")

        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            for made in pool.map(make, *zip(*self.precompiled.items())):
                if made.returncode != 0:
                    sys.exit(made.stderr)

    def errors(self, file, known):
        if file.endswith((".c", ".h")):
            text, language = f'#include "{ROOT / file}"\n', ["-x", "c"]
            if file.endswith(".h"):
                known = ("cc", "-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror")
        else:
            text, language = f'#include "{ROOT / file}"\n', ["-include", self.precompiled[known], "-x", "c++"]
        run = subprocess.run([*known, "-fsyntax-only", *language, "-"], input=text, capture_output=True, text=True, errors="replace")
        if run.returncode == 0:
            return ""
        lines = [line for line in run.stderr.splitlines() if "error" in line] or run.stderr.splitlines()
        return f"{file}: does not compile alone\n  " + "\n  ".join(lines[:5])


def main():
    if len(sys.argv) < 3 or sys.argv[1] not in ("headers", "sources"):
        sys.exit(__doc__)
    build = Path(sys.argv[2]).resolve()
    if not (build / "compile_commands.json").is_file():
        print(f"skipped: there is no {build}/compile_commands.json")
        return SKIPPED
    sources = options_of_sources(build)
    asked = tuple(sys.argv[3:]) or FOLDERS
    if sys.argv[1] == "sources":
        files = {name: known for name, known in sources.items() if name.startswith(asked)}
    else:
        headers = [name for name in tracked(ROOT) if name.endswith((".hpp", ".h")) and name.startswith(asked)]
        files = {name: sources[near] for name in headers if (near := nearest(name, sources))}
    if not files:
        sys.exit(f"{build} compiles no file of {' '.join(asked)}")
    with tempfile.TemporaryDirectory() as scratch:
        compiler = Compiler(scratch)
        compiler.precompile({known for name, known in files.items() if not name.endswith((".c", ".h"))})
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            bad = [error for error in pool.map(compiler.errors, files, files.values()) if error]
    print(*bad, f"{len(files) - len(bad)} of {len(files)} {sys.argv[1]} compile alone", sep="\n")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
