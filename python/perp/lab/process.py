# SPDX-License-Identifier: Apache-2.0
"""Processes under limits of wall clock and memory.

All that a run has started ends with it, and with this program, however that ends. Each run has a mark in its environment,
which all that it starts inherits: by the mark it is found in /proc. As a script, `process.py MARK` waits for the end of its
standard input, which is the end of the program that has started it, and kills whatever bears a mark that begins so.
"""

import contextlib
import itertools
import os
import select
import signal
import subprocess
import sys
import threading
import time
from dataclasses import dataclass

try:
    import resource
except ImportError:  # no limits where there are none
    resource = None

MIB = 1 << 20
OUTPUT_LIMIT = 1 << 30  # of standard output; a result of ten million variables fits
TAIL = 4000  # characters of standard error that are kept
NAME, MARK, NUMBERS = "PERP_LAB_RUN", f"{os.getpid()}.{time.time_ns()}.", itertools.count()
ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in ("OPENBLAS", "OMP", "MKL", "BLIS", "GOTO")}


class Stopped(Exception):
    """The campaign has been interrupted: nothing is booked of this run."""


@dataclass
class End:
    """How a process ended."""

    why: str = "itself"  # or "time", "memory"
    status: int = 0  # of os.wait4
    seconds: float = 0
    peak_mb: float = 0
    out: bytes = b""
    err: bytes = b""

    @property
    def signal(self):
        return os.WTERMSIG(self.status) if os.WIFSIGNALED(self.status) else 0

    @property
    def code(self):
        return os.WEXITSTATUS(self.status) if os.WIFEXITED(self.status) else None

    def words(self):
        return signal_name(self.signal) if self.signal else f"exit code {self.code}"

    def said(self, most=300):
        """The last words on standard error."""
        return one_line(self.err.decode("utf-8", "replace")[-most:])


def signal_name(number):
    return f"signal {number} ({signal.strsignal(number) or 'unknown'})"


def one_line(text, most=600):
    return "".join(c if c >= " " else " " for c in text[:most]).strip()


def resident_mb(pid):
    try:
        with open(f"/proc/{pid}/statm", encoding="ascii") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE") / MIB
    except (OSError, IndexError, ValueError):
        return 0.0


def marked(mark):
    """The processes that bear a mark that begins so. One that has ended has no environment any more."""
    found, word = [], f"{NAME}={mark}".encode()
    for name in os.listdir("/proc") if os.path.isdir("/proc") else ():
        with contextlib.suppress(OSError):
            if name.isdigit():
                with open(f"/proc/{name}/environ", "rb") as file:
                    if any(entry.startswith(word) for entry in file.read().split(b"\0")):
                        found.append(int(name))
    return found


def kill_marked(mark, rounds=1):
    """Kills until nothing is left: what was started meanwhile is found in the next round."""
    for k in range(100):
        found = marked(mark)
        if not found and k + 1 >= rounds:
            return
        for pid in found:
            with contextlib.suppress(OSError):
                os.kill(pid, signal.SIGKILL)
        time.sleep(0.01)


def kill_group(pid, number):
    with contextlib.suppress(OSError):
        os.killpg(pid, number)


class Run:
    """One process. `tree`: it may start others, whose memory counts; else the address space is limited, too."""

    def __init__(self, arguments, seconds, memory_mb, grace, tree):
        self.seconds, self.memory_mb, self.grace, self.tree = seconds, memory_mb, grace, tree
        self.mark, self.end, self.told, self.looked = f"{MARK}{next(NUMBERS)}.", End(), False, 0.0
        # Linux counts the memory of the process that forked, too: a maximum no larger than that says nothing.
        self.least = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss if resource else 0
        environment = {**os.environ, **ONE_THREAD, NAME: self.mark}
        pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        self.child = subprocess.Popen(arguments, env=environment, start_new_session=True, **pipes)
        self.pid, self.begin = self.child.pid, time.monotonic()
        if not tree and hasattr(resource, "prlimit"):  # for what grows faster than one can look; reserved is not used
            limit = int(2 * MIB * memory_mb) + 1024 * MIB
            with contextlib.suppress(OSError, ValueError):
                resource.prlimit(self.pid, resource.RLIMIT_AS, (limit, limit))
        self.open = {stream.fileno(): bytearray() for stream in (self.child.stdout, self.child.stderr)}
        self.out, self.err = self.open.values()
        self.poll = select.poll()
        for stream in self.open:
            os.set_blocking(stream, False)
            self.poll.register(stream, select.POLLIN)

    def read(self, stream):
        """Takes what is there; false when there is nothing more for now."""
        try:
            data = os.read(stream, 1 << 16)
        except BlockingIOError:
            return False
        except OSError:
            data = b""
        if not data:
            self.poll.unregister(stream)
            del self.open[stream]
            return False
        self.open[stream] += data
        del self.err[:-TAIL]
        if len(self.out) > OUTPUT_LIMIT:
            self.kill()
        return True

    def kill(self):
        kill_group(self.pid, signal.SIGSTOP)  # so that nobody starts another while one after the other dies
        if self.tree:
            kill_marked(self.mark)
        kill_group(self.pid, signal.SIGKILL)

    def keep_limits(self):
        now = time.monotonic() - self.begin
        if now >= self.seconds and not self.told:
            self.told, self.end.why = True, "time"
            kill_group(self.pid, signal.SIGTERM)
        if now >= self.seconds + self.grace:
            self.kill()
        if now - self.looked >= (0.05 if self.tree else 0.01):
            self.looked = now
            mb = sum(map(resident_mb, marked(self.mark) if self.tree else [self.pid]))
            self.end.peak_mb = max(self.end.peak_mb, mb)
            if mb > self.memory_mb:
                self.end.why = "memory"
                self.kill()

    def wait(self, stopped):
        try:
            while True:
                if self.open:
                    for stream, _ in self.poll.poll(10):
                        self.read(stream)
                else:
                    time.sleep(0.001)
                pid, self.end.status, usage = os.wait4(self.pid, os.WNOHANG)
                if pid:
                    break
                if stopped():
                    raise Stopped
                self.keep_limits()
        except BaseException:
            self.kill()
            os.waitpid(self.pid, 0)
            raise
        finally:
            self.child.returncode = 0
            self.end.seconds = time.monotonic() - self.begin
            if self.tree:
                kill_marked(self.mark)
            kill_group(self.pid, signal.SIGKILL)  # what it left behind
            for stream in list(self.open):
                while self.read(stream):
                    pass
            self.child.stdout.close()
            self.child.stderr.close()
        if usage.ru_maxrss > self.least:
            self.end.peak_mb = max(self.end.peak_mb, usage.ru_maxrss / 1024)
        self.end.out, self.end.err = bytes(self.out), bytes(self.err)
        return self.end


def run(arguments, seconds=60.0, memory_mb=4096, grace=2.0, tree=False, stopped=lambda: False):
    """The End of a process: after `seconds` it gets SIGTERM, `grace` seconds later SIGKILL. Raises Stopped."""
    return Run(arguments, seconds, memory_mb, grace, tree).wait(stopped)


def run_all(jobs, work, items, stopped, tick=lambda: None):
    """work(item) of all items, `jobs` at a time; the first exception, or what `stopped` says, ends it."""
    if resource:  # no run leaves a core dump
        resource.setrlimit(resource.RLIMIT_CORE, (0, resource.getrlimit(resource.RLIMIT_CORE)[1]))
    command = [sys.executable, "-S", "-E", __file__, MARK]
    guard = subprocess.Popen(command, stdin=subprocess.PIPE, start_new_session=True)
    waiting, lock, failed = iter(items), threading.Lock(), []

    def worker():
        while not failed and not stopped():
            with lock:
                item = next(waiting, None)
            if item is None:
                return
            try:
                work(item)
            except Stopped:
                return
            except BaseException as error:
                failed.append(error)

    threads = [threading.Thread(target=worker) for _ in range(jobs)]
    for thread in threads:
        thread.start()
    for thread in threads:
        while thread.is_alive():
            thread.join(0.1)
            tick()
    guard.stdin.close()
    guard.wait()
    if failed:
        raise failed[0]


if __name__ == "__main__":
    sys.stdin.buffer.read()
    kill_marked(sys.argv[1], rounds=5)  # one that was forked just now bears its mark a moment later
