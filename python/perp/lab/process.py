# SPDX-License-Identifier: Apache-2.0
"""Processes under limits of wall clock and memory.

All that a run has started ends with it, and with this program, however that ends. Each run has a mark in its
environment, which all that it starts inherits: by the mark it is found in /proc. As a script, `process.py MARK` waits
for the end of its standard input, which is the end of the program that has started it, and kills whatever bears a mark
that begins so.
"""

import contextlib
import itertools
import json
import os
import signal
import subprocess
import sys
import threading
import time
from concurrent import futures
from dataclasses import dataclass, field

with contextlib.suppress(ImportError):  # reports are made where processes have no limits, too
    import resource

MIB = 1 << 20
OUTPUT_LIMIT = 1 << 30  # of standard output; a result of ten million variables fits
GRACE = 2.0  # s between SIGTERM and SIGKILL
TAIL = 4000  # characters of standard error that are kept
NAME, MARK, NUMBERS = "PERP_LAB_RUN", f"{os.getpid()}.{time.time_ns()}.", itertools.count()
ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in ("OPENBLAS", "OMP", "MKL", "BLIS", "GOTO")}


class Stopped(Exception):
    """The campaign has been interrupted: nothing is booked of this run."""


@dataclass
class End:
    """How a process ended."""

    why: str = "itself"  # or "time", "memory"
    code: int = 0  # of its exit, or minus the signal that ended it
    seconds: float = 0
    peak_mb: float = 0
    out: bytearray = field(default_factory=bytearray)
    err: bytearray = field(default_factory=bytearray)

    @property
    def signal(self):
        return max(-self.code, 0)

    def words(self):
        return signal_name(self.signal) if self.signal else f"exit code {self.code}"

    @property
    def answer(self):
        """The object in JSON on standard output, or None."""
        with contextlib.suppress(ValueError):
            answer = json.loads(self.out)
            return answer if isinstance(answer, dict) else None

    def said(self, most=300):
        """The last words on standard error."""
        return one_line(self.err.decode("utf-8", "replace")[-most:])


def signal_name(number):
    return f"signal {number} ({signal.strsignal(number) or 'unknown'})"


def one_line(text, most=600):
    return "".join(c if c >= " " else " " for c in text[:most]).strip()


def resident_mb(pid):
    with contextlib.suppress(OSError, IndexError, ValueError), open(f"/proc/{pid}/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE") / MIB
    return 0.0


def marked(mark):
    """The processes that bear a mark that begins so. One that has ended has no environment any more."""
    found, word = [], f"{NAME}={mark}".encode()
    for name in filter(str.isdigit, os.listdir("/proc") if os.path.isdir("/proc") else ()):
        with contextlib.suppress(OSError), open(f"/proc/{name}/environ", "rb") as file:
            if any(entry.startswith(word) for entry in file.read().split(b"\0")):
                found.append(int(name))
    return found


def send(kill, pid, number):
    with contextlib.suppress(OSError):  # it is gone
        kill(pid, number)


def kill_marked(mark, rounds=1):
    """Kills until nothing is left: what was started meanwhile is found in the next round."""
    for k in range(100):
        found = marked(mark)
        if not found and k + 1 >= rounds:
            return
        for pid in found:
            send(os.kill, pid, signal.SIGKILL)
        time.sleep(0.01)


def collect(stream, most, kept):
    """Reads to the end, and keeps no more than the last part."""
    with stream:
        while data := stream.read1(1 << 16):
            kept += data
            if len(kept) > 2 * most:
                del kept[:-most]


def run(arguments, seconds=60.0, memory_mb=4096, tree=False, stopped=lambda: False):
    """The End of a process: after `seconds` it gets SIGTERM, GRACE seconds later SIGKILL. Raises Stopped.

    tree: it may start others, whose memory counts, too; else its address space is limited.
    """
    mark, end, looked = f"{MARK}{next(NUMBERS)}.", End(), 0.0
    # Linux counts the memory of the process that forked, too: a maximum no larger than that says nothing.
    least = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    child = subprocess.Popen(arguments, env={**os.environ, **ONE_THREAD, NAME: mark}, start_new_session=True, **pipes)
    begin = time.monotonic()
    if not tree and hasattr(resource, "prlimit"):  # for what grows faster than one can look; reserved is not used
        limit = int(2 * MIB * memory_mb) + 1024 * MIB
        with contextlib.suppress(OSError, ValueError):
            resource.prlimit(child.pid, resource.RLIMIT_AS, (limit, limit))
    streams = ((child.stdout, OUTPUT_LIMIT, end.out), (child.stderr, TAIL, end.err))
    readers = [threading.Thread(target=collect, args=of, daemon=True) for of in streams]
    for reader in readers:
        reader.start()

    def kill():
        send(os.killpg, child.pid, signal.SIGSTOP)  # so that nobody starts another while one after the other dies
        if tree:
            kill_marked(mark)
        send(os.killpg, child.pid, signal.SIGKILL)

    while True:
        pid, status, usage = os.wait4(child.pid, os.WNOHANG)
        now = time.monotonic() - begin
        if pid:
            break
        if end.why == "itself" and stopped():
            end.why = "stopped"
        if end.why == "itself" and now >= seconds:
            end.why = "time"
            send(os.killpg, child.pid, signal.SIGTERM)
        if now - looked >= (0.05 if tree else 0.01):
            looked = now
            mb = sum(map(resident_mb, marked(mark) if tree else [child.pid]))
            end.peak_mb = max(end.peak_mb, mb)
            end.why = "memory" if mb > memory_mb else end.why
        if end.why in ("memory", "stopped") or now >= seconds + GRACE:
            kill()
        readers[0].join(0.002)  # most end when they close their output
        if not readers[0].is_alive():
            time.sleep(0.0005)
    child.returncode, end.code, end.seconds = 0, os.waitstatus_to_exitcode(status), now
    kill()  # what it left behind
    for reader in readers:
        reader.join(1)
    if end.why == "stopped":
        raise Stopped
    if usage.ru_maxrss > least:
        end.peak_mb = max(end.peak_mb, usage.ru_maxrss / 1024)
    return end


def run_all(jobs, work, items, stopped, tick=lambda: None):
    """work(item) of all items, `jobs` at a time; the first exception, or what `stopped` says, ends it."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, resource.getrlimit(resource.RLIMIT_CORE)[1]))  # no run leaves a dump
    command = [sys.executable, "-S", "-E", __file__, MARK]
    guard = subprocess.Popen(command, stdin=subprocess.PIPE, start_new_session=True)
    failed = []

    def worker(item):
        try:
            if not failed and not stopped():
                work(item)
        except Stopped:
            pass
        except BaseException as error:
            failed.append(error)

    with futures.ThreadPoolExecutor(jobs) as pool:
        try:
            for one in [pool.submit(worker, item) for item in items]:
                while not one.done():
                    futures.wait([one], 0.1)
                    tick()
        except BaseException as error:  # as where nobody reads standard error any more
            failed.append(error)
    guard.kill()  # nothing is left for it
    guard.wait()
    guard.stdin.close()
    if failed:
        raise failed[0]


if __name__ == "__main__":
    sys.stdin.buffer.read()
    kill_marked(sys.argv[1], rounds=5)  # one that was forked just now bears its mark a moment later
