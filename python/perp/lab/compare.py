# SPDX-License-Identifier: Apache-2.0
"""The commands: perp-compare, a campaign and its report; perp-report, the report again, and shards joined."""

import argparse
import importlib.util
import sys

from .campaign import INTERRUPTED, REFUSED, SOLVED, note, parse_shard
from .files import Environment, InputError, cell_line, pretty, read_campaign, read_cells, take_folder, write_files

#: What may differ between the cells of two shards; of a problem's file the content counts.
MAY_DIFFER = {"build", "libraries", "date", "command_line", "machine", "jobs", "shard"}


def same(campaign):
    """Common parts of all shards of a campaign."""
    kept = {key: value for key, value in campaign.items() if key not in MAY_DIFFER}
    problems = [{**problem, "file": ""} for problem in campaign["problems"]]
    return {**kept, "problems": problems, "number of shards": parse_shard(campaign.get("shard"))[1]}


def join_shards(folders, out):
    """Makes OUT a campaign of the shards in these folders; sentences about those that are missing."""
    campaign, shards, lines = None, {}, b""
    for folder in folders:
        part = read_campaign(folder)
        number, of = parse_shard(part.get("shard"))
        campaign = campaign or part
        there, here = same(campaign), same(part)
        if apart := sorted(key for key in there | here if there.get(key) != here.get(key)):
            raise InputError(f"'{folders[0]}' and '{folder}' are of different campaigns, by their {', '.join(apart)}")
        if number in shards:
            raise InputError(f"'{shards[number]}' and '{folder}' both hold shard {number}/{of}")
        shards[number] = folder
        cells = read_cells(folder)[0]
        lines += b"".join(cell_line(cells[key]) for key in sorted(cells))
    take_folder(out, True)
    campaign.pop("shard", None)
    write_files(out, {"campaign.json": pretty(campaign), "cells.jsonl": lines.decode("utf-8")})
    return [f"shard {k}/{of} is missing: its cells are not in the report" for k in range(1, of + 1) if k not in shards]


# The commands.


def report(arguments):
    words = "Makes DIR/report.html and its numbers again, also while perp-compare runs, and joins shards."
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
    kind = arguments[0] if arguments else ""
    from . import comparison, contact

    if kind in ("forces", "facets", "ball"):
        return getattr(contact, kind)(arguments[1:])
    return (contact.ContactComparison(arguments[1:]) if kind == "contact" else comparison.Comparison(arguments)).run()


def run(command, arguments):
    try:
        for name in () if {"-h", "--help"} & set(arguments) else ("numpy", "matplotlib", "jinja2"):
            if importlib.util.find_spec(name) is None:  # before anything runs
                where = f"Debian has python3-{name}, pip install 'perp[lab]' elsewhere"
                raise InputError(f"{sys.executable} has no {name}: {where}")
        return command(arguments)
    except (InputError, Environment, OSError) as error:
        print(f"perp: {error}", file=sys.stderr)
        return REFUSED if isinstance(error, InputError) else INTERRUPTED


def main_compare():
    sys.exit(run(compare, sys.argv[1:]))


def main_report():
    sys.exit(run(report, sys.argv[1:]))
