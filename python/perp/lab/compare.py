# SPDX-License-Identifier: Apache-2.0
"""perp-compare: a campaign of methods x problems x starts. perp-report: its report, and shards joined."""

import argparse
import csv
import datetime
import sys

from .campaign import (
    INTERRUPTED, REFUSED, SOLVED, UNSOLVED, Campaign, Interrupt, add_options, cores, count, differences, machine,
    need_packages, note, parse_shard, print_table, read_campaign, word_of,
)  # fmt: skip
from .cells import KEYS, OUTCOMES, CellRunner, good, is_failure, settle, source_of
from .files import Environment, InputError, cell_line, crc_of, pretty, read_cells, take_folder, write_files
from .lists import described, external_methods, select_methods, select_problems
from .process import run_all

COMPARE_WORDS = """\
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
  perp-compare --problems all --shard 3/7 --out part3   the third of seven parts
  perp-compare contact --help                           variants on problems of contact with friction
  perp-compare facets --help                            what polygons cost in place of friction disks
  perp-compare ball --help                              the path of a ball by polygons and by Coulomb's law
  perp-compare forces --help                            the forces of a solution, drawn in their friction disks

A cell is one method on one problem from one start. It runs in a process of its own, with limits of time and
memory. The judge, another process, builds the problem anew and evaluates the natural residual at the point found.
Every finished cell is on the disk at once. If the machine fails (a full disk, a judge that is killed), the cell stays
open, and --resume runs it again. In the end DIR has report.html, cells.csv and cells.json. outcomes.csv has no times,
so two campaigns can be compared with cmp.

Exit codes: 0 complete, 1 complete but something that the baseline solved is not solved, 2 wrong usage or input,
3 internal error, 4 interrupted, or cells are open (--resume goes on)."""


def all_or_number(text):
    if text != "all" and not (text.isdecimal() and int(text) > 0):
        raise argparse.ArgumentTypeError(f"'{text}': 'all', or how many of each problem at most, from 1")
    return text if text == "all" else int(text)


class Comparison(Campaign):
    NAME, COMMAND, KEYS = "campaign", "perp-compare", KEYS
    OPTIONS = ("tol", "time_limit", "memory_limit_mb", "restarts", "seed", "starts", "shard", "jobs")
    LISTS = ("problems", "methods", "external")

    @classmethod
    def parser(cls):
        parser = argparse.ArgumentParser(prog=cls.COMMAND, epilog=COMPARE_WORDS, allow_abbrev=False)
        parser.formatter_class = argparse.RawDescriptionHelpFormatter
        parser.description = "Compares methods on many problems: a campaign and its report."
        starts = "all starts of each problem, or at most K (%(default)s)"
        shard = "run part K of N of the cells, each part in a DIR of its own; 'perp-report' joins the parts"
        external = "add a program that AMPL could call, as 'COMMAND stub -AMPL'; {tol} in COMMAND is the tolerance"
        add = parser.add_argument
        add("--problems", metavar="PROBLEMS", help="which problems (all of the collection)")
        add("--methods", metavar="METHODS", help="which methods (presets)")
        add("--starts", metavar="all|K", default="all", type=all_or_number, help=starts)
        add("--shard", metavar="K/N", default="", help=shard)
        add("--baseline", metavar="FILE.csv", help="cells.csv or outcomes.csv of an earlier campaign: what is lost?")
        add("--external", action="append", default=[], metavar="NAME=COMMAND", help=external + "; may be repeated")
        add_options(
            parser,
            ("--tol", 1e-6, "tolerance of the judge, and of the methods unless their options set one"),
            ("--time-limit", 60.0, "wall-clock limit of a run"),
            ("--memory-limit", 4096, "limit of the resident memory of a run"),
            ("--restarts", 0, "after a failure, up to R runs from perturbed starts"),
            ("--seed", 1, "seed of the perturbed starts"),
            ("--jobs", cores(), "number of runs at a time (one for each core)"),
        )
        cls.add_folder(parser, "comparison")
        return parser

    @staticmethod
    def key(cell):
        return cell["method"], cell["problem"], cell["start"]

    def asked(self):
        words, notes = self.words, []
        parse_shard(words.shard)
        methods = select_methods(words.methods or "presets", words.tol, self.program, notes)
        methods += external_methods(words.external, self.program)
        if not methods:
            raise InputError("--methods: nothing is left")
        problems = select_problems(words.problems or "all", words.starts, self.program)
        if self.before:  # without files that were refused when it began, or that have come since
            begun = {p["name"] for p in self.before["problems"]}
            problems = [p for p in problems if p["name"] in begun or "file" not in p]
        for text in () if self.before else notes:
            note(text)
        program = self.program.json("methods", "--json")
        head = {"program": "perp", "version": program["version"], self.NAME: 1, "build": crc_of(self.program.path)}
        date = datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
        head |= {"libraries": program["libraries"], "date": date, "command_line": [self.COMMAND, *self.arguments]}
        campaign = {**head, "machine": machine(), **self.options(), "methods": methods, "problems": problems}
        if not campaign["shard"]:
            del campaign["shard"]
        return campaign

    def check_same(self, before):
        super().check_same(before)
        jobs = count(before["jobs"], "run")
        for same, text in (
            (before["build"] == crc_of(self.program.path), "the program is another build than that of the other cells"),
            (
                before["machine"]["cpu"] == machine()["cpu"],
                "another machine made the other cells: times do not compare",
            ),
            (
                before["jobs"] == self.words.jobs,
                f"begun with {jobs}, now {self.words.jobs} at a time: times do not compare",
            ),
        ):
            if not same:
                note(text)
        before["jobs"] = self.words.jobs

    def run(self):
        if self.words.baseline and self.words.shard:
            raise InputError("--baseline: compares all cells, --shard runs some of them")
        self.baseline = read_baseline(self.words.baseline) if self.words.baseline else {}
        return super().run()

    def describe(self):
        """Of problems of a size, and files."""
        runner, refused = CellRunner(self.campaign, self.program, stopped=self.stopped), {}

        def describe(problem):
            source = source_of(problem)
            answer = runner.judge(source, source)
            if "residual" in answer:
                problem.update(described(answer, self.campaign["starts"]))
            elif problem.get("file"):
                refused[problem["name"]] = answer["message"]
            else:
                raise InputError(answer["message"])

        problems = self.campaign["problems"]
        run_all(self.campaign["jobs"], describe, [p for p in problems if "n" not in p], self.stopped)
        for name, why in refused.items():
            note(f"{name} is left out: {why}")
        problems[:] = [p for p in problems if p["name"] not in refused]
        if not problems:
            raise InputError("--problems: every file is refused")

    def table(self):
        """Problem by problem, so that what is seen first is comparable; of a shard, its own."""
        campaign = self.campaign
        number, of = parse_shard(campaign.get("shard"))
        starts = [(p, s) for p in campaign["problems"] for s in range(1, p["starts"] + 1)]
        cells = [(m, p, s) for p, s in starts for m in campaign["methods"]]
        self.make = CellRunner(campaign, self.program, self.work_folder, self.stopped).cell
        return {(m["label"], p["name"], s): (m, p, s) for m, p, s in cells[number - 1 :: of]}

    def show(self, cells, complete):
        from .report import write_report

        if not complete:
            return INTERRUPTED
        found = dict(write_report(self.out))
        if self.campaign.get("shard"):
            shard = self.campaign["shard"]
            print(f"Shard {shard} is complete. 'perp-report DIR... --out JOINED' joins the folders of all.")
            return SOLVED
        settle(self.campaign, cells)
        print_outcomes(self.campaign, cells)
        print(f"\nFalse claims: {found['False claims']}")
        out = self.out
        print(f"\n{out}/report.html shows and {out}/findings.txt says what came out; {out}/cells.csv has every cell.")
        return against_baseline(self.words.baseline, self.baseline, cells) if self.words.baseline else SOLVED


def print_outcomes(campaign, cells):
    unsolvable = {p["name"] for p in campaign["problems"] if not p["solvable"]}
    word = {id(cell): word_of(cell, unsolvable) for cell in cells}
    occur = [w for w in (*OUTCOMES, "honest") if w in word.values()]
    rows, restarts = [], campaign["restarts"] > 0
    for label in (m["label"] for m in campaign["methods"]):
        mine = [cell for cell in cells if cell["method"] == label]
        numbers = [sum(word[id(cell)] == w for cell in mine) for w in occur]
        if restarts:
            numbers.append(sum(word[id(c)] != "honest" and is_failure(c["outcome_after_restarts"]) for c in mine))
        rows.append([label, *(str(n or ".") for n in numbers), f"{sum(cell['seconds'] for cell in mine):.1f}"])
    print_table(["method", *(f">{w}" for w in occur), *[">failures after restarts"] * restarts, ">seconds"], rows)
    said = {"infeasible": "infeasible, it says so", "honest": "honest, it does not claim one"}
    if parts := [said[w] for w in said if w in occur]:
        print("\nOf problems that have no solution: " + "; ".join(parts) + ".")


# Baselines and shards.


def read_baseline(path):
    """{(method, problem, start): outcome} of a cells.csv or outcomes.csv."""
    try:
        with open(path, encoding="utf-8-sig", newline="") as file:
            records = [[one[name].removeprefix("'") for name in KEYS[:4]] for one in csv.DictReader(file, strict=True)]
        if not records or not all(outcome in OUTCOMES for *_, outcome in records):
            raise ValueError("no outcomes of a comparison")
        return {(method, problem, int(start)): outcome for method, problem, start, outcome in records}
    except OSError as error:
        raise InputError(f"--baseline: '{path}': {error.strerror}") from error
    except (KeyError, AttributeError, ValueError, csv.Error) as error:
        raise InputError(f"--baseline: '{path}' is no cells.csv or outcomes.csv: {error}") from error


def against_baseline(path, baseline, cells):
    """Nothing that was solved may become unsolved."""
    pairs = [(cell, baseline[key]) for cell in cells if (key := Comparison.key(cell)) in baseline]
    lost, gained = [], 0
    for cell, before in pairs:
        denied = before == "solved" and cell["outcome"] == "infeasible"
        if good(before) and (denied or not good(cell["outcome"])):
            lost.append([cell["method"], cell["problem"], str(cell["start"]), before, cell["outcome"], cell["message"]])
        gained += not good(before) and good(cell["outcome"])
    numbers = f"{len(lost)} solved there and not here, {gained} here and not there"
    print(f"\nAgainst {path}: {count(len(pairs), 'cell')} compared, {numbers}.")
    if not lost:
        return SOLVED
    print()
    print_table(["regression", "problem", ">start", "was", "is", "because"], lost)
    return UNSOLVED


def join_shards(folders, out):
    """Makes OUT a campaign of the shards in these folders; sentences about those that are missing."""
    campaign, shards, lines = None, {}, b""
    for folder in folders:
        part = read_campaign(folder, Comparison)
        number, of = parse_shard(part.pop("shard", ""))
        part["number of shards"] = of
        campaign = campaign or part
        if found := differences(campaign, part):
            listed = "\n  ".join(found)
            raise InputError(f"'{folders[0]}' and '{folder}' are of different campaigns:\n  {listed}")
        if number in shards:
            raise InputError(f"'{shards[number]}' and '{folder}' both hold shard {number}/{of}")
        shards[number] = folder
        cells = read_cells(folder, Comparison)[0]
        lines += b"".join(cell_line(cells[key]) for key in sorted(cells))
    take_folder(out, True)
    del campaign["number of shards"]
    write_files(out, {"campaign.json": pretty(campaign), "cells.jsonl": lines.decode("utf-8")})
    return [f"shard {k}/{of} is missing: its cells are not in the report" for k in range(1, of + 1) if k not in shards]


# The commands.


def report(arguments):
    words = (
        "Makes DIR/report.html, one page that needs nothing else, and its numbers as CSV and JSON, from the files "
        "campaign.json and cells.jsonl that perp-compare has left in DIR. It also works while perp-compare runs, and "
        "after it was killed."
    )
    parser = argparse.ArgumentParser(prog="perp-report", description=words)
    parser.add_argument("dirs", nargs="+", metavar="DIR", help="folder of the campaign, or those of its shards")
    parser.add_argument("--out", metavar="DIR", help="folder for the joined campaign of the shards; new or empty")
    given = parser.parse_args(arguments)
    from .report import write_report

    if len(given.dirs) > 1 and not given.out:
        raise InputError("--out DIR says where the shards are joined")
    for text in join_shards(given.dirs, given.out) if given.out else ():
        note(text)
    folder = given.out or given.dirs[0]
    for topic, text in write_report(folder):
        print(f"{topic}: {text}")
    print(f"{folder}/report.html")
    return SOLVED


def compare(arguments):
    interrupt, kind = Interrupt(), arguments[0] if arguments else ""
    if kind == "contact":
        from .contact import ContactComparison

        return ContactComparison(arguments[1:], interrupt).run()
    if kind in ("facets", "ball", "forces"):
        from . import studies

        return getattr(studies, kind)(arguments[1:], interrupt)
    return Comparison(arguments, interrupt).run()


def run(command, arguments):
    try:
        if not {"-h", "--help"} & set(arguments):
            need_packages()
        return command(arguments)
    except InputError as error:
        print(f"perp: {error}", file=sys.stderr)
        return REFUSED
    except (Environment, OSError) as error:
        print(f"perp: {error}", file=sys.stderr)
        return INTERRUPTED


def main_compare():
    sys.exit(run(compare, sys.argv[1:]))


def main_report():
    sys.exit(run(report, sys.argv[1:]))
