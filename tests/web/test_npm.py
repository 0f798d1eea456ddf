# SPDX-License-Identifier: Apache-2.0
"""The npm package that `scripts/portable web` builds, packed and installed as npm does it; PERP_WEB is the folder with it."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
PACKAGE = Path(os.environ["PERP_WEB"]) / "npm"


@pytest.mark.skipif(shutil.which("npm") is None, reason="npm is not installed")
def test_in_node(tmp_path, monkeypatch):
    def run(*words):
        done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    packed = run("npm", "pack", "--silent", str(PACKAGE)).strip()
    (tmp_path / "package.json").write_text('{"type": "module"}\n')
    run("npm", "install", "--silent", "--offline", "--no-audit", f"./{packed}")
    shutil.copy(HERE / "npm_test.mjs", tmp_path)
    monkeypatch.setenv("PERP_MODELS", str(HERE.parent.parent / "data" / "models"))
    run("node", "--test", "npm_test.mjs")
