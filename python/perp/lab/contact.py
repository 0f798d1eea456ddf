# SPDX-License-Identifier: Apache-2.0
"""perp-compare contact: variants x problems of contact with Coulomb friction, each cell a `perp contact` of its own.

A cell counts as solved by its variant's own law: glocker, coulomb and ncp1 by Coulomb's exact law, faceted and
frictionless variants by the law of their affine problem; what Coulomb's law says of them stands beside it.
"""

import argparse
import math
import os
import shlex
from collections import Counter
from statistics import median

from .campaign import SOLVED, Campaign, add_options, count, machine, print_table
from .cells import answer_of, crash_words, source_of
from .files import InputError, crc_of, csv_text, number, pretty, write_files
from .process import one_line, run

KEYS = (
    "variant", "problem", "exact", "outcome", "status", "solved_by", "contacts", "iterations", "seconds", "peak_mb",
    "siconos", "rr9118", "scaled", "own_residual", "message", "command",
)  # fmt: skip
DEFAULT = (
    "glocker+auto,glocker+homotopy,glocker+path/B,glocker+semismooth/B,glocker+smooth/B,inner:8,outer:8,frictionless"
)
READING = 10  # s, beside the solve's own limit twice: then a process counts as hanging
LEAST_TIME = 1e-6  # s; below it times are noise
OUTCOME_OF = {
    "Solved": "solved", "Infeasible": "infeasible", "TimeLimit": "time-limit", "OutOfMemory": "memory-limit",
    "NotApplicable": "not-applicable",
}  # fmt: skip


def run_contact(program, words, tol, time_limit, memory_mb, stopped):
    """The End of `perp contact WORDS`, its answer, and the command."""
    arguments = ["contact", *words, "--tol", repr(tol), "--time-limit", repr(time_limit)]
    arguments += ["--log-level", "quiet", "--json", "-"]
    end = run([program.path, *arguments], seconds=2 * time_limit + READING, memory_mb=memory_mb, stopped=stopped)
    return end, answer_of(end, "perp contact"), "perp " + shlex.join(arguments[:-4])


def cell_of(end, answer, campaign):
    """Without variant, problem and command."""
    cell = {**dict.fromkeys(KEYS), "outcome": "crashed", "status": "", "solved_by": "", "message": crash_words(end)}
    cell.update(seconds=end.seconds, peak_mb=end.peak_mb)
    if answer is not None:
        status, message = answer["status"], one_line(answer["message"])
        cell.update(status=status, outcome=OUTCOME_OF.get(status, "failed"), message=message)
        if status == "InputError":
            cell["message"] = "refused: " + message
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
        killed = f"killed after {end.seconds:.3g} s, reading included"
        cell.update(outcome="time-limit", message=told if answer else killed)
    elif cell["seconds"] > campaign["time_limit"] and cell["outcome"] in ("solved", "failed"):
        if cell["outcome"] == "solved":
            cell["message"] = f"solved after {cell['seconds']:.3g} s, beyond the limit"
        cell["outcome"] = "time-limit"
    return cell


class ContactComparison(Campaign):
    NAME, COMMAND, KEYS = "contact_campaign", "perp-compare contact", KEYS
    OPTIONS, LISTS = ("tol", "time_limit", "memory_limit_mb"), ("problems", "variants")

    @classmethod
    def parser(cls):
        words = "Runs variants of formulation and method on problems of contact with friction, a process for each run."
        parser = argparse.ArgumentParser(prog=cls.COMMAND, description=words, allow_abbrev=False)
        problems = "files of FCLIB or Siconos, or NAME:SIZE[:SEED[:MU]]"
        variants = f"FORMULATION[+METHOD][/WORD]...; * as METHOD is every method, * as WORD every form ({DEFAULT})"
        parser.add_argument("problems", nargs="*", metavar="PROBLEM", help=problems)
        parser.add_argument("--variants", metavar="LIST", help=variants)
        add_options(
            parser,
            ("--tol", 1e-8, "tolerance"),
            ("--time-limit", 30.0, "limit of each run"),
            ("--memory-limit", 4096, "limit of the resident memory of a run"),
            ("--jobs", 1, "number of runs at a time; with 1 their times can be compared"),
        )
        cls.add_folder(parser, "contact-comparison")
        return parser

    @staticmethod
    def key(cell):
        return cell["variant"], cell["problem"]

    def asked(self):
        words = self.words
        if not words.problems:
            raise InputError("which problems? FILE..., or NAME:SIZE[:SEED[:MU]] of a generator")
        if len(set(words.problems)) < len(words.problems):
            raise InputError("a problem is there twice")
        asked = []
        for problem in words.problems:
            file = {"file": os.path.abspath(problem), "crc": crc_of(problem)} if os.path.isfile(problem) else {}
            asked.append({"name": problem, **file})
        # Files are read once before anything runs: a misspelt name is no result.
        lists = {"variants": [v["label"] for v in self.expand(words.problems, words.variants or DEFAULT)]}
        version = self.program.version()
        return {"program": "perp", "version": version, self.NAME: 1, **self.options(), **lists, "problems": asked}

    def expand(self, problems, variants):
        return self.program.json("contact", *problems, "--variants", variants, "--json", "-")["variants"]

    def table(self):
        problems = self.campaign["problems"]
        variants = self.expand([source_of(p) for p in problems], ",".join(self.campaign["variants"]))
        return {(v["label"], p["name"]): (p, v) for p in problems for v in variants}

    def make(self, problem, variant):
        words = [source_of(problem), *variant["flags"]]
        limits = (self.campaign[key] for key in self.OPTIONS)
        end, answer, command = run_contact(self.program, words, *limits, self.stopped)
        known = {"variant": variant["label"], "problem": problem["name"], "exact": variant["exact"], "command": command}
        return {**cell_of(end, answer, self.campaign), **known}

    def show(self, cells, complete):
        shown = Shown(self.campaign, cells)
        write_files(self.out, shown.files())
        shown.print()
        out = self.out
        print(f"\n{out}/report.html shows it; {out}/cells.csv has every cell, {out}/profile.svg the profile.")
        return SOLVED


def seconds(value):
    return f"{1e3 * value:.3g} ms" if value < 1 else f"{value:.3g} s"


COLUMNS = {
    "variant": "formulation+method/form", "judged by": "the law whose residual decides",
    "solved": "of the cells that ran", "solved by": "the step that made the accepted point",
    "infeasible": "proven to have no solution", "failed": "the method gave up, or its point is no solution",
    "time limit": "", "broken": "crashed, or beyond the limit of memory", "not applicable": "",
    "time in all": "what was neither solved nor proven infeasible counts as the time limit",
    "iterations": "median of the solved", "exact-law error": "Siconos' metric of Coulomb's law, median of the solved",
    "largest": "of those errors",
}  # fmt: skip


class Shown:
    """What a comparison says: tables for a terminal, a page, a chart."""

    def __init__(self, campaign, cells):
        self.campaign, self.variants = campaign, campaign["variants"]
        self.problems = [p["name"] for p in campaign["problems"]]
        self.table = {(c["variant"], c["problem"]): c for c in cells}
        self.cells = [self.table[v, p] for p in self.problems for v in self.variants if (v, p) in self.table]
        self.exact = {v: all(c["exact"] for c in self.cells if c["variant"] == v) for v in self.variants}
        self.names = [v + ("" if self.exact[v] else " *") for v in self.variants]

    def line(self, variant):
        mine = [c for c in self.cells if c["variant"] == variant]
        counts, solved = Counter(c["outcome"] for c in mine), [c for c in mine if c["outcome"] == "solved"]
        errors = [max(1e-300, number(c["siconos"])) for c in solved]
        by = Counter(c["solved_by"] for c in solved if c["solved_by"]).most_common()
        limit = self.campaign["time_limit"]
        time = sum(c["seconds"] if c["outcome"] in ("solved", "infeasible") else limit for c in mine)
        steps = [max(1, c["iterations"] or 1) for c in solved]
        numbers = (median(steps), median(errors), max(errors)) if solved else (math.nan,) * 3
        broken = counts["crashed"] + counts["memory-limit"]
        return [
            variant, "Coulomb" if self.exact[variant] else "its own", f"{len(solved)}/{len(mine)}",
            ", ".join(f"{name} {n}" for name, n in by), str(counts["infeasible"]), str(counts["failed"]),
            str(counts["time-limit"]), str(broken), str(counts["not-applicable"]), seconds(time),
            *("" if math.isnan(v) else f"{v:.{digits}g}" for v, digits in zip(numbers, (3, 2, 2))),
        ]  # fmt: skip

    def print(self):
        headers = [name if k < 2 else f">{name}" for k, name in enumerate(COLUMNS)]
        print_table(headers, [self.line(v) for v in self.variants])
        for c in self.cells:
            if c["outcome"] == "crashed":
                print(f"CRASH: {c['command']}: {c['message']}")

    def chart(self, name, title, exact_only=False, legend=False):
        from .findings import performance_profiles
        from .report import profile_chart

        def cost(variant, problem):
            cell = self.table.get((variant, problem))
            return max(LEAST_TIME, cell["seconds"]) if cell and cell["outcome"] == "solved" else math.inf

        shown = [k for k, v in enumerate(self.variants) if self.exact[v] or not exact_only]
        profiles = performance_profiles([[cost(self.variants[k], p) for p in self.problems] for k in shown])
        curves = [(f"{name}-m{k}", k, True, profile) for k, profile in zip(shown, profiles)]
        axis = "tau: solve time over the best one's" + ("; *: by a law of its own" if legend else "")
        names = self.names if legend else None
        return profile_chart(name, title, axis, curves, len(self.problems), True, names, what="problems")

    def page(self):
        from . import report

        charts = [self.chart("contact-all", "All variants, each by its own law (* not Coulomb's)")]
        if any(self.exact.values()) and not all(self.exact.values()):
            charts.insert(0, self.chart("contact-exact", "Coulomb's exact law", exact_only=True))
        legend = [{"m": k, "style": k, "name": name, "on": True} for k, name in enumerate(self.names)]
        lines, words = [self.line(v) for v in self.variants], ("judged by", "solved", "solved by")
        profiles = {"legend": legend, "charts": [{"charts": charts}]}
        sections = [
            report.section("variants", "Variants", report.table("Variants", COLUMNS, lines, words=words)),
            report.section("profiles", "Performance profiles", profiles),
            report.section("problems", "Every problem", self.every_problem(report)),
        ]
        c = self.campaign
        limits = f"{c['time_limit']:g} s, {c['memory_limit_mb']} MB; each in a process of its own"
        how = {"program": f"perp {c['version']}", "machine": report.machine_words(machine())}
        how |= {"tolerance": f"{c['tol']:g}", "limits of a run": limits}
        sizes = f"{count(len(self.variants), 'variant')} on {count(len(self.problems), 'problem')}"
        title, sub = "Contact problems: formulations and methods", f"{sizes} \u00b7 perp {c['version']}"
        return report.html_page(kind="contact", title=title, sub=sub, sections=sections, how=how)

    def every_problem(self, report):
        def shown(c):
            if c is None or c["outcome"] != "solved":
                return report.cell(c["outcome"] if c else "-", None, "bad" if c else "", c["message"] if c else "")
            error = "" if c["exact"] else f"; error {number(c['siconos']):.2g}"
            return report.cell(seconds(c["seconds"]) + error, c["seconds"], "", c["message"])

        rows = []
        for problem in self.problems:
            mine = [self.table.get((v, problem)) for v in self.variants]
            contacts = max((c["contacts"] or 0 for c in mine if c), default=0)
            rows.append([os.path.basename(problem), contacts, *map(shown, mine)])
        caption = "Time of the solve; where the law is not Coulomb's, also the error of Coulomb's law"
        return report.table(caption, dict.fromkeys(("problem", "contacts", *self.variants), ""), rows)

    def files(self):
        whole = {"program": "perp", "version": self.campaign["version"], "schema": "perp/contact-cells/1"}
        title = "Problems solved within tau times the best time"
        return {
            "cells.csv": csv_text([KEYS, *(c.values() for c in self.cells)]),
            "cells.json": pretty({**whole, "cells": self.cells}),
            "profile.svg": self.chart("profile", title, legend=True),
            "report.html": self.page(),
        }
