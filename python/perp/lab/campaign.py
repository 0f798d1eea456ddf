# SPDX-License-Identifier: Apache-2.0
"""A campaign: cells of a table, each made by processes of its own and on the disk before the next one begins.

Campaign is what perp-compare and perp-compare contact have in common: options, DIR/campaign.json, which says what was
asked for, the journal, resuming, several cells at a time, progress, and cells that stay open where the machine failed.
"""

import argparse
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

from .files import Environment, InputError, Journal, NotSeen, crc_of, pretty, read_cells, take_folder, write_files
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
    for name in ("matplotlib", "jinja2"):
        if importlib.util.find_spec(name) is None:
            where = f"Debian has python3-{name}, pip install 'perp[lab]' elsewhere"
            raise InputError(f"{sys.executable} has no {name}: {where}")


def beside(command):
    """Where perp is if it was installed with this command."""
    return os.path.join(os.path.dirname(os.path.abspath(command)), "perp")


class Program:
    """The program perp."""

    def __init__(self, path=None):
        wanted = path or os.environ.get("PERP_PROGRAM") or shutil.which(beside(sys.argv[0])) or "perp"
        found = shutil.which(wanted)
        if found is None:
            where = "--program or the variable PERP_PROGRAM says where perp is"
            raise InputError(f"there is no program '{wanted}': {where}")
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

    def version(self):
        return self.json("methods", "--json")["version"]


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


def between(low, high, kind=float):
    def check(text):
        value = kind(text)
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(f"{text}: a number from {low:g} to {high:g} is asked for")
        return value

    check.__name__ = "number"
    return check


OPTIONS = {  # flag: key in campaign.json, word for its value, kind
    "--tol": ("tol", "TOL", between(1e-15, 1)),
    "--time-limit": ("time_limit", "SECONDS", between(0.01, 1e6)),
    "--memory-limit": ("memory_limit_mb", "MB", between(16, 1 << 32, int)),
    "--restarts": ("restarts", "R", between(0, 1000, int)),
    "--seed": ("seed", "N", between(0, 2**32 - 1, int)),
    "--jobs": ("jobs", "N", between(1, 1024, int)),
}


def add_options(parser, *options):
    """`options`: (flag of OPTIONS, default, help)."""
    for flag, usual, words in options:
        dest, metavar, kind = OPTIONS[flag]
        words += "" if words.endswith(")") else " (%(default)g)"
        parser.add_argument(flag, dest=dest, type=kind, metavar=metavar, default=usual, help=words)
    parser.add_argument("--program", metavar="FILE", help="the program perp (PERP_PROGRAM, else perp beside this command or on the PATH)")


def parse_shard(text):
    """(K, N) of "K/N"; "" is the whole."""
    match = re.fullmatch(r"(\d{1,6})/(\d{1,6})", text or "1/1", re.A)
    if not match or not 1 <= int(match[1]) <= int(match[2]) <= 100_000:
        raise InputError(f"--shard: '{text}' is no K/N with 1 <= K <= N <= 100000, such as 3/7")
    return int(match[1]), int(match[2])


# Parts that two campaigns have in common.


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
    except OSError as error:
        raise InputError(f"'{path}' cannot be read") from error
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(f"{path}: no campaign: {error}") from error
    return campaign


#: What may differ between cells of one campaign; of files the content counts.
MAY_DIFFER = {"build", "libraries", "date", "command_line", "machine", "jobs", "file"}


def flat(value, place=()):
    """{place: value} of what campaign.json says; items of a list by their names."""
    if isinstance(value, dict):
        items = value.items()
    elif isinstance(value, list):
        items = ((one, "there") if isinstance(one, str) else (one.get("label", one["name"]), one) for one in value)
    else:
        return {place: value} if value != "" else {}
    return {k: v for key, item in items if key not in MAY_DIFFER for k, v in flat(item, (*place, key)).items()}


def differences(before, now):
    """What keeps cells of two campaigns apart, one line each; `before` may tell more of a problem."""
    there, here = flat(before), flat(now)
    items = {place[:2] for place in here}
    places = sorted(place for place in there | here if place in here or place[:2] not in items)
    apart = [place for place in places if there.get(place) != here.get(place)]
    first = {place[:2]: place for place in reversed(apart)}.values()  # of a method or problem one line is enough
    return sorted(
        f"{' of '.join(reversed(at))}: {there.get(at, 'not')} there, {here.get(at, 'not')} here" for at in first
    )


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

    NAME, COMMAND, KEYS   the key in campaign.json, the command, the columns of a cell
    OPTIONS, LISTS  the options that campaign.json records, and those that say which problems and methods
    parser()        of the command line
    key(cell)       what tells a cell from others, in the order of KEYS
    asked()         campaign.json by the words of the command line
    describe()      completes a new campaign by what only processes can say
    table()         {key: what make() gets} of all cells, in the order in which they run
    make(...)       a finished cell; raises NotSeen where there is none
    show(cells, complete)   says and writes what came out; the exit code of a complete campaign
    """

    def __init__(self, arguments, interrupt):
        self.arguments, self.interrupt, self.open, self.failed = arguments, interrupt, [], False
        parser = self.parser()
        self.words, self.before = parser.parse_args(arguments), None
        self.out = self.words.out
        if self.words.resume and os.path.exists(os.path.join(self.out, "campaign.json")):
            self.before = read_campaign(self.out, type(self))
            parser.set_defaults(**{key: self.before[key] for key in self.OPTIONS if key in self.before})
            self.words = parser.parse_args(arguments)
        self.program = Program(self.words.program)
        self.work_folder = os.path.join(os.path.abspath(self.out), "work")

    @staticmethod
    def add_folder(parser, folder):
        parser.add_argument("--out", default=folder, metavar="DIR", help="folder of the campaign (%(default)s)")
        parser.add_argument("--resume", action="store_true", help="go on with the campaign in DIR, with its options")

    def describe(self):
        pass

    def options(self):
        return {key: getattr(self.words, key) for key in self.OPTIONS}

    def stopped(self):
        return self.failed or self.interrupt()

    def run(self):
        if self.before:
            self.check_same(self.before)
        elif self.words.resume and not any(getattr(self.words, key) for key in self.LISTS):
            raise InputError(f"--resume: there is no campaign in '{self.out}'")
        self.campaign = self.before or self.asked()
        if not self.before:
            self.describe()
        if self.stopped():
            print("perp: interrupted before the first cell", file=sys.stderr)
            return INTERRUPTED
        self.lock = take_folder(self.out, not self.before)
        if not self.before:
            write_files(self.out, {"campaign.json": pretty(self.campaign)})
        return self.work(Journal(self.out))

    def check_same(self, before):
        """The words ask for nothing else than those that began the campaign, and its files are what they were."""
        if any(getattr(self.words, key) for key in self.LISTS):
            now = self.asked()
        else:
            problems = [{**p, "crc": crc_of(p["file"])} if "file" in p else p for p in before["problems"]]
            now = {**before, **self.options(), "version": self.program.version(), "problems": problems}
        if found := differences(before, now):
            lines = "\n  ".join(found)
            how = f"'--out {self.out} --resume' alone goes on as it was begun, another --out begins anew"
            raise InputError(f"--resume: '{self.out}' holds a campaign that asks for something else:\n  {lines}\n{how}")
        paths = {p["name"]: {"file": p["file"]} for p in now["problems"] if "file" in p}  # a file may move
        before["problems"] = [{**p, **paths.get(p["name"], {})} for p in before["problems"]]

    def work(self, journal):
        cells, dropped = read_cells(self.out, type(self))
        for line in dropped:
            note(f"{self.out}/cells.jsonl, {line}: left out, its cell runs again")
        table, jobs = self.table(), self.words.jobs
        cells = {key: cell for key, cell in cells.items() if key in table}
        pending = [what for key, what in table.items() if key not in cells]
        kinds = [kind for kind in ("method", "variant", "problem") if kind + "s" in self.campaign]
        sizes = " x ".join(count(len(self.campaign[kind + "s"]), kind) for kind in kinds)
        to_do = f", {len(pending)} of them to do" if cells else ""
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


def word_of(cell, unsolvable):
    """Its outcome; who fails on a problem without a solution is honest."""
    return "honest" if cell["outcome"] == "failed" and cell["problem"] in unsolvable else cell["outcome"]


class Progress:
    """A line at each tenth of a campaign, and after half a minute."""

    def __init__(self, total, cells, unsolvable):
        self.total, self.cells, self.unsolvable, self.before = max(total, 1), cells, unsolvable, len(cells)
        self.begin, self.shown, self.tenths = time.monotonic(), 0.0, -1

    def tick(self, last=False):
        seconds, done = time.monotonic() - self.begin, len(self.cells)
        tenths = done * 10 // self.total
        if tenths == self.tenths and seconds - self.shown < 30 and not (last and done < self.total):
            return
        self.shown, self.tenths = seconds, tenths
        words = Counter(word_of(cell, self.unsolvable) for cell in list(self.cells.values()))
        text = "  ".join([f"perp: {done}/{self.total}", *(f"{word} {n}" for word, n in sorted(words.items()))])
        if self.before < done < self.total:
            left = int(seconds / (done - self.before) * (self.total - done)) + 1
            text += f"  {datetime.timedelta(seconds=left)} left"
        print(text, file=sys.stderr, flush=True)


def print_table(headers, rows):
    """Aligned; a header that begins with > has its column at the right."""
    names = [header.lstrip(">") for header in headers]
    widths = [max(len(line[k]) for line in [names, *rows]) for k in range(len(names))]
    for line in [names, ["-" * width for width in widths], *rows]:
        columns = zip(headers, line, widths)
        print("  ".join(text.rjust(w) if head.startswith(">") else text.ljust(w) for head, text, w in columns).rstrip())
