#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Rules of the source tree, checked: check_tree.py CHECK [ROOT].

includes   who may include which library (CONTRIBUTING.md, "The folders")
floors     includes go down: a file includes what is in its own folder and in those below it
length     no source file beyond 500 lines
names      no function template in an anonymous namespace shares its name with a function in that of another file of its folder
format     clang-format (the major version below, else skipped) would change nothing
readme     the examples of docs/cpp.md, docs/c.md, docs/contact/nonlinear.md and contact/README.md are those the packaging test builds and runs
paths      files that texts and comments name exist, seen from the root or from where they are named
links      files and headings that texts link to exist
licence    sources and scripts name their licence in the first lines; pyproject.toml, CITATION.cff and LICENSE name the same
version    CITATION.cff, CHANGELOG.md, perp.h and docs/path-library.md name the version of CMakeLists.txt
self-test  each check reports a tree that breaks its rule

Prints one line a violation; exit status 1 if there is one, 77 if the check was skipped.
"""

import collections
import posixpath
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

CLANG_FORMAT_VERSION = "14"
LONGEST = 500
SKIPPED = 77
SOURCES = (".cpp", ".hpp", ".h", ".cc", ".c")
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]')

# Below: (headers, folders or files that may include them). tests/ and bench/ may include everything.
RULES = [
    (r"(app)/", ("app/",), "only app sees app"),
    (r"(capi)/", ("capi/", "web/"), "only capi and web see capi"),
    (r"(contact)/", ("contact/", "capi/", "app/"), "only contact, capi and app see contact"),
    (r"(collection)/", ("collection/", "capi/", "app/"), "only collection, capi and app see collection"),
    (r"(ncp)/", ("ncp/", "collection/", "contact/", "capi/", "app/"), "lcp sees nothing above it"),
    (r"(petsc)/\w+\.hpp$", ("petsc/",), "only petsc sees petsc"),
    (r"(.*/)?(petsc\w*|mpi)\.h$", ("petsc/",), "PETSc and MPI stay in petsc"),
    (r"(tests|bench)/", (), "nobody includes tests or bench"),
    (
        r"(suitesparse/)?(umfpack|klu|btf|cholmod|spqr|cs|amd|colamd|SuiteSparse)\w*\.(h|hpp)$"
        r"|Eigen/(UmfPack|KLU|Cholmod|SPQR)Support$",
        ("lcp/",),
        "SuiteSparse stays behind the linear-algebra seam in lcp",
    ),
    (r"(.*/)?(asl|asl_pfg|asl_pfgh|nlp|nlp2|getstub|jacpdim)\.h$", ("ncp/ampl/",), "AMPL's library stays in ncp/ampl"),
    (r"(.*/)?(hdf5|H5\w*)\.h$", (), "HDF5's library stays in the tests"),
    (r"gsl/", ("ncp/methods/multiroot_gsl.cpp", "ncp/methods/gsl_errors.cpp"), "GSL stays behind multiroot"),
    (r"mpfi|mpfr|gmp", ("ncp/interval/",), "MPFI and GMP stay behind the intervals"),
    (r"(CLI/|nlohmann/)", ("app/", "petsc/mpi/"), "command line and JSON stay in the programs"),
    (r"(pybind11/|Python\.h$)", (), "Python stands on the interface of C, by ctypes"),
    (r"(.*/)?\.\./", (), "includes are written from the root of the tree"),
]
UNRULED = ("tests/", "bench/", "data/")

# The folders from the ground up.
FLOORS = """
lcp lcp/cholesky lcp/lu lcp/judge lcp/linalg lcp/pivoting lcp/qp lcp/iterative lcp/classes lcp/solve lcp/vi lcp/io
ncp/interval ncp/problem ncp/ampl ncp/run ncp/reformulation ncp/transforms ncp/analysis ncp/path ncp/methods ncp/strategy
ncp/explain ncp/settings
collection/base collection/random collection/models collection/scalable collection/kkt collection
contact/model contact/existence contact/io contact/laws contact/classics contact/cones contact/solvers contact/scenes
capi capi/path
petsc petsc/mpi
app/program app/text app/options app/problem app/report app/commands app/contact/run app/contact app
""".split()
OURS = re.compile(r"(lcp|ncp|collection|contact|capi|petsc|app)/(?!private/)")  # petsc/private is PETSc's own


def tracked(root):
    """The tracked files, relative to root; all outside of build folders where there is no git."""
    command = ["git", "-c", "safe.directory=*", "-C", root, "ls-files", "-z"]
    git = subprocess.run(command, capture_output=True, text=True) if shutil.which("git") else None
    if git and git.returncode == 0:
        names = git.stdout.split("\0")
    else:
        names = [path.relative_to(root).as_posix() for path in Path(root).rglob("*") if path.is_file()]
        names = [name for name in names if not name.startswith(("build", "."))]
    return sorted(name for name in names if (Path(root) / name).is_file())


def sources(root):
    return [name for name in tracked(root) if name.endswith(SOURCES)]


def includes(root):
    for name in sources(root):
        if name.startswith(UNRULED):
            continue
        for number, line in enumerate((Path(root) / name).read_text(encoding="utf-8").splitlines(), 1):
            found = INCLUDE.match(line)
            for pattern, allowed, reason in RULES if found else ():
                if re.match(pattern, found[1]) and not name.startswith(allowed):
                    yield f"{name}:{number}: includes {found[1]}: {reason}"


def floors(root):
    names = set(tracked(root))
    rank = {folder: number for number, folder in enumerate(FLOORS)}
    for name in sources(root):
        folder = posixpath.dirname(name)
        if not OURS.match(name):
            continue
        if folder not in rank:
            yield f"{name}: {folder} is not among the floors (tests/packaging/check_tree.py)"
            continue
        for number, line in enumerate((Path(root) / name).read_text(encoding="utf-8").splitlines(), 1):
            found = INCLUDE.match(line)
            if not found or not OURS.match(found[1]):
                continue
            if found[1] not in names:
                yield f"{name}:{number}: there is no {found[1]}"
            elif rank.get(posixpath.dirname(found[1]), 0) > rank[folder]:
                yield f"{name}:{number}: includes {found[1]}, which stands above {folder}"


def length(root):
    for name in sources(root):
        lines = sum(LICENCE not in line for line in (Path(root) / name).read_text(encoding="utf-8").splitlines())
        if lines > LONGEST:
            yield f"{name}: {lines} lines, more than {LONGEST}"


FUNCTION = re.compile(r"[^(=:]*?(?:[\w>]::[^(=:]*?)*[\s&*>](\w+)\(")


def names(root):
    """Unity builds compile files of a folder, in app of all its folders, as one: the template would take the other's calls."""
    folders = collections.defaultdict(lambda: collections.defaultdict(dict))
    for name in sources(root):
        folder = "app" if name.startswith("app/") else posixpath.dirname(name)
        hidden, before = False, ""
        for line in (Path(root) / name).read_text(encoding="utf-8").splitlines() if name.endswith(".cpp") else ():
            if line in ("namespace {", "}  // namespace"):
                hidden = line == "namespace {"
            found = FUNCTION.match(line) if hidden and re.match(r"[a-z\[]", line, re.I) else None
            if found:
                files = folders[folder][found[1]]
                files[name] = files.get(name, False) or before.startswith("template")
            before = line
    for functions in folders.values():
        for function, files in functions.items():
            if len(files) > 1:
                yield from (f"{name}: the template {function} has the name of a function in {', '.join(sorted(files.keys() - {name}))}" for name, template in files.items() if template)


def format_(root):
    program = shutil.which(f"clang-format-{CLANG_FORMAT_VERSION}") or shutil.which("clang-format")
    version = subprocess.run([program, "--version"], capture_output=True, text=True).stdout if program else ""
    if f"version {CLANG_FORMAT_VERSION}." not in version:
        print(f"skipped: clang-format {CLANG_FORMAT_VERSION} is not installed")
        sys.exit(SKIPPED)
    names = sources(root)
    if not names:
        return
    run = subprocess.run([program, "--dry-run", *names], cwd=root, capture_output=True, text=True)
    bad = {line.split(":")[0] for line in run.stderr.splitlines() if "[-Wclang-format-violations]" in line}
    yield from (f"{name}: clang-format would change it" for name in sorted(bad))
    if run.returncode != 0 and not bad:
        yield f"{program}: {run.stderr.strip()}"


CONSUMER = "tests/packaging/consumer"
EXAMPLES = {
    f"{CONSUMER}/example.cpp": "docs/cpp.md",
    f"{CONSUMER}/lcp.cpp": "docs/cpp.md",
    f"{CONSUMER}/contact.cpp": "contact/README.md",
    f"{CONSUMER}/nonlinear.cpp": "docs/contact/nonlinear.md",
    f"{CONSUMER}/from_c.c": "docs/c.md",
}


def readme(root):
    for source, page in EXAMPLES.items():
        example = (Path(root) / source).read_text(encoding="utf-8").removeprefix(f"// {LICENCE}\n")
        if f"```{source.rpartition('.')[2]}\n{example}```" not in (Path(root) / page).read_text(encoding="utf-8"):
            yield f"{page}: its example is not {source}"


# folder/file.py, and of sources also file.cpp. Names in capitals (ncp/METHOD.cpp) stand for any file, with * for some.
PATH = re.compile(r"(?<![\w/.*<-])((?:[\w.-]+/)+[a-z][\w-]*\.(?:hpp|cpp|py|cmake)|[a-z][\w-]*\.(?:hpp|cpp))(?![\w*])")
UNCHECKED = ("CHANGELOG.md", "tests/packaging/check_tree.py")  # of files that are gone; of files that are made up


def named(name, line):
    """What a line of a text, or the comment of a line of a source, says."""
    return line if name.endswith(".md") else line.partition("//")[2] if name.endswith(SOURCES) else ""


def paths(root):
    """A header has its name without the folder, too (cmake/install.cmake)."""
    names = set(tracked(root))
    names |= {f"{folder[1]}/{posixpath.basename(name)}" for name in names if (folder := OURS.match(name)) and name.endswith(".hpp")}
    for name in sorted(set(tracked(root)) - set(UNCHECKED)):
        if not name.endswith((".md", *SOURCES)):
            continue
        folder = posixpath.dirname(name)
        for number, line in enumerate((Path(root) / name).read_text(encoding="utf-8").splitlines(), 1):
            for found in PATH.findall(named(name, line)):
                # Tests speak of the sources they mirror.
                places = (found, posixpath.join(folder, found), posixpath.join(folder.removeprefix("tests/"), found))
                if names.isdisjoint(posixpath.normpath(place) for place in places):
                    yield f"{name}:{number}: there is no file {found}"


LINK = re.compile(r"\[[^\]]+\]\((?!\w+:)([^)#\s]*)(?:#([^)]*))?\)")


def anchors(text):
    """What headings are called in links: GitHub's rule."""
    text = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
    headings = re.findall(r"^#+ (.*?)\s*$", text, flags=re.M)
    return {re.sub(r"[^\w -]", "", heading).lower().replace(" ", "-") for heading in headings}


def links(root):
    names = set(tracked(root))
    for name in sorted(names):
        if not name.endswith(".md"):
            continue
        text = (Path(root) / name).read_text(encoding="utf-8")
        for target, anchor in LINK.findall(text):
            there = posixpath.normpath(posixpath.join(posixpath.dirname(name), target)) if target else name
            if there not in names:
                yield f"{name}: there is no {target}"
            elif anchor and anchor not in anchors((Path(root) / there).read_text(encoding="utf-8")):
                yield f"{name}: {there} has no heading {anchor}"


LICENCE = "SPDX-License-Identifier: Apache-2.0"
LICENSED = (*SOURCES, ".py", ".pyi", ".cmake", ".sh", ".bash", ".js", ".css", ".map", ".yml", ".toml", ".1", ".in", "CMakeLists.txt")
GRANTS = {  # other files that say what the licence is, and how
    "LICENSE": "Apache License\n                           Version 2.0",
    "NOTICE": "Apache License, Version 2.0",
    "README.md": "Apache License 2.0",
    "CITATION.cff": "license: Apache-2.0",
    "pyproject.toml": "Apache-2.0",
    "cmake/debian/copyright.in": "License: Apache-2.0",
}


def licence(root):
    for name in tracked(root):
        path = Path(root) / name
        with path.open("rb") as file:
            script = file.read(2) == b"#!"
        if script or name.endswith(LICENSED) and not name.startswith("cmake/debian/"):
            if LICENCE not in "".join(path.read_text(encoding="utf-8").splitlines(keepends=True)[:2]):
                yield f"{name}: its first two lines have no {LICENCE}"
        if name in GRANTS and GRANTS[name] not in path.read_text(encoding="utf-8"):
            yield f"{name}: does not say {GRANTS[name]!r}"


VERSIONS = {  # files that name the version, and how
    "CHANGELOG.md": "\n## [{}] - 2",
    "CITATION.cff": "version: {}\n",
    "capi/perp.h": 'Version of the library that runs, "{}".',
    "docs/path-library.md": "(Perp {})",
}


def version(root):
    found = re.search(r"project\(perp VERSION ([\d.]+)", (Path(root) / "CMakeLists.txt").read_text(encoding="utf-8"))[1]
    for name, words in VERSIONS.items():
        if words.format(found) not in (Path(root) / name).read_text(encoding="utf-8"):
            yield f"{name}: does not say {words.format(found)!r}"


CHECKS = {
    "includes": includes,
    "floors": floors,
    "length": length,
    "names": names,
    "format": format_,
    "readme": readme,
    "paths": paths,
    "links": links,
    "licence": licence,
    "version": version,
}


# --- self-test -------------------------------------------------------------------------------------------------------

GOOD = {
    "lcp/a.cpp": '#include <umfpack.h>\n\n#include "lcp/a.hpp"\n',
    "lcp/e.cpp": "#include <Eigen/UmfPackSupport>\n",
    "ncp/b.cpp": '#include "lcp/a.hpp"\n// #include "app/main.hpp" in a comment is none\n',
    "ncp/ampl/r.cpp": "#include <asl.h>\n",
    "contact/io/hdf5.cpp": '#include "contact/io/hdf5.hpp"\n',
    "petsc/s.cpp": '#include <petscsnes.h>\n\n#include "lcp/a.hpp"\n#include "petsc/s.hpp"\n',
    "app/c.cpp": '#include <CLI/CLI.hpp>\n\n#include "contact/c.hpp"\n',
    "tests/t.cpp": '#include <nlohmann/json.hpp>\n\n#include "app/c.hpp"\n',
}
BAD = {  # file -> its line, one violation each
    "lcp/a.hpp": '#include "ncp/problem/mcp.hpp"',
    "lcp/b.hpp": "#include <contact/model/problem.hpp>",
    "ncp/a.hpp": '  #  include "app/options/options.hpp"',
    "ncp/b.hpp": '#include "contact/model/problem.hpp"',
    "ncp/c.hpp": "#include <umfpack.h>",
    "ncp/d.hpp": "#include <suitesparse/klu.h>",
    "ncp/e.hpp": "#include <Eigen/UmfPackSupport>",
    "ncp/f.hpp": "#include <asl.h>",
    "ncp/g.hpp": "#include <nlohmann/json.hpp>",
    "ncp/methods/multiroot.hpp": "#include <gsl/gsl_multiroots.h>",
    "ncp/ampl/h.hpp": "#include <cholmod.h>",
    "contact/a.hpp": '#include "app/options/options.hpp"',
    "contact/b.hpp": "#include <hdf5.h>",
    "contact/c.hpp": "#include <CLI/App.hpp>",
    "app/a.hpp": '#include "tests/support/a.hpp"',
    "app/b.hpp": "#include <asl_pfgh.h>",
    "app/c.hpp": '#include "../lcp/a.hpp"',
    "capi/p.cpp": "#include <pybind11/pybind11.h>",
    "python/a.cpp": "#include <Python.h>",
    "ncp/i.hpp": "#include <petscksp.h>",
    "app/d.hpp": '#include "petsc/box.hpp"',
    "petsc/a.hpp": "#include <nlohmann/json.hpp>",
}


def write(root, files):
    for name, content in files.items():
        (Path(root) / name).parent.mkdir(parents=True, exist_ok=True)
        (Path(root) / name).write_text(content, encoding="utf-8")


def self_test(_):
    """Trees that keep the rules and trees that break each of them, without git and with."""
    with tempfile.TemporaryDirectory() as folder:
        write(folder, GOOD)
        yield from (f"a good tree is refused: {violation}" for violation in [*includes(folder), *length(folder)])
        write(folder, {name: line + "\n" for name, line in BAD.items()})
        write(folder, {"lcp/long.cpp": "\n" * (LONGEST + 1), "lcp/short.cpp": "\n" * LONGEST})
        found = list(includes(folder))
        for name, line in BAD.items():
            if sum(violation.startswith(name + ":1:") for violation in found) != 1:
                yield f"not reported once: {name} with {line}"
        if len(found) != len(BAD):
            yield f"{len(found)} violations instead of {len(BAD)}: {found}"
        if [violation.split(":")[0] for violation in length(folder)] != ["lcp/long.cpp"]:
            yield "the long file is not the one reported"
        subprocess.run(["git", "init", "-q", folder], check=True)
        subprocess.run(["git", "-C", folder, "add", "ncp/a.hpp"], check=True)
        if sources(folder) != ["ncp/a.hpp"]:
            yield "untracked files are looked at"
        write(folder, dict.fromkeys(EXAMPLES.values(), "```cpp\nint a;\n```\n```c\nint a;\n```\n") | dict.fromkeys(EXAMPLES, "int a;\n"))
        yield from readme(folder)
        write(folder, dict.fromkeys(EXAMPLES, "int b;\n"))
        if len(list(readme(folder))) != len(EXAMPLES):
            yield "another example is taken for the text's"
    with tempfile.TemporaryDirectory() as folder:
        text = "`lcp/a.cpp`, `a.cpp`, lcp/METHOD.hpp, `x/*.cpp`, in b.hpp\n"
        write(folder, {"README.md": text, "lcp/README.md": text, "lcp/a.cpp": "f();  // as in b.hpp\n", "lcp/b.hpp": "\n"})
        wanted = ["README.md:1: there is no file a.cpp", "README.md:1: there is no file b.hpp"]
        if list(paths(folder)) != wanted:
            yield f"{list(paths(folder))} instead of {wanted}"
    with tempfile.TemporaryDirectory() as folder:
        text = "# A heading's words\n[a](a.md#a-headings-words) [b](b.md) [c](#a-heading) [d](https://e.org/b.md)\n"
        write(folder, {"a.md": text})
        if list(links(folder)) != ["a.md: there is no b.md", "a.md: a.md has no heading a-heading"]:
            yield f"{list(links(folder))}: not the two links that lead nowhere"
    with tempfile.TemporaryDirectory() as folder:
        write(folder, {"lcp/a.hpp": "\n", "lcp/lu/b.hpp": '#include "lcp/a.hpp"\n#include "lcp/lu/b.hpp"\n', "tests/t.cpp": '#include "lcp/c.hpp"\n'})
        yield from (f"a good tree is refused: {violation}" for violation in floors(folder))
        write(folder, {"lcp/c.hpp": '#include "lcp/lu/b.hpp"\n', "lcp/d.hpp": '#include "lcp/b.hpp"\n', "lcp/e/f.hpp": "\n"})
        if [violation.split(":")[0] for violation in floors(folder)] != ["lcp/c.hpp", "lcp/d.hpp", "lcp/e/f.hpp"]:
            yield f"{list(floors(folder))}: not the include that goes up, the file that is missing, the folder without a floor"
    with tempfile.TemporaryDirectory() as folder:
        write(folder, {"a.cpp": f"// {LICENCE}\n", "b.py": f"#!/usr/bin/env python3\n# {LICENCE}\n", "c.txt": "\n"})
        yield from (f"a good tree is refused: {violation}" for violation in licence(folder))
        write(folder, {"d.cpp": f"\n\n// {LICENCE}\n", "scripts/e": "#!/bin/sh\n", "LICENSE": "MIT\n"})
        if [violation.split(":")[0] for violation in licence(folder)] != ["LICENSE", "d.cpp", "scripts/e"]:
            yield f"{list(licence(folder))}: not the two files without a licence and the one with another"
    with tempfile.TemporaryDirectory() as folder:
        write(folder, {name: words.format("1.2.3") for name, words in VERSIONS.items()} | {"CMakeLists.txt": "project(perp VERSION 1.2.3)\n"})
        yield from (f"a good tree is refused: {violation}" for violation in version(folder))
        write(folder, {"CITATION.cff": "version: 1.2.30\n"})
        if len(list(version(folder))) != 1:
            yield "a version of another number is not the one reported"
    with tempfile.TemporaryDirectory() as folder:
        hidden = "namespace {{\n\n{}\n}}  // namespace\n"
        template = hidden.format("template <class... T>\nvoid f(const T&... t) {\n}\n")
        write(folder, {"a/a.cpp": template, "b/b.cpp": hidden.format("void f() {}\n"), "a/c.cpp": hidden.format("void g() {\n  f();\n}\nvoid C::f() {}\n")})
        yield from (f"a good tree is refused: {violation}" for violation in names(folder))
        write(folder, {"a/b.cpp": hidden.format("[[noreturn]] std::vector<a::B> f(long x) {}\n"), "app/a/a.cpp": template, "app/b.cpp": template})
        if [violation.split(":")[0] for violation in names(folder)] != ["a/a.cpp", "app/a/a.cpp", "app/b.cpp"]:
            yield f"{list(names(folder))}: not the templates whose name another file has"
    if shutil.which("clang-format"):
        with tempfile.TemporaryDirectory() as folder:
            write(folder, {".clang-format": "BasedOnStyle: Google\n", "a.cpp": "int a ;\n", "b.cpp": "int b;\n"})
            if [violation.split(":")[0] for violation in format_(folder)] != ["a.cpp"]:
                yield "the badly formatted file is not the one reported"


def main():
    checks = {**CHECKS, "self-test": self_test}
    if len(sys.argv) not in (2, 3) or sys.argv[1] not in checks:
        sys.exit(__doc__)
    root = sys.argv[2] if len(sys.argv) == 3 else str(Path(__file__).resolve().parent.parent.parent)
    violations = list(checks[sys.argv[1]](root))
    print("\n".join(violations), end="\n" if violations else "")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
