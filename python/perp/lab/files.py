# SPDX-License-Identifier: Apache-2.0
"""Files of a campaign: JSON, CSV, files written whole or not at all, a lock, and the journal of its finished cells.

The journal, DIR/cells.jsonl, has a line for each finished cell and only grows:

    {"cell":{...},"crc":"xxxxxxxx"}

with zlib's CRC-32 of the text of the cell's object. A line that is torn, or whose text does not fit its CRC, does not
count, wherever it stands. A line is on the disk when Journal.add() returns; one that could not be written is cut off.
"""

import contextlib
import json
import math
import os
import re
import tempfile
import threading
import zlib
from pathlib import Path

try:
    import fcntl
except ImportError:  # no lock where there is none
    fcntl = None


class InputError(Exception):
    """What the user can mend: refused, with exit code 2."""


class Environment(Exception):
    """The machine failed, as when its disk is full: nothing is booked any more."""


class NotSeen(Environment):
    """A process was killed by somebody else, or left nothing: its cell stays open, and others go on."""


def to_json(value):
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if isinstance(value, dict):
        return {key: to_json(item) for key, item in value.items()}
    return [to_json(item) for item in value] if isinstance(value, (list, tuple)) else value


def number(value):
    """A number of JSON, or "inf", "-inf", "nan", as a float: NaN for null."""
    return math.nan if value is None else float(value)


def compact(value, **how):
    return json.dumps(to_json(value), ensure_ascii=False, allow_nan=False, **(how or {"separators": (",", ":")}))


def pretty(value):
    return compact(value, indent=2) + "\n"


def crc_of(path):
    try:
        return f"{zlib.crc32(Path(path).read_bytes()):08x}"
    except OSError as error:
        raise InputError(f"there is no file '{path}' that can be read") from error


def write_files(folder, files):
    """Writes {name: text}: all drafts are on the disk before the first takes the place of its file."""
    with tempfile.TemporaryDirectory(prefix=".perp-", dir=folder) as drafts:
        for name, text in files.items():
            draft = os.path.join(drafts, name)
            with open(draft, "w", encoding="utf-8", errors="replace", newline="") as file:
                file.write(text)
                file.flush()
                os.fsync(file.fileno())
        for name in files:
            os.replace(os.path.join(drafts, name), os.path.join(folder, name))
        sync_folder(folder)


def write_file(path, text):
    folder, name = os.path.split(os.path.abspath(path))
    write_files(folder, {name: text})


def sync_folder(folder):
    with contextlib.suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        with contextlib.suppress(OSError):
            os.fsync(handle)
        os.close(handle)


def take_folder(folder, fresh):
    """Makes the folder, and holds it: the file that comes back is the lock, which goes with this process."""
    try:
        os.makedirs(folder, exist_ok=True)
        names = [name for name in os.listdir(folder) if name not in ("lock", "work") and not name.startswith(".perp-")]
        lock = open(os.path.join(folder, "lock"), "a+", encoding="ascii")
        lock.seek(0)
    except OSError as error:
        raise InputError(f"'{folder}' cannot be made: {error.strerror}") from error
    if fresh and names:
        what = "holds a campaign: --resume goes on with it," if "campaign.json" in names else "is not empty:"
        raise InputError(f"'{folder}' {what} --out DIR names another")
    try:
        if fcntl is not None:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        raise InputError(f"'{folder}': another campaign is at work there (process {lock.read().strip()})") from error
    lock.truncate(0)
    lock.write(f"{os.getpid()}\n")
    lock.flush()
    return lock


def read_campaign(folder):
    path = os.path.join(folder, "campaign.json")
    try:
        campaign = json.loads(Path(path).read_text("utf-8"))
        if campaign["campaign"] != 1:
            raise InputError(f"{path}: written in format {campaign['campaign']}, of another version")
    except OSError as error:
        raise InputError(f"'{path}' cannot be read") from error
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(f"{path}: no campaign: {error}") from error
    return campaign


class Journal:
    def __init__(self, folder):
        self.path, self.lock = os.path.join(folder, "cells.jsonl"), threading.Lock()
        self.file = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o666)
        os.ftruncate(self.file, Path(self.path).read_bytes().rfind(b"\n") + 1)
        os.fsync(self.file)
        sync_folder(folder)

    def add(self, cell):
        with self.lock:
            line, before = memoryview(cell_line(cell)), os.fstat(self.file).st_size
            try:
                while line:
                    line = line[os.write(self.file, line) :]
                os.fsync(self.file)
            except OSError as error:
                with contextlib.suppress(OSError):
                    os.ftruncate(self.file, before)
                raise Environment(f"{self.path}: {error.strerror}") from error


def cell_line(cell):
    text = compact(cell).encode("utf-8", "replace")
    return b'{"cell":%s,"crc":"%08x"}\n' % (text, zlib.crc32(text))


def key_of(cell):
    return cell["method"], cell["problem"], cell["start"]


def read_cells(folder):
    """({key: cell}, what does not count and why); of two cells with one key the later."""
    path = os.path.join(folder, "cells.jsonl")
    try:
        lines = Path(path).read_bytes().removeprefix(b"\xef\xbb\xbf").splitlines(keepends=True)
    except OSError as error:
        raise InputError(f"'{path}' cannot be read") from error
    cells, dropped = {}, []
    for place, line in enumerate(lines, 1):
        match = re.fullmatch(rb'\{"cell":(.*),"crc":"([0-9a-f]{8})"\}\n', line)
        try:
            if match is None:
                raise ValueError("torn")
            if (crc := zlib.crc32(match[1])) != int(match[2], 16):
                raise ValueError(f"its CRC is {crc:08x}, not {match[2].decode()}")
            cell = json.loads(match[1])
            cells[key_of(cell)] = cell
        except (ValueError, KeyError, TypeError) as error:
            dropped.append(f"line {place}: {error}")
    return cells, dropped
