#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""build.py ENGINE LICENCES VERSION FOLDER: makes of perp-engine.wasm the page, FOLDER/page, which a browser can open from a
disk, and the npm package, FOLDER/npm. scripts/portable web runs it."""

import base64
import gzip
import json
import re
import shutil
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
MODELS = ROOT / "data" / "models"
CONTACT = ROOT / "data" / "contact"

#: Title, text, the words that name the problem to the program, its files.
EXAMPLES = [
    ("cournot", "Five power stations with capacities compete", "cournot.nl"),
    ("energy", "Prices and flows of two fuels between regions, with rents", "energy.nl"),
    ("economy", "A trading economy with unemployment, a quota and permits", "economy.nl"),
    ("growth", "Growth over time with an exhaustible resource", "growth.nl"),
    ("harberger", "General equilibrium with a tax on capital in one sector", "harberger.nl"),
    ("spatial", "Prices and flows between regions; the flows are not unique", "spatial.nl"),
    ("streets", "Traffic in equilibrium on a grid of streets", "streets.nl"),
    ("infeasible-own", "A linear problem without solution, and the proof of that", "infeasible-own"),
    ("arch-9", "A stone arch of nine blocks stands by friction", "arch-9.hdf5"),
    ("spheres-15", "Fifteen spheres in contact with friction", "spheres-15.hdf5"),
]


def classic(*sources):
    """Modules of JavaScript, one after the other, as a script: workers of a page on a disk can be nothing else."""
    text = "\n".join(source.read_text(encoding="utf-8") for source in sources)
    text = re.sub(r"^import .*\n", "", text, flags=re.M)
    return '"use strict";\n' + re.sub(r"^export ", "", text, flags=re.M)


def base64_of(data):
    return base64.b64encode(data).decode()


def example(title, text, problem):
    stem = Path(problem).stem
    paths = [path for path in (MODELS / problem, MODELS / f"{stem}.row", MODELS / f"{stem}.col", CONTACT / problem) if path.is_file()]
    files = {path.name: base64_of(path.read_bytes()) for path in paths}
    return {"title": title, "text": text, "words": [problem], "files": files, "contact": problem.endswith(".hdf5")}


def build_page(engine, version, folder):
    content = {
        "version": version,
        "worker": classic(HERE / "engine" / "wasi.js", HERE / "engine" / "program.js", HERE / "page" / "worker.js"),
        "examples": [example(*words) for words in EXAMPLES],
        "program": base64_of(gzip.compress(engine, mtime=0)),
    }
    for name in ("index.html", "page.css", "page.js"):
        shutil.copy(HERE / "page" / name, folder)
    (folder / "engine.js").write_text(f"const perp_engine = {json.dumps(content)};\n", encoding="utf-8")


def build_npm(engine, version, folder):
    shutil.copytree(HERE / "npm", folder, dirs_exist_ok=True)
    for source in (HERE / "engine").iterdir():
        shutil.copy(source, folder)
    package = json.loads((HERE / "npm" / "package.json").read_text(encoding="utf-8"))
    package["version"] = version
    (folder / "package.json").write_text(json.dumps(package, indent=2) + "\n", encoding="utf-8")
    (folder / "perp.wasm").write_bytes(engine)


def main():
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    engine, licences, version, folder = Path(sys.argv[1]).read_bytes(), Path(sys.argv[2]), sys.argv[3], Path(sys.argv[4])
    for part, build in (("page", build_page), ("npm", build_npm)):
        place = folder / part
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir(parents=True)
        build(engine, version, place)
        shutil.copytree(licences, place / "licences")
        for name in ("LICENSE", "NOTICE"):
            shutil.copy(ROOT / name, place)


if __name__ == "__main__":
    main()
