# SPDX-License-Identifier: Apache-2.0
"""Runs pytest on a file of this folder; 77 where a package of Debian's is not installed."""

import importlib.util
import sys
from pathlib import Path

NEEDED = {"numpy": "python3-numpy", "scipy": "python3-scipy", "pytest": "python3-pytest"}

missing = [package for module, package in NEEDED.items() if importlib.util.find_spec(module) is None]
if missing:
    print("skipped: not installed:", *missing)
    sys.exit(77)

import pytest  # noqa: E402  (after the check that it is there)

status = pytest.main(["-q", "-rs", "-p", "no:cacheprovider", str(Path(__file__).parent / sys.argv[1])])
sys.exit(77 if status == pytest.ExitCode.NO_TESTS_COLLECTED else status)  # all of the file is skipped
