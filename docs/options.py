#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints the options of methods as a Markdown table: options.py PERP [METHOD...] [KEY...].

The table follows from what the program says: the JSON of a run has the options of a method and their defaults, and
`perp methods` has their meaning. Without a METHOD: the options that all methods share. A KEY may have `*`; the table
then has the options that fit one of the keys, and no others.
"""

import fnmatch
import functools
import json
import re
import subprocess
import sys

# A small problem for any method, and one for those that take affine problems alone.
PROBLEMS = ("nash5", "cyclic3-own")


@functools.cache
def said(perp, *arguments):
    run = subprocess.run([perp, *arguments], capture_output=True, text=True, timeout=60, check=False)
    if run.returncode not in (0, 1):
        sys.exit(f"{perp} {' '.join(arguments)}: {run.stderr.strip()}")
    return run.stdout


def methods(perp):
    """The names that `perp methods` has before its options."""
    names = re.split(r"^Options", said(perp, "methods"), maxsplit=1, flags=re.M)[0]
    return re.findall(r"^  ([a-z][\w-]*)(?:  \(default\))?$", names, flags=re.M)


# What values an option takes stands on a line of its own, after the help and before the defaults; words may fill more.
DEFAULT = re.compile(r"^-;|; default |; for |; no effect on ")
WORDS = re.compile(r"[a-z-]+(, [a-z-]+)*,$")


def meanings(perp):
    """key -> (values, help). The defaults of each method are left out: the tables have them."""
    text = re.split(r"^Options", said(perp, "methods"), maxsplit=1, flags=re.M)[1]
    found = {}
    for key, block in re.findall(r"^  (\w+)(?: \([^)]*\))?\n((?:      .*\n?)+)", text, flags=re.M):
        lines = [line.strip() for line in block.splitlines()]
        at = next((k for k in range(1, len(lines)) if DEFAULT.search(lines[k])), len(lines))
        while at > 1 and WORDS.match(lines[at - 1]):
            at -= 1
        found[key] = (DEFAULT.split(" ".join(lines[at:]))[0], " ".join(lines[:at]))
    return found


def defaults(perp, method):
    """key -> default of the options in force for the method."""
    for problem in PROBLEMS:
        arguments = ["solve", problem, "--method", method, "--time-limit", "10", "--json", "-"]
        run = subprocess.run([perp, *arguments], capture_output=True, text=True, timeout=60, check=False)
        if run.returncode in (0, 1):
            options = json.loads(run.stdout)["options"]
            return {key: shown(value) for key, value in options.items() if key not in ("method", "time_limit")}
    sys.exit(f"{perp}: no problem for method {method}: {run.stderr.strip()}")


def shown(value):
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:g}" if isinstance(value, float) else str(value)


@functools.cache
def shared(perp):
    """The options that all methods have."""
    tables = [defaults(perp, method) for method in methods(perp)]
    return {key: value for key, value in tables[0].items() if all(key in table for table in tables)}


def cell(text):
    return re.sub(r"([|*_])", r"\\\1", text).replace("<", "&lt;")


def table(perp, words):
    """Makes the table for these methods and keys: of the options that not all methods share or, with no method, of those
    that all share."""
    what = meanings(perp)
    names = [word for word in words if word in methods(perp)]
    wanted = [word for word in words if word not in names]
    of = {name: defaults(perp, name) for name in names} or {"default": shared(perp)}
    common = shared(perp) if names else {}
    keys = dict.fromkeys(key for options in of.values() for key in options if key not in common)
    if wanted:
        keys = [key for key in keys if any(fnmatch.fnmatchcase(key, pattern) for pattern in wanted)]
        unused = [pattern for pattern in wanted if not fnmatch.filter(keys, pattern)]
        if unused:
            sys.exit(f"{perp}: no method and no option of {', '.join(of)}: {', '.join(unused)}")
    if not keys:
        return "It has no options of its own.\n"
    heads = ["default"] if len(of) == 1 else list(of)
    lines = [f"| option | {' | '.join(heads)} | values | meaning |", "|---" * (len(heads) + 3) + "|"]
    for key in keys:
        values = " | ".join(cell(options.get(key, "-")) for options in of.values())
        takes, meaning = what.get(key, ("", ""))
        lines.append(f"| `{key}` | {values} | {cell(takes)} | {cell(meaning)} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    print(table(sys.argv[1], sys.argv[2:]), end="")
