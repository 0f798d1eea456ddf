# SPDX-License-Identifier: Apache-2.0
"""Processes under limits of wall clock and memory, several at a time, in one thread.

A task is a generator: it yields a Request and is sent its End. Pool runs such tasks. All that a process has started
ends with it, and with this process, however that ends.

As a script, `process.py COMMAND STUB` is the guard of an external program: it runs `COMMAND STUB -AMPL`, kills what the
program leaves running, prints what is known of its end as JSON, and does all this when its standard input is closed, too.
"""

import ctypes
import json
import os
import select
import signal
import subprocess
import sys
import time
from collections import deque
from dataclasses import dataclass

MIB = 1 << 20
OUTPUT_LIMIT = 1 << 30  # of standard output; a result of ten million variables fits
LIBC = ctypes.CDLL(None, use_errno=True) if sys.platform == "linux" else None
PR_SET_PDEATHSIG, PR_SET_CHILD_SUBREAPER = 1, 36
THREADS = ("OPENBLAS", "OMP", "MKL", "BLIS", "GOTO")


@dataclass
class Request:
    arguments: list
    seconds: float = 60  # then SIGTERM
    grace: float = 2  # s after it, then SIGKILL
    memory_mb: float = 4096  # resident; of all that it started if `tree`
    tree: bool = False  # it is a guard


@dataclass
class End:
    why: str = "itself"  # or "time", "memory", "stopped"
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


def signal_name(number):
    return f"signal {number} ({signal.strsignal(number) or 'unknown'})"


def one_line(text, most=600):
    """The beginning of what a program says, in one line."""
    return "".join(c if c >= " " else " " for c in text[:most]).strip()


def resident_mb(pid):
    try:
        with open(f"/proc/{pid}/statm", encoding="ascii") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE") / MIB
    except (OSError, IndexError, ValueError):
        return 0.0


def descendants(root):
    parent = {}
    for name in os.listdir("/proc") if os.path.isdir("/proc") else ():
        if name.isdigit():
            try:
                with open(f"/proc/{name}/stat", "rb") as file:
                    parent[int(name)] = int(file.read().rpartition(b")")[2].split()[1])
            except (OSError, IndexError, ValueError):
                continue
    found, layer = [], {root}
    while layer:
        layer = {pid for pid, of in parent.items() if of in layer} - set(found)
        found += layer
    return found


def kill_descendants(root):
    for _ in range(20):  # what was started meanwhile is found in the next round
        found = [pid for pid in descendants(root) if resident_mb(pid) > 0]
        for pid in found:
            try:
                os.kill(pid, signal.SIGKILL)
            except OSError:
                pass
        if not found:
            return


def kill_group(pid, number):
    try:
        os.killpg(pid, number)
    except OSError:
        pass


def prepare(request, parent):
    """What a child does before it becomes the program."""
    import resource

    def limit(what, value):
        hard = resource.getrlimit(what)[1]
        value = value if hard == resource.RLIM_INFINITY else min(value, hard)
        resource.setrlimit(what, (value, value))

    def child():
        os.setpgid(0, 0)
        if LIBC is not None and not request.tree:  # a guard sees the end of its standard input instead
            LIBC.prctl(PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
            if os.getppid() != parent:
                os._exit(127)
        limit(resource.RLIMIT_CORE, 0)
        if not request.tree:  # for what grows faster than one can look; reserved is not used
            limit(resource.RLIMIT_AS, int(2 * MIB * request.memory_mb) + 1024 * MIB)

    return child


class Running:
    def __init__(self, request):
        self.request, self.end, self.told, self.looked, self.least = request, End(), False, 0.0, resident_mb(os.getpid())
        environment = {**os.environ, **{f"{name}_NUM_THREADS": "1" for name in THREADS}}
        self.child = subprocess.Popen(
            request.arguments,
            stdin=subprocess.PIPE if request.tree else subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=environment,
            preexec_fn=prepare(request, os.getpid()) if os.name == "posix" else None,
        )
        self.pid, self.begin, self.out, self.err = self.child.pid, time.monotonic(), bytearray(), bytearray()
        self.open = [self.child.stdout, self.child.stderr]
        for stream in self.open:
            os.set_blocking(stream.fileno(), False)

    def read(self, stream):
        try:
            data = os.read(stream.fileno(), 1 << 16)
        except BlockingIOError:
            return False
        except OSError:
            data = b""
        if not data:
            self.open.remove(stream)
            return False
        if stream is self.child.stdout:
            self.out += data
            if len(self.out) > OUTPUT_LIMIT:
                self.stop(self.end.why)
        else:
            self.err += data
            del self.err[4000:-4000]
        return True

    def stop(self, why):
        self.end.why = why
        kill_group(self.pid, signal.SIGSTOP)  # so that nobody starts another while one after the other dies
        if self.request.tree:
            kill_descendants(self.pid)
        kill_group(self.pid, signal.SIGKILL)

    def look(self):
        """Keeps the limits; true when it has ended."""
        pid, status, usage = os.wait4(self.pid, os.WNOHANG)
        now, request = time.monotonic() - self.begin, self.request
        if pid:
            self.finish(status, now, usage.ru_maxrss / 1024)
            return True
        if now >= request.seconds and not self.told:
            self.told = True
            self.end.why = "time" if self.end.why == "itself" else self.end.why
            kill_group(self.pid, signal.SIGTERM)
        if now >= request.seconds + request.grace:
            self.stop(self.end.why)
        if now - self.looked >= (0.05 if request.tree else 0.01):
            self.looked = now
            mb = resident_mb(self.pid) + sum(map(resident_mb, descendants(self.pid) if request.tree else ()))
            self.end.peak_mb = max(self.end.peak_mb, mb)
            if mb > request.memory_mb:
                self.stop("memory")
        return False

    def finish(self, status, seconds, largest_mb):
        kill_group(self.pid, signal.SIGKILL)  # what it left behind
        while any([self.read(stream) for stream in list(self.open)]):
            pass
        self.child.returncode = status
        for stream in (self.child.stdout, self.child.stderr, self.child.stdin):
            if stream is not None:
                stream.close()
        # Linux counts what this process had when it forked, too: a maximum no larger than that says nothing.
        peak = largest_mb if largest_mb > self.least else 0
        self.end.status, self.end.seconds, self.end.peak_mb = status, seconds, max(self.end.peak_mb, peak)
        self.end.out, self.end.err = bytes(self.out), bytes(self.err)


class Pool:
    """Runs tasks, at most `jobs` at a time; `stopped()` is asked now and then and ends all."""

    def __init__(self, jobs, stopped=lambda: False, tick=lambda: None):
        self.jobs, self.stopped, self.tick = jobs, stopped, tick

    def run(self, tasks):
        waiting, running = deque(tasks), []
        try:
            while running or (waiting and not self.stopped()):
                while waiting and len(running) < self.jobs and not self.stopped():
                    self.step(waiting.popleft(), None, running)
                self.wait(running)
                for item in list(running):
                    run, task = item
                    if self.stopped() and run.end.why != "stopped":
                        run.stop("stopped")
                    if run.look():
                        running.remove(item)
                        self.step(task, run.end, running)
                self.tick()
        finally:
            for run, _ in running:
                run.stop("stopped")
                while not run.look():
                    time.sleep(0.001)

    def step(self, task, end, running):
        if end is not None and end.why == "stopped":
            task.close()
            return
        try:
            running.append((Running(task.send(end)), task))
        except StopIteration:
            pass

    @staticmethod
    def wait(running):
        streams = {stream: run for run, _ in running for stream in run.open}
        if not streams:
            time.sleep(0.002 if running else 0)
            return
        for stream in select.select(list(streams), [], [], 0.01)[0]:
            streams[stream].read(stream)


def guard(command, stub):
    signal.signal(signal.SIGTERM, lambda *_: None)  # the program gets its own
    if LIBC is not None:
        LIBC.prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)  # orphans come to this process, which finds and ends them
    begin, output = time.monotonic(), os.pipe()
    script = f'exec {command} "$0" -AMPL'
    with open(os.devnull, "rb") as nothing:
        child = subprocess.Popen(["/bin/sh", "-c", script, stub], stdin=nothing, stdout=output[1], stderr=output[1])
    os.close(output[1])
    open_ends, tail, status, usage = [0, output[0]], b"", None, None
    while status is None:
        for end in select.select(open_ends, [], [], 0.01)[0]:
            data = os.read(end, 1 << 16)
            if end == 0 and not data:
                kill_descendants(os.getpid())
                os._exit(3)
            if not data:
                open_ends.remove(end)
            tail = (tail + data)[-400:] if end else tail
        pid, code, use = os.wait4(child.pid, os.WNOHANG)
        if pid:
            status, usage = code, use
    seconds = time.monotonic() - begin
    kill_descendants(os.getpid())  # before the rest is read: they could write for ever
    os.set_blocking(output[0], False)
    try:
        while data := os.read(output[0], 1 << 16):
            tail = (tail + data)[-400:]
    except OSError:
        pass
    words = one_line(tail.decode("utf-8", "replace"))
    print(json.dumps({"status": status, "seconds": seconds, "peak_mb": usage.ru_maxrss / 1024, "said": words}))


if __name__ == "__main__":
    guard(*sys.argv[1:])
