# SPDX-License-Identifier: Apache-2.0
"""A campaign: cells, each made by processes of its own and on the disk before the next one begins.

DIR/campaign.json says what was asked for, DIR/cells.jsonl is the journal of what is finished. A cell stays open where
the machine failed.
"""

import argparse
import csv
import datetime
import os
import shlex
import shutil
import sys

from .campaign import (
    INTERRUPTED, SOLVED, UNSOLVED, Program, Progress, add_folder, add_options, cores, count, interrupts, machine,
    note, parse_shard, print_table,
)  # fmt: skip
from .cells import KEYS, OUTCOMES, CellRunner, good, is_failure, outcome_counts, settle
from .files import (
    Environment, InputError, Journal, NotSeen, crc_of, key_of, pretty, read_campaign, read_cells, take_folder,
    write_files,
)  # fmt: skip
from .lists import external_methods, select_methods, select_problems
from .process import run_all

WORDS = """\
PROBLEMS is a comma-separated list of NAME, NAME:SIZE, class:CLASS, FILE.nl, FILE.dat and all.
METHODS is a comma-separated list of NAME, NAME:key=value:key=value, presets, published, all, none and:
  cfunctions       semismooth with every C-function
  cfunction-grid   the C-functions that have a parameter, each at 4 or 5 values of it
Options follow these words, too: presets:max_iterations=50. Names may contain * and ?. An item that begins with - is
taken out of the list.

Examples:
  perp-compare --problems all,-class:pde --methods path,miles,semismooth:tol=1e-9 --starts 1
  perp-compare --problems 'models/*.nl' --external 'peer=./peer tol={tol}' --out peers
  perp-compare --out peers --resume                     after Ctrl-C, kill -9, a full disk or a power cut
  perp-compare contact --help                           variants on problems of contact with friction
  perp-compare forces|facets|ball --help                friction drawn; polygons in place of friction disks

A cell is one method on one problem from one start, in a process of its own. In the end DIR has report.html,
report.json and cells.csv; outcomes.csv has no times, so that cmp compares two campaigns.

Exit codes: 0 complete, 1 complete but something that the baseline solved is not solved, 2 wrong usage or input,
3 internal error, 4 interrupted, or cells are open (--resume goes on)."""


def all_or_number(text):
    if text != "all" and not (text.isdecimal() and int(text) > 0):
        raise argparse.ArgumentTypeError(f"'{text}': 'all', or how many of each problem at most, from 1")
    return text if text == "all" else int(text)


class Comparison:
    """Methods x problems x starts. A kind of comparison differs by what is before __init__, and by items()."""

    COMMAND, RUNNER, KIND = "perp-compare", CellRunner, {}
    OPTIONS = ("tol", "time_limit", "memory_limit_mb", "restarts", "seed", "starts", "shard", "jobs")
    LISTS = ("problems", "methods", "external")  # the options that say what is compared

    @classmethod
    def parser(cls):
        parser = argparse.ArgumentParser(prog=cls.COMMAND, epilog=WORDS, allow_abbrev=False)
        parser.formatter_class = argparse.RawDescriptionHelpFormatter
        parser.description = "Compares methods on many problems: a campaign and its report."
        starts = "all starts of each problem, or at most K (%(default)s)"
        external = "add a program that AMPL could call, as 'COMMAND stub -AMPL'; {tol} in COMMAND is the tolerance"
        add = parser.add_argument
        add("--problems", metavar="PROBLEMS", help="which problems (all of the collection)")
        add("--methods", metavar="METHODS", help="which methods (presets)")
        add("--starts", metavar="all|K", default="all", type=all_or_number, help=starts)
        add("--external", action="append", default=[], metavar="NAME=COMMAND", help=external + "; may be repeated")
        add_options(parser, tol=1e-6, time_limit=60.0, memory_limit_mb=4096, restarts=0, seed=1, jobs=cores())
        add_folder(parser, "comparison")
        return parser

    def items(self):
        """The methods and the problems that the words ask for."""
        words = self.words
        methods = select_methods(words.methods or "presets", words.tol, self.program)
        methods += external_methods(words.external, self.program)
        if not methods:
            raise InputError("--methods: nothing is left")
        return methods, select_problems(words.problems or "all", words.starts, self.program)

    def __init__(self, arguments):
        self.arguments, self.interrupt, self.open, self.failed = arguments, interrupts(), [], False
        parser = self.parser()
        self.words, self.before = parser.parse_args(arguments), None
        self.out = self.words.out
        if self.words.resume and os.path.exists(os.path.join(self.out, "campaign.json")):
            self.before = read_campaign(self.out)
            self.begun = parser.parse_args(self.before["command_line"][1:])
            parser.set_defaults(**{key: self.before.get(key, "") for key in self.OPTIONS})
            self.words = parser.parse_args(arguments)
        self.program = Program(self.words.program)

    def stopped(self):
        return self.failed or self.interrupt()

    def run(self):
        words = self.words
        if words.baseline and words.shard:
            raise InputError("--baseline: compares all cells, --shard runs some of them")
        self.baseline = read_baseline(words.baseline) if words.baseline else {}
        if self.before:
            self.check_same(self.before)
        elif words.resume and not any(getattr(words, key) for key in self.LISTS):
            raise InputError(f"--resume: there is no campaign in '{self.out}'")
        self.campaign = self.before or self.asked()
        self.lock = take_folder(self.out, not self.before)
        if not self.before:
            write_files(self.out, {"campaign.json": pretty(self.campaign)})
        return self.work(Journal(self.out))

    def asked(self):
        """campaign.json by the words of the command line."""
        parse_shard(self.words.shard)
        methods, problems = self.items()
        program = self.program.json("methods", "--json")
        head = {"program": "perp", "version": program["version"], "campaign": 1, "build": crc_of(self.program.path)}
        date = datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
        head |= {"libraries": program["libraries"], "date": date, "command_line": [self.COMMAND, *self.arguments]}
        options = {key: value for key in self.OPTIONS if (value := getattr(self.words, key)) != ""}
        return {**head, "machine": machine(), **options, **self.KIND, "methods": methods, "problems": problems}

    def check_same(self, before):
        """The words ask for nothing else than those that began the campaign, and its files are what they were."""
        pairs = [(key, before.get(key, ""), getattr(self.words, key)) for key in self.OPTIONS if key != "jobs"]
        given = [key for key in self.LISTS if getattr(self.words, key)]
        pairs += [(key, getattr(self.begun, key), getattr(self.words, key)) for key in given]
        pairs += [(f"crc of {p['name']}", p["crc"], crc_of(p["file"])) for p in before["problems"] if "file" in p]
        pairs.append(("version", before["version"], self.program.json("methods", "--json")["version"]))
        if found := [f"{what}: {there} there, {here} here" for what, there, here in pairs if there != here]:
            lines = "\n  ".join(found)
            how = f"'--out {self.out} --resume' alone goes on as it was begun, another --out begins anew"
            raise InputError(f"--resume: '{self.out}' holds a campaign that asks for something else:\n  {lines}\n{how}")
        here = {"build": crc_of(self.program.path), "machine": machine()["cpu"], "number of jobs": self.words.jobs}
        for what, there in zip(here, (before["build"], before["machine"]["cpu"], before["jobs"])):
            if there != here[what]:
                note(f"the other cells are of another {what}: times do not compare")
        before["jobs"] = self.words.jobs

    def table(self):
        """{key: what makes it} of the shard's cells, problem by problem, so that what is seen first is comparable."""
        campaign = self.campaign
        number, of = parse_shard(campaign.get("shard"))
        starts = [(p, s) for p in campaign["problems"] for s in range(1, p["starts"] + 1)]
        cells = [(m, p, s) for p, s in starts for m in campaign["methods"]]
        return {(m["label"], p["name"], s): (m, p, s) for m, p, s in cells[number - 1 :: of]}

    def work(self, journal):
        cells, dropped = read_cells(self.out)
        for line in dropped:
            note(f"{self.out}/cells.jsonl, {line}: left out, its cell runs again")
        table, jobs = self.table(), self.words.jobs
        cells = {key: cell for key, cell in cells.items() if key in table}
        pending = [what for key, what in table.items() if key not in cells]
        sizes = " x ".join(count(len(self.campaign[kind + "s"]), kind) for kind in ("method", "problem"))
        to_do = f", {len(pending)} of them to do" if cells else ""
        print(f"perp: {sizes}: {count(len(table), 'cell')}{to_do}, {jobs} at a time", file=sys.stderr, flush=True)
        progress = Progress(len(table), cells)
        work_folder = os.path.join(os.path.abspath(self.out), "work")
        shutil.rmtree(work_folder, ignore_errors=True)  # of a campaign that was killed
        runner = self.RUNNER(self.campaign, self.program, work_folder, self.stopped)

        def work(what):
            try:
                cell = runner.cell(*what)
                journal.add(cell)
                cells[key_of(cell)] = cell
            except (Environment, OSError) as why:
                self.open.append(str(why))
                self.failed |= not isinstance(why, NotSeen)  # the others stop, too

        run_all(jobs, work, pending, self.stopped, progress.tick)
        progress.tick()
        shutil.rmtree(work_folder, ignore_errors=True)
        for why in dict.fromkeys(self.open[:5]):
            print(f"perp: a cell stays open: {why}", file=sys.stderr)
        if left := len(table) - len(cells):
            how = "interrupted" if self.interrupt() else f"{count(left, 'cell')} open"
            again = f"'{self.COMMAND} --out {shlex.quote(self.out)} --resume' goes on"
            print(f"perp: {how}; {len(cells)} of {count(len(table), 'cell')} are done. {again}", file=sys.stderr)
            return INTERRUPTED
        return self.show([cells[key] for key in sorted(cells)])

    def show(self, cells):
        """Writes the report of a complete campaign, and says what came out; the exit code."""
        from .report import write_report

        found, out = dict(write_report(self.out)), self.out
        if shard := self.campaign.get("shard"):
            print(f"Shard {shard} is complete. 'perp-report DIR... --out JOINED' joins the folders of all.")
            return SOLVED
        settle(self.campaign, cells)
        print_outcomes(self.campaign, cells)
        print(f"\nFalse claims: {found['False claims']}")
        print(f"\n{out}/report.html shows and {out}/findings.txt says what came out; {out}/cells.csv has every cell.")
        return against_baseline(self.words.baseline, self.baseline, cells) if self.words.baseline else SOLVED


def print_outcomes(campaign, cells):
    occur, counts = outcome_counts(campaign, cells)
    rows, restarts = [], campaign["restarts"] > 0
    solvable = {p["name"] for p in campaign["problems"] if p["solvable"]}
    for label, numbers in counts.items():
        mine = [cell for cell in cells if cell["method"] == label]
        left = sum(is_failure(c["outcome_after_restarts"]) for c in mine if c["problem"] in solvable)
        numbers = [*numbers, *[left] * restarts]
        rows.append([label, *(str(n or ".") for n in numbers), f"{sum(cell['seconds'] for cell in mine):.1f}"])
    print_table(["method", *(f">{w}" for w in occur), *[">failures after restarts"] * restarts, ">seconds"], rows)
    if "infeasible" in occur or "honest" in occur:
        print("\nOf problems that have no solution: infeasible, it says so; honest, it does not claim one.")


# Baselines.


def read_baseline(path):
    """{(method, problem, start): outcome} of a cells.csv or outcomes.csv."""
    try:
        with open(path, encoding="utf-8-sig", newline="") as file:
            records = [[one[name] for name in KEYS[:4]] for one in csv.DictReader(file, strict=True)]
        if not records or not all(outcome in OUTCOMES for *_, outcome in records):
            raise ValueError("no outcomes of a comparison")
        return {(method, problem, int(start)): outcome for method, problem, start, outcome in records}
    except OSError as error:
        raise InputError(f"--baseline: '{path}': {error.strerror}") from error
    except (KeyError, ValueError, csv.Error) as error:
        raise InputError(f"--baseline: '{path}' is no cells.csv or outcomes.csv: {error}") from error


def against_baseline(path, baseline, cells):
    """Nothing that was solved may become unsolved."""
    pairs = [(cell, baseline[key], cell["outcome"]) for cell in cells if (key := key_of(cell)) in baseline]
    gained = sum(good(now) and not good(before) for _, before, now in pairs)
    lost = [
        [cell["method"], cell["problem"], str(cell["start"]), before, now, cell["message"]]
        for cell, before, now in pairs
        if good(before) and (not good(now) or (before, now) == ("solved", "infeasible"))
    ]
    numbers = f"{len(lost)} solved there and not here, {gained} here and not there"
    print(f"\nAgainst {path}: {count(len(pairs), 'cell')} compared, {numbers}.")
    if lost:
        print()
        print_table(["regression", "problem", ">start", "was", "is", "because"], lost)
    return UNSOLVED if lost else SOLVED
