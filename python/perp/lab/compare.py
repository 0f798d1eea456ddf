# SPDX-License-Identifier: Apache-2.0
"""perp-compare: a campaign of methods x problems x starts. perp-report: its report, and shards joined."""

import argparse
import csv
import os
import re
import sys

from .campaign import (
    INTERRUPTED, REFUSED, SOLVED, UNSOLVED, Campaign, Interrupt, cores, count, differences, machine, need_packages, note, now,
    parse_shard, print_table, read_campaign, word_of,
)  # fmt: skip
from .cells import KEYS, OUTCOMES, CellRunner, good, is_failure, settle, source_of
from .files import Environment, InputError, cell_line, check_apart, crc_of, pretty, read_cells, take_folder, write_files
from .lists import described, external_method, select_methods, select_problems
from .process import run_all

COMPARE_WORDS = """\
PROBLEMS is a comma-separated list of NAME, NAME:SIZE, class:CLASS, FILE.nl, FILE.dat and all.
METHODS is a comma-separated list of NAME, NAME:key=value:key=value, presets, published, all, none and:
  cfunctions                    semismooth with every C-function
  cfunctions:rho=0.01:rho=100   the same, with these values of the parameters rho, lambda or alpha
  cfunction-grid                the C-functions that have a parameter, each at 4 or 5 values of it
Names may contain * and ?. An item that begins with - is taken out of the list.

Examples:
  perp-compare --problems all,-class:pde --methods path,miles,semismooth:tol=1e-9 --starts 1
  perp-compare --problems 'models/*.nl' --external 'peer=./peer tol={tol}' --out peers
  perp-compare --out peers --resume                     after Ctrl-C, kill -9, a full disk or a power cut
  perp-compare --problems all --shard 3/7 --out part3   the third of seven parts
  perp-compare contact --help                           variants on problems of contact with friction
  perp-compare facets --help                            what polygons cost in place of friction disks
  perp-compare ball --help                              the path of a ball by polygons and by Coulomb's law

A cell is one method on one problem from one start. It runs in a process of its own, with limits of time and
memory. The judge, another process, builds the problem anew and evaluates the natural residual at the point found.
Every finished cell is on the disk at once. If the machine fails (a full disk, a judge that is killed), the cell stays
open, and --resume runs it again. In the end DIR has report.html, cells.csv and cells.json. outcomes.csv has no times,
so two campaigns can be compared with cmp.

Exit codes: 0 complete, 1 complete but something that the baseline solved is not solved, 2 wrong usage or input,
3 internal error, 4 interrupted, or cells are open (--resume goes on)."""


# The command line.


def within(low, high, kind=float):
    def check(text):
        value = kind(text)
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(f"{text}: a number from {low:g} to {high:g} is asked for")
        return value

    check.__name__ = "number"
    return check


NUMBERS = {  # of flags that commands have in common
    "--tol": ("TOL", within(1e-15, 1)),
    "--time-limit": ("SECONDS", within(0.01, 1e6)),
    "--memory-limit": ("MB", within(16, 1 << 32, int)),
    "--restarts": ("R", within(0, 1000, int)),
    "--seed": ("N", within(0, 2**32 - 1, int)),
    "--jobs": ("N", within(1, 1024, int)),
}


def add_numbers(parser, usual=(), **flags):
    """Flags of NUMBERS with their help, and with defaults, if there are any; --program, too."""
    for name, words in flags.items():
        flag = "--" + name.replace("_", "-")
        metavar, kind = NUMBERS[flag]
        parser.add_argument(flag, type=kind, metavar=metavar, help=words, default=dict(usual).get(name))
    parser.add_argument("--program", metavar="FILE", help="the program perp (PERP_PROGRAM, else perp on the PATH)")


def add_folder(parser, folder):
    parser.add_argument("--out", default=folder, metavar="DIR", help=f"folder of the campaign ({folder})")
    parser.add_argument("--resume", action="store_true", help="go on with the campaign in DIR, with its options")


MEMORY_WORDS = "limit of the resident memory of a run (4096)"


def parser_of():
    kind = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(prog="perp-compare", formatter_class=kind, epilog=COMPARE_WORDS, allow_abbrev=False)
    parser.description = "Compares methods on many problems: a campaign and its report."
    external = "add a program that AMPL could call, as 'COMMAND stub -AMPL'; {tol} in COMMAND is the tolerance of --tol; may be repeated"
    for flag, metavar, words in (
        ("--problems", "PROBLEMS", "which problems (all of the collection)"),
        ("--methods", "METHODS", "which methods (presets)"),
        ("--starts", "all|K", "all starts of each problem, or at most K (all)"),
        ("--shard", "K/N", "run part K of N of the cells, each part in a DIR of its own; 'perp-report' joins the parts"),
        ("--baseline", "FILE.csv", "cells.csv or outcomes.csv of an earlier campaign: what is lost?"),
    ):
        parser.add_argument(flag, metavar=metavar, help=words)
    parser.add_argument("--external", action="append", default=[], metavar="NAME=COMMAND", help=external)
    add_numbers(
        parser,
        tol="tolerance of the judge, and of the methods unless their options set one (1e-6)",
        time_limit="wall-clock limit of a run (60)",
        memory_limit=MEMORY_WORDS,
        restarts="after a failure, up to R runs from perturbed starts (0)",
        seed="seed of the perturbed starts (1)",
        jobs="number of runs at a time (one for each core)",
    )
    add_folder(parser, "comparison")
    return parser


# The campaign.


class Comparison(Campaign):
    NAME, COMMAND, KEYS = "campaign", "perp-compare", KEYS
    FILES = (
        "cells.csv", "cells.json", "outcomes.csv", "methods.csv", "pairs.csv", "profiles.csv", "summary.csv", "robustness.csv",
        "unsolvable.csv", "false_claims.csv", "curves.csv", "findings.txt", "report.json", "report.html",
    )  # fmt: skip
    USUAL = {
        "tol": 1e-6, "time_limit": 60.0, "memory_limit_mb": 4096, "restarts": 0, "seed": 1, "starts": "all", "shard": "",
        "jobs": cores(),
    }  # fmt: skip

    @staticmethod
    def key(cell):
        return cell["method"], cell["problem"], cell["start"]

    def asked(self, before):
        words = self.words
        if words.baseline and words.shard:
            raise InputError("--baseline: compares all cells, --shard runs some of them")
        if words.resume and not before and not (words.problems or words.methods or words.external):
            raise InputError(f"--resume: there is no campaign in '{self.out}'")
        self.baseline = read_baseline(words.baseline) if words.baseline else {}
        values = self.values(before)
        if values["starts"] != "all":
            if not str(values["starts"]).isdecimal() or int(values["starts"]) < 1:
                raise InputError(f"--starts '{values['starts']}': 'all', or how many of each problem at most, from 1")
            values["starts"] = int(values["starts"])
        parse_shard(values["shard"])
        notes = []
        methods = self.methods(before, values["tol"], notes)
        known = {p["name"]: p for p in before["problems"]} if before else {}
        problems = select_problems(words.problems or "all", self.program) if words.problems or not before else known.values()
        problems = [known_problem(p, known) for p in problems if not before or p["name"] in known or not p.get("by_pattern")]
        for text in () if before else notes:
            note(text)
        program = self.program.json("methods", "--json")
        head = {"program": "perp", "version": program["version"], self.NAME: 1, "build": crc_of(self.program.path)}
        head |= {"libraries": program["libraries"], "date": now(), "command_line": [self.COMMAND, *words.given]}
        campaign = {**head, "machine": machine(), **values, "methods": methods, "problems": problems}
        if not campaign["shard"]:
            del campaign["shard"]
        return campaign

    def methods(self, before, tol, notes):
        """As asked for, else as before; the same of external programs."""
        words, methods = self.words, []
        if before:
            methods = [m for m in before["methods"] if not m["external"]]
        if words.methods is not None or not before:
            methods = select_methods(words.methods or "presets", tol, self.program, notes)
        external = [external_method(text, self.program) for text in words.external]
        for method in external:
            name = method["label"]
            if [m["label"] for m in external].count(name) > 1:
                raise InputError(f"--external: '{name}' is given twice")
            for word in re.findall(r"(?:^|(?<!\$))(\{[A-Za-z_]+\})", method["command"]):
                if word != "{tol}":
                    notes.append(f"--external {name}: {word} is left to the shell as it is; only {{tol}} is filled in")
        if before and not external:
            external = [m for m in before["methods"] if m["external"]]
        if not methods and not external:
            raise InputError("--methods: nothing is left")
        return methods + external

    def check_same(self, before):
        super().check_same(before)
        if before["build"] != self.campaign["build"]:
            note("the program is another build than the one that began this campaign")
        if before["machine"]["cpu"] != self.campaign["machine"]["cpu"]:
            note(f"another machine began this campaign ({before['machine']['cpu']}): times do not compare")
        if before["jobs"] != self.campaign["jobs"]:
            note(f"begun with {count(before['jobs'], 'run')}, now {self.campaign['jobs']} at a time: times do not compare")
        now = {p["name"]: p for p in self.campaign["problems"]}
        problems = [now[p["name"]] for p in before["problems"]]  # in their order, which shards count by
        self.campaign = {**before, "jobs": self.campaign["jobs"], "problems": problems}

    def describe(self):
        """Of problems of a size, and files."""
        runner, refused = CellRunner(self.campaign, self.program, stopped=self.stopped), {}

        def describe(problem):
            source = source_of(problem)
            answer = runner.judge(source, source)
            if "residual" in answer:
                problem.update(described(answer))
            elif problem.get("by_pattern"):
                refused[problem["name"]] = answer["message"]
            else:
                raise InputError(answer["message"])

        problems, most = self.campaign["problems"], self.campaign["starts"]
        run_all(self.campaign["jobs"], describe, [p for p in problems if "n" not in p], self.stopped)
        for name, why in refused.items():
            note(f"{name} is left out: {why}")
        problems[:] = [p for p in problems if p["name"] not in refused]
        if not problems:
            raise InputError("--problems: every file is refused")
        for problem in problems:
            problem.pop("by_pattern", None)
            if most != "all" and "starts" in problem:
                problem["starts"] = min(problem["starts"], most)

    def table(self):
        """Problem by problem, so that what is seen first is comparable; of a shard, its own."""
        campaign = self.campaign
        number, of = parse_shard(campaign.get("shard"))
        starts = [(p, s) for p in campaign["problems"] for s in range(1, p["starts"] + 1)]
        cells = [(m, p, s) for p, s in starts for m in campaign["methods"]]
        self.runner = CellRunner(campaign, self.program, self.work_folder, self.stopped)
        return {(m["label"], p["name"], s): (m, p, s) for m, p, s in cells[number - 1 :: of]}

    def make(self, method, problem, start):
        return self.runner.cell(method, problem, start)

    def show(self, cells, complete):
        from .report import write_report

        if not complete:
            return INTERRUPTED
        write_report(self.out)
        if self.campaign.get("shard"):
            shard = self.campaign["shard"]
            print(f"Shard {shard} is complete. 'perp-report DIR... --out JOINED' joins the folders of all.")
            return SOLVED
        settle(self.campaign, cells)
        print_outcomes(self.campaign, cells)
        print_false_claims(cells)
        out = self.out
        print(f"\n{out}/report.html shows and {out}/findings.txt says what came out; {out}/cells.csv has every cell.")
        return against_baseline(self.words.baseline, self.baseline, cells) if self.words.baseline else SOLVED


def known_problem(problem, known):
    """With what a campaign knows of it, and the CRC of its file as it is now."""
    problem = {**problem, **known.get(problem["name"], {}), **({"file": problem["file"]} if "file" in problem else {})}
    if "file" in problem:
        if not os.path.isfile(problem["file"]):
            raise InputError(f"there is no file '{problem['file']}' any more")
        problem["crc"] = crc_of(problem["file"])
    return problem


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


def print_false_claims(cells):
    wrong = [c for c in cells if c["outcome"] in ("false-convergence", "false-infeasible")]
    rows = [[c["method"], c["problem"], str(c["start"]), c["outcome"], f"{c['natural']:.3g}", c["message"]] for c in wrong[:20]]
    if rows:
        print()
        print_table(["false claim of", "problem", ">start", "outcome", ">residual", "message"], rows)
        if len(wrong) > 20:
            print(f"  ... {len(wrong) - 20} more; the report shows them")


# Baselines and shards.


def read_baseline(path):
    """{(method, problem, start): outcome} of a cells.csv or outcomes.csv."""
    try:
        with open(path, encoding="utf-8-sig", newline="") as file:
            records = list(csv.DictReader(file))
    except OSError as error:
        raise InputError(f"--baseline: '{path}': {error.strerror}") from error
    rows = {}
    for line, record in enumerate(records, 2):
        method, problem, start, outcome = ((record.get(name) or "").removeprefix("'") for name in (*KEYS[:3], "outcome"))
        if None in record or None in record.values() or not start.isdecimal() or outcome not in OUTCOMES:
            raise InputError(f"{path}: record {line} is not of a comparison: method, problem, start and outcome are asked for")
        rows[method, problem, int(start)] = outcome
    if not rows:
        raise InputError(f"{path}: there is no record in it")
    return rows


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
        number, of = parse_shard(part.get("shard"))
        campaign = campaign or part
        parts = ({"number": parse_shard(one.get("shard"))[1]} for one in (campaign, part))
        if found := differences(campaign, part) + differences(*parts, " of shards"):
            listed = "\n  ".join(found)
            raise InputError(f"'{folders[0]}' and '{folder}' are of different campaigns:\n  {listed}")
        if number in shards:
            raise InputError(f"'{shards[number]}' and '{folder}' both hold shard {number}/{of}")
        shards[number] = folder
        cells = read_cells(folder, Comparison)[0]
        lines += b"".join(cell_line(cells[key]) for key in sorted(cells))
    take_folder(out, True)
    campaign.pop("shard", None)
    write_files(out, {"campaign.json": pretty(campaign), "cells.jsonl": lines.decode("utf-8")})
    return [f"shard {k}/{of} is missing: its cells are not in the report" for k in range(1, of + 1) if k not in shards]


# The commands.


def report(arguments):
    words = (
        "Makes DIR/report.html, one page that needs nothing else, and its numbers as CSV and JSON, from the files campaign.json "
        "and cells.jsonl that perp-compare has left in DIR. It also works while perp-compare runs, and after it was killed."
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
    check_apart([os.path.join(folder, name) for name in Comparison.FILES], [])
    for topic, text in write_report(folder):
        print(f"{topic}: {text}")
    print(f"{folder}/report.html")
    return SOLVED


def compare(arguments):
    interrupt, kind = Interrupt(), arguments[0] if arguments else ""
    if kind == "contact":
        from .contact import compare_contact

        return compare_contact(arguments[1:], interrupt)
    if kind in ("facets", "ball"):
        from . import studies

        return getattr(studies, kind)(arguments[1:], interrupt)
    words = parser_of().parse_args(arguments)
    words.given = arguments
    return Comparison(words, interrupt).run()


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
