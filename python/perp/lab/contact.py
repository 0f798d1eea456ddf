# SPDX-License-Identifier: Apache-2.0
"""perp-compare contact: variants x problems of contact with Coulomb friction, each cell a `perp contact` of its own.

A cell counts as solved by its variant's own law: glocker, coulomb and ncp1 by Coulomb's exact law, faceted and
frictionless variants by the law of their affine problem; what Coulomb's law says of them stands beside it.
"""

import argparse
import os
import shlex

from .campaign import add_folder, add_options
from .cells import COUNTS, CellRunner, attempt_of, source_of
from .comparison import Comparison
from .files import InputError, crc_of, number

DEFAULT = (
    "glocker+auto,glocker+homotopy,glocker+path/B,glocker+semismooth/B,glocker+smooth/B,inner:8,outer:8,frictionless"
)
PROBLEM = "a file of FCLIB or Siconos, or NAME:SIZE[:SEED[:MU]]"
READING = 10  # s, beside the solve's own limit twice: then a process counts as hanging
FACTS = ("contacts", "solved_by", "siconos", "rr9118", "command")  # columns of a cell, after those of every comparison
EXACT = ("siconos", "rr9118", "cone_share", "normal_share", "slip_share")  # what Coulomb's law asks to be small


def read_contact(answer):
    """Of a finished `perp contact`, whose judge has seen its point."""
    stats, residual = answer["stats"], answer["residual"]
    natural = max(number(residual[name]) for name in EXACT) if answer["exact"] else number(answer["own_residual"])
    steps = sum(stats.get(name, 0) for name in ("iterations", "newton_steps", "sweeps"))
    facts = {"contacts": len(answer["contacts"]), "solved_by": answer["solved_by"] or ""}
    facts |= {name: residual[name] for name in ("siconos", "rr9118")}
    counts = (steps, *[None] * (len(COUNTS) - 1))
    return {"counts": counts, "seconds": stats["time_s"], "natural": natural, "facts": facts}


class ContactRunner(CellRunner):
    def contact(self, source, flags, tol):
        """(its End, the command that repeats it) of a run of `perp contact`."""
        limit = self.campaign["time_limit"]
        words = ["contact", source, *flags, "--tol", repr(tol), "--time-limit", repr(limit)]
        end = self.run(self.program, *words, "--log-level", "quiet", "--json", "-", seconds=2 * limit + READING)
        return end, "perp " + shlex.join(words)

    def attempt(self, method, problem, start, restart):
        limit = self.campaign["time_limit"]
        end, command = self.contact(source_of(problem), method["options"], self.campaign["tol"])
        made = attempt_of(end, f"{method['label']} on {problem['name']}", read_contact)
        if made.claim in ("solved", "failed") and made.seconds > limit:
            made.claim, made.message = "time-limit", f"{made.message} after {made.seconds:.3g} s, beyond the limit"
        made.facts = {**dict.fromkeys(FACTS), **made.facts, "command": command}
        return made


class ContactComparison(Comparison):
    COMMAND, RUNNER = "perp-compare contact", ContactRunner
    LISTS = ("problems", "variants")

    @classmethod
    def parser(cls):
        words = "Runs variants of formulation and method on problems of contact with friction, a process for each run."
        parser = argparse.ArgumentParser(prog=cls.COMMAND, description=words, allow_abbrev=False)
        variants = f"FORMULATION[+METHOD][/WORD]...; * as METHOD is every method, * as WORD every form ({DEFAULT})"
        parser.add_argument("problems", nargs="*", metavar="PROBLEM", help=PROBLEM)
        parser.add_argument("--variants", metavar="LIST", help=variants)
        add_options(parser, tol=1e-8, time_limit=30.0, memory_limit_mb=4096, jobs=1)
        parser.set_defaults(restarts=0, seed=1, starts=1)
        add_folder(parser, "contact-comparison")
        return parser

    def asked(self):
        return {**super().asked(), "contact": True}

    def items(self):
        asked = self.words.problems
        if not asked:
            raise InputError("which problems? FILE..., or NAME:SIZE[:SEED[:MU]] of a generator")
        if len(set(asked)) < len(asked):
            raise InputError("a problem is there twice")
        unknown = {"n": None, "nonzeros": None, "affine": False, "starts": 1, "known_solutions": 0}
        problems = []
        for name in asked:
            isfile = os.path.isfile(name)
            kind = os.path.splitext(name)[1][1:] if isfile else name.partition(":")[0]
            file = {"file": os.path.abspath(name), "crc": crc_of(name)} if isfile else {}
            problems.append({"name": name, "class": kind, **unknown, "solvable": True, "no_solution": "", **file})
        # Files are read once before anything runs: a misspelt name is no result.
        variants = self.program.json("contact", *asked, "--variants", self.words.variants or DEFAULT, "--json", "-")
        plain = {"external": False, "affine": False, "in_force": {}}
        names = [{"label": v["label"], "name": v["label"], "options": v["flags"]} for v in variants["variants"]]
        return [{**of, **plain, "exact": v["exact"]} for of, v in zip(names, variants["variants"])], problems
