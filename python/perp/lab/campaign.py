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

from .files import Environment, InputError, Journal, NotSeen, check_apart, crc_of, pretty, read_cells, take_folder, write_files
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


PROBLEM_FACTS = {"file": "file", "crc": "content (CRC)", "n": "size", "starts": "starts"}
FLAGS = ("tol", "time_limit", "memory_limit_mb", "restarts", "seed", "starts")


def facts(campaign):
    """{"methods" or the like: {name: {what: value}}}: what keeps cells apart. Jobs, build, machine and date may differ."""
    found = {group: {label: {} for label in campaign[group]} for group in ("variants",) if group in campaign}
    if "methods" in campaign:
        found["methods"] = {
            m["label"]: {"command": m.get("command", ""), **{f"option {k}": v for k, v in m["in_force"].items()}}
            for m in campaign["methods"]
        }
    known = {key: what for key, what in PROBLEM_FACTS.items() if key != "file" or "methods" in campaign}
    found["problems"] = {p["name"]: {what: p.get(key, "") for key, what in known.items()} for p in campaign["problems"]}
    flags = {f"--{key.removesuffix('_mb').replace('_', '-')}": campaign[key] for key in FLAGS if key in campaign}
    shards = parse_shard(campaign.get("shard"))[1]
    found[""] = {"": {**flags, "number of shards": shards, "version of perp": campaign["version"]}}
    return found


def differences(before, now):
    """What keeps cells of two campaigns apart, one line each."""

    def some(these, others):
        names = [name for name in these if name not in others]
        return ", ".join(names[:5]) + (f" and {len(names) - 5} more" if len(names) > 5 else "")

    lines, present = [], facts(now)
    for group, there in facts(before).items():
        here = present[group]
        for names, where in ((some(there, here), "there but not here"), (some(here, there), "here but not there")):
            lines += [f"{group} {where}: {names}"] if names else []
        for name in there.keys() & here.keys():
            for what, value in here[name].items():
                old = there[name].get(what, "(none)")
                if old != value:
                    lines.append(f"{what}{' of ' + name if name else ''}: {old} there, {value} here")
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
    """A kind of campaign has NAME, COMMAND, KEYS and FILES (of its report), USUAL (its options), and the methods that raise
    NotImplementedError here."""

    def __init__(self, words, interrupt):
        self.words, self.interrupt, self.out, self.program = words, interrupt, words.out, Program(words.program)
        self.campaign, self.open, self.failed = None, [], False

    @staticmethod
    def key(cell):
        """What tells a cell from others, in the order of KEYS."""
        raise NotImplementedError

    def asked(self, before):
        """campaign.json of the words of the command line; what they leave open is as in `before`, if there is one."""
        raise NotImplementedError

    def describe(self):
        """Completes a new campaign by what only processes can say."""

    def table(self):
        """{key: what make() gets} of all cells, in the order in which they run."""
        raise NotImplementedError

    def make(self, *what):
        """The finished cell. Raises NotSeen where there is none."""
        raise NotImplementedError

    def show(self, cells, complete):
        """Says and writes what came out; the exit code of a complete campaign."""
        raise NotImplementedError

    def values(self, before):
        """The options of USUAL: as given, else as before, else as usual."""
        given = vars(self.words)
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
        self.work_folder = os.path.join(os.path.abspath(self.out), "work")
        return self.work(Journal(self.out))

    def check_same(self, before):
        found = differences(before, self.campaign)
        shards = before.get("shard", "all"), self.campaign.get("shard", "all")
        if shards[0] != shards[1]:
            found.append(f"--shard: {shards[0]} there, {shards[1]} here")
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
        sizes = [count(len(self.campaign[name + "s"]), name) for name in ("method", "variant", "problem") if name + "s" in self.campaign]
        print(f"perp: {' x '.join(sizes)}: {count(len(table), 'cell')}{to_do}, {jobs} at a time", file=sys.stderr, flush=True)
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
        progress.end()
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
        self.begin, self.shown, self.shown_done, self.terminal = time.monotonic(), 0.0, len(cells), sys.stderr.isatty()

    def line(self, seconds, done):
        words = Counter(word_of(cell, self.unsolvable) for cell in list(self.cells.values()))
        numbers = {name: sum(words[word] for word in of) for name, of in GROUPS.items()}
        left = int(seconds / max(done - self.before, 1) * (self.total - done)) + 1
        parts = [f"{done}/{self.total}", *(f"{name} {n}" for name, n in numbers.items() if n)]
        if self.before < done < self.total:
            parts.append(f"{datetime.timedelta(seconds=left)} left" if left >= 60 else f"{left} s left")
        return "  ".join(parts)

    def tick(self):
        seconds, done = time.monotonic() - self.begin, len(self.cells)
        tenth = done * 10 // self.total > self.shown_done * 10 // self.total
        if self.terminal or tenth or seconds - self.shown >= 30:
            self.show(seconds, done)

    def show(self, seconds, done):
        self.shown, self.shown_done = seconds, done
        text, width = self.line(seconds, done), shutil.get_terminal_size().columns
        line = f"\r\033[K{text[: width - 1]}" if self.terminal else f"perp: {text}\n"
        print(line, end="", file=sys.stderr, flush=True)

    def end(self):
        if self.terminal:
            print("\r\033[K", end="", file=sys.stderr, flush=True)
        elif self.shown_done != len(self.cells):
            self.show(time.monotonic() - self.begin, len(self.cells))


def print_table(headers, rows):
    """Aligned; a header that begins with > has its column at the right."""
    names = [header.lstrip(">") for header in headers]
    widths = [max(len(line[k]) for line in [names, *rows]) for k in range(len(names))]
    for line in [names, ["-" * width for width in widths], *rows]:
        padded = (text.rjust(w) if header.startswith(">") else text.ljust(w) for text, w, header in zip(line, widths, headers))
        print("  ".join(padded).rstrip())
