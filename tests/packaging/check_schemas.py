#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What perp writes for other programs, validated by docs/schema: check_schemas.py PERP [PERP_MPI].

Runs the commands below and validates each document. Then each schema has to refuse the documents it has accepted, with
a key removed, with an unknown key, with a value of another type, and of another version. The schemas themselves are
valid, describe every key, and have no part that is not used.

Prints one line a violation; exit status 1 if there is one, 77 if Debian's python3-jsonschema is not installed.
"""

import copy
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

try:
    from jsonschema import Draft202012Validator, RefResolver
    from jsonschema.exceptions import SchemaError, best_match
except ImportError:
    print("skipped: python3-jsonschema is not installed")
    sys.exit(77)

ROOT = Path(__file__).resolve().parent.parent.parent
FOLDER = ROOT / "docs" / "schema"
SHARED = "common"

# (schema of what --json writes or None, exit code or None for 0 or 1, arguments of perp), small documents first
RUNS = [
    (None, 0, "solve data/models/cournot.nl --json cournot.json"),
    ("solve", 0, "solve kojshin"),
    ("solve", 0, "solve kojshin --all 2 --method semismooth"),
    ("solve", 0, "solve murty:3 --method enumeration"),
    ("solve", 0, "solve kojshin --check-derivatives --start 2 --method josephy"),
    ("solve", 0, "solve data/models/cournot.nl --warm-start cournot.json"),
    ("solve", 0, "solve data/models/harberger.nl --verify"),
    ("solve", None, "solve billups --method path"),
    ("solve", 0, "solve M.mtx q.mtx"),
    ("solve", 1, "solve kojshin --max-iterations 1"),
    ("solve", 1, "solve infeasible-own --method lemke"),
    ("solve", 1, "solve feasible-unsolvable-own --all"),
    ("solve", 1, "solve billups --method newton-min"),
    ("solve", 1, "solve helical-valley --start-at zeros.mtx"),
    ("solve", 1, "solve random-pd-own:50 --time-limit 1e-9"),
    ("no-result", 2, "solve nowhere.nl"),
    ("no-result", 2, "solve kojshin --option nowhere=1"),
    ("no-result", 1, "solve kojshin --start-at pipe --time-limit 0.1"),
    ("no-result", 1, "solve kojshin --start-at pipe"),
    ("no-result", 2, "solve kojshin --method lemke"),
    ("no-result", 2, "inspect nowhere.nl"),
    ("no-result", 2, "contact nowhere.dat"),
    ("no-result", 1, "contact pipe --time-limit 0.1"),
    ("inspect", 0, "inspect feasible-unsolvable-own"),
    ("inspect", 0, "inspect helical-valley --start-at zeros.mtx"),
    ("solve", 1, "solve terms.nl"),
    ("inspect", 0, "inspect data/models/harberger.nl"),
    ("inspect", 0, "inspect M.mtx q.mtx"),
    ("explain", 0, "explain data/models/cournot.nl"),
    ("explain", 1, "explain infeasible-own"),
    ("explain", 1, "explain terms.nl"),
    ("explain", 1, "explain feasible-unsolvable-own"),
    ("no-result", 2, "explain nowhere.nl"),
    ("list", 0, "list --class tiny"),
    ("list", 0, "list"),
    ("problem", 0, "list kojshin"),
    ("problem", 0, "list infeasible-own"),
    ("problem", 0, "list obstacle"),
    ("contact", 0, "contact data/contact/incline-4.hdf5"),
    ("contact", 0, "contact plane.dat --method path --encoding A --row original --option delta=1e-9"),
    ("contact", 0, "contact roll.dat"),
    ("contact", 0, "contact incline:3 --formulation inner:4 --form mixed"),
    ("contact", 0, "contact incline:3 --formulation ncp1"),
    ("contact", 1, "contact none.dat"),
    ("contact", 1, "contact none.dat --formulation frictionless"),
    ("contact", 1, "contact stack:3 --formulation outer:4 --method psor"),
    ("contact", 1, "contact spheres:15 --method homotopy --option max_iterations=1"),
    ("contact-runs", 2, "contact incline:3 roll.dat none.dat nowhere.dat"),
    (None, 0, "compare facets incline:3 data/contact/incline-3-sliding.hdf5 --facets 3,6 --json facets.json"),
    ("judge", 1, "judge kojshin --start 2 --full"),
    ("no-result", 2, "judge kojshin nowhere.mtx"),
    ("methods", 0, "methods"),
    ("methods", 0, "methods --show path --option crash_method=none --option cfunction=min"),
    ("contact-variants", 0, "contact incline:3 --variants glocker,inner:4/mixed"),
    (None, 0, "compare --problems kojshin --methods path --out all"),
    (None, 0, "compare --problems kojshin --methods path --shard 1/2 --out shard"),
    (
        None,
        0,
        "compare --problems kojshin,infeasible-own,data/models/cournot.nl --external gone=false"
        " --methods path,lemke,semismooth:max_iterations=1 --starts 1 --restarts 1 --time-limit 20 --out some",
    ),
    (
        None,
        0,
        "compare contact data/contact/incline-4.hdf5 none.dat stack:3 --variants glocker,outer:4+psor --out contact",
    ),
]

# (exit code, arguments of perp-mpi), where it has been built
MPI_RUNS = [(0, "solve M.mtx q.mtx"), (1, "solve M.mtx q.mtx --max-iterations 0 --lower=-1")]
MPI = "solve-mpi"

# Those that get SIGINT as soon as they listen to it.
INTERRUPTED = ("solve kojshin --start-at pipe", "contact spheres:10000")

# (schema, file that the runs have left)
LEFT = [
    ("solve", "cournot.json"),
    ("campaign", "all/campaign.json"),
    ("campaign", "some/campaign.json"),
    ("campaign", "shard/campaign.json"),
    ("cells-line", "some/cells.jsonl"),
    ("report", "all/report.json"),
    ("report", "some/report.json"),
    ("contact-facets", "facets.json"),
    ("campaign", "contact/campaign.json"),
    ("cells-line", "contact/cells.jsonl"),
    ("report", "contact/report.json"),
]

FILES = {
    "M.mtx": "%%MatrixMarket matrix coordinate real general\n2 2 2\n1 1 1\n2 1 1e-300\n",
    "q.mtx": "%%MatrixMarket matrix array real general\n2 1\n-1\n1\n",
    "zeros.mtx": "%%MatrixMarket matrix array real general\n3 1\n0\n0\n0\n",
    # x_2 - exp(x_1) >= 0 and exp(x_1) - x_2 >= 1.
    "terms.nl": "g3 1 1 0\n 2 2 0 0 0 0\n 2 0 0 2 0 0\n 0 0\n 2 2 2\n 0 0 0 1\n 0 0 0 0 0\n 4 0\n 0 0\n 0 0 0 0 0\nC0\no16\no44\nv0\nC1\no0\nn-1\no44\nv0\nx0\nr\n5 1 1\n5 1 2\nb\n2 0\n2 0\nk1\n2\nJ0 2\n0 0\n1 1\nJ1 2\n0 0\n1 -1\n",
    # W = I, slipping and sticking; W = 0 and a velocity that nothing stops.
    "plane.dat": "2\n2\n0 4 4\n4 4\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n-1 2 -1 -0.2\n0.5 0.5\n",
    # Rolling in 2D: W = I, mu_r = 0.1.
    "roll.dat": "3\n1\n0 3 3\n3 3\n1 0 0\n0 1 0\n0 0 1\n-1 0.2 1\n0.5\n0.1\n",
    "none.dat": "2\n1\n0 2 2\n2 2\n0 0\n0 0\n-1 0\n0.5\n",
}

# Keys that a document may lack, "*" for an item of a list, and tables of any keys.
OPTIONAL = {("solve", "derivatives"), ("solve", "residual_bound"), ("solve", "proven_by"), ("solve", "certificate"), ("solve", "verified"), ("solve", "deflation"), ("campaign", "shard"), ("solve", "variables.*.basis"), ("judge", "lower"), ("judge", "x"), ("judge", "upper")}
OPTIONAL |= {("solve", "certificate.terms_from"), ("explain", "conflict.certificate.terms_from")}
OPTIONAL |= {("contact", "states.roll"), ("contact", "contacts.*.mu_r")}  # with rolling friction
OPTIONAL |= {("contact-runs", "problems.*." + key) for key in ("states.roll", "contacts.*.mu_r")}
OPTIONAL |= {("cells-line", "cell." + key) for key in ("contacts", "solved_by", "siconos", "rr9118", "command")}
OPTIONAL |= {("campaign", "contact"), ("campaign", "methods.*.exact")}  # of contact
OPTIONAL |= {("methods", key) for key in ("method", "affine", "options", "notes")}
OPEN = {("solve", "options"), ("methods", "options"), ("campaign", "methods.*.in_force")}
# Where a document says its version; the cells of a comparison have that of its campaign.
VERSIONS = ("schema", "campaign")
UNVERSIONED = {"cells-line"}
WRONG = [[None]]  # fits no key


def no_constant(word):
    raise ValueError(f"{word} is no JSON")


def parsed(text):
    return json.loads(text, parse_constant=no_constant)


class Schemas:
    def __init__(self):
        self.parts = {path.stem: parsed(path.read_text(encoding="utf-8")) for path in sorted(FOLDER.glob("*.json"))}
        self.followed = set()
        store = {(FOLDER / f"{name}.json").as_uri(): part for name, part in self.parts.items()}
        self.validators = {}
        for name, part in self.parts.items():
            resolver = RefResolver((FOLDER / f"{name}.json").as_uri(), part, store)
            self.validators[name] = Draft202012Validator(part, resolver=resolver)

    def follow(self, name, reference):
        """Name of the file and the part that a $ref in the file `name` leads to."""
        file, _, pointer = reference.partition("#")
        name = file.removesuffix(".json") or name
        part = self.parts[name]
        self.followed.add((name, pointer))
        for key in pointer.split("/")[1:]:
            part = part[key]
        return name, part

    def keys(self, name, part, path=(), within=()):
        """(path, whether it is described) of every key that a document may have, "*" for an item of a list. What is part
        of itself is gone into once."""
        if part in within:
            return
        within = (*within, part)
        if "$ref" in part:
            yield from self.keys(*self.follow(name, part["$ref"]), path, within)
        for key, below in part.get("properties", {}).items():
            if below is False:
                continue
            described = below
            while "description" not in described and "$ref" in described:
                described = self.follow(name, described["$ref"])[1]
            yield ".".join((*path, key)), described.get("description", "").endswith((".", "?"))
            yield from self.keys(name, below, (*path, key), within)
        for below in part.get("anyOf", ()):
            yield from self.keys(name, below, path, within)
        if isinstance(part.get("items"), dict):
            yield from self.keys(name, part["items"], (*path, "*"), within)


def places(value, path=()):
    """The path of the document and of everything in it."""
    yield path
    inside = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, below in inside:
        yield from places(below, (*path, key))


def general(path):
    return ".".join("*" if isinstance(key, int) else key for key in path)


def changed(document, path, change):
    """A copy in which change(container, key) has been made at the path."""
    copied = {"": copy.deepcopy(document)}
    container, key = copied, ""
    for step in path:
        container, key = container[key], step
    change(container, key)
    return copied[""]


def remove(container, key):
    del container[key]


def make_wrong(container, key):
    container[key] = WRONG


def add_unknown(container, key):
    container[key]["unknown"] = 0


def raise_version(container, key):
    value = container[key]
    container[key] = value + 1 if isinstance(value, int) else value[:-1] + str(int(value[-1]) + 1)


def bad_documents(name, document, done):
    """(what was done, document) of documents that the schema has to refuse; `done` is what was tried before."""
    for path in places(document):
        where, within = general(path), general(path[:-1])
        value, container = document, None
        for key in path:
            value, container = value[key], value
        # Objects of one place may be of several kinds, which their keys tell.
        around = ((within, container), (where, value))
        kind = tuple(tuple(of) for at, of in around if isinstance(of, dict) and (name, at) not in OPEN)
        if (where, kind) in done:
            continue
        done.add((where, kind))
        yield f"{where} of another type", changed(document, path, make_wrong)
        if isinstance(value, dict) and (name, where) not in OPEN:
            yield f"a key that is unknown in {where}", changed(document, path, add_unknown)
        if path and isinstance(path[-1], str) and (name, where) not in OPTIONAL and (name, within) not in OPEN:
            yield f"no {where}", changed(document, path, remove)
    for key in VERSIONS:
        if isinstance(document, dict) and key in document:
            yield f"another version of {key}", changed(document, (key,), raise_version)


def listens(pid):
    """Whether the process catches SIGINT."""
    status = Path(f"/proc/{pid}/status").read_text(encoding="utf-8")
    caught = next(line.split()[1] for line in status.splitlines() if line.startswith("SigCgt:"))
    return int(caught, 16) >> (signal.SIGINT - 1) & 1 == 1


def documents(perp, perp_mpi, folder):
    """(schema, where from, text) of all that perp writes; None and a complaint where it ends otherwise."""
    (Path(folder) / "data").symlink_to(ROOT / "data")
    os.mkfifo(Path(folder) / "pipe")
    for name, text in FILES.items():
        (Path(folder) / name).write_text(text, encoding="utf-8")
    for schema, code, words in RUNS:
        flags = [] if schema is None else ["--json"] if words.startswith(("list", "methods")) else ["--json", "-"]
        compares = words.startswith("compare ")  # perp-compare beside perp
        command = [f"{perp}-compare" if compares else perp, *words.removeprefix("compare ").split(), *flags]
        with subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as run:
            while words in INTERRUPTED and run.poll() is None and not listens(run.pid):
                time.sleep(0.01)
            if words in INTERRUPTED:
                run.send_signal(signal.SIGINT)
            out, err = run.communicate(timeout=120)
        if run.returncode not in ((0, 1) if code is None else (code,)):
            yield None, f"perp {words}", f"exit code {run.returncode}, not {code}\n{err}"
        elif schema is not None:
            yield schema, f"perp {words}", out
    for code, words in MPI_RUNS if perp_mpi else ():
        run = subprocess.run([perp_mpi, *words.split(" "), "--json", "-"], cwd=folder, capture_output=True, text=True, timeout=120)
        yield (MPI, f"perp-mpi {words}", run.stdout) if run.returncode == code else (None, f"perp-mpi {words}", run.stderr)
    for schema, name in LEFT:
        text = (Path(folder) / name).read_text(encoding="utf-8")
        for line in text.splitlines() if name.endswith(".jsonl") else [text]:
            yield schema, name, line


def check_documents(perp, perp_mpi, schemas, seen):
    """Validates all documents, and what is made of them; `seen` gets the paths of each schema's keys."""
    done = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, source, text in documents(perp, perp_mpi, folder):
            if name is None:
                yield f"{source}: {text}"
                continue
            document = parsed(text)
            validator = schemas.validators[name]
            error = best_match(validator.iter_errors(document))
            if error is not None:
                yield f"{source}: not as {name}.json says at {error.json_path}: {error.message[:1000]}"
                continue
            versioned = isinstance(document, dict) and any(key in document for key in VERSIONS)
            if versioned == (name in UNVERSIONED):
                yield f"{source}: a version where there is none, or none where there is one"
            seen.setdefault(name, set()).update(map(general, places(document)))
            for what, bad in bad_documents(name, document, done.setdefault(name, set())):
                if validator.is_valid(bad):
                    yield f"{name}.json accepts {what} (of {source})"


def check_schemas(schemas, seen):
    """Whether the schemas themselves are in order, and whether the runs have shown all of them."""
    for name, part in schemas.parts.items():
        try:
            Draft202012Validator.check_schema(part)
        except SchemaError as error:
            yield f"{name}.json is no schema: {error.message}"
            continue
        if name == SHARED:
            continue
        if name not in seen:
            yield f"{name}.json: no run writes such a document"
            continue
        version = part.get("properties", {}).get("schema", {}).get("const")
        if version is not None and version.rpartition("/")[0] != f"perp/{name}":
            yield f"{name}.json: describes {version}"
        for key, described in schemas.keys(name, part):
            if not described:
                yield f"{name}.json: {key} is not described in a sentence"
            if key not in seen[name]:
                yield f"{name}.json: no run writes the key {key}"
    for name, part in schemas.parts.items():
        for definition in part.get("$defs", {}):
            used = f"/$defs/{definition}/"
            if not any(file == name and f"{pointer}/".startswith(used) for file, pointer in schemas.followed):
                yield f"{name}.json: nothing uses its {definition}"


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    schemas, seen = Schemas(), {}
    perp, *perp_mpi = (Path(program).resolve() for program in sys.argv[1:])
    if not perp_mpi:
        del schemas.parts[MPI]
    wrong = [*check_documents(perp, perp_mpi[0] if perp_mpi else None, schemas, seen), *check_schemas(schemas, seen)]
    print("\n".join(wrong), end="\n" if wrong else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
