# SPDX-License-Identifier: Apache-2.0
"""A campaign: cells of a table, each made by processes of its own and on the disk before the next one begins.

Campaign is what perp-compare and perp-compare contact have in common: DIR/campaign.json, which says what was asked for, the
journal, resuming, several cells at a time, progress, and cells that stay open where the machine has failed.
"""

import contextlib
import datetime
import importlib.util
import json
import os
import platform
import re
import shlex
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from difflib import get_close_matches

from .files import Environment, InputError, Journal, NotSeen, check_apart, pretty, read_cells, take_folder, write_files
from .process import run_all

SOLVED, UNSOLVED, REFUSED, INTERNAL, INTERRUPTED = range(5)


def suggestion(word, words):
    near = get_close_matches(word, words, 1)
    return f" Did you mean '{near[0]}'?" if near else ""


def count(n, noun, several=None):
    return f"{n} {noun if n == 1 else several or noun + 's'}"


def note(text):
    print(f"perp: note: {text}", file=sys.stderr)


def need_packages():
    """Before anything runs: what the report is made with is there."""
    missing = [name for name in ("matplotlib", "jinja2") if importlib.util.find_spec(name) is None]
    if missing:
        packages = " ".join(f"python3-{name}" for name in missing)
        elsewhere = "Debian has {}, pip install 'perp[lab]' elsewhere".format(packages)
        raise InputError(f"{sys.executable} has no {', '.join(missing)}: {elsewhere}")


class Program:
    """The program perp."""

    def __init__(self, path=None):
        wanted = path or os.environ.get("PERP_PROGRAM") or "perp"
        found = shutil.which(wanted)
        if found is None:
            raise InputError(f"there is no program '{wanted}': --program or the variable PERP_PROGRAM says where perp is")
        self.path = os.path.abspath(found)

    def json(self, *arguments):
        """What the program answers. Raises InputError with its words where it refuses."""
        run = subprocess.run([self.path, *arguments], stdin=subprocess.DEVNULL, capture_output=True, check=False)
        try:
            answer = json.loads(run.stdout)
        except ValueError:
            answer = {}
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
    system = platform.uname()
    return {"cpu": cpu, "cores": cores(), "memory_mb": memory, "system": f"{system.system} {system.release} {system.machine}"}


def cores():
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def now():
    return datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")


def read_campaign(folder, kind):
    """campaign.json, by whose key `kind.NAME` its kind is known."""
    path = os.path.join(folder, "campaign.json")
    try:
        with open(path, encoding="utf-8") as file:
            campaign = json.load(file)
        if kind.NAME not in campaign:
            raise InputError(f"{path}: no campaign of {kind.COMMAND}")
        if campaign[kind.NAME] != 1:
            raise InputError(f"{path}: written in format {campaign[kind.NAME]}, of another version")
        for key in ("tol", "time_limit"):
            if not isinstance(campaign[key], (int, float)):
                raise InputError(f"{path}: '{key}' is no number")
        if not all(isinstance(p["name"], str) and 1 <= p.get("starts", 1) <= 10_000 for p in campaign["problems"]):
            raise InputError(f"{path}: a problem has no name, or no starts")
    except OSError as error:
        raise InputError(f"'{path}' cannot be read") from error
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(f"{path}: no campaign: {error}") from error
    return campaign


def parse_shard(text):
    """(K, N) of "K/N"; "" is the whole."""
    match = re.fullmatch(r"(\d{1,6})/(\d{1,6})", text or "1/1", re.A)
    if not match or not 1 <= int(match[1]) <= int(match[2]) <= 100_000:
        raise InputError(f"--shard: '{text}' is no K/N with 1 <= K <= N <= 100000, such as 3/7")
    return int(match[1]), int(match[2])


#: What may differ between cells of one campaign; of files the content counts.
MAY_DIFFER = {"build", "libraries", "date", "command_line", "machine", "jobs", "shard", "file", "by_pattern"}


def by_name(items):
    return {item if isinstance(item, str) else item.get("label", item["name"]): item for item in items}


def differences(before, now, of=""):
    """What keeps cells of two campaigns apart, one line each: what campaign.json says, but for MAY_DIFFER."""
    lines = []
    for key, there in before.items():
        here = now.get(key, type(there)())
        if key in MAY_DIFFER:
            continue
        if isinstance(there, list):
            there, here = by_name(there), by_name(here)
            for names, where in ((there.keys() - here, "there but not here"), (here.keys() - there, "here but not there")):
                if names:
                    more = f" and {len(names) - 5} more" if len(names) > 5 else ""
                    lines.append(f"{key} {where}: {', '.join(sorted(names)[:5])}{more}")
            for name in [name for name in there if name in here and isinstance(there[name], dict)]:
                lines += differences(there[name], here[name], f" of {name}")
        elif isinstance(there, dict):
            lines += differences(there, here, of)
        elif there != here:
            what = key if of or key == "version" else "--" + key.removesuffix("_mb").replace("_", "-")
            lines.append(f"{what}{of}: {there} there, {here} here")
    return lines


class Interrupt:
    """SIGINT and SIGTERM end the campaign after what is on the disk; a second one ends the program."""

    def __init__(self):
        self.asked = False
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self.handle)

    def handle(self, number, _):
        signal.signal(number, signal.SIG_DFL)
        self.asked = True

    def __call__(self):
        return self.asked


class Campaign:
    """What a kind of campaign adds to this:

    NAME, COMMAND, KEYS, FILES   the key in campaign.json, the command, the columns of a cell, the files of the report
    USUAL           the options that campaign.json records, with their defaults
    key(cell)       what tells a cell from others, in the order of KEYS
    asked(before)   campaign.json by the words of the command line; what they leave open is as in `before`, if there is one
    describe()      completes a new campaign by what only processes can say
    table()         {key: what make() gets} of all cells, in the order in which they run
    make(...)       a finished cell; raises NotSeen where there is none
    show(cells, complete)   says and writes what came out; the exit code of a complete campaign
    """

    def __init__(self, words, interrupt):
        self.words, self.interrupt, self.out, self.program = words, interrupt, words.out, Program(words.program)
        self.campaign, self.open, self.failed = None, [], False
        self.work_folder = os.path.join(os.path.abspath(self.out), "work")

    def describe(self):
        pass

    def values(self, before):
        """The options of USUAL: as given, else as before, else as usual."""
        given = {**vars(self.words), "memory_limit_mb": self.words.memory_limit}
        return {key: (before or {}).get(key, usual) if given[key] is None else given[key] for key, usual in self.USUAL.items()}

    def stopped(self):
        return self.failed or self.interrupt()

    def run(self):
        resumed = self.words.resume and os.path.exists(os.path.join(self.out, "campaign.json"))
        before = read_campaign(self.out, type(self)) if resumed else None
        self.campaign = self.asked(before)
        if before:
            self.check_same(before)
        else:
            if self.words.resume:
                note(f"there is no campaign in '{self.out}' yet: one begins")
            self.describe()
        outputs = [os.path.join(self.out, name) for name in ("lock", "campaign.json", "cells.jsonl", *self.FILES)]
        check_apart(outputs, [getattr(self.words, "baseline", None), *(p.get("file") for p in self.campaign["problems"])])
        if self.stopped():
            print("perp: interrupted before the first cell", file=sys.stderr)
            return INTERRUPTED
        self.lock = take_folder(self.out, not before)
        if not before:
            write_files(self.out, {"campaign.json": pretty(self.campaign)})
        return self.work(Journal(self.out))

    def check_same(self, before):
        shards = ({"part": campaign.get("shard", "1/1")} for campaign in (before, self.campaign))
        found = differences(before, self.campaign) + differences(*shards, " of the cells (--shard)")
        if found:
            lines = "\n  ".join(found)
            how = f"'--out {self.out} --resume' alone goes on as it was begun, another --out begins anew"
            raise InputError(f"--resume: '{self.out}' holds a campaign that asks for something else:\n  {lines}\n{how}")

    def work(self, journal):
        cells, dropped = read_cells(self.out, type(self))
        for line in dropped:
            note(f"{self.out}/cells.jsonl, {line}: left out, its cell runs again")
        table = self.table()
        cells = {key: cell for key, cell in cells.items() if key in table}
        pending = [what for key, what in table.items() if key not in cells]
        jobs = self.words.jobs or self.campaign.get("jobs", 1)
        to_do = f", {len(pending)} of them to do" if cells else ""
        kinds = [kind for kind in ("method", "variant", "problem") if kind + "s" in self.campaign]
        sizes = " x ".join(count(len(self.campaign[kind + "s"]), kind) for kind in kinds)
        print(f"perp: {sizes}: {count(len(table), 'cell')}{to_do}, {jobs} at a time", file=sys.stderr, flush=True)
        unsolvable = {p["name"] for p in self.campaign["problems"] if not p.get("solvable", True)}
        progress = Progress(len(table), cells, unsolvable)
        shutil.rmtree(self.work_folder, ignore_errors=True)  # of a campaign that was killed

        def work(what):
            try:
                cell = self.make(*what)
                journal.add(cell)
                cells[self.key(cell)] = cell
            except NotSeen as why:
                self.open.append(str(why))
            except (Environment, OSError):
                self.failed = True
                raise

        try:
            run_all(jobs, work, pending, self.stopped, progress.tick)
        except (Environment, OSError) as error:
            self.open.append(str(error))
        progress.tick(last=True)
        shutil.rmtree(self.work_folder, ignore_errors=True)
        left = len(table) - len(cells)
        for why in dict.fromkeys(self.open[:5]):
            print(f"perp: a cell stays open: {why}", file=sys.stderr)
        code = self.show([cells[key] for key in sorted(cells)], not left)
        if not left:
            return code
        how = "interrupted" if self.interrupt() else f"{count(left, 'cell')} open"
        again = f"'{self.COMMAND} --out {shlex.quote(self.out)} --resume' goes on"
        print(f"perp: {how}; {len(cells)} of {count(len(table), 'cell')} are done. {again}", file=sys.stderr)
        return INTERRUPTED


# What is said on the way and in the end.


GROUPS = {
    "solved": ("solved", "infeasible"), "to rounding": ("solved-to-rounding",), "failed": ("failed", "unclaimed"),
    "false": ("false-convergence", "false-infeasible"), "limits": ("time-limit", "memory-limit"), "crashed": ("crashed",),
    "garbage": ("garbage",), "n/a": ("not-applicable",), "honest": ("honest",),
}  # fmt: skip


def word_of(cell, unsolvable):
    """Its outcome; who fails on a problem without a solution is honest."""
    return "honest" if cell["outcome"] == "failed" and cell["problem"] in unsolvable else cell["outcome"]


class Progress:
    """How far a campaign is: on a terminal one line that is rewritten, elsewhere a line now and then."""

    def __init__(self, total, cells, unsolvable):
        self.total, self.cells, self.unsolvable, self.before = max(total, 1), cells, unsolvable, len(cells)
        self.begin, self.shown, self.tenths, self.text = time.monotonic(), 0.0, -1, ""
        self.terminal = sys.stderr.isatty()

    def tick(self, last=False):
        seconds, done = time.monotonic() - self.begin, len(self.cells)
        tenths = done * 10 // self.total
        if not self.terminal and tenths == self.tenths and seconds - self.shown < 30 and not last:
            return
        self.shown, self.tenths = seconds, tenths
        words = Counter(word_of(cell, self.unsolvable) for cell in list(self.cells.values()))
        numbers = {name: sum(words[word] for word in of) for name, of in GROUPS.items()}
        text = "  ".join([f"{done}/{self.total}", *(f"{name} {n}" for name, n in numbers.items() if n)])
        if self.before < done < self.total:
            left = int(seconds / (done - self.before) * (self.total - done)) + 1
            text += f"  {datetime.timedelta(seconds=left)} left"
        width = shutil.get_terminal_size().columns
        line = f"\r\033[K{'' if last else text[: width - 1]}" if self.terminal else f"perp: {text}\n"
        print(line if line != self.text else "", end="", file=sys.stderr, flush=True)
        self.text = line


def print_table(headers, rows):
    """Aligned; a header that begins with > has its column at the right."""
    names = [header.lstrip(">") for header in headers]
    widths = [max(len(line[k]) for line in [names, *rows]) for k in range(len(names))]
    for line in [names, ["-" * width for width in widths], *rows]:
        padded = (text.rjust(w) if header.startswith(">") else text.ljust(w) for text, w, header in zip(line, widths, headers))
        print("  ".join(padded).rstrip())
