# SPDX-License-Identifier: Apache-2.0
"""What a comparison was asked to do, DIR/campaign.json, and the journal of its finished cells, DIR/cells.jsonl.

The journal has a line for each finished cell and only grows:

    {"cell":{...},"crc":"xxxxxxxx"}

with zlib's CRC-32 of the text of the cell's object. A line that is torn, or whose text does not fit its CRC, does not
count, wherever it stands. A line is on the disk when Journal.add() returns; one that could not be written is cut off.
"""

import contextlib
import csv
import datetime
import glob
import importlib.util
import io
import json
import math
import os
import platform
import re
import shutil
import subprocess
import sys
import tempfile
import zlib
from difflib import get_close_matches
from fnmatch import fnmatchcase

try:
    import fcntl
except ImportError:  # no lock where there is none
    fcntl = None


class InputError(Exception):
    """What the user can mend: refused, with exit code 2."""


class Environment(Exception):
    """The machine failed (a full disk, a killed process): nothing was seen, so that nothing is booked."""


def suggestion(word, words):
    near = get_close_matches(word, words, 1)
    return f" Did you mean '{near[0]}'?" if near else ""


def count(n, noun, several=None):
    return f"{n} {noun if n == 1 else several or noun + 's'}"


def need_packages():
    """Before anything runs: what the report is made with is there."""
    missing = [name for name in ("matplotlib", "jinja2") if importlib.util.find_spec(name) is None]
    if missing:
        packages = " ".join(f"python3-{name}" for name in missing)
        raise InputError(f"{sys.executable} has no {', '.join(missing)}: Debian has {packages}, pip install 'perp[lab]' elsewhere")


# The program.


class Program:
    def __init__(self, path=None):
        wanted = path or os.environ.get("PERP_PROGRAM") or "perp"
        self.path = shutil.which(wanted)
        if self.path is None:
            raise InputError(f"there is no program '{wanted}': --program or the variable PERP_PROGRAM says where perp is")
        self.path = os.path.abspath(self.path)

    def json(self, *arguments):
        """What the program answers. Raises InputError with its words where it refuses."""
        run = subprocess.run([self.path, *arguments], stdin=subprocess.DEVNULL, capture_output=True, check=False)
        try:
            answer = json.loads(run.stdout)
        except ValueError:
            answer = {}
        if run.returncode not in (0, 1) or not answer:
            said = answer.get("message") or run.stderr.decode("utf-8", "replace").strip() or f"exit code {run.returncode}"
            raise InputError(said.removeprefix("perp: "))
        return answer

    def stamp(self):
        known = self.json("methods", "--json")
        date = datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
        return {"version": known["version"], "build": crc_of(self.path), "libraries": known["libraries"], "date": date}


def machine():
    cpu = "unknown"
    with contextlib.suppress(OSError), open("/proc/cpuinfo", encoding="utf-8") as file:
        cpu = next((line.split(": ", 1)[1].strip() for line in file if line.startswith("model name")), cpu)
    memory = 0
    with contextlib.suppress(OSError, ValueError, AttributeError):
        memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") >> 20
    system = platform.uname()
    words = f"{system.system} {system.release} {system.machine}"
    return {"cpu": cpu, "cores": cores(), "memory_mb": memory, "system": words}


def cores():
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def crc_of(path):
    with open(path, "rb") as file:
        return f"{zlib.crc32(file.read()):08x}"


# JSON, where infinities and NaN are words.

WORDS = {"inf": math.inf, "-inf": -math.inf, "nan": math.nan}


def to_json(value):
    if isinstance(value, float) and not math.isfinite(value):
        return "nan" if math.isnan(value) else "inf" if value > 0 else "-inf"
    if isinstance(value, dict):
        return {key: to_json(item) for key, item in value.items()}
    return [to_json(item) for item in value] if isinstance(value, (list, tuple)) else value


def number(value):
    """A number of JSON as a float: NaN for null."""
    return math.nan if value is None else WORDS[value] if isinstance(value, str) else float(value)


def pretty(value):
    return json.dumps(to_json(value), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


# Files.


def write_files(files):
    """Writes (path, text) pairs, each whole or not at all: drafts of all are on the disk before the first is renamed."""
    drafts = []
    try:
        for path, text in files:
            handle, draft = tempfile.mkstemp(prefix=".perp-", suffix=".part", dir=os.path.dirname(path) or ".")
            drafts.append((draft, path))
            with open(handle, "w", encoding="utf-8", errors="replace", newline="") as file:
                file.write(text)
                file.flush()
                os.fsync(file.fileno())
            mask = os.umask(0)
            os.umask(mask)
            os.chmod(draft, 0o666 & ~mask)
        for draft, path in drafts:
            os.replace(draft, path)
        sync_folder(os.path.dirname(drafts[0][1]))
    except BaseException:
        for draft, _ in drafts:
            with contextlib.suppress(OSError):
                os.unlink(draft)
        raise


def sync_folder(folder):
    with contextlib.suppress(OSError):
        handle = os.open(folder or ".", os.O_RDONLY)
        with contextlib.suppress(OSError):
            os.fsync(handle)
        os.close(handle)


def csv_text(rows):
    """RFC 4180. A text that a spreadsheet would compute gets an apostrophe before it."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    for row in rows:
        writer.writerow(map(field_text, row))
    return out.getvalue()


def field_text(value):
    if isinstance(value, float):
        return repr(value).removesuffix(".0")
    guarded = isinstance(value, str) and value.startswith(tuple("=+-@\t\r")) and value not in WORDS
    return f"'{value}" if guarded else value


class Lock:
    """A folder held by one campaign; the lock goes with the process, however that ends."""

    def __init__(self, folder):
        self.file = open(os.path.join(folder, "lock"), "a+", encoding="ascii")
        if fcntl is None:
            return
        try:
            fcntl.flock(self.file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            self.file.seek(0)
            who = self.file.read().strip()
            raise InputError(f"'{folder}': another campaign is at work there" + (f" (process {who})" if who else "")) from error
        self.file.truncate(0)
        self.file.write(f"{os.getpid()}\n")
        self.file.flush()


class Journal:
    def __init__(self, folder):
        self.path = os.path.join(folder, "cells.jsonl")
        self.file = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o666)
        with open(self.path, "rb") as file:
            text = file.read()
        if text and not text.endswith(b"\n"):
            os.ftruncate(self.file, text.rfind(b"\n") + 1)
        os.fsync(self.file)
        sync_folder(folder)

    def add(self, cell):
        line, before = memoryview(cell_line(cell)), os.fstat(self.file).st_size
        try:
            while line:
                line = line[os.write(self.file, line) :]
            os.fsync(self.file)
        except OSError as error:
            with contextlib.suppress(OSError):
                os.ftruncate(self.file, before)
            raise Environment(f"{self.path}: {error.strerror}") from error


def cell_line(cell):
    text = json.dumps(to_json(cell), separators=(",", ":"), ensure_ascii=False, allow_nan=False).encode("utf-8", "replace")
    return b'{"cell":%s,"crc":"%08x"}\n' % (text, zlib.crc32(text))


def read_cells(folder, key, keys):
    """({key: cell}, what does not count and why); of two cells with one key the later. `keys`: those of a cell."""
    path = os.path.join(folder, "cells.jsonl")
    try:
        with open(path, "rb") as file:
            text = file.read().removeprefix(b"\xef\xbb\xbf")
    except OSError as error:
        raise InputError(f"'{path}' cannot be read") from error
    cells, dropped = {}, []
    *lines, last = text.split(b"\n")
    for place, line in enumerate(lines + [last] * bool(last), 1):
        match = re.fullmatch(rb'\{"cell":(.*),"crc":"([0-9a-f]{8})"\}', line, re.S)
        try:
            if match is None or place > len(lines):
                raise ValueError("torn")
            crc = zlib.crc32(match[1])
            if crc != int(match[2], 16):
                raise ValueError(f"its CRC is {crc:08x}, not {match[2].decode()}")
            cell = json.loads(match[1])
            if list(cell) != list(keys):
                raise ValueError("no cell of this kind of comparison")
            cells[key(cell)] = cell
        except (ValueError, KeyError, TypeError) as error:
            dropped.append(f"line {place}: {error}")
    return cells, dropped


def make_folder(folder, fresh):
    if os.path.exists(folder) and not os.path.isdir(folder):
        raise InputError(f"'{folder}' is a file")
    try:
        os.makedirs(folder, exist_ok=True)
        names = [name for name in os.listdir(folder) if name not in ("lock", "work") and not name.startswith(".perp-")]
    except OSError as error:
        raise InputError(f"'{folder}' cannot be made: {error.strerror}") from error
    if fresh and names:
        holds = "campaign.json" in names
        how = "holds a campaign: --resume goes on with it, --out DIR begins another" if holds else "is not empty: --out DIR names another"
        raise InputError(f"'{folder}' {how}")


CAMPAIGN_KEYS = {"campaign": "perp-compare", "contact_campaign": "perp-compare contact"}


def read_campaign(folder, kind="campaign"):
    path = os.path.join(folder, "campaign.json")
    try:
        with open(path, encoding="utf-8") as file:
            campaign = json.load(file)
        if kind not in campaign:
            raise InputError(f"{path}: no campaign of {CAMPAIGN_KEYS[kind]}")
        if campaign[kind] != 1:
            raise InputError(f"{path}: written in format {campaign[kind]}, of another version")
        for key in ("tol", "time_limit"):
            if not isinstance(campaign[key], (int, float)):
                raise InputError(f"{path}: '{key}' is no number")
        if not all(isinstance(p["name"], str) and 1 <= p.get("starts", 1) <= 10_000 for p in campaign["problems"]):
            raise InputError(f"{path}: a problem has no name, or no starts")
    except OSError as error:
        raise InputError(f"'{path}' cannot be read") from error
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(f"{path}: no campaign: {error}") from error
    return campaign


def named_differences(what, before, now):
    def some(these, others):
        names = [name for name in these if name not in others]
        return ", ".join(names[:5]) + (f" and {len(names) - 5} more" if len(names) > 5 else "")

    gone, added = some(before, now), some(now, before)
    return ([f"{what} there but not here: {gone}"] if gone else []) + ([f"{what} here but not there: {added}"] if added else [])


def value_differences(triples):
    return [f"{what}: {before} there, {now} here" for what, before, now in triples if before != now]


def differences(before, now):
    """What keeps cells of two campaigns apart, one line each. Jobs, build, machine, command line and date may differ."""
    methods = {m["label"]: m for m in before["methods"]}
    problems = {p["name"]: p for p in before["problems"]}
    found = named_differences("methods", methods, [m["label"] for m in now["methods"]])
    found += named_differences("problems", problems, [p["name"] for p in now["problems"]])
    triples = []
    for method in now["methods"]:
        if old := methods.get(method["label"]):
            triples.append((f"command of {method['label']}", old.get("command", ""), method.get("command", "")))
            for key, value in method["in_force"].items():
                triples.append((f"option {key} of {method['label']}", old["in_force"].get(key, "(none)"), value))
    for problem in now["problems"]:
        if old := problems.get(problem["name"]):
            for what, key in (("file of ", "file"), ("content (CRC) of ", "crc"), ("size of ", "n"), ("starts of ", "starts")):
                triples.append((what + problem["name"], old.get(key, ""), problem.get(key, "")))
    keys = ("tol", "time_limit", "memory_limit_mb", "restarts", "seed")
    triples += [("--" + key.removesuffix("_mb").replace("_", "-"), before[key], now[key]) for key in keys]
    return found + value_differences([*triples, ("version of perp", before["version"], now["version"])])


def parse_shard(text):
    """(K, N) of "K/N"; "" is the whole."""
    if not text:
        return 1, 1
    match = re.fullmatch(r"(\d{1,6})/(\d{1,6})", text, re.A)
    if not match or not 1 <= int(match[1]) <= int(match[2]) <= 100_000:
        raise InputError(f"--shard: '{text}' is no K/N with 1 <= K <= N <= 100000, such as 3/7")
    return int(match[1]), int(match[2])


# The LISTs of problems and methods.


def items_of(text, flag):
    """(item, is it taken?) of a comma-separated list; commas in parentheses belong to strategies."""
    items, depth, begin = [], 0, 0
    for at, c in enumerate(text + ","):
        depth += (c == "(") - (c == ")")
        if c == "," and (depth <= 0 or at == len(text)):
            items.append(text[begin:at].strip())
            begin = at + 1
    if any(item in ("", "-") for item in items):
        raise InputError(f"{flag} '{text}': an item is empty")
    pairs = [(item.removeprefix("-"), not item.startswith("-")) for item in items]
    return pairs if any(take for _, take in pairs) else [("all", True), *pairs]


def select(items, expand, name):
    taken, away = {}, set()
    for item, take in items:
        for found in expand(item):
            if take:
                taken.setdefault(name(found), found)
            else:
                away.add(name(found))
    return [found for key, found in taken.items() if key not in away]


def is_pattern(text):
    return any(c in text for c in "*?[")


def of_file(path, by_pattern=False):
    if not path.endswith((".nl", ".dat")):
        raise InputError(f"--problems: '{path}' is neither an .nl nor a .dat file")
    if not os.path.isfile(path):
        raise InputError(f"--problems: there is no file '{path}'")
    file = os.path.realpath(path)
    if not file.isprintable() or any("\ud800" <= c <= "\udfff" for c in file):
        raise InputError(f"--problems: the name of {ascii(file)} is not printable UTF-8")
    kind = "nl" if path.endswith(".nl") else "dat"
    return {"name": os.path.basename(path), "class": kind, "file": file, "by_pattern": by_pattern}


def select_problems(text, program):
    """The problems of a LIST, those of the collection described; sized ones and files are yet to be built."""
    entries = program.json("list", "--json")["problems"]
    known = {entry["name"]: entry for entry in entries}

    def of_entry(entry, name=None):
        problem = {"name": name or entry["name"], "class": entry["class"]}
        return problem if name else {**problem, **described(entry)}

    def expand(item):
        if item == "all":
            return map(of_entry, entries)
        if item.startswith("class:"):
            if found := [of_entry(entry) for entry in entries if fnmatchcase(entry["class"], item[6:])]:
                return found
            classes = ", ".join(sorted({entry["class"] for entry in entries}))
            raise InputError(f"--problems: there is no class '{item[6:]}'; the collection has {classes}")
        if item.endswith((".nl", ".dat")) or "/" in item:
            if not is_pattern(item):
                return [of_file(item)]
            if paths := sorted(glob.glob(item)):
                return [of_file(path, True) for path in paths]
            raise InputError(f"--problems: no file fits '{item}'")
        if is_pattern(item):
            if found := [of_entry(entry) for entry in entries if fnmatchcase(entry["name"], item)]:
                return found
            raise InputError(f"--problems: no problem of the collection fits '{item}'")
        name = item.partition(":")[0]
        if name not in known:
            raise InputError(f"there is no problem '{name}' in the collection.{suggestion(name, known)} 'perp list' shows all.")
        return [of_entry(known[name], item if ":" in item else None)]

    files = {}

    def expand_checked(item):
        for problem in expand(item):
            name, file = problem["name"], problem.get("file")
            if files.setdefault(name, file) != file:
                raise InputError(f"--problems: '{name}' is the name of two files, {files[name]} and {file}")
            yield problem

    problems = select(items_of(text, "--problems"), expand_checked, lambda p: p["name"])
    if not problems:
        raise InputError(f"--problems '{text}': nothing is left")
    return problems


def described(answer):
    """The facts of a problem in the words of campaign.json, from `perp list` or `perp judge`."""
    reason = answer["no_solution"]
    keys = ("nonzeros", "affine", "starts", "known_solutions")
    facts = {"n": answer["size"], **{key: answer[key] for key in keys}}
    return {**facts, "solvable": not reason, "no_solution": reason}


def select_methods(text, tol, program, notes):
    known = program.json("methods", "--json")
    names = [m["name"] for m in known["methods"]]
    kinds = {
        "all": names,
        "none": [],
        "presets": [m["name"] for m in known["methods"] if not m["affine"] and not m["published"]],
        "published": [m["name"] for m in known["methods"] if m["published"]],
        "cfunction-grid": [
            f"semismooth:cfunction={c['name']}:cfunction_parameter={value:g}"
            for c in known["cfunctions"]
            if c["parameter"]
            for value in c["parameter"]["values"]
        ],
    }

    def cfunctions(item):
        """Of cfunctions:rho=0.01:lu=klu: semismooth over all functions, those with a rho at this value."""
        parameters = [c["parameter"] for c in known["cfunctions"] if c["parameter"]]

        def takes(parameter, key, value):
            return parameter and parameter["name"] == key and parameter["above"] < value < number(parameter["below"])

        values, options = [], ""
        for option in item.split(":")[1:]:
            key, _, value = option.partition("=")
            if all(p["name"] != key for p in parameters):
                options += ":" + option
                continue
            try:
                fits = any(takes(p, key, float(value)) for p in parameters)
            except ValueError:
                fits = False
            if not fits:
                raise InputError(f"--methods {item}: no C-function takes {option}; 'perp cfunctions' has the ranges")
            values.append((key, value))
        for c in known["cfunctions"]:
            name = f"semismooth:cfunction={c['name']}"
            at = [f"{name}:cfunction_parameter={v}{options}" for k, v in values if takes(c["parameter"], k, float(v))]
            yield from at or [name + options]

    def expand(item):
        if item in kinds:
            return kinds[item]
        if item == "cfunctions" or item.startswith("cfunctions:"):
            return cfunctions(item)
        name, colon, rest = item.partition(":")
        found = [m + colon + rest for m in names if m == name or (is_pattern(name) and "(" not in name and fnmatchcase(m, name))]
        if found or "(" in name:
            return found or [item]
        if is_pattern(name):
            raise InputError(f"--methods: no method fits '{name}'")
        near = suggestion(name, [*names, *kinds, "cfunctions"])
        raise InputError(f"--methods: there is no method '{name}'.{near} 'perp methods' lists them.")

    methods = []
    for label in select(items_of(text, "--methods"), expand, str):
        name, *options = label.split(":")
        flags = [word for option in (f"convergence_tolerance={tol!r}", *options) for word in ("--option", option)]
        try:
            answer = program.json("methods", "--json", "--show", name, *flags)
        except InputError as error:
            raise InputError(f"--methods {label}: {error}") from error
        notes += [f"--methods {label}: {note}" for note in answer["notes"]]
        method = {"label": name if "(" in name and not options else label, "name": name, "options": options, "external": False}
        methods.append({**method, "affine": answer["affine"], "in_force": answer["options"]})
    return methods


def parse_external(text, program):
    name, _, command = (part.strip() for part in text.partition("="))
    if not name or not command:
        raise InputError(f"--external '{text}': NAME=COMMAND is asked for, as in path=./path_peer")
    if any(c in name for c in ",:/*?[ ") or name.startswith("-"):
        raise InputError(f"--external: '{name}' is no NAME: letters, digits, _ and - make one")
    if name in [m["name"] for m in program.json("methods", "--json")["methods"]]:
        raise InputError(f"--external: '{name}' is a method of perp's own")
    word = command.split()[0]
    if not any(c in word for c in "'\"$`\\(") and shutil.which(word) is None:
        raise InputError(f"--external {name}: '{word}' is no program that can be run")
    return {"label": name, "name": name, "options": [], "external": True, "affine": False, "in_force": {}, "command": command}


def check_apart(outputs, inputs):
    """No file that is written is one that is read, by whatever names and links, and no two of them are one."""

    def places(path):
        yield os.path.realpath(path)
        with contextlib.suppress(OSError):
            status = os.stat(path)
            yield (status.st_dev, status.st_ino)

    seen = {place: path for path in inputs if path for place in places(path)}
    for path in outputs:
        for place in set(places(path)):
            if place in seen:
                raise InputError(f"'{path}' is also '{seen[place]}': nothing is written over it")
            seen[place] = path


