# SPDX-License-Identifier: Apache-2.0
"""perp-compare: a campaign of methods x problems x starts. perp-report: its report, and shards joined."""

import argparse
import contextlib
import csv
import os
import shlex
import shutil
import signal
import sys
import time

from . import campaign as base
from . import cells as cell_module
from .campaign import Environment, InputError, Journal, Lock, Program, count
from .cells import CellRunner, good, settle
from .process import Pool

SOLVED, UNSOLVED, REFUSED, INTERNAL, INTERRUPTED = range(5)

COMPARE_WORDS = """\
PROBLEMS is a comma-separated list of NAME, NAME:SIZE, class:CLASS, FILE.nl, FILE.dat and all.
METHODS is a comma-separated list of NAME, NAME:key=value:key=value, presets, published, all, none and:
  cfunctions                    semismooth with every C-function
  cfunctions:rho=0.01:rho=100   the same, with these values of the parameters rho, lambda or alpha
  cfunction-grid                the C-functions that have a parameter, each at 4 or 5 values of it
Names may contain * and ?. An item that begins with - is taken out of the list.

Examples:
  perp-compare --problems class:tiny --out tiny
  perp-compare --problems all,-class:pde --methods path,miles,semismooth:tol=1e-9 --starts 1
  perp-compare --methods=presets,-gsl* --restarts 2 --out with-restarts
  perp-compare --problems 'models/*.nl' --external 'peer=./peer tol={tol}' --out peers
  perp-compare --out tiny --resume                      after Ctrl-C, kill -9, a full disk or a power cut
  perp-compare --problems all --shard 3/7 --out part3   the third of seven parts
  perp-compare --problems class:tiny --baseline tiny/outcomes.csv --out again
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


def within(low, high, kind=float):
    def check(text):
        value = kind(text)
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(f"{text}: a number from {low:g} to {high:g} is asked for")
        return value

    check.__name__ = "number"
    return check


def limits(parser, tol, seconds):
    parser.add_argument("--tol", type=within(1e-15, 1), metavar="TOL", help=tol)
    parser.add_argument("--time-limit", type=within(0.01, 1e6), metavar="SECONDS", help=seconds)
    parser.add_argument("--memory-limit", type=within(16, 1 << 32, int), metavar="MB", help="limit of the resident memory of a run (4096)")


def campaign_flags(parser, folder, jobs):
    parser.add_argument("--jobs", type=within(1, 1024, int), metavar="N", help=f"number of runs at a time ({jobs})")
    parser.add_argument("--out", default=folder, metavar="DIR", help=f"folder of the campaign ({folder})")
    parser.add_argument("--resume", action="store_true", help="go on with the campaign in DIR, with its options")
    parser.add_argument("--program", metavar="FILE", help="the program perp (PERP_PROGRAM, else perp on the PATH)")


def parser_of():
    kind = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(prog="perp-compare", formatter_class=kind, epilog=COMPARE_WORDS, allow_abbrev=False)
    parser.description = "Compares methods on many problems: a campaign and its report."
    parser.add_argument("--problems", metavar="PROBLEMS", help="which problems (all of the collection)")
    parser.add_argument("--methods", metavar="METHODS", help="which methods (presets)")
    parser.add_argument("--starts", metavar="all|K", help="all starts of each problem, or at most K (all)")
    limits(parser, "tolerance of the judge, and of the methods unless their options set one (1e-6)", "wall-clock limit of a run (60)")
    parser.add_argument("--restarts", type=within(0, 1000, int), metavar="R", help="after a failure, up to R runs from perturbed starts (0)")
    parser.add_argument("--seed", type=within(0, 2**32 - 1, int), metavar="N", help="seed of the perturbed starts (1)")
    external = "add a program that AMPL could call, as 'COMMAND stub -AMPL'; {tol} in COMMAND is the tolerance of --tol; may be repeated"
    parser.add_argument("--external", action="append", default=[], metavar="NAME=COMMAND", help=external)
    shard = "run part K of N of the cells, each part in a DIR of its own; 'perp-report' joins the parts"
    parser.add_argument("--shard", metavar="K/N", help=shard)
    parser.add_argument("--baseline", metavar="FILE.csv", help="cells.csv or outcomes.csv of an earlier campaign: what is lost?")
    campaign_flags(parser, "comparison", "one for each core")
    return parser


def note(text):
    print(f"perp: note: {text}", file=sys.stderr)


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


# What is asked for.


def asked_campaign(words, program, before, notes):
    """What is left open is as in `before`, if there is one, else as usual."""
    usual = {"tol": 1e-6, "time_limit": 60.0, "memory_limit_mb": 4096, "restarts": 0, "seed": 1, "starts": "all", "shard": ""}
    usual["jobs"] = base.cores()
    otherwise = {**usual, **(before or {})}
    given = {**vars(words), "memory_limit_mb": words.memory_limit}
    values = {key: otherwise[key] if given[key] is None else given[key] for key in usual}
    if values["starts"] != "all":
        if not str(values["starts"]).isdecimal() or int(values["starts"]) < 1:
            raise InputError(f"--starts '{values['starts']}': 'all', or how many of each problem at most, from 1")
        values["starts"] = int(values["starts"])
    base.parse_shard(values["shard"])
    if before and words.methods is None:
        methods = [m for m in before["methods"] if not m["external"]]
        methods = [{"affine": False, **m} for m in methods]
    else:
        methods = base.select_methods(words.methods or "presets", values["tol"], program, notes)
    methods += [m for m in before["methods"] if m["external"]] if before and not words.external else []
    for text in words.external:
        methods.append(base.parse_external(text, program))
        if [m["label"] for m in methods].count(methods[-1]["label"]) > 1:
            raise InputError(f"--external: '{methods[-1]['label']}' is given twice")
        for word in unfilled_words(methods[-1]["command"]):
            notes.append(f"--external {methods[-1]['label']}: {word} is left to the shell as it is; only {{tol}} is filled in")
    if not methods:
        raise InputError("--methods: nothing is left")
    problems = before["problems"] if before and words.problems is None else base.select_problems(words.problems or "all", program)
    problems = [known_problem(problem, before) for problem in problems]
    head = {"campaign": 1, **program.stamp(), "command_line": ["perp-compare", *words.given], "machine": base.machine()}
    campaign = {"program": "perp", **head, **values, "methods": methods, "problems": problems}
    if not campaign["shard"]:
        del campaign["shard"]
    return campaign


def unfilled_words(command):
    return [word for word in cell_module.re.findall(r"(?:^|(?<!\$))(\{[A-Za-z_]+\})", command) if word != "{tol}"]


def known_problem(problem, before):
    """The problem with the CRC of its file as it is now and, where a campaign knows it, what that knows."""
    same = next((p for p in before["problems"] if p["name"] == problem["name"]), {}) if before else {}
    problem = {**problem, **same, **({"file": problem["file"]} if "file" in problem else {})}
    if "file" in problem:
        if not os.path.isfile(problem["file"]):
            raise InputError(f"there is no file '{problem['file']}' any more")
        problem["crc"] = base.crc_of(problem["file"])
    return problem


REPORT_FILES = (
    "lock", "campaign.json", "cells.jsonl", "cells.csv", "cells.json", "outcomes.csv", "methods.csv", "pairs.csv", "profiles.csv",
    "summary.csv", "robustness.csv", "unsolvable.csv", "false_claims.csv", "curves.csv", "findings.txt", "report.json", "report.html",
)  # fmt: skip


class Comparison:
    def __init__(self, words, interrupt):
        self.words, self.interrupt, self.out = words, interrupt, words.out
        self.program = Program(words.program)
        self.open_cells = []

    def run(self):
        words = self.words
        if words.baseline and words.shard:
            raise InputError("--baseline: compares all cells, --shard runs some of them")
        self.baseline = read_baseline(words.baseline) if words.baseline else {}
        holds = os.path.exists(os.path.join(self.out, "campaign.json"))
        if words.resume and not holds:
            if not (words.problems or words.methods or words.external):
                raise InputError(f"--resume: there is no campaign in '{self.out}'")
            note(f"there is no campaign in '{self.out}' yet: one begins")
        if not (self.take_up() if words.resume and holds else self.begin()):
            print("perp: interrupted before the first cell", file=sys.stderr)
            return INTERRUPTED
        return self.work()

    def check_files(self, campaign):
        outputs = [os.path.join(self.out, name) for name in REPORT_FILES]
        base.check_apart(outputs, [self.words.baseline, *(p.get("file") for p in campaign["problems"])])

    def take_up(self):
        before, notes = base.read_campaign(self.out), []
        now = asked_campaign(self.words, self.program, before, notes)
        there = {p["name"] for p in before["problems"]}
        now["problems"] = [p for p in now["problems"] if p["name"] in there or not p.get("by_pattern")]  # left out then
        found = base.differences(before, now)
        found += base.value_differences((f"--{key}", before.get(key) or "all", now.get(key) or "all") for key in ("starts", "shard"))
        if found:
            lines = "\n  ".join(found)
            raise InputError(f"--resume: '{self.out}' holds a campaign that asks for something else:\n  {lines}\n'--out {self.out} --resume' alone goes on as it was begun, another --out begins anew")
        self.check_files(now)
        if before["build"] != now["build"]:
            note("the program is another build than the one that began this campaign")
        if before["machine"]["cpu"] != now["machine"]["cpu"]:
            note(f"another machine began this campaign ({before['machine']['cpu']}): times do not compare")
        if before["jobs"] != now["jobs"]:
            note(f"begun with {count(before['jobs'], 'run')}, now {now['jobs']} at a time: times do not compare")
        self.lock = Lock(self.out)
        affine = {m["label"]: m["affine"] for m in now["methods"]}
        self.campaign = {**before, "jobs": now["jobs"]}
        self.campaign["methods"] = [{**m, "affine": affine[m["label"]]} for m in before["methods"]]
        return True

    def begin(self):
        notes = []
        self.campaign = asked_campaign(self.words, self.program, None, notes)
        for text in notes:
            note(text)
        self.check_files(self.campaign)
        base.make_folder(self.out, True)
        self.lock = Lock(self.out)
        try:
            done = self.describe()
            if done:
                base.write_files([(os.path.join(self.out, "campaign.json"), base.pretty(self.campaign))])
        except BaseException:
            self.leave_nothing()
            raise
        if not done:
            self.leave_nothing()
        return done

    def leave_nothing(self):
        shutil.rmtree(self.work_folder(), ignore_errors=True)
        for remove, path in ((os.unlink, os.path.join(self.out, "lock")), (os.rmdir, self.out)):
            with contextlib.suppress(OSError):
                remove(path)

    def work_folder(self):
        return os.path.join(os.path.abspath(self.out), "work")

    def describe(self):
        """What the campaign does not know of problems yet: those of a size, and files."""
        runner, refused = CellRunner(self.campaign, self.program, self.work_folder()), {}

        def task(problem):
            source = problem.get("file") or problem["name"]
            answer = yield from runner.answer(source, "judge", source, "--json", "-")
            if "residual" in answer:
                problem.update(base.described(answer))
            elif problem.get("by_pattern"):
                refused[problem["name"]] = answer["message"]
            else:
                raise InputError(answer["message"])

        problems = self.campaign["problems"]
        Pool(self.campaign["jobs"], self.interrupt).run(task(p) for p in problems if "n" not in p)
        for name, why in refused.items():
            note(f"{name} is left out: {why}")
        self.campaign["problems"] = [p for p in problems if p["name"] not in refused]
        if not self.campaign["problems"]:
            raise InputError("--problems: every file is refused")
        most = self.campaign["starts"]
        for problem in self.campaign["problems"]:
            problem.pop("by_pattern", None)
            if most != "all" and "starts" in problem:
                problem["starts"] = min(problem["starts"], most)
        return not self.interrupt()

    def pending(self, done):
        """(cells to do, how many there are in all), problem by problem, so that what is seen first is comparable."""
        number, of = base.parse_shard(self.campaign.get("shard", ""))
        cells = [(m, p, s) for p in self.campaign["problems"] for s in range(1, p["starts"] + 1) for m in self.campaign["methods"]]
        mine = cells[number - 1 :: of]
        return [(m, p, s) for m, p, s in mine if (m["label"], p["name"], s) not in done], len(mine)

    def work(self):
        campaign = self.campaign
        journal = Journal(self.out)
        done, dropped = base.read_cells(self.out, cell_module.key, cell_module.KEYS)
        for line in dropped:
            note(f"{self.out}/cells.jsonl, {line}: left out, its cell runs again")
        pending, total = self.pending(done)
        methods, problems = count(len(campaign["methods"]), "method"), count(len(campaign["problems"]), "problem")
        to_do = f", {len(pending)} of them to do" if done else ""
        print(f"perp: {methods} x {problems}: {count(total, 'cell')}{to_do}, {campaign['jobs']} at a time", file=sys.stderr, flush=True)
        unsolvable = {p["name"] for p in campaign["problems"] if not p["solvable"]}
        progress = Progress(total, done.values(), unsolvable)
        shutil.rmtree(self.work_folder(), ignore_errors=True)  # of a campaign that was killed
        runner = CellRunner(campaign, self.program, self.work_folder())

        def task(method, problem, start):
            try:
                cell = yield from runner.cell(method, problem, start)
            except Environment as why:
                self.open_cells.append(str(why))
                return
            journal.add(cell)
            progress.add(cell)

        try:
            Pool(campaign["jobs"], self.interrupt, progress.tick).run(task(*cell) for cell in pending)
        except (Environment, OSError) as error:
            self.open_cells.append(str(error))
        progress.end()
        shutil.rmtree(self.work_folder(), ignore_errors=True)
        if progress.done < total:
            for why in dict.fromkeys(self.open_cells[:5]):
                print(f"perp: a cell stays open: {why}", file=sys.stderr)
            how = "interrupted" if self.interrupt() else f"{count(total - progress.done, 'cell')} open"
            again = f"'perp-compare --out {shlex.quote(self.out)} --resume' goes on"
            print(f"perp: {how}; {progress.done} of {count(total, 'cell')} are done. {again}", file=sys.stderr)
            return INTERRUPTED
        return self.finish()

    def finish(self):
        from .report import write_report

        write_report(self.out)
        campaign = self.campaign
        if campaign.get("shard"):
            print(f"Shard {campaign['shard']} is complete. 'perp-report DIR... --out JOINED' joins the folders of all.")
            return SOLVED
        cells = sorted(base.read_cells(self.out, cell_module.key, cell_module.KEYS)[0].values(), key=cell_module.key)
        settle(campaign, cells)
        print_outcomes(campaign, cells)
        print_false_claims(cells)
        out = self.out
        print(f"\n{out}/report.html shows and {out}/findings.txt says what came out; {out}/cells.csv has every cell.")
        return against_baseline(self.words.baseline, self.baseline, cells) if self.words.baseline else SOLVED


# What is said on the way and in the end.


def table(headers, rows):
    """Aligned; a header that begins with > has its column at the right."""
    names = [header.lstrip(">") for header in headers]
    lines = [names, ["-" * max(len(line[k]) for line in [names, *rows]) for k in range(len(names))], *rows]
    widths = [len(rule) for rule in lines[1]]
    for line in lines:
        padded = (text.rjust(w) if header.startswith(">") else text.ljust(w) for text, w, header in zip(line, widths, headers))
        print("  ".join(padded).rstrip())


GROUPS = {
    "solved": ("solved", "infeasible"), "to rounding": ("solved-to-rounding",), "failed": ("failed", "unclaimed"),
    "false": ("false-convergence", "false-infeasible"), "limits": ("time-limit", "memory-limit"), "crashed": ("crashed", "garbage"),
    "n/a": ("not-applicable",), "honest": ("honest",),
}  # fmt: skip


def duration_text(seconds):
    s = int(seconds) + (seconds % 1 > 0)
    return f"{s} s" if s < 60 else f"{s // 60}:{s % 60:02}" if s < 3600 else f"{s // 3600}:{s // 60 % 60:02}:{s % 60:02}"


class Progress:
    """How far a campaign is: on a terminal one line that is rewritten, elsewhere a line now and then."""

    def __init__(self, total, before, unsolvable):
        self.total, self.unsolvable, self.counts, self.done = total, unsolvable, {}, 0
        self.begin, self.shown, self.terminal = time.monotonic(), 0.0, sys.stderr.isatty()
        for cell in before:
            self.take(cell)
        self.before = self.shown_done = self.done

    def take(self, cell):
        self.done += 1
        honest = cell["outcome"] == "failed" and cell["problem"] in self.unsolvable
        word = "honest" if honest else cell["outcome"]
        self.counts[word] = self.counts.get(word, 0) + 1

    def line(self, now):
        parts = [f"{self.done}/{self.total}"]
        for name, words in GROUPS.items():
            if n := sum(self.counts.get(word, 0) for word in words):
                parts.append(f"{name} {n}")
        if self.before < self.done < self.total:
            parts.append(f"{duration_text(now / (self.done - self.before) * (self.total - self.done))} left")
        return "  ".join(parts)

    def add(self, cell):
        self.take(cell)
        self.tick()

    def tick(self):
        now = time.monotonic() - self.begin
        tenth = self.done * 10 // max(self.total, 1) > self.shown_done * 10 // max(self.total, 1)
        if now - self.shown >= 0.1 if self.terminal else now - self.shown >= 30 or tenth:
            self.show(now)

    def show(self, now):
        self.shown, self.shown_done = now, self.done
        text = self.line(now)
        width = shutil.get_terminal_size().columns
        print(f"\r\033[K{text[: width - 1]}" if self.terminal else f"perp: {text}\n", end="", file=sys.stderr, flush=True)

    def end(self):
        if self.terminal:
            print("\r\033[K", end="", file=sys.stderr, flush=True)
        elif self.shown_done != self.done:
            self.show(time.monotonic() - self.begin)


def print_outcomes(campaign, cells):
    solvable = {p["name"]: p["solvable"] for p in campaign["problems"]}
    words, restarts = [*cell_module.OUTCOMES, "honest"], campaign["restarts"] > 0

    def word(cell):
        return "honest" if cell["outcome"] == "failed" and not solvable[cell["problem"]] else cell["outcome"]

    occur = [w for w in words if any(word(cell) == w for cell in cells)]
    rows = []
    for label in (m["label"] for m in campaign["methods"]):
        mine = [cell for cell in cells if cell["method"] == label]
        numbers = [sum(word(cell) == w for cell in mine) for w in occur]
        if restarts:
            numbers.append(sum(word(cell) != "honest" and cell_module.is_failure(cell["outcome_after_restarts"]) for cell in mine))
        rows.append([label, *(str(n or ".") for n in numbers), f"{sum(cell['seconds'] for cell in mine):.1f}"])
    table(["method", *(f">{w}" for w in occur), *([">failures after restarts"] if restarts else []), ">seconds"], rows)
    said = {"infeasible": "infeasible, it says so", "honest": "honest, it does not claim one"}
    if parts := [said[w] for w in said if w in occur]:
        print("\nOf problems that have no solution: " + "; ".join(parts) + ".")


def print_false_claims(cells):
    wrong = [c for c in cells if c["outcome"] in ("false-convergence", "false-infeasible")]
    rows = [[c["method"], c["problem"], str(c["start"]), c["outcome"], f"{c['natural']:.3g}", c["message"]] for c in wrong[:20]]
    if rows:
        print()
        table(["false claim of", "problem", ">start", "outcome", ">residual", "message"], rows)
        if len(wrong) > 20:
            print(f"  ... {len(wrong) - 20} more; the report shows them")


def read_baseline(path):
    """{(method, problem, start): outcome} of a cells.csv or outcomes.csv."""
    try:
        with open(path, encoding="utf-8-sig", newline="") as file:
            records = list(csv.reader(file))
    except OSError as error:
        raise InputError(f"--baseline: '{path}': {error.strerror}") from error
    if not records:
        raise InputError(f"{path}: no header")
    columns = ("method", "problem", "start", "outcome")
    for name in columns:
        if name not in records[0]:
            raise InputError(f"{path}: no column '{name}'")
    rows = {}
    for line, record in enumerate(records[1:], 2):
        if len(record) != len(records[0]):
            raise InputError(f"{path}: record {line} has {len(record)} fields, the header {len(records[0])}")
        method, problem, start, outcome = (record[records[0].index(name)].removeprefix("'") for name in columns)
        if not start.isdecimal():
            raise InputError(f"{path}: record {line}: '{start}' is no start")
        if outcome not in cell_module.OUTCOMES:
            raise InputError(f"{path}: record {line}: '{outcome}' is no outcome")
        rows[method, problem, int(start)] = outcome
    return rows


def against_baseline(path, baseline, cells):
    """Nothing that was solved may become unsolved."""
    lost, gained, compared = [], 0, 0
    for cell in cells:
        before = baseline.get(cell_module.key(cell))
        if before is None:
            continue
        compared += 1
        denied = before == "solved" and cell["outcome"] == "infeasible"
        if good(before) and (denied or not good(cell["outcome"])):
            lost.append([cell["method"], cell["problem"], str(cell["start"]), before, cell["outcome"], cell["message"]])
        gained += not good(before) and good(cell["outcome"])
    print(f"\nAgainst {path}: {count(compared, 'cell')} compared, {len(lost)} solved there and not here, {gained} here and not there.")
    if not lost:
        return SOLVED
    print()
    table(["regression", "problem", ">start", "was", "is", "because"], lost)
    return UNSOLVED


def join_shards(folders, out):
    """Makes OUT a campaign of the shards in these folders; sentences about those that are missing."""
    campaign, shards, lines = None, {}, b""
    for folder in folders:
        part = base.read_campaign(folder)
        number, of = base.parse_shard(part.get("shard", ""))
        campaign = campaign or part
        found = base.differences(campaign, part)
        found += base.value_differences([("--shard", base.parse_shard(campaign.get("shard", ""))[1], of)])
        if found:
            lines_of = "\n  ".join(found)
            raise InputError(f"'{folders[0]}' and '{folder}' are of different campaigns:\n  {lines_of}")
        if number in shards:
            raise InputError(f"'{shards[number]}' and '{folder}' both hold shard {number}/{of}")
        shards[number] = folder
        cells = base.read_cells(folder, cell_module.key, cell_module.KEYS)[0]
        lines += b"".join(base.cell_line(cells[key]) for key in sorted(cells))
    base.make_folder(out, True)
    campaign.pop("shard", None)
    paths = [os.path.join(out, name) for name in ("campaign.json", "cells.jsonl")]
    base.write_files(zip(paths, (base.pretty(campaign), lines.decode("utf-8"))))
    return [f"shard {k}/{of} is missing: its cells are not in the report" for k in range(1, of + 1) if k not in shards]


def report(arguments):
    words = "Makes DIR/report.html, one page that needs nothing else, and its numbers as CSV and JSON, from the files campaign.json and cells.jsonl that perp-compare has left in DIR. It also works while perp-compare runs, and after it was killed."
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
    base.check_apart([os.path.join(folder, name) for name in REPORT_FILES], [])
    for topic, text in write_report(folder):
        print(f"{topic}: {text}")
    print(f"{folder}/report.html")
    return SOLVED


def compare(arguments):
    interrupt = Interrupt()
    if arguments and arguments[0] == "contact":
        from .contact import compare_contact

        return compare_contact(arguments[1:], interrupt)
    if arguments and arguments[0] in ("facets", "ball"):
        from . import studies

        return getattr(studies, arguments[0])(arguments[1:])
    words = parser_of().parse_args(arguments)
    words.given = arguments
    return Comparison(words, interrupt).run()


def run(command, arguments):
    try:
        if not {"-h", "--help"} & set(arguments):
            base.need_packages()
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
