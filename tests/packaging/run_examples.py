#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The commands that texts show, run: run_examples.py PERP FILE.md...; also: run_examples.py PERP --pages.

A block ```console holds commands after "$ " and what they print. The lines shown have to come in the output in their
order, word by word; numbers within 0.1 %, or all below 1e-5. "..." stands for any lines, at the end of a line for its
rest, within a line for anything. Exit code 1 of perp (not solved) is as good as 0. A command with nothing shown may
print anything, but has to end with exit code 0.

--pages: every method of `perp methods` has a page in docs/, or is a variant (NAME-...) of one that has.
"""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
TINY = 1e-5
CLOSE = 1e-3


def commands(text):
    """(command, lines shown) of every console block."""
    for block in re.findall(r"^```console\n(.*?)^```", text, flags=re.M | re.S):
        for part in re.split(r"^\$ ", block, flags=re.M)[1:]:
            command, *shown = part.rstrip("\n").split("\n")
            yield command, shown


def same_word(shown, printed):
    try:
        a, b = float(shown), float(printed)
    except ValueError:
        return shown == printed
    return abs(a - b) <= CLOSE * max(abs(a), abs(b)) or max(abs(a), abs(b)) < TINY


def same_line(shown, printed):
    """Word by word; "..." is a pattern for any text."""
    if "..." in shown:
        head, *rest = (re.escape(piece.strip()) for piece in shown.split("..."))
        words = shown.split("...")[0].split()
        begins = len(words) <= len(printed.split()) and all(map(same_word, words, printed.split()))
        return begins and re.search(".*".join(["", *rest]), printed) is not None
    a, b = shown.split(), printed.split()
    return len(a) == len(b) and all(map(same_word, a, b))


def missing(shown, printed):
    """The first line shown that the output has not, or printed and not shown; None if the text is true."""
    at = 0
    gap = False  # whether lines may be skipped before the next one
    for line in shown:
        if line.strip() == "...":
            gap = True
            continue
        found = next((k for k in range(at, len(printed)) if same_line(line, printed[k])), None)
        if found is None or (found > at and not gap):
            return line
        at, gap = found + 1, False
    return None if gap or at == len(printed) else f"(the end, before) {printed[at]}"


def run_file(perp, path, folder):
    (Path(folder) / "data").symlink_to(ROOT / "data")
    environment = {**os.environ, "PATH": f"{Path(perp).resolve().parent}:{os.environ['PATH']}"}
    count = 0
    for command, shown in commands(path.read_text(encoding="utf-8")):
        count += 1
        shell = {"args": ["bash", "-c", command], "cwd": folder, "env": environment}
        run = subprocess.run(**shell, capture_output=True, text=True, timeout=60, check=False)
        line = missing(shown, run.stdout.splitlines()) if shown else None
        if run.returncode not in ((0, 1) if shown else (0,)):
            yield f"{path}: exit code {run.returncode}: {command}\n{run.stderr}"
        elif line is not None:
            yield f"{path}: {command}\n  shown: {line}\n  printed:\n{run.stdout}"
    if count == 0:
        yield f"{path}: shows no commands"


def pages(perp):
    """The methods without a page: no heading of docs/*/ has their name, nor that of the method they vary."""
    said = subprocess.run([perp, "methods"], capture_output=True, text=True, timeout=60, check=True).stdout
    names = re.findall(r"^  ([a-z][\w-]*)(?:  \(default\))?$", said.split("\nOptions:")[0], flags=re.M)
    headings = [page.read_text(encoding="utf-8").splitlines()[0] for page in (ROOT / "docs").glob("*/*.md")]
    known = {name.strip(" #") for heading in headings for name in heading.split(",")}
    for name in names:
        variants = {name[:at] for at in range(len(name) + 1) if name[at : at + 1] in ("-", "")}
        if known.isdisjoint(variants):
            yield f"docs: no page for method {name}"
    if not names:
        yield "perp methods: no names"


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    perp = sys.argv[1]
    wrong = []
    for name in sys.argv[2:]:
        if name == "--pages":
            wrong += pages(perp)
            continue
        with tempfile.TemporaryDirectory() as folder:
            wrong += run_file(perp, Path(name).resolve(), folder)
    print("\n".join(wrong), end="\n" if wrong else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
