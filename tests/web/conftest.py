# SPDX-License-Identifier: Apache-2.0
import os
from pathlib import Path

import pytest


def pytest_configure():
    if not Path(os.environ["PERP_WEB"], "page", "engine.js").is_file():
        pytest.exit("`scripts/portable web` has built nothing here", returncode=77)
