#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How far the engines' answers are from Coulomb's law, and Perp's, in newtons, metres per second and degrees.

    table.py PERP FOLDER PICTURE.svg

PERP is the program perp, FOLDER has the files of record.py. Solves every problem with the default of `perp contact`,
judges all answers by `step.errors`, prints two tables as Markdown, and draws a picture. Needs h5py and matplotlib from
PyPI.
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
from step import Array, Step, delassus, errors, read

KINDS = {"friction": "friction [N]", "normal": "normal [m/s]", "creep": "creep [m/s]", "angle": "angle [degrees]"}


class Answer(NamedTuple):
    """The largest errors of a law at a step."""

    scene: str
    engine: str
    law: str
    worst: dict[str, float]  # of KINDS; angle is NaN where nothing slips
    force: float  # [N]


def largest(values: Array) -> float:
    return float("nan") if np.isnan(values).all() else float(np.nanmax(values))


def solve(program: str, file: Path) -> dict:
    """What `perp contact` says, and the seconds of the processor that it took."""
    command = [program, "contact", str(file), "--json", "-", "--log-level", "quiet"]
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    result = json.loads(subprocess.run(command, capture_output=True, text=True).stdout)
    return result | {"seconds": resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before}


def answers(step: Step, result: dict) -> list[Answer]:
    """Of the engine's laws, and of Perp."""
    W, _ = delassus(step)
    points = [(f"{step.engine.split()[0]}, {point.law}", point.r, point.v) for point in step.points]
    r = np.array([contact["r"] for contact in result["contacts"]]).ravel()
    points.append(("Perp", r, np.linalg.solve(step.M, step.H @ r + step.f)))
    judged = [(law, errors(step, W, r, v)) for law, r, v in points]
    return [
        Answer(step.scene, step.engine, law, {k: largest(getattr(e, k)) for k in KINDS}, largest(e.force))
        for law, e in judged
    ]


def figures(some: list[Answer], kind: str) -> str:
    """Median and largest over the steps."""
    values = np.array([answer.worst[kind] for answer in some])
    values = values[~np.isnan(values)]
    return ", ".join(short(value) for value in (np.median(values), values.max())) if len(values) else "-"


def short(value: float) -> str:
    if value < 1e-9:
        return "< 1e-9"
    return f"{value:.0f}" if value >= 100 else f"{value:.2g}"


def by_law(all_answers: list[Answer]) -> None:
    print("| law | steps answered |", *(f" {text} |" for text in KINDS.values()), " friction / largest force |", sep="")
    print("|---" * 7 + "|")
    for law in dict.fromkeys(answer.law for answer in all_answers):
        some = [answer for answer in all_answers if answer.law == law]
        share = np.median([answer.worst["friction"] / max(answer.force, 1e-300) for answer in some])
        print(f"| {law} | {len(some)} | " + " | ".join(figures(some, kind) for kind in KINDS) + f" | {short(share)} |")


def by_scene(all_answers: list[Answer], runs: list[tuple[Step, dict]]) -> None:
    print(
        "| scene | contacts | force [N] |",
        *(f" {text} |" for text in KINDS.values()),
        " Perp: solved | slowest, CPU [s] |",
        sep="",
    )
    print("|---" * 9 + "|")
    for engine, scene in dict.fromkeys((step.engine, step.scene) for step, _ in runs):
        mine = [(step, result) for step, result in runs if (step.engine, step.scene) == (engine, scene)]
        law = f"{engine.split()[0]}, {mine[0][0].points[0].law}"
        some = [answer for answer in all_answers if (answer.engine, answer.scene, answer.law) == (engine, scene, law)]
        contacts = [len(step.mu) for step, _ in mine]
        solved = sum(result["status"] == "Solved" for _, result in mine)
        cells = [f"{scene}, {law}", f"{min(contacts)}-{max(contacts)}", f"{max(answer.force for answer in some):.3g}"]
        cells += [figures(some, kind) for kind in KINDS]
        cells += [f"{solved} of {len(mine)}", f"{max(result['seconds'] for _, result in mine):.2g}"]
        print("| " + " | ".join(cells) + " |")


def draw(all_answers: list[Answer], picture: Path) -> None:
    import matplotlib

    matplotlib.use("Agg")
    matplotlib.rcParams |= {"svg.hashsalt": "perp", "font.size": 9}
    from matplotlib import pyplot

    laws = list(dict.fromkeys(answer.law for answer in all_answers))[::-1]
    figure, panels = pyplot.subplots(1, len(KINDS), figsize=(11, 3.2), sharey=True, layout="constrained")
    for panel, (kind, text) in zip(panels, KINDS.items()):
        columns = [np.array([a.worst[kind] for a in all_answers if a.law == law]) for law in laws]
        floor = 1e-12  # [N, m/s, degrees]: below is rounding, and what is 0 has a place, too
        panel.boxplot(
            [np.maximum(c[~np.isnan(c)], floor) for c in columns],
            orientation="horizontal",
            whis=(0, 100),
            widths=0.6,
            medianprops={"color": "#c0392b", "linewidth": 1.5},
        )
        panel.set_xscale("log")
        panel.set_xticks([1e-12, 1e-9, 1e-6, 1e-3, 1])
        panel.set_xlabel(text)
        panel.grid(axis="x", alpha=0.3)
    panels[0].set_yticks(range(1, len(laws) + 1), laws)
    figure.savefig(picture, metadata={"Date": None})


def main(program: str, folder: Path, picture: Path) -> None:
    runs, all_answers = [], []
    for file in sorted(folder.glob("*.hdf5")):
        step, result = read(file), solve(program, file)
        runs.append((step, result))
        all_answers += answers(step, result)
        if result["status"] != "Solved":
            print(f"{file.name}: {result['status']}: {result['message']}", file=sys.stderr)
    runs.sort(key=lambda run: not run[0].engine.startswith("MuJoCo"))
    all_answers.sort(key=lambda answer: (answer.law == "Perp", not answer.engine.startswith("MuJoCo")))
    by_law(all_answers)
    print()
    by_scene(all_answers, runs)
    draw(all_answers, picture)


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3]))
