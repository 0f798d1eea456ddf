# SPDX-License-Identifier: Apache-2.0
"""The commands: perp-compare, a campaign and its report; perp-report, the report again, and shards joined."""

import argparse
import sys

from .campaign import INTERRUPTED, REFUSED, SOLVED, interrupts, need_packages, note, parse_shard
from .files import Environment, InputError, cell_line, pretty, read_campaign, read_cells, take_folder, write_files

#: What may differ between the cells of two shards; of a problem's file the content counts.
MAY_DIFFER = {"build", "libraries", "date", "command_line", "machine", "jobs", "shard"}


def same(campaign):
    """Common parts of all shards of a campaign."""
    problems = [{key: value for key, value in p.items() if key != "file"} for p in campaign["problems"]]
    kept = {key: value for key, value in campaign.items() if key not in MAY_DIFFER}
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
    if kind == "forces":
        from .forces import forces

        return forces(arguments[1:])
    if kind in ("facets", "ball"):
        from . import polygons

        return polygons.ball(arguments[1:]) if kind == "ball" else polygons.facets(arguments[1:], interrupts())
    if kind == "contact":
        from .contact import ContactComparison

        return ContactComparison(arguments[1:], interrupts()).run()
    from .comparison import Comparison

    return Comparison(arguments, interrupts()).run()


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
