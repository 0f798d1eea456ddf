# SPDX-License-Identifier: Apache-2.0
"""The LISTs of problems and methods that perp-compare takes, and external programs."""

import glob
import os
import re
import shutil
from fnmatch import fnmatchcase

from .campaign import suggestion
from .files import InputError, crc_of, number


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
    found = [(name(one), one, take) for item, take in items for one in expand(item)]
    away = {key for key, _, take in found if not take}
    taken = {}
    for key, one, _ in found:
        if key not in away:
            taken.setdefault(key, one)
    return list(taken.values())


def is_pattern(text):
    return any(c in text for c in "*?[")


# Problems.


def of_file(path, by_pattern=False):
    """A file yet to be described; those that a pattern has found may be left out."""
    if not path.endswith((".nl", ".dat")):
        raise InputError(f"--problems: '{path}' is neither an .nl nor a .dat file")
    if not os.path.isfile(path):
        raise InputError(f"--problems: there is no file '{path}'")
    file = os.path.realpath(path)
    if not file.isprintable() or any("\ud800" <= c <= "\udfff" for c in file):
        raise InputError(f"--problems: the name of {ascii(file)} is not printable UTF-8")
    kind = os.path.splitext(path)[1][1:]
    return {"name": os.path.basename(path), "class": kind, "file": file, "crc": crc_of(file), "by_pattern": by_pattern}


def described(answer):
    """The facts of a problem in the words of campaign.json, from `perp list` or `perp judge`."""
    reason = answer["no_solution"]
    facts = {key: answer[key] for key in ("nonzeros", "affine", "starts", "known_solutions")}
    return {"n": answer["size"], **facts, "solvable": not reason, "no_solution": reason}


def select_problems(text, program):
    """The problems of a LIST, those of the collection described; sized ones and files are yet to be."""
    entries = program.json("list", "--json")["problems"]
    known = {entry["name"]: {"name": entry["name"], "class": entry["class"], **described(entry)} for entry in entries}

    def fitting(pattern, key, complaint):
        found = [p for p in known.values() if fnmatchcase(p[key], pattern)]
        if not found:
            raise InputError(f"--problems: {complaint}")
        return found

    def expand(item):
        name, sized, _ = item.partition(":")
        if item == "all":
            return known.values()
        if item.startswith("class:"):
            classes = ", ".join(sorted({p["class"] for p in known.values()}))
            return fitting(item[6:], "class", f"there is no class '{item[6:]}'; the collection has {classes}")
        if item.endswith((".nl", ".dat")) or "/" in item:
            if not is_pattern(item):
                return [of_file(item)]
            if paths := sorted(glob.glob(item)):
                return [of_file(path, True) for path in paths]
            raise InputError(f"--problems: no file fits '{item}'")
        if is_pattern(item):
            return fitting(item, "name", f"no problem of the collection fits '{item}'")
        if name not in known:
            near = suggestion(name, known)
            raise InputError(f"there is no problem '{name}' in the collection.{near} 'perp list' shows all.")
        return [{"name": item, "class": known[name]["class"]} if sized else known[name]]

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


# Methods.


def cfunctions(item, known):
    """Of cfunctions:rho=0.01:lu=klu: semismooth over all functions, those with a rho at this value."""

    def takes(parameter, key, value):
        return bool(parameter) and parameter["name"] == key and parameter["above"] < value < number(parameter["below"])

    parameters, values, options = [c["parameter"] for c in known if c["parameter"]], [], ""
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
    for c in known:
        name = f"semismooth:cfunction={c['name']}"
        at = [f"{name}:cfunction_parameter={v}{options}" for k, v in values if takes(c["parameter"], k, float(v))]
        yield from at or [name + options]


def select_methods(text, tol, program, notes):
    known = program.json("methods", "--json")
    names, functions = [m["name"] for m in known["methods"]], known["cfunctions"]
    grid = [(c["name"], value) for c in functions if c["parameter"] for value in c["parameter"]["values"]]
    kinds = {
        "all": names,
        "none": [],
        "presets": [m["name"] for m in known["methods"] if not m["affine"] and not m["published"]],
        "published": [m["name"] for m in known["methods"] if m["published"]],
        "cfunction-grid": [f"semismooth:cfunction={name}:cfunction_parameter={value:g}" for name, value in grid],
    }

    def expand(item):
        name, colon, rest = item.partition(":")
        if name == "cfunctions":
            return cfunctions(item, functions)
        if item in kinds:
            return kinds[item]
        if "(" in name:
            return [item]
        found = [m + colon + rest for m in names if fnmatchcase(m, name)]
        if not found and is_pattern(name):
            raise InputError(f"--methods: no method fits '{name}'")
        if not found:
            near = suggestion(name, [*names, *kinds, "cfunctions"])
            raise InputError(f"--methods: there is no method '{name}'.{near} 'perp methods' lists them.")
        return found

    methods = []
    for label in select(items_of(text, "--methods"), expand, str):
        name, *options = label.split(":")
        flags = [word for option in (f"convergence_tolerance={tol!r}", *options) for word in ("--option", option)]
        try:
            answer = program.json("methods", "--json", "--show", name, *flags)
        except InputError as error:
            raise InputError(f"--methods {label}: {error}") from error
        notes += [f"--methods {label}: {note}" for note in answer["notes"]]
        method = {"label": label, "name": name, "options": options, "external": False}
        methods.append({**method, "affine": answer["affine"], "in_force": answer["options"]})
    return methods


def external_methods(texts, program, notes):
    """Of NAME=COMMAND, each."""
    methods, own = {}, [m["name"] for m in program.json("methods", "--json")["methods"]] if texts else []
    for text in texts:
        name, _, command = (part.strip() for part in text.partition("="))
        if not name or not command:
            raise InputError(f"--external '{text}': NAME=COMMAND is asked for, as in path=./path_peer")
        if any(c in name for c in ",:/*?[ ") or name.startswith("-"):
            raise InputError(f"--external: '{name}' is no NAME: letters, digits, _ and - make one")
        if name in methods:
            raise InputError(f"--external: '{name}' is given twice")
        if name in own:
            raise InputError(f"--external: '{name}' is a method of perp's own")
        word = command.split()[0]
        if not any(c in word for c in "'\"$`\\(") and shutil.which(word) is None:
            raise InputError(f"--external {name}: '{word}' is no program that can be run")
        for brace in re.findall(r"(?:^|(?<!\$))(\{[A-Za-z_]+\})", command):
            if brace != "{tol}":
                notes.append(f"--external {name}: {brace} is left to the shell as it is; only {{tol}} is filled in")
        methods[name] = {"label": name, "name": name, "options": [], "external": True, "affine": False, "in_force": {}}
        methods[name]["command"] = command
    return list(methods.values())
