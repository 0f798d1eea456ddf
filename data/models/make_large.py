#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the large models of this folder's generators: make_large.py FOLDER [PART_OF_NAME]. See ../README.md.

They take some hundred megabytes and a minute; nothing of them is kept in the repository."""

import sys
import time
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from cge import Shock, cge  # noqa: E402
from electricity import expansion, grid_cournot  # noqa: E402
from ramsey import ramsey  # noqa: E402
from spatial import spatial  # noqa: E402
from traffic import traffic  # noqa: E402


def reform():
    return Shock(free_trade=True, output_tax=1.5, world_price=0.2, labour=1.1)


def rationed():
    return Shock(
        output_tax=0.5, world_price=0.2, wage_floor=1.05, quota=0.6, carbon=0.6, backstop=0.95, keep_public=True
    )


MODELS = {
    "cge-100": lambda n: cge(n, 19, 6, reform()),
    "cge-200": lambda n: cge(n, 45, 8, reform(), seed=2),
    "cge-400": lambda n: cge(n, 92, 12, reform(), seed=3),
    "cge-100-benchmark": lambda n: cge(n, 19, 6),
    "cge-100-ones": lambda n: cge(n, 19, 6, reform(), scaled=False, ones=True),
    "cge-200-unscaled": lambda n: cge(n, 45, 8, reform(), scaled=False, seed=2),
    "cge-200-ones": lambda n: cge(n, 45, 8, reform(), scaled=False, ones=True, seed=2),
    "cge-400-ones": lambda n: cge(n, 92, 12, reform(), scaled=False, ones=True, seed=3),
    "cge-100-far": lambda n: cge(n, 19, 6, reform(), spread=2),
    "cge-200-far": lambda n: cge(n, 45, 8, reform(), spread=2, seed=2),
    "cge-400-far": lambda n: cge(n, 92, 12, reform(), spread=2, seed=3),
    "cge-rationed-100-far": lambda n: cge(n, 19, 6, rationed(), spread=2),
    "cge-rationed-200-far": lambda n: cge(n, 45, 8, rationed(), spread=2, seed=2),
    "cge-rationed-400-far": lambda n: cge(n, 92, 12, rationed(), spread=2, seed=3),
    "cge-rationed-100": lambda n: cge(n, 19, 6, rationed()),
    "cge-rationed-200": lambda n: cge(n, 45, 8, rationed(), seed=2),
    "cge-rationed-400": lambda n: cge(n, 92, 12, rationed(), seed=3),
    "cge-rationed-100-ones": lambda n: cge(n, 19, 6, rationed(), scaled=False, ones=True),
    "cge-rationed-200-ones": lambda n: cge(n, 45, 8, rationed(), scaled=False, ones=True, seed=2),
    "cge-rationed-100-zero": lambda n: cge(n, 19, 6, rationed(), lowest=0.0),
    "spatial-linear-25": lambda n: spatial(n, 5, 5, "linear"),
    "spatial-linear-64": lambda n: spatial(n, 8, 8, "linear"),
    "spatial-isoelastic-25": lambda n: spatial(n, 5, 5, "isoelastic", lowest=0.01),
    "spatial-isoelastic-64": lambda n: spatial(n, 8, 8, "isoelastic", lowest=0.01),
    "spatial-isoelastic-25-zero": lambda n: spatial(n, 5, 5, "isoelastic"),
    "spatial-grid-linear-900": lambda n: spatial(n, 30, 30, "linear", neighbours_only=True),
    "spatial-grid-isoelastic-900": lambda n: spatial(n, 30, 30, "isoelastic", neighbours_only=True, lowest=0.01),
    "traffic-one-400": lambda n: traffic(n, 20, 20, 1),
    "traffic-one-1600": lambda n: traffic(n, 40, 40, 1),
    "traffic-one-ties-1600": lambda n: traffic(n, 40, 40, 1, equal_times=True),
    "traffic-many-49": lambda n: traffic(n, 7, 7, 6),
    "traffic-many-100": lambda n: traffic(n, 10, 10, 10),
    "traffic-many-ties-100": lambda n: traffic(n, 10, 10, 10, equal_times=True),
    "traffic-many-sums-49": lambda n: traffic(n, 7, 7, 6, volumes=False),
    "traffic-many-225": lambda n: traffic(n, 15, 15, 8),
    "traffic-few-trips-225": lambda n: traffic(n, 15, 15, 8, origins=10),
    "electricity-36": lambda n: grid_cournot(n, 6, 6, 8),
    "electricity-100": lambda n: grid_cournot(n, 10, 10, 10),
    "expansion-10": lambda n: expansion(n, 10),
    "expansion-50": lambda n: expansion(n, 50),
    "ramsey-30": lambda n: ramsey(n, 30),
    "ramsey-60": lambda n: ramsey(n, 60, cap_from=10),
    "ramsey-60-poor": lambda n: ramsey(n, 60, cap_from=10, capital=0.5),
    "ramsey-30-ones": lambda n: ramsey(n, 30, ones=True),
    "ramsey-60-ones": lambda n: ramsey(n, 60, cap_from=10, ones=True),
}


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name, make in MODELS.items():
        if len(sys.argv) > 2 and sys.argv[2] not in name:
            continue
        begin = time.monotonic()
        model = make(name)
        model.write(folder / f"{name}.nl")
        entries = sum(len(row.linear) for row in model.rows)
        size = (folder / f"{name}.nl").stat().st_size / 1e6
        print(f"{name:28} {len(model.variables):6} variables {entries:7} entries {size:6.1f} MB {time.monotonic() - begin:5.1f} s")


if __name__ == "__main__":
    main()
