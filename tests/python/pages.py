# SPDX-License-Identifier: Apache-2.0
"""The examples of the pages, which tests run as a reader would."""

import re
import warnings
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def run_examples(page, least=1):
    """Runs the blocks of Python of a page one after the other, at least so many."""
    blocks = re.findall(r"^```python\n(.*?)^```", (ROOT / page).read_text(encoding="utf-8"), re.M | re.S)
    assert len(blocks) >= least
    scope = {}
    for block in blocks:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # of numpy's, at points where F overflows
            exec(compile(block, page, "exec"), scope)
