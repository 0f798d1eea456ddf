# SPDX-License-Identifier: Apache-2.0
"""One cell of a comparison, (method, problem, start): a run of the method, the judge, further runs after a failure.

Each is a process of its own: `perp solve` or an external program, then `perp judge`, which builds the problem anew. The
judge's word counts. Where there is no word of the judge, or where the machine failed, there is no outcome: the cell
stays open, and `--resume` runs it again.
"""

import itertools
import math
import os
import random
import re
import shutil
import signal
import tempfile
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from .files import NotSeen, number
from .process import End, one_line, run, signal_name

OUTCOMES = (
    "solved", "solved-to-rounding", "failed", "false-convergence", "unclaimed", "time-limit", "memory-limit", "crashed",
    "garbage", "not-applicable", "infeasible", "false-infeasible",
)  # fmt: skip
NO_JUDGE = ("time-limit", "memory-limit", "crashed", "garbage", "not-applicable")
HONEST = ("failed", "time-limit", "memory-limit")  # ends that claim nothing
COUNTS = ("iterations", "F_evals", "J_evals", "factorizations", "krylov_iterations")
KEYS = (
    "method", "problem", "start", "outcome", "status", "claimed", "natural", *COUNTS, "restarts",
    "outcome_after_restarts", "seconds", "peak_mb", "message", "curve",
)  # fmt: skip
FACTS = ("contacts", "solved_by", "siconos", "rr9118", "command")  # of contact, after those of every comparison
LONGEST_CURVE = 200
LEAST_FOR_OTHERS = 60  # s: for the judge and for a problem's description
# Sent by people, and by systems that are out of memory.
FROM_OUTSIDE = [getattr(signal, name, None) for name in ("SIGKILL", "SIGTERM", "SIGINT", "SIGHUP")]


def good(outcome):
    return outcome in ("solved", "infeasible")


def is_failure(outcome):
    return not good(outcome) and outcome != "not-applicable"


@dataclass
class Attempt:
    """How a run ended: what its process tells, what the method says, what the judge says."""

    end: End = field(default_factory=End)
    claim: str = "failed"  # or "solved", "to rounding", "infeasible", "proven infeasible", an outcome of NO_JUDGE
    message: str = ""
    status: str = ""
    counts: tuple = (None,) * len(COUNTS)
    seconds: float = 0
    curve: tuple = ()
    x: list = None
    natural: float = math.nan
    judged_to_rounding: bool = False
    facts: dict = field(default_factory=dict)  # further columns of the cell

    def outcome(self, problem, campaign):
        """(the one word, why): limits, crashes, garbage; then its claim, held against the judge and what is known."""
        solvable, claim, most = problem["solvable"], self.claim, campaign["memory_limit_mb"]
        holds = self.natural <= campaign["tol"] and solvable
        if self.end.why == "memory" or self.end.peak_mb > most:
            return "memory-limit", f"more than {most} MB"
        if self.end.why == "time" and claim != "memory-limit":
            killed = f"killed after {self.end.seconds:.3g} s"
            return "time-limit", killed if claim == "crashed" else f"told to end after {campaign['time_limit']:g} s"
        if claim in NO_JUDGE:
            return claim, self.message
        if claim == "to rounding" and not holds and self.judged_to_rounding and solvable:
            return "solved-to-rounding", self.message
        if claim in ("solved", "to rounding"):
            known = "" if solvable else f"there is no solution: {problem['no_solution']}; it says: "
            return "solved" if holds else "false-convergence", known + self.message
        denies = claim in ("infeasible", "proven infeasible")
        proven = claim == "proven infeasible" and not holds and problem["known_solutions"] == 0
        if denies and (not solvable or proven):
            return "infeasible", self.message
        if denies and (holds or not problem.get("file")):
            return "false-infeasible", self.message
        return "unclaimed" if holds else "failed", self.message


def check_seen(end, what):
    """Nothing was seen of a process that somebody else has ended."""
    if end.why == "itself" and end.signal in FROM_OUTSIDE:
        raise NotSeen(f"{what} was ended from outside by {end.words()}")


CLAIMS = {
    "Solved": "solved", "SolvedToRounding": "to rounding", "Infeasible": "proven infeasible",
    "NotApplicable": "not-applicable", "TimeLimit": "time-limit", "OutOfMemory": "memory-limit",
}  # fmt: skip


def attempt_of(end, name, read):
    """Of a run of perp with `--json -`; `read` makes the last fields of a finished one from its answer."""
    check_seen(end, name)
    answer, by_itself = end.answer, end.why == "itself"
    if answer is None and by_itself and not end.signal and end.code != 3:
        raise NotSeen(f"{name} left no result: {end.words()}; {end.said()}")
    if answer is None:
        return Attempt(end, "crashed", end.words() + ("" if end.signal else ", no result"), seconds=end.seconds)
    status, message = answer["status"], answer["message"]
    if status == "Interrupted" and by_itself:
        raise NotSeen(f"{name} was interrupted from outside")
    if status == "InputError":
        claim = "memory-limit" if ": out of memory" in message else "failed"
        return Attempt(end, claim, f"refused: {message}", "Refused")
    fields = read(answer) if "stats" in answer else {}
    return Attempt(end, CLAIMS.get(status, "failed"), message, status, **fields)


def read_solve(answer):
    """Of `perp solve`: the judge is yet to see x."""
    counts = tuple(answer["stats"][name] for name in COUNTS)
    curve = [number(it["residual"]) for it in answer["iterations"]]
    if len(curve) > LONGEST_CURVE:
        curve = [curve[k * (len(curve) - 1) // (LONGEST_CURVE - 1)] for k in range(LONGEST_CURVE)]
    x = [number(v["value"]) for v in answer["variables"] if v["state"] != "computed"]
    return {"counts": counts, "seconds": answer["stats"]["time_s"], "curve": curve, "x": x}


# Points and .sol files.


def write_point(folder, name, x):
    path, head = Path(folder, name), f"%%MatrixMarket matrix array real general\n{len(x)} 1\n"
    path.write_text(head + "".join(f"{v!r}\n" for v in x), "ascii")
    return str(path)


def perturbed(point, rule, run):
    """x_i = mid(l_i, x0_i + d (1 + |x0_i|) u_i, u_i), d = min(2^(run-1)/10, 1), u_i uniform in [-1, 1)."""
    uniform = random.Random(f"{rule} {run}").random
    d = min(0.1 * 2 ** (run - 1), 1.0)
    moved = (x + d * (1 + abs(x)) * (2 * uniform() - 1) for x in map(number, point["x"]))
    low, high = [number(v) for v in point["lower"]], [number(v) for v in point["upper"]]
    return [min(max(v, a), b) for v, a, b in zip(moved, low, high)]


def nl_with_start(text, x):
    """An .nl file with its initial guess replaced by the first entries of x."""
    variables = int(text.splitlines()[1].split()[0])
    guess = f"x{variables}\n" + "".join(f"{i} {x[i]!r}\n" for i in range(variables))
    without = re.sub(r"^x\d.*\n(\d.*\n)*", "", text, flags=re.M)
    return re.sub("^r", guess + "r", without, count=1, flags=re.M)  # the bounds of the rows, which come next


CLAIMS_OF_SOL = {0: "solved", 1: "to rounding", 2: "infeasible"}  # by the hundreds of its solve_result_num


class Garbage(Exception):
    """A .sol file that is none for its model."""


def read_sol(data, variables):
    """(message, solve_result_num, x or None) of a .sol file in text (Gay, Hooking your solver to AMPL, 1997)."""
    *lines, cut = data.removeprefix(b"\xef\xbb\xbf").decode("utf-8", "replace").replace("\r\n", "\n").split("\n")
    if cut or not data:
        raise Garbage("its last line is cut off" if cut else "it is empty")
    is_number = re.compile(r"-?\d{1,9}").fullmatch
    try:
        at = lines.index("Options", lines.index(""))  # an empty line ends the message
        announced, *options = map(int, itertools.takewhile(is_number, lines[at + 1 :]))
        tolerance = announced > 4 and options[1] == 3  # two of the announced are a real number, after the sizes
        first = announced - 2 * tolerance
        rows, duals, columns, values = options[first : first + 4]
        *floats, objno = lines[at + 6 + first + tolerance :][: max(duals, 0) + max(values, 0) + 1]
        floats = [float(line) for line in floats]
    except (IndexError, ValueError) as error:
        raise Garbage(f"{error}") from error
    match = re.fullmatch(r"objno\s+-?\d{1,9}\s+(-?\d{1,9})\s*", objno, re.A)
    if not match:
        raise Garbage(f"'{objno:.40}' where objno belongs")
    if columns != variables:
        raise Garbage(f"for {columns} variables, the model has {variables}")
    if rows < 0 or duals not in (0, rows) or values not in (0, columns) or len(floats) != duals + values:
        raise Garbage(f"{duals} dual values for {rows} rows, {values} values for {columns} variables")
    return "\n".join(filter(None, lines[:at])), int(match[1]), floats[duals:] or None


def with_tolerance(command, tol):
    """{tol} filled in; all other braces, ${tol} too, are the shell's."""
    return re.sub(r"(?<!\$)\{tol\}", lambda _: repr(tol), command)


class CellRunner:
    """Makes cells; `folder` is for the files of its processes, a folder below it for each cell that is being made."""

    def __init__(self, campaign, program, folder, stopped):
        self.campaign, self.program, self.folder, self.stopped = campaign, program.path, folder, stopped

    def run(self, *words, **how):
        """A run of a method."""
        limits = {"seconds": self.campaign["time_limit"], "memory_mb": self.campaign["memory_limit_mb"], **how}
        return run(list(words), stopped=self.stopped, **limits)

    def help(self, *words):
        """`perp WORDS`, which is no run of a method."""
        seconds = max(LEAST_FOR_OTHERS, 2 * self.campaign["time_limit"])
        return self.run(self.program, *words, seconds=seconds, memory_mb=2 * self.campaign["memory_limit_mb"])

    def judge(self, what, *words):
        """What `perp judge` answers."""
        end = self.help("judge", *words, "--json", "-")
        if end.code in (0, 1, 2) and (answer := end.answer) is not None:
            return answer
        how = {"time": "no answer in time", "memory": "too much memory"}.get(end.why) or end.words()
        raise NotSeen(f"{what}: {how}; {end.said()}")

    def verdict(self, source, x, folder):
        """(natural residual, is it as near as rounding lets it be?) of a point."""
        if not all(map(math.isfinite, x)):
            return math.inf, False
        point = write_point(folder, "x.mtx", x)
        answer = self.judge(f"the judge of {source}", source, point, "--tol", repr(self.campaign["tol"]))
        if "residual" not in answer:
            raise NotSeen(f"the judge of {source}: {answer.get('message')}")
        return number(answer["residual"]["natural"]), answer["to_rounding"]

    def start_of(self, problem, start, restart):
        """The perturbed point from which a run begins; None for the first one."""
        if restart == 0:
            return None
        source = source_of(problem)
        point = self.judge(f"the start of {source}", source, "--start", str(start), "--full")
        return perturbed(point, f"{self.campaign['seed']} {problem['name']} {start}", restart)

    def solve(self, method, problem, start, restart, folder):
        tol, limit = self.campaign["tol"], self.campaign["time_limit"]
        if method["affine"] and not problem["affine"]:
            return Attempt(claim="not-applicable", message="for affine problems, and this one does not say it is one")
        margin = min(max(0.02 * limit, 0.05), 1.0)
        own = min(float(method["in_force"].get("time_limit", "inf")), max(1e-3, limit - margin))
        words = ["solve", source_of(problem), "--json", "-", "--log-level", "quiet", "--time-limit", repr(own)]
        for option in (f"method={method['name']}", f"convergence_tolerance={tol!r}", *method["options"]):
            words += ["--option", option]
        point = self.start_of(problem, start, restart)
        words += ["--start", str(start)] if point is None else ["--start-at", write_point(folder, "start.mtx", point)]
        return attempt_of(self.run(self.program, *words), f"{method['label']} on {problem['name']}", read_solve)

    def external(self, method, problem, start, restart, folder):
        """One run of somebody else's program, on a private copy of the model."""
        stub, source = os.path.join(folder, "model"), source_of(problem)
        point = self.start_of(problem, start, restart)
        if source.endswith(".nl"):
            for ending in (".nl", ".col", ".row"):
                if os.path.isfile(source[:-3] + ending):
                    shutil.copyfile(source[:-3] + ending, stub + ending)
        else:
            end = self.help("export", source, "--start", str(start), "-o", stub + ".nl")
            if end.why != "itself" or end.code not in (0, 2):
                raise NotSeen(f"writing {source} as .nl file: {end.words()}")
            if end.code == 2:
                probe(folder)
                return Attempt(claim="not-applicable", message="neither an .nl file nor written as one")
        file = Path(stub + ".nl")
        text = file.read_text("latin-1")
        if not text.startswith("g"):
            return Attempt(claim="not-applicable", message="a binary .nl file; external programs are given text ones")
        if point is not None:
            file.write_text(nl_with_start(text, point), "latin-1")
        model = self.judge(f"the size of {stub}", stub + ".nl")
        if "own_variables" not in model:
            return Attempt(message=f"refused: {model.get('message')}")
        command = f'exec {with_tolerance(method["command"], self.campaign["tol"])} "$0" -AMPL 1>&2'
        end = self.run("/bin/sh", "-c", command, stub, tree=True)
        return attempt_of_sol(end, stub, model["own_variables"], folder, method["label"])

    def attempt(self, method, problem, start, restart):
        os.makedirs(self.folder, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=self.folder) as folder:
            make = self.external if method["external"] else self.solve
            result = make(method, problem, start, restart, folder)
            if result.x is not None:
                result.natural, result.judged_to_rounding = self.verdict(source_of(problem), result.x, folder)
            return result

    def cell(self, method, problem, start):
        first = self.attempt(method, problem, start, 0)
        outcome, message = first.outcome(problem, self.campaign)
        after, restarts = outcome, 0
        while problem["solvable"] and restarts < self.campaign["restarts"] and is_failure(after):
            restarts += 1
            after = self.attempt(method, problem, start, restarts).outcome(problem, self.campaign)[0]
        values = method["label"], problem["name"], start, outcome, first.status, first.claim == "solved", first.natural
        rest = restarts, after, first.seconds, first.end.peak_mb, one_line(message), list(first.curve)
        return {**dict(zip(KEYS, (*values, *first.counts, *rest))), **first.facts}


def source_of(problem):
    return problem.get("file") or problem["name"]


def probe(folder):
    """Where files cannot be written, what is missing or torn is nobody's answer."""
    with tempfile.NamedTemporaryFile(dir=folder) as file:
        file.write(b"0" * (1 << 20))
        file.flush()
        os.fsync(file.fileno())


def attempt_of_sol(end, stub, variables, folder, name):
    """Of an external program."""
    check_seen(end, name)
    said = end.words() + (f"; it said: {end.said(400)}" if end.err else "")
    if end.signal:
        told = end.why != "itself" and end.signal != signal.SIGKILL
        return Attempt(end, "failed" if told else "crashed", said, seconds=end.seconds)
    try:
        if not os.path.isfile(stub + ".sol"):
            raise Garbage("there is none")
        message, code, x = read_sol(Path(stub + ".sol").read_bytes(), variables)
        if code in range(200) and x is None and variables > 0:
            raise Garbage("it claims a solution and gives no values")
    except Garbage as error:
        probe(folder)
        shell = end.code - 128  # what a shell says of a signal
        if 0 < shell < 65 and signal.strsignal(shell):
            return Attempt(end, "crashed", f"{signal_name(shell)} of what it ran; {said}", seconds=end.seconds)
        return Attempt(end, "garbage", f".sol file: {error}; {said}", seconds=end.seconds)
    x = [] if variables == 0 else x
    claim = "not-applicable" if code == 590 else CLAIMS_OF_SOL.get(code // 100, "failed")
    return Attempt(end, claim, message, f"solve_result_num {code}", seconds=end.seconds, x=x)


def settle(campaign, cells):
    """What cells say of each other's problems.

    A method of perp that says infeasible has a proof: it settles a problem of which nobody knew, unless somebody has a
    solution. The files are not touched; whoever shows cells calls this first.
    """
    if campaign.get("contact"):  # its variants have laws of their own
        return
    for problem in campaign["problems"]:
        these = [(c, {c["outcome"], c["outcome_after_restarts"]}) for c in cells if c["problem"] == problem["name"]]
        deniers = [c for c, words in these if "infeasible" in words]
        if not problem["solvable"] or not deniers:
            continue
        found = {"solved", "solved-to-rounding", "unclaimed"}
        solvers = [c for c, words in these if c["natural"] <= campaign["tol"] or words & found]
        if not solvers:
            problem["denied_by"], problem["solvable"] = deniers[0]["method"], False
            problem["no_solution"] = f"proven by {problem['denied_by']}"
        for cell in deniers if solvers else ():
            for key in ("outcome", "outcome_after_restarts"):
                cell[key] = "false-infeasible" if cell[key] == "infeasible" else cell[key]
            cell["message"] = f"{solvers[0]['method']} has a solution; it says: {cell['message']}"


def outcome_counts(campaign, cells):
    """(the words of these cells, {method: how many of each}); honest: no claim, where there is no solution."""
    unsolvable = {p["name"] for p in campaign["problems"] if not p["solvable"]}
    honest = [cell["outcome"] in HONEST and cell["problem"] in unsolvable for cell in cells]
    ends = Counter((cell["method"], "honest" if is_so else cell["outcome"]) for cell, is_so in zip(cells, honest))
    occur = [word for word in (*OUTCOMES, "honest") if any(word == of for _, of in ends)]
    return occur, {m["label"]: [ends[m["label"], word] for word in occur] for m in campaign["methods"]}
