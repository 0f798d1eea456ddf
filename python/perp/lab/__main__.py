# SPDX-License-Identifier: Apache-2.0
"""python3 -m perp.lab compare|report; or python3 FOLDER compare|report with this folder, wherever it is."""

import sys
import types
from pathlib import Path

if not __package__:  # run as a folder: the rest of the package perp is not asked for
    package = types.ModuleType("perp")
    package.__path__ = [str(Path(__file__).resolve().parent.parent)]
    sys.modules["perp"] = package

from perp.lab.compare import compare, report, run

if __name__ == "__main__":
    command = {"compare": compare, "report": report}.get("".join(sys.argv[1:2]))
    sys.exit(run(command, sys.argv[2:]) if command else "python3 -m perp.lab compare|report; 'compare --help' explains")
