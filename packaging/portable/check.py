#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""check.py SYSTEM PREFIX WHEEL ARCHIVE: what scripts/portable has made for Linux, Windows or Darwin is whole, and needs no
more of a system than each has (of Linux what PEP 600 lets manylinux_2_28 need); every library that it was linked with, in
PREFIX, has its licence in it."""

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

NEWEST = (2, 28)  # of glibc
#: What each system has, and may be linked at run time.
OF_THE_SYSTEM = {
    "Linux": re.compile(r"lib(c|m|dl|pthread|rt)\.so\.\d|ld-linux-x86-64\.so\.2"),
    "Windows": re.compile(r"(kernel32|shell32|advapi32|ntdll|api-ms-win-crt-[a-z]+-l1-1-0)\.dll", re.I),
    "Darwin": re.compile(r"/usr/lib/libSystem\.B\.dylib"),
}
#: How programs and libraries begin.
MAGIC = {"Linux": b"\x7fELF", "Windows": b"MZ", "Darwin": b"\xcf\xfa\xed\xfe"}
#: What follows there, by the platform of a wheel.
PROCESSORS = {"macosx_13_0_arm64": b"\x0c\0\0\1", "macosx_13_0_x86_64": b"\x07\0\0\1"}

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
OTHERS = ["SuiteSparse-BTF", "SuiteSparse-COLAMD", "libeigen3-dev", "libcli11-dev", "nlohmann-json3-dev"]
OTHERS += ["libcxx", "libcxxabi", "libunwind", "zig"]
C_LIBRARIES = {"Linux": ["glibc"], "Windows": ["mingw"], "Darwin": [], "WASI": ["musl", "wasi"]}

#: Of all systems; {...} are names that each system writes in its own way.
WHEEL = [
    "perp/__init__.py",
    "perp/py.typed",
    "perp/pyomo/__init__.py",
    "perp/lab/page.js",
    "perp/{perp}",
    "perp/{perp_path}",
    r"perp-[0-9.]+\.data/scripts/perp{exe}",
    r"perp-[0-9.]+\.dist-info/entry_points\.txt",
    r"perp-[0-9.]+\.dist-info/licenses/LICENSE",
    r"perp-[0-9.]+\.dist-info/licenses/NOTICE",
    r"perp-[0-9.]+\.dist-info/licenses/libraries/libraries",
]
ARCHIVE = [
    "LICENSE",
    "NOTICE",
    "bin/perp{exe}",
    "bin/pathampl{exe}",
    "bin/perp-compare",
    "include/perp.h",
    "include/perp_path.h",
    "lib/pkgconfig/perp-c.pc",
    r"share/perp/examples/energy\.nl",
    r"share/perp/schema/solve\.json",
    "share/perp/licences/libraries",
]
NAMES = {
    "Linux": {"{exe}": "", "{perp}": r"libperp\.so", "{perp_path}": r"libperp_path\.so"},
    "Windows": {"{exe}": r"\.exe", "{perp}": r"perp\.dll", "{perp_path}": r"perp_path\.dll"},
    "Darwin": {"{exe}": "", "{perp}": r"libperp\.dylib", "{perp_path}": r"libperp_path\.dylib"},
}
#: The man pages are written by the program, which runs on Linux alone where they are made.
WHEEL_TOO = {"Linux": [r"perp-[0-9.]+\.data/data/share/man/man1/perp-solve\.1\.gz"], "Windows": [], "Darwin": []}
ARCHIVE_TOO = {
    "Linux": [
        "lib/libperp.so",
        r"lib/libperp\.so\.1",
        "lib/libperp_path.so",
        r"lib/libperp_path\.so\.1",
        r"share/man/man1/perp-solve\.1\.gz",
        "share/bash-completion/completions/perp",
    ],
    "Windows": [r"bin/perp\.dll", r"bin/perp_path\.dll", r"lib/perp\.lib", r"lib/perp_path\.lib"],
    "Darwin": [r"lib/libperp\.dylib", r"lib/libperp\.1\.dylib", r"lib/libperp_path\.1\.dylib"],
}


def licences(system):
    """The folders of the licences of what is in a product for the system."""
    return [*LIBRARIES.values(), *OTHERS, *C_LIBRARIES[system]]


def of_system(patterns, folder, system):
    """The patterns, with the names as the system writes them, and the licences in their folder."""
    patterns = [*patterns, *(f"{folder}/{re.escape(name)}/[^/]+" for name in licences(system))]
    for word, name in NAMES[system].items():
        patterns = [pattern.replace(word, name) for pattern in patterns]
    return patterns


def wheel(system):
    return of_system(WHEEL, r"perp-[0-9.]+\.dist-info/licenses/libraries", system) + WHEEL_TOO[system]


def archive(system):
    return of_system(ARCHIVE, "share/perp/licences", system) + ARCHIVE_TOO[system]


def missing(patterns, names):
    """The patterns that no name is like."""
    return [pattern for pattern in patterns if not any(re.fullmatch(pattern, name) for name in names)]


def output(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def libraries_of(binary, system):
    """The names of what it is linked with at run time."""
    if system == "Windows":
        return re.findall(r"DLL Name: (.*)", output("objdump", "-p", binary))
    if system == "Darwin":
        return re.findall(r"cmd LC_LOAD_DYLIB\n.*\n *name (\S+)", output("llvm-objdump-14", "--macho", "--private-headers", binary))
    return re.findall(r"\(NEEDED\).*\[(.*)\]", output("readelf", "-W", "-d", binary))


def wrong_with(binary, system="Linux"):
    """What a program or library needs beyond what a system has."""
    yield from (f"needs {name}" for name in libraries_of(binary, system) if not OF_THE_SYSTEM[system].fullmatch(name))
    if system == "Darwin":
        headers = output("llvm-objdump-14", "--macho", "--private-headers", binary)
        names = re.findall(r"cmd (?:LC_ID_DYLIB|LC_RPATH)\n.*\n *(?:name|path) (\S+)", headers)
        yield from (f"has the place {name}" for name in names if not name.startswith(("@rpath/", "@loader_path")))
    if system != "Linux":
        return
    versions = set(re.findall(r"Name: ([A-Z]+)_([0-9.]+) +Flags:", output("readelf", "-W", "-V", binary)))  # not of its own
    for name, version in sorted(versions):
        if name != "GLIBC" or tuple(map(int, version.split("."))) > NEWEST:
            yield f"needs {name}_{version}"


def magic(system, platform):
    """The first bytes of programs and libraries."""
    return MAGIC[system] + PROCESSORS.get(platform, b"")


def is_binary(path, first):
    with open(path, "rb") as file:
        return file.read(len(first)) == first


def wrong_with_folder(folder, patterns, binaries, system="Linux", platform=""):
    """What is missing in an unpacked wheel or archive, and what is wrong with the binaries in it; they are so many."""
    first = magic(system, platform)
    names = [path.relative_to(folder).as_posix() for path in folder.rglob("*") if not path.is_dir()]
    yield from (f"has no {pattern}" for pattern in missing(patterns, names))
    found = [name for name in names if not (folder / name).is_symlink() and is_binary(folder / name, first)]
    if len(found) != binaries:
        yield f"has {len(found)} programs and libraries in place of {binaries}: {found}"
    yield from (f"{name} {fault}" for name in found for fault in wrong_with(folder / name, system))


def wrong_with_prefix(prefix):
    """Static libraries of which nothing is known."""
    for library in sorted(prefix.glob("lib/*.a")):
        if library.name not in LIBRARIES:
            yield f"{library} has no place in the list of licences, LIBRARIES in {Path(__file__).name}"


def main():
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    system = sys.argv[1]
    prefix, made, packed = map(Path, sys.argv[2:])
    platform = made.stem.split("-")[-1]
    wrong = list(wrong_with_prefix(prefix))
    with tempfile.TemporaryDirectory() as folder:
        shutil.unpack_archive(made, f"{folder}/wheel", "zip")
        faults = wrong_with_folder(Path(folder) / "wheel", wheel(system), 3, system, platform)
        wrong += [f"{made.name} {fault}" for fault in faults]
        shutil.unpack_archive(packed, f"{folder}/archive")
        (unpacked,) = (Path(folder) / "archive").iterdir()
        copies = system == "Windows"  # pathampl is no link
        faults = wrong_with_folder(unpacked, archive(system), 3 + copies, system, platform)
        wrong += [f"{packed.name} {fault}" for fault in faults]
    print("\n".join(wrong), end="\n" if wrong else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
