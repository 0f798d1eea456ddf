# SPDX-License-Identifier: Apache-2.0
"""The LISTs of problems and methods that perp-compare takes, and external programs."""

import glob
import os
import re
import shutil
from fnmatch import fnmatchcase

from .campaign import note, suggestion
from .cells import source_of
from .files import InputError, crc_of


def items_of(text, flag):
    """(item, is it taken?) of a comma-separated list; commas in parentheses belong to strategies."""
    items, depth = [""], 0
    for c in text:
        depth += (c == "(") - (c == ")")
        if c == "," and depth <= 0:
            items.append("")
        else:
            items[-1] += c
    items = [item.strip() for item in items]
    if any(item in ("", "-") for item in items):
        raise InputError(f"{flag} '{text}': an item is empty")
    pairs = [(item.removeprefix("-"), not item.startswith("-")) for item in items]
    return pairs if any(take for _, take in pairs) else [("all", True), *pairs]


def select(items, expand, name):
    """What the items name, each once, without what is taken out."""
    away = {name(one) for item, take in items if not take for one in expand(item)}
    found = [one for item, take in items if take for one in expand(item)]
    return list({name(one): one for one in found if name(one) not in away}.values())


# Problems.


def file_facts(path):
    """Of a file, which is known by its content."""
    return {"class": os.path.splitext(path)[1][1:], "file": os.path.realpath(path), "crc": crc_of(path)}


def described(answer, most):
    """The facts of a problem in the words of campaign.json, from `perp list` or `perp judge`; of its starts `most`."""
    reason = answer["no_solution"]
    facts = {key: answer[key] for key in ("nonzeros", "affine", "known_solutions")}
    starts = answer["starts"] if most == "all" else min(answer["starts"], most)
    return {"n": answer["size"], **facts, "starts": starts, "solvable": not reason, "no_solution": reason}


def select_problems(text, most, program):
    """The problems of a LIST, described; files that perp refuses are left out."""
    entries = program.json("list", "--json")["problems"]
    known = {e["name"]: {"name": e["name"], "class": e["class"], **described(e, most)} for e in entries}
    files = {}  # by name

    def expand(item):
        name, sized, _ = item.partition(":")
        if item.endswith((".nl", ".dat")) or "/" in item:
            paths = sorted(glob.glob(item)) or [item]
            if wrong := [path for path in paths if not path.endswith((".nl", ".dat"))]:
                raise InputError(f"--problems: '{wrong[0]}' is neither an .nl nor a .dat file")
            found = [{"name": os.path.basename(path), **file_facts(path)} for path in paths]
        elif item == "all" or name == "class":
            pattern = "*" if item == "all" else item[6:]
            found = [p for p in known.values() if fnmatchcase(p["class"], pattern)]
        elif sized and name in known:
            found = [{"name": item, "class": known[name]["class"]}]
        else:
            found = [p for p in known.values() if fnmatchcase(p["name"], item)]
        if not found:
            classes = f" It has the classes {', '.join(sorted({p['class'] for p in known.values()}))}."
            more = classes if name == "class" else suggestion(name, known)
            raise InputError(f"--problems: nothing fits '{item}'.{more} 'perp list' shows the collection.")
        for name, file in ((p["name"], p.get("file")) for p in found):
            if files.setdefault(name, file) != file:
                raise InputError(f"--problems: '{name}' is the name of two files, {files[name]} and {file}")
        return found

    problems = []
    for problem in select(items_of(text, "--problems"), expand, lambda p: p["name"]):
        try:
            if "n" not in problem:
                problem.update(described(program.json("judge", source_of(problem), "--json", "-"), most))
            problems.append(problem)
        except InputError as error:
            if "file" not in problem:
                raise
            note(f"{problem['name']} is left out: {error}")
    if not problems:
        raise InputError(f"--problems '{text}': nothing is left")
    return problems


# Methods.


def method_of(label, name, options=(), external=False, affine=False, in_force=None, **more):
    """What campaign.json says of a method."""
    flags = {"external": external, "affine": affine, "in_force": in_force or {}}
    return {"label": label, "name": name, "options": list(options), **flags, **more}


def select_methods(text, tol, program):
    known = program.json("methods", "--json")
    names, functions = [m["name"] for m in known["methods"]], known["cfunctions"]
    grid = [(c["name"], value) for c in functions if c["parameter"] for value in c["parameter"]["values"]]
    kinds = {
        "all": names,
        "none": [],
        "presets": [m["name"] for m in known["methods"] if not m["affine"] and not m["published"]],
        "published": [m["name"] for m in known["methods"] if m["published"]],
        "cfunctions": [f"semismooth:cfunction={c['name']}" for c in functions],
        "cfunction-grid": [f"semismooth:cfunction={name}:cfunction_parameter={value:g}" for name, value in grid],
    }

    def expand(item):
        name, colon, options = item.partition(":")
        if "(" in name:
            return [item]
        found = kinds[name] if name in kinds else [m for m in names if fnmatchcase(m, name)]
        if not found and name not in kinds:
            near = suggestion(name, [*names, *kinds])
            raise InputError(f"--methods: there is no method '{name}'.{near} 'perp methods' lists them.")
        return [label + colon + options for label in found]

    methods = []
    for label in select(items_of(text, "--methods"), expand, str):
        name, *options = label.split(":")
        flags = [word for option in (f"convergence_tolerance={tol!r}", *options) for word in ("--option", option)]
        try:
            answer = program.json("methods", "--json", "--show", name, *flags)
        except InputError as error:
            raise InputError(f"--methods {label}: {error}") from error
        for words in answer["notes"]:
            note(f"--methods {label}: {words}")
        methods.append(method_of(label, name, options, affine=answer["affine"], in_force=answer["options"]))
    return methods


def external_methods(texts, program):
    """Of NAME=COMMAND, each."""
    methods, own = {}, [m["name"] for m in program.json("methods", "--json")["methods"]] if texts else []
    for text in texts:
        name, _, command = (part.strip() for part in text.partition("="))
        if not re.fullmatch(r"\w[\w.-]*", name) or not command:
            raise InputError(f"--external '{text}': NAME=COMMAND is asked for, as in path=./path_peer")
        if name in methods or name in own:
            what = "given twice" if name in methods else "a method of perp's own"
            raise InputError(f"--external: '{name}' is {what}")
        word = command.split()[0]
        if not any(c in word for c in "'\"$`\\(") and shutil.which(word) is None:
            raise InputError(f"--external {name}: '{word}' is no program that can be run")
        methods[name] = method_of(name, name, external=True, command=command)
    return list(methods.values())
