#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Records steps of the scenes as FCLIB files, with the engines' own answers as guesses.

    record.py FOLDER [mujoco|drake ...] [SCENE ...]

Needs h5py, and mujoco or drake, from PyPI. Without engines in the list it takes both, without scenes all.

An answer must balance M v+ = H r + f to 1e-3 of the largest term, or it is not one of this step: tamsi divides steps
and tells the forces of the last part. A step without an answer that does is refused, because the record would be wrong.
Prints what is written, the largest imbalance, and the answers left out.
"""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

from scenes import scenes
from step import imbalance, write

ENGINES = ("mujoco", "drake")


def main(folder: Path, words: list[str]) -> None:
    known = {scene.name: scene for scene in scenes()}
    if unknown := set(words) - set(known) - set(ENGINES):
        sys.exit(f"record.py: neither an engine ({', '.join(ENGINES)}) nor a scene ({', '.join(known)}): {unknown}")
    folder.mkdir(parents=True, exist_ok=True)
    for engine in [e for e in ENGINES if e in words] or ENGINES:
        steps = importlib.import_module(f"{engine}_steps").steps
        for scene in [known[name] for name in known if name in words] or known.values():
            contacts, worst, left_out = [], 0.0, 0
            for step in steps(scene):
                apart = {point.law: imbalance(step, point) for point in step.points}
                step.points = [point for point in step.points if apart[point.law] <= 1e-3]
                if not step.points:
                    sys.exit(f"record.py: {step.name}: momentum is out of balance: {apart}")
                write(step, folder / f"{step.name}.hdf5")
                contacts.append(len(step.mu))
                worst = max([worst, *(apart[point.law] for point in step.points)])
                left_out += len(apart) - len(step.points)
            counts = f"{len(contacts)} steps, {min(contacts)} to {max(contacts)} contacts"
            print(f"{engine} {scene.name}: {counts}, imbalance {worst:.1g}, {left_out} left out", flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
