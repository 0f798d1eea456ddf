# SPDX-License-Identifier: Apache-2.0
"""Common parts of the laboratory's commands: the program perp, the machine, options, Ctrl-C, progress, tables."""

import argparse
import contextlib
import json
import os
import platform
import re
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from difflib import get_close_matches

from .files import InputError

SOLVED, UNSOLVED, REFUSED, INTERNAL, INTERRUPTED = range(5)


def suggestion(word, words):
    near = get_close_matches(word, words, 1)
    return f" Did you mean '{near[0]}'?" if near else ""


def count(n, noun, several=None):
    return f"{n} {noun if n == 1 else several or noun + 's'}"


def note(text):
    print(f"perp: note: {text}", file=sys.stderr)


class Program:
    """The program perp."""

    def __init__(self, path=None):
        beside = os.path.join(os.path.dirname(os.path.abspath(sys.argv[0])), "perp")  # if it was installed with this
        wanted = path or os.environ.get("PERP_PROGRAM") or shutil.which(beside) or "perp"
        found = shutil.which(wanted)
        if found is None:
            where = "--program or the variable PERP_PROGRAM says where perp is"
            raise InputError(f"there is no program '{wanted}': {where}")
        self.path = os.path.abspath(found)

    def json(self, *arguments):
        """What the program answers. Raises InputError with its words where it refuses."""
        run = subprocess.run([self.path, *arguments], stdin=subprocess.DEVNULL, capture_output=True, check=False)
        answer = {}
        with contextlib.suppress(ValueError):
            answer = json.loads(run.stdout)
        if run.returncode not in (0, 1) or not answer:
            error = run.stderr.decode("utf-8", "replace").strip() or f"exit code {run.returncode}"
            raise InputError(answer.get("message", error).removeprefix("perp: "))
        return answer


def machine():
    cpu, memory = "unknown", 0
    with contextlib.suppress(OSError), open("/proc/cpuinfo", encoding="utf-8") as file:
        cpu = next((line.split(": ", 1)[1].strip() for line in file if line.startswith("model name")), cpu)
    with contextlib.suppress(OSError, ValueError, AttributeError):
        memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") >> 20
    of = platform.uname()
    return {"cpu": cpu, "cores": cores(), "memory_mb": memory, "system": f"{of.system} {of.release} {of.machine}"}


def cores():
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


# Options that commands have in common.


def between(low, high, kind=float, many=False):
    """Of a number, or of many with commas between them, which are sorted."""

    def check(text):
        values = sorted({kind(word) for word in (text.split(",") if many else [text])})
        if not all(low <= value <= high for value in values):
            raise argparse.ArgumentTypeError(f"{text}: a number from {low:g} to {high:g} is asked for")
        return values if many else values[0]

    check.__name__ = "list" if many else "number"
    return check


OPTIONS = {  # key in campaign.json: flag, word for its value, kind, help
    "tol": ("--tol", "TOL", between(1e-15, 1), "tolerance of the judge, and of methods whose options set none"),
    "time_limit": ("--time-limit", "SECONDS", between(0.01, 1e6), "wall-clock limit of a run"),
    "memory_limit_mb": ("--memory-limit", "MB", between(16, 1 << 32, int), "limit of the resident memory of a run"),
    "restarts": ("--restarts", "R", between(0, 1000, int), "after a failure, up to R runs from perturbed starts"),
    "seed": ("--seed", "N", between(0, 2**32 - 1, int), "seed of the perturbed starts"),
    "jobs": ("--jobs", "N", between(1, 1024, int), "number of runs at a time; with 1 their times can be compared"),
}


def add_options(parser, **usual):
    """`usual`: the defaults of some OPTIONS."""
    for key, default in usual.items():
        flag, metavar, kind, words = OPTIONS[key]
        words += " (%(default)g)"
        parser.add_argument(flag, dest=key, type=kind, metavar=metavar, default=default, help=words)
    where = "the program perp (PERP_PROGRAM, else perp beside this command or on the PATH)"
    parser.add_argument("--program", metavar="FILE", help=where)


def add_folder(parser, folder):
    shard = "run part K of N of the cells, each part in a DIR of its own; 'perp-report' joins the parts"
    baseline = "cells.csv or outcomes.csv of an earlier campaign: what is lost?"
    parser.add_argument("--shard", metavar="K/N", default="", help=shard)
    parser.add_argument("--baseline", metavar="FILE.csv", help=baseline)
    parser.add_argument("--out", default=folder, metavar="DIR", help="folder of the campaign (%(default)s)")
    parser.add_argument("--resume", action="store_true", help="go on with the campaign in DIR, with its options")


def parse_shard(text):
    """(K, N) of "K/N"; "" is the whole."""
    match = re.fullmatch(r"(\d{1,6})/(\d{1,6})", text or "1/1", re.A)
    if not match or not 1 <= int(match[1]) <= int(match[2]) <= 100_000:
        raise InputError(f"--shard: '{text}' is no K/N with 1 <= K <= N <= 100000, such as 3/7")
    return int(match[1]), int(match[2])


def interrupts():
    """Tells from now on whether SIGINT or SIGTERM has come; a second one ends the program."""
    asked = []

    def handle(number, _):
        signal.signal(number, signal.SIG_DFL)
        asked.append(number)

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, handle)
    return lambda: bool(asked)


# What is said on the way and in the end.


class Progress:
    """A line at each tenth of a campaign, and after half a minute."""

    def __init__(self, total, cells):
        self.total, self.cells, self.shown, self.tenths = max(total, 1), cells, 0.0, -1

    def tick(self):
        now, done = time.monotonic(), len(self.cells)
        tenths = done * 10 // self.total
        if tenths != self.tenths or now - self.shown > 30:
            self.shown, self.tenths = now, tenths
            words = Counter(cell["outcome"] for cell in list(self.cells.values()))
            text = "".join(f"  {word} {n}" for word, n in sorted(words.items()))
            print(f"perp: {done}/{self.total}{text}", file=sys.stderr, flush=True)


def print_table(headers, rows):
    """Aligned; a header that begins with > has its column at the right."""
    names = [header.lstrip(">") for header in headers]
    widths = [max(len(line[k]) for line in [names, *rows]) for k in range(len(names))]
    for line in [names, ["-" * width for width in widths], *rows]:
        columns = zip(headers, line, widths)
        print("  ".join(text.rjust(w) if head.startswith(">") else text.ljust(w) for head, text, w in columns).rstrip())
