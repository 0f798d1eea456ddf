#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""check_portable.py CC: what scripts/portable checks of its product (packaging/portable/check.py) is refused where it is
wrong. Catches a wheel that runs only on the machine where it was made, and one without the licence of a part."""

import importlib.util
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

ROOT = Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "packaging" / "portable"))
import check  # noqa: E402

CC = sys.argv.pop(1)


class Portable(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def library(self, name, text, *flags):
        source = self.folder / "source.c"
        source.write_text(text)
        subprocess.run([CC, "-shared", "-nostdlib", "-fPIC", "-o", self.folder / name, source, *flags], check=True)
        return self.folder / name

    def of_version(self, version):
        """A library that needs something of this version from one of the system's name."""
        versions = self.folder / "map"
        versions.write_text(f"{version} {{ global: f; local: *; }};\n")
        self.library("m.so", "int f(void) { return 1; }", "-Wl,-soname,libm.so.6", f"-Wl,--version-script={versions}")
        return self.library("user.so", "int f(void); int g(void) { return f(); }", self.folder / "m.so")

    def test_versions(self):
        self.assertEqual(list(check.wrong_with(self.of_version("GLIBC_2.28"))), [])
        self.assertEqual(list(check.wrong_with(self.of_version("GLIBC_2.29"))), ["needs GLIBC_2.29"])
        self.assertEqual(list(check.wrong_with(self.of_version("GLIBC_2.3.4"))), [])
        self.assertEqual(list(check.wrong_with(self.of_version("GLIBCXX_3.4"))), ["needs GLIBCXX_3.4"])
        self.assertEqual(list(check.wrong_with(self.folder / "m.so")), [])  # has it, and needs nothing

    def test_libraries(self):
        self.library("umfpack.so", "int f(void) { return 1; }", "-Wl,-soname,libumfpack.so.5")
        user = self.library("user.so", "int f(void); int g(void) { return f(); }", self.folder / "umfpack.so")
        self.assertEqual(list(check.wrong_with(user)), ["needs libumfpack.so.5"])

    def test_contents(self):
        for patterns in [of(system) for of in (check.wheel, check.archive) for system in check.NAMES]:
            names = [re.sub(r"\[[^]]*\]\+", "1.0.0", pattern).replace("\\", "") for pattern in patterns]
            self.assertEqual(check.missing(patterns, names), [])
            for k, pattern in enumerate(patterns):
                self.assertEqual(check.missing(patterns, names[:k] + names[k + 1 :]), [pattern])

    def test_counterparts(self):
        """What asks a system has an implementation for the systems of which nothing is known. Catches a build for macOS or
        Windows that lacks a function."""
        of_a_system = {path for system in ("linux", "windows") for path in ROOT.glob(f"*/**/*_{system}.cpp")}
        of_a_system = {path for path in of_a_system if "build" not in path.relative_to(ROOT).parts}
        self.assertGreaterEqual(len(of_a_system), 8)
        for path in of_a_system:
            portable = path.with_name(re.sub("_[a-z]+$", "_portable", path.stem) + ".cpp")
            self.assertTrue(portable.exists(), f"{path} has no counterpart {portable.name}")

    def test_loader(self):
        """The package looks for its library by the name that it has in the wheel. Catches a wheel that finds none."""
        for platform, system in (("linux", "Linux"), ("win32", "Windows"), ("darwin", "Darwin")):
            specification = importlib.util.spec_from_file_location("library", ROOT / "python" / "perp" / "_library.py")
            loader = importlib.util.module_from_spec(specification)
            with mock.patch.object(sys, "platform", platform):
                specification.loader.exec_module(loader)
            self.assertIn(f"perp/{re.escape(loader._FILE)}", check.wheel(system))

    def test_windows(self):
        """Of its own tools alone. Catches a wheel that asks for MinGW's or Debian's libraries."""
        of_windows = check.OF_THE_SYSTEM["Windows"]
        for name in ("KERNEL32.dll", "api-ms-win-crt-math-l1-1-0.dll"):
            self.assertTrue(of_windows.fullmatch(name), name)
        for name in ("libwinpthread-1.dll", "libc++.dll", "perp.dll", "xkernel32.dll"):
            self.assertFalse(of_windows.fullmatch(name), name)

    def test_a_folder(self):
        self.library("perp.so", "int f(void) { return 1; }")
        self.assertEqual(list(check.wrong_with_folder(self.folder, ["source.c"], 1)), [])
        self.assertEqual(len(list(check.wrong_with_folder(self.folder, ["LICENSE"], 2))), 2)

    def test_licences(self):
        (self.folder / "lib").mkdir()
        for name in ("libklu.a", "libcholmod.a"):
            (self.folder / "lib" / name).touch()
        (wrong,) = check.wrong_with_prefix(self.folder)
        self.assertIn("libcholmod.a", wrong)

    def test_sources(self):
        """None is under the GPL alone, as UMFPACK and GSL are."""
        lines = re.findall(
            r"^(?:source|headers|tools|zig|linux|windows|web) +\S+ +(.*?)  ", (ROOT / "packaging/portable/libraries").read_text(), flags=re.M
        )
        self.assertGreaterEqual(len(lines), 10)
        for licence in lines:
            self.assertNotRegex(licence, r"^GPL|, GPL")


if __name__ == "__main__":
    unittest.main()
