# SPDX-License-Identifier: Apache-2.0
"""The lab as a package, without the rest of perp, and as the commands that users type."""

import json
import os
import subprocess
import sys
import types
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
LAB = ROOT / "python" / "perp" / "lab"
PROGRAM = os.environ["PERP_PROGRAM"]

package = types.ModuleType("perp")
package.__path__ = [str(LAB.parent)]
sys.modules.setdefault("perp", package)


def command(*words):
    return [sys.executable, str(LAB), *map(str, words)]


def compare(*words, **how):
    return subprocess.run(command("compare", *words), capture_output=True, text=True, timeout=240, check=False, **how)


def start(*words, **how):
    return subprocess.Popen(command("compare", *words), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, **how)


def cells(folder):
    return [json.loads(line)["cell"] for line in (Path(folder) / "cells.jsonl").read_text().splitlines()]


def script(path, body):
    path.write_text(f"#!/bin/sh\n{body}\n")
    path.chmod(0o755)
    return path


def wrapper(path, body):
    """A program in place of perp: BODY sees perp's words as $@, and exec "$perp" "$@" is the rest."""
    return script(path, f"perp='{PROGRAM}'\n{body}\nexec \"$perp\" \"$@\"")


def sol(x, code):
    """A .sol file for one variable."""
    return f"peer\n\nOptions\n3\n1\n1\n0\n1\n0\n1\n1\n{x}\nobjno 0 {code}\n"


def writes(text):
    return f"cat > $1.sol <<'END'\n{text}END"
