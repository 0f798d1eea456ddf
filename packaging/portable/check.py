#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""check.py PREFIX WHEEL ARCHIVE: what scripts/portable has made for Linux is whole, and needs no more of a system than
PEP 600 lets manylinux_2_28 need; every library that it was linked with, in PREFIX, has its licence in it."""

import re
import subprocess
import sys
import tarfile
import tempfile
import zipfile
from pathlib import Path

NEWEST = (2, 28)  # of glibc
#: What every Linux has, and may be linked at run time.
OF_THE_SYSTEM = re.compile(r"lib(c|m|dl|pthread|rt)\.so\.\d|ld-linux-x86-64\.so\.2")

#: Static libraries, and the folder of their licence.
LIBRARIES = {
    "libamd.a": "SuiteSparse-AMD",
    "libamplsolver.a": "AMPL-solver-library",
    "libfmt.a": "fmt",
    "libgmp.a": "GMP",
    "libklu.a": "SuiteSparse-KLU",
    "libmpfi.a": "MPFI",
    "libmpfr.a": "MPFR",
}
#: What else is compiled in.
OTHERS = ["SuiteSparse-BTF", "SuiteSparse-COLAMD", "libeigen3-dev", "libcli11-dev", "nlohmann-json3-dev", "libcxx", "zig"]
LICENCES = [*LIBRARIES.values(), *OTHERS]

WHEEL = [
    "perp/__init__.py",
    "perp/py.typed",
    "perp/pyomo/__init__.py",
    "perp/lab/page.js",
    "perp/libperp.so",
    "perp/libperp_path.so",
    r"perp-[0-9.]+\.data/scripts/perp",
    r"perp-[0-9.]+\.data/data/share/man/man1/perp-solve\.1\.gz",
    r"perp-[0-9.]+\.dist-info/entry_points\.txt",
    r"perp-[0-9.]+\.dist-info/licenses/LICENSE",
    r"perp-[0-9.]+\.dist-info/licenses/NOTICE",
    r"perp-[0-9.]+\.dist-info/licenses/libraries/libraries",
    *(rf"perp-[0-9.]+\.dist-info/licenses/libraries/{re.escape(name)}/[^/]+" for name in LICENCES),
]
ARCHIVE = [
    "LICENSE",
    "NOTICE",
    "bin/perp",
    "bin/pathampl",
    "bin/perp-compare",
    "include/perp.h",
    "include/perp_path.h",
    "lib/libperp.so",
    r"lib/libperp\.so\.1",
    "lib/libperp_path.so",
    r"lib/libperp_path\.so\.1",
    "lib/pkgconfig/perp-c.pc",
    r"share/man/man1/perp-solve\.1\.gz",
    "share/bash-completion/completions/perp",
    r"share/perp/examples/energy\.nl",
    r"share/perp/schema/solve\.json",
    "share/perp/licences/libraries",
    *(rf"share/perp/licences/{re.escape(name)}/[^/]+" for name in LICENCES),
]


def missing(patterns, names):
    """The patterns that no name is like."""
    return [pattern for pattern in patterns if not any(re.fullmatch(pattern, name) for name in names)]


def readelf(*arguments):
    return subprocess.run(["readelf", "-W", *arguments], check=True, capture_output=True, text=True).stdout


def wrong_with(binary):
    """What a program or library needs beyond what a system has."""
    needed = re.findall(r"\(NEEDED\).*\[(.*)\]", readelf("-d", binary))
    yield from (f"needs {name}" for name in needed if not OF_THE_SYSTEM.fullmatch(name))
    versions = set(re.findall(r"Name: ([A-Z]+)_([0-9.]+) +Flags:", readelf("-V", binary)))  # not of its own functions
    for name, version in sorted(versions):
        if name != "GLIBC" or tuple(map(int, version.split("."))) > NEWEST:
            yield f"needs {name}_{version}"


def is_elf(path):
    with open(path, "rb") as file:
        return file.read(4) == b"\x7fELF"


def wrong_with_folder(folder, patterns, binaries):
    """What is missing in an unpacked wheel or archive, and what is wrong with the binaries in it; they are so many."""
    names = [str(path.relative_to(folder)) for path in folder.rglob("*") if not path.is_dir()]
    yield from (f"has no {pattern}" for pattern in missing(patterns, names))
    elves = [name for name in names if not (folder / name).is_symlink() and is_elf(folder / name)]
    if len(elves) != binaries:
        yield f"has {len(elves)} programs and libraries in place of {binaries}: {elves}"
    yield from (f"{name} {fault}" for name in elves for fault in wrong_with(folder / name))


def wrong_with_prefix(prefix):
    """Static libraries of which nothing is known."""
    for library in sorted(prefix.glob("lib/*.a")):
        if library.name not in LIBRARIES:
            yield f"{library} has no place in the list of licences, LIBRARIES in {Path(__file__).name}"


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    prefix, wheel, archive = map(Path, sys.argv[1:])
    wrong = list(wrong_with_prefix(prefix))
    with tempfile.TemporaryDirectory() as folder:
        zipfile.ZipFile(wheel).extractall(f"{folder}/wheel")
        wrong += [f"{wheel.name} {fault}" for fault in wrong_with_folder(Path(folder) / "wheel", WHEEL, 3)]
        with tarfile.open(archive) as tar:
            tar.extractall(folder)
        unpacked = Path(folder) / archive.name.removesuffix(".tar.gz")
        wrong += [f"{archive.name} {fault}" for fault in wrong_with_folder(unpacked, ARCHIVE, 3)]
    print("\n".join(wrong), end="\n" if wrong else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
