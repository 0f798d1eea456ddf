# SPDX-License-Identifier: Apache-2.0
"""perp-compare contact: variants x problems of contact with Coulomb friction, each cell a `perp contact` of its own.

A cell counts as solved by its variant's own law: glocker, coulomb and ncp1 by Coulomb's exact law, faceted and
frictionless variants by the law of their affine problem; what Coulomb's law says of them stands beside it.
"""

import argparse
import math
import os
import shlex
import sys
from collections import Counter

from . import campaign as base
from .campaign import Environment, InputError, Journal, Lock, Program, count, number
from .cells import answer_of, check_seen
from .compare import INTERRUPTED, SOLVED, campaign_flags, limits, note, table
from .process import Pool, Request, one_line

KEYS = (
    "variant", "problem", "exact", "outcome", "status", "solved_by", "contacts", "iterations", "seconds", "peak_mb", "siconos",
    "rr9118", "scaled", "own_residual", "message", "command",
)  # fmt: skip
DEFAULT = "glocker+auto,glocker+homotopy,glocker+path/B,glocker+semismooth/B,glocker+smooth/B,inner:8,outer:8,frictionless"
READING = 10  # s, beside the solve's own limit twice: then a process counts as hanging
LEAST_TIME = 1e-6  # s; below it times are noise
OUTCOME_OF = {
    "Solved": "solved", "Infeasible": "infeasible", "TimeLimit": "time-limit", "OutOfMemory": "memory-limit",
    "NotApplicable": "not-applicable",
}  # fmt: skip
FILES = ("lock", "campaign.json", "cells.jsonl", "cells.csv", "cells.json", "profile.svg", "report.html")


def key(cell):
    return cell["variant"], cell["problem"]


def cell_of(end, campaign):
    """Of a process that has ended; without variant, problem and command."""
    answer, cell = answer_of(end), dict.fromkeys(KEYS)
    numbers = dict.fromkeys(("siconos", "rr9118", "scaled", "own_residual"))
    cell.update(numbers, outcome="failed", status="", solved_by="", seconds=end.seconds, peak_mb=end.peak_mb, message="")
    if answer is not None:
        cell["status"], cell["message"] = answer["status"], one_line(answer["message"])
        cell["outcome"] = OUTCOME_OF.get(answer["status"], "failed")
        if answer["status"] == "InputError":
            cell["message"] = "refused: " + cell["message"]
        elif "stats" in answer:
            stats, residual = answer["stats"], answer["residual"]
            cell.update({name: residual[name] for name in ("siconos", "rr9118", "scaled")})
            cell.update(solved_by=answer["solved_by"] or "", contacts=len(answer["contacts"]), seconds=stats["time_s"])
            cell["own_residual"] = answer["own_residual"]
            cell["iterations"] = stats.get("iterations", -1) + stats.get("newton_steps", 0) + stats.get("sweeps", 0)
    if end.why == "memory":
        cell.update(outcome="memory-limit", message=f"killed: more than {campaign['memory_limit_mb']} MB")
    elif end.why == "time":
        told = f"told to end after {end.seconds:.3g} s; {cell['message']}"
        cell.update(outcome="time-limit", message=told if answer else f"killed after {end.seconds:.3g} s, reading included")
    elif answer is None:
        check_seen(end, "perp contact")
        if not end.signal and end.code != 3:
            raise Environment(f"perp contact left no result: {end.words()}; {one_line(end.err.decode('utf-8', 'replace')[-300:])}")
        cell.update(outcome="crashed", message=end.words() + ("" if end.signal else ", no result"))
    elif answer["status"] == "Interrupted":
        raise Environment("perp contact was interrupted from outside")
    if cell["seconds"] > campaign["time_limit"] and cell["outcome"] in ("solved", "failed"):
        if cell["outcome"] == "solved":
            cell["message"] = f"solved after {cell['seconds']:.3g} s, beyond the limit"
        cell["outcome"] = "time-limit"
    return cell


def differences(before, now):
    files = {p["name"]: p.get("crc") for p in before["problems"]}
    triples = [(f"content (CRC) of {p['name']}", files[p["name"]], p.get("crc")) for p in now["problems"] if p["name"] in files]
    triples += [("--" + k.removesuffix("_mb").replace("_", "-"), before[k], now[k]) for k in ("tol", "time_limit", "memory_limit_mb")]
    found = base.named_differences("variants", before["variants"], now["variants"])
    found += base.named_differences("problems", list(files), [p["name"] for p in now["problems"]])
    return found + base.value_differences([*triples, ("version of perp", before["version"], now["version"])])


class Comparison:
    def __init__(self, words, interrupt):
        self.words, self.interrupt, self.out, self.program = words, interrupt, words.out, Program(words.program)
        self.open_cells = []

    def asked(self, before):
        words = self.words
        problems = words.problems or [p.get("file", p["name"]) for p in before["problems"]]
        if len(set(problems)) < len(problems):
            raise InputError("a problem is there twice")
        listed = words.variants or (",".join(before["variants"]) if before else DEFAULT)
        # Files are read once before anything runs: a misspelt name is no result.
        self.variants = self.program.json("contact", *problems, "--variants", listed, "--json", "-")["variants"]
        names = {p.get("file", p["name"]): p["name"] for p in before["problems"]} if before else {}
        usual = {"tol": 1e-8, "time_limit": 30.0, "memory_limit_mb": 4096, **(before or {})}
        given = {"tol": words.tol, "time_limit": words.time_limit, "memory_limit_mb": words.memory_limit}
        values = {name: usual[name] if value is None else value for name, value in given.items()}
        head = {"program": "perp", "version": self.program.json("methods", "--json")["version"], "contact_campaign": 1}
        asked = [{"name": names.get(p, p), **({"file": os.path.abspath(p), "crc": base.crc_of(p)} if os.path.isfile(p) else {})} for p in problems]
        return {**head, **values, "variants": [v["label"] for v in self.variants], "problems": asked}

    def run(self):
        words, holds = self.words, os.path.exists(os.path.join(self.out, "campaign.json"))
        resumed = words.resume and holds
        if not words.problems and not resumed:
            raise InputError(f"--resume: there is no campaign in '{self.out}'" if words.resume else "which problems? FILE..., or NAME:SIZE[:SEED[:MU]] of a generator")
        before = base.read_campaign(self.out, "contact_campaign") if resumed else None
        self.campaign = self.asked(before)
        if before and (found := differences(before, self.campaign)):
            lines = "\n  ".join(found)
            raise InputError(f"--resume: '{self.out}' holds another campaign:\n  {lines}")
        base.check_apart([os.path.join(self.out, name) for name in FILES], [p.get("file") for p in self.campaign["problems"]])
        base.make_folder(self.out, not resumed)
        self.lock = Lock(self.out)
        if not resumed:
            base.write_files([(os.path.join(self.out, "campaign.json"), base.pretty(self.campaign))])
        return self.work(Journal(self.out))

    def work(self, journal):
        campaign = self.campaign
        done, dropped = base.read_cells(self.out, key, KEYS)
        for line in dropped:
            note(f"{self.out}/cells.jsonl, {line}: left out, its cell runs again")
        all_ = [(p, v) for p in campaign["problems"] for v in self.variants]
        pending = [(p, v) for p, v in all_ if (v["label"], p["name"]) not in done]
        numbers = count(len(self.variants), "variant"), count(len(campaign["problems"]), "problem"), count(len(all_), "cell")
        print(f"perp: {numbers[0]} x {numbers[1]}: {numbers[2]}" + (f", {len(pending)} of them to do" if done else ""), file=sys.stderr)

        def task(problem, variant):
            words = ["contact", problem.get("file", problem["name"]), *variant["flags"]]
            words += ["--tol", repr(campaign["tol"]), "--time-limit", repr(campaign["time_limit"])]
            flags = ["--log-level", "quiet", "--json", "-"]
            end = yield Request([self.program.path, *words, *flags], 2 * campaign["time_limit"] + READING, 2, campaign["memory_limit_mb"])
            try:
                cell = cell_of(end, campaign)
            except Environment as why:
                self.open_cells.append(str(why))
                return
            cell.update(variant=variant["label"], problem=problem["name"], exact=variant["exact"], command="perp " + shlex.join(words))
            journal.add(cell)
            done[key(cell)] = cell
            print(f"perp: {len(done)} of {len(all_)}: {cell['problem']}, {cell['variant']}: {cell['outcome']} after {seconds(cell['seconds'])}", file=sys.stderr, flush=True)

        try:
            Pool(self.words.jobs or 1, self.interrupt).run(task(*cell) for cell in pending)
        except (Environment, OSError) as error:
            self.open_cells.append(str(error))
        shown = Shown(campaign, done)
        shown.write(self.out)
        shown.print()
        print(f"\n{self.out}/report.html shows it; {self.out}/cells.csv has every cell, {self.out}/profile.svg the profile.")
        if len(shown.cells) == len(all_):
            return SOLVED
        for why in dict.fromkeys(self.open_cells[:5]):
            print(f"perp: a cell stays open: {why}", file=sys.stderr)
        again = f"'perp-compare contact --out {shlex.quote(self.out)} --resume' goes on"
        print(f"perp: {'interrupted' if self.interrupt() else 'open'}; {len(shown.cells)} of {numbers[2]} are done. {again}", file=sys.stderr)
        return INTERRUPTED


def seconds(value):
    return f"{1e3 * value:.3g} ms" if value < 1 else f"{value:.3g} s"



def median(values):
    """Geometric between the middle two."""
    values = sorted(values)
    return math.sqrt(values[(len(values) - 1) // 2] * values[len(values) // 2]) if values else math.nan


COLUMNS = {
    "variant": "formulation+method/form", "judged by": "the law whose residual decides", "solved": "of the cells that ran",
    "solved by": "the step that made the accepted point", "infeasible": "proven to have no solution",
    "failed": "the method gave up, or its point is no solution", "time limit": "", "broken": "crashed, or beyond the limit of memory",
    "not applicable": "", "time in all": "what was neither solved nor proven infeasible counts as the time limit",
    "iterations": "median of the solved", "exact-law error": "Siconos' metric of Coulomb's law, median of the solved",
    "largest": "of those errors",
}  # fmt: skip
SHORT = {"failed": "failed", "time-limit": "limit", "memory-limit": "memory", "crashed": "CRASH", "infeasible": "infeasible"}
LAWS = "A variant is a formulation of the problem and a method. glocker, coulomb and ncp1 are solved when Coulomb's law of friction holds: the natural map of the impulses r, which is 0 at a solution, is at most the tolerance relative to max(|q|, |r|, |u|) (the metric of the program Siconos 4.4) and relative to |q| (INRIA's report RR-9118); q are the velocities without impulses, u those with them. inner:K and outer:K replace the disk of friction by a polygon of K corners in it or edges around it, frictionless leaves friction out: laws of their own. They are solved when their own affine problem is; by how much their impulses violate Coulomb's law stands beside it."
PROFILE = "Share of the problems solved within tau times the best time on each (Dolan & Mor\u00e9 2002). A curve's height at tau = 1 is the share on which the variant is the quickest; far to the right stands what it solves at all."


class Shown:
    """What a comparison says: tables for a terminal, a page, a chart."""

    def __init__(self, campaign, cells):
        self.campaign, self.variants, self.problems = campaign, campaign["variants"], [p["name"] for p in campaign["problems"]]
        self.table = {k: c for k, c in cells.items() if k[0] in self.variants and k[1] in self.problems}
        self.cells = [self.table[v, p] for p in self.problems for v in self.variants if (v, p) in self.table]
        self.exact = {v: all(c["exact"] for c in self.cells if c["variant"] == v) for v in self.variants}

    def line(self, variant):
        mine = [c for c in self.cells if c["variant"] == variant]
        counts, solved = Counter(c["outcome"] for c in mine), [c for c in mine if c["outcome"] == "solved"]
        errors = [max(1e-300, number(c["siconos"])) for c in solved]
        by = Counter(c["solved_by"] for c in solved if c["solved_by"])
        time = sum(c["seconds"] if c["outcome"] in ("solved", "infeasible") else self.campaign["time_limit"] for c in mine)
        broken = counts["crashed"] + counts["memory-limit"]
        steps, error = median(max(1, c["iterations"] or 1) for c in solved), median(errors)
        return [
            variant, "Coulomb" if self.exact[variant] else "its own", f"{len(solved)}/{len(mine)}",
            ", ".join(f"{name} {n}" for name, n in by.most_common()),
            *map(str, (counts["infeasible"], counts["failed"], counts["time-limit"], broken, counts["not-applicable"])), seconds(time),
            *("" if math.isnan(v) else f"{v:.{d}g}" for v, d in ((steps, 3), (error, 2), (max(errors, default=math.nan), 2))),
        ]  # fmt: skip

    def contacts(self, problem):
        known = [c["contacts"] for c in self.cells if c["problem"] == problem and c["contacts"] is not None]
        return str(max(known)) if known else ""

    def word(self, cell):
        return "-" if cell is None else seconds(cell["seconds"]) if cell["outcome"] == "solved" else SHORT.get(cell["outcome"], "n/a")

    def print(self):
        table([name if k < 2 else f">{name}" for k, name in enumerate(COLUMNS)], [self.line(v) for v in self.variants])
        print("\nTimes; [1], [2], ... are the variants in the order above")
        rows = [[os.path.basename(p)[:36], self.contacts(p), *(self.word(self.table.get((v, p))) for v in self.variants)] for p in self.problems]
        table(["problem", ">contacts", *(f">[{k}]" for k in range(1, len(self.variants) + 1))], rows)
        for c in self.cells:
            if c["outcome"] == "crashed":
                print(f"CRASH: {c['command']}: {c['message']}")

    def chart(self, title, exact_only, legend=False):
        from .findings import performance_profiles
        from .report import figure, line_style, profile_chart, svg_of

        def cost(variant, problem):
            cell = self.table.get((variant, problem))
            return max(LEAST_TIME, cell["seconds"]) if cell and cell["outcome"] == "solved" else math.inf

        shown = [(k, v) for k, v in enumerate(self.variants) if self.exact[v] or not exact_only]
        profiles = performance_profiles([[cost(v, p) for p in self.problems] for _, v in shown])
        name = f"profile{'-exact' if exact_only else ''}"
        curves = [(f"{name}-m{k}", k, True, profile) for (k, _), profile in zip(shown, profiles)]
        x = "tau: solve time over the best one's"
        if not legend:
            return profile_chart(name, title, x, curves, len(self.problems), True)
        made, axes = figure(name, height=4.1 + 0.11 * len(shown))
        for (k, v), profile in zip(shown, profiles):
            xs = [1, *(at for at, _ in profile), 2 * max((at for _, p in zip(shown, profiles) for at, _ in p), default=1)]
            ys = [0, *(100 * n / len(self.problems) for _, n in profile)]
            axes.step(xs, [*ys, ys[-1]], where="post", label=v + ("" if self.exact[v] else " *"), **line_style(k))
        axes.set(xscale="log", title=title, xlabel=x + "; *: by a law of its own", ylabel="problems solved [%]")
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2, frameon=False, fontsize=8.5)
        return svg_of(made, inline=False)

    def page(self):
        from . import report

        c = self.campaign
        legend = [{"m": k, "style": k, "name": v + ("" if self.exact[v] else " *"), "on": True} for k, v in enumerate(self.variants)]
        charts = [self.chart("All variants, each by its own law (* not Coulomb's)", False)]
        if any(self.exact.values()) and not all(self.exact.values()):
            charts.insert(0, self.chart("Coulomb's exact law", True))
        columns = [report.column(name, tip, k > 3) for k, (name, tip) in enumerate(COLUMNS.items())]
        lines = [[report.cell(words) for words in self.line(v)] for v in self.variants]
        sections = [
            {"id": "variants", "title": "Variants", "short": "Variants", "blocks": [report.table("Variants", columns, lines)]},
            {"id": "profiles", "title": "Performance profiles", "short": "Profiles", "blocks": [report.text(PROFILE), {"id": "contact", "legend": legend, "tabs": [{"title": "", "charts": charts}]}]},
            {"id": "problems", "title": "Every problem", "short": "Every problem", "blocks": [self.cells_table(report)]},
        ]
        how = [
            ("program", f"perp {c['version']}"), ("machine", report.machine_words(base.machine())), ("tolerance", f"{c['tol']:g}"),
            ("limits of a run", f"{c['time_limit']:g} s, {c['memory_limit_mb']} MB; each in a process of its own"),
        ]  # fmt: skip
        words = f"{count(len(self.variants), 'variant')} on {count(len(self.problems), 'problem')}"
        return report.html_page(title="Contact problems: formulations and methods", sub=f"{words} \u00b7 perp {c['version']}", before=[report.text(LAWS)], findings=[], sections=sections, how=how, after=[], data="")

    def cells_table(self, report):
        rows = []
        for p in self.problems:
            row = [report.cell(os.path.basename(p)), report.cell(self.contacts(p))]
            mine = [self.table.get((v, p)) for v in self.variants]
            best = min((c["seconds"] for c in mine if c and c["exact"] and c["outcome"] == "solved"), default=0)
            for c in mine:
                solved = c is not None and c["outcome"] == "solved"
                words = self.word(c) + (f"; error {number(c['siconos']):.2g}" if solved and not c["exact"] else "")
                css = ("best" if c["exact"] and c["seconds"] <= best else "") if solved else "soft" if c is None else "bad"
                row.append(report.cell(words, key=c["seconds"] if solved else None, css=css, tip=c["message"] if c else ""))
            rows.append(row)
        columns = [report.column("problem", is_number=False), report.column("contacts"), *map(report.column, self.variants)]
        return report.table("Time of the solve; where the law is not Coulomb's, also the error of Coulomb's law", columns, rows)

    def write(self, folder):
        whole = {"program": "perp", "version": self.campaign["version"], "schema": "perp/contact-cells/1", "cells": self.cells}
        title = "Problems solved within tau times the best time"
        rows = [KEYS, *(["yes" if v is True else "no" if v is False else v for v in c.values()] for c in self.cells)]
        files = {"cells.csv": base.csv_text(rows), "cells.json": base.pretty(whole), "profile.svg": self.chart(title, False, True), "report.html": self.page()}
        base.write_files([(os.path.join(folder, name), content) for name, content in files.items()])


def compare_contact(arguments, interrupt):
    words = "Runs variants of the formulation and method on all problems of contact with friction, each in a process of its own."
    parser = argparse.ArgumentParser(prog="perp-compare contact", description=words, allow_abbrev=False)
    parser.add_argument("problems", nargs="*", metavar="PROBLEM", help="files of FCLIB or Siconos, or NAME:SIZE[:SEED[:MU]]")
    variants = f"FORMULATION[+METHOD][/WORD]...; * as METHOD is every method, * as WORD every form; default {DEFAULT}"
    parser.add_argument("--variants", metavar="LIST", help=variants)
    limits(parser, "tolerance (1e-8)", "limit of each run (30)")
    campaign_flags(parser, "contact-comparison", "1, so that times can be compared")
    return Comparison(parser.parse_args(arguments), interrupt).run()
