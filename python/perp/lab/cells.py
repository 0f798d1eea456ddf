# SPDX-License-Identifier: Apache-2.0
"""One cell of a comparison, (method, problem, start): a run of the method, the judge, further runs after a failure.

Each is a process of its own: `perp solve` or an external program, then `perp judge`, which builds the problem anew. The
judge's word counts. Where there is no word of the judge, or where the machine failed, there is no outcome: the cell
stays open, and `--resume` runs it again.
"""

import json
import math
import os
import random
import re
import shutil
import signal
import struct
import sys
from dataclasses import dataclass

from . import process
from .campaign import Environment, number
from .process import Request, one_line, signal_name

OUTCOMES = (
    "solved", "solved-to-rounding", "failed", "false-convergence", "unclaimed", "time-limit", "memory-limit", "crashed",
    "garbage", "not-applicable", "infeasible", "false-infeasible",
)  # fmt: skip
KEYS = (
    "method", "problem", "start", "outcome", "status", "claimed", "natural", "iterations", "F_evals", "J_evals",
    "factorizations", "krylov_iterations", "seconds", "peak_mb", "restarts", "outcome_after_restarts", "message", "curve",
)  # fmt: skip
LONGEST_CURVE = 200
LEAST_FOR_OTHERS = 60  # s: for the judge and for a problem's description
NOBODY_ELSE = ("SIGKILL", "SIGTERM", "SIGINT", "SIGHUP")  # sent by people and by systems that are out of memory


def key(cell):
    return cell["method"], cell["problem"], cell["start"]


def good(outcome):
    return outcome in ("solved", "infeasible")


def is_failure(outcome):
    return not good(outcome) and outcome != "not-applicable"


@dataclass
class Attempt:
    """How a run ended: what processes tell, what the method says, what the judge says."""

    why: str = "itself"
    complete: bool = True
    refused: str = ""
    out_of_memory: bool = False
    status: str = ""
    claimed: bool = False
    to_rounding: bool = False  # the method says so
    infeasible: bool = False
    proven: bool = False
    not_applicable: bool = False
    time_limit: bool = False
    crashed: str = ""
    garbage: str = ""
    message: str = ""
    counts: tuple = (None,) * 5
    seconds: float = 0
    process_seconds: float = 0
    peak_mb: float = 0
    curve: tuple = ()
    x: list = None
    natural: float = math.nan
    judged_to_rounding: bool = False

    def outcome(self, problem, campaign):
        """The one word: limits, crashes, garbage; then what the method says, held against the judge and the known."""
        solvable = problem["solvable"]
        holds = self.natural <= campaign["tol"] and solvable
        if self.why == "memory" or self.out_of_memory or self.peak_mb > campaign["memory_limit_mb"]:
            return "memory-limit"
        if self.why == "time" or self.time_limit:
            return "time-limit"
        if not self.complete or self.crashed:
            return "crashed"
        if self.garbage:
            return "garbage"
        if self.not_applicable:
            return "not-applicable"
        if self.to_rounding and not holds:
            return "solved-to-rounding" if self.judged_to_rounding and solvable else "false-convergence"
        if self.claimed or self.to_rounding:
            return "solved" if holds else "false-convergence"
        if self.infeasible and (not solvable or (self.proven and not holds and problem["known_solutions"] == 0)):
            return "infeasible"
        if self.infeasible and (holds or not problem.get("file")):
            return "false-infeasible"
        return "unclaimed" if holds else "failed"

    def words(self, outcome, problem, campaign):
        if outcome == "time-limit" and self.why == "time":
            limit = f"told to end after {campaign['time_limit']:g} s"
            return limit if self.complete else f"killed after {self.process_seconds:.3g} s"
        if outcome == "memory-limit":
            if self.why == "memory":
                return f"killed: more than {campaign['memory_limit_mb']} MB"
            return "out of memory" if self.out_of_memory else f"used more than {campaign['memory_limit_mb']} MB"
        if outcome in ("crashed", "garbage"):
            return self.crashed or self.garbage
        if outcome == "false-convergence" and not problem["solvable"]:
            return f"there is no solution: {problem['no_solution']}; it says: {self.message}"
        return f"refused: {self.refused}" if self.refused else self.message


def thinned(curve):
    last, most = len(curve) - 1, LONGEST_CURVE
    return curve if last < most else [curve[k * last // (most - 1)] for k in range(most)]


def check_seen(end, what):
    """Nothing was seen of a process that somebody else has ended."""
    outside = [getattr(signal, name, None) for name in NOBODY_ELSE]
    if end.why == "itself" and end.signal and end.signal in outside:
        raise Environment(f"{what} was ended from outside by {end.words()}")


def answer_of(end):
    try:
        answer = json.loads(end.out)
        return answer if isinstance(answer, dict) else None
    except ValueError:
        return None


def attempt_of(end, name):
    """Of a `perp solve --json -`."""
    check_seen(end, name)
    result = Attempt(why=end.why, process_seconds=end.seconds, seconds=end.seconds, peak_mb=end.peak_mb)
    answer = answer_of(end)
    said = one_line(end.err.decode("utf-8", "replace")[-300:])
    if answer is None:
        if end.why == "itself" and not end.signal and end.code != 3:
            raise Environment(f"{name} left no result: {end.words()}; {said}")
        result.complete, result.message = False, said
        result.crashed = "" if end.why != "itself" else end.words() + ("" if end.signal else ", no result")
        return result
    status = result.status = answer["status"]
    result.message = answer["message"]
    if status == "Interrupted" and end.why == "itself":
        raise Environment(f"{name} was interrupted from outside")
    result.time_limit, result.out_of_memory = status == "TimeLimit", status == "OutOfMemory"
    if "stats" not in answer:
        result.out_of_memory = status == "InputError" and ": out of memory" in result.message
        result.refused, result.status, result.seconds = (result.message, "Refused", 0) if status == "InputError" else ("", status, 0)
        return result
    result.claimed, result.to_rounding = status == "Solved", status == "SolvedToRounding"
    result.infeasible = result.proven = status == "Infeasible"
    result.not_applicable = status == "NotApplicable"
    stats = answer["stats"]
    result.counts = tuple(stats[name] for name in KEYS[7:12])
    result.seconds = stats["time_s"]
    result.curve = thinned([number(it["residual"]) for it in answer["iterations"]])
    result.x = [number(v["value"]) for v in answer["variables"]]
    return result


def vector_text(x):
    return "%%MatrixMarket matrix array real general\n" + f"{len(x)} 1\n" + "".join(f"{v!r}\n" for v in x)


def perturbed(point, rule, run):
    """x_i = mid(l_i, x0_i + d (1 + |x0_i|) u_i, u_i), d = min(2^(run-1)/10, 1), u_i uniform in [-1, 1): the same for all methods."""
    uniform = random.Random(f"{rule} {run}").random
    d = min(0.1 * 2 ** (run - 1), 1.0)
    moved = (x + d * (1 + abs(x)) * (2 * uniform() - 1) for x in map(number, point["x"]))
    low, high = [number(v) for v in point["lower"]], [number(v) for v in point["upper"]]
    return [min(max(v, a), b) for v, a, b in zip(moved, low, high)]


def nl_with_start(text, x):
    """An .nl file with its initial guess replaced by the first entries of x; None for a binary one."""
    lines = text.splitlines(keepends=True)
    if not text.startswith("g") or len(lines) < 10:
        return None
    variables = int(lines[1].split()[0])
    result, skip = lines[:10], 0
    for line in lines[10:]:
        if line.startswith("x") and line[1:2].isdigit():
            skip = int(re.match(r"\d+", line[1:])[0])
        elif skip > 0:
            skip -= 1
        else:
            if line.startswith("r"):
                result += [f"x{variables}\n", *(f"{i} {x[i]!r}\n" for i in range(variables))]
            result.append(line)
    return "".join(result)


class Garbage(Exception):
    """A .sol file that is none for its model."""


def read_sol(data, variables):
    """(message, solve_result_num, x or None) of a .sol file, text or binary (Gay, Hooking your solver to AMPL, 1997)."""
    if not data:
        raise Garbage("it is empty")
    try:
        return (sol_binary if data.startswith(b"\6\0\0\0binary\6\0\0\0") else sol_text)(data, variables)
    except (IndexError, struct.error) as error:
        raise Garbage("it ends too early") from error


def check_sizes(rows, duals, columns, values, variables):
    if columns != variables:
        raise Garbage(f"for {columns} variables, the model has {variables}")
    if rows < 0 or duals not in (0, rows) or values not in (0, columns):
        raise Garbage(f"{duals} dual values for {rows} rows, {values} values for {columns} variables")


def has_tolerance(announced, options):
    return announced > 4 and len(options) > 1 and options[1] == 3  # two of those announced are a tolerance then


def sol_text(data, variables):
    text = data.removeprefix(b"\xef\xbb\xbf").decode("utf-8", "replace")
    if not text.endswith("\n"):
        raise Garbage("its last line is cut off")
    lines = [line.rstrip("\r") for line in text.split("\n")[:-1]]
    blank = lines.index("") if "" in lines else len(lines)
    at = next((k for k in range(blank, len(lines)) if lines[k] == "Options"), None)
    if at is None:
        raise Garbage("it ends too early")
    message = "\n".join(line for line in lines[:at] if line)

    def read(kind, what):
        nonlocal at
        at += 1
        try:
            if "_" in lines[at]:
                raise ValueError
            return kind(lines[at])
        except ValueError as error:
            raise Garbage(f"'{lines[at]:.40}' is no {what}") from error

    announced, options = read(int, "number of options"), []
    if not 0 <= announced <= 11:
        raise Garbage(f"{announced} options")
    while len(options) < announced - (2 if has_tolerance(announced, options) else 0):
        options.append(read(int, "option"))
    sizes = [read(int, "size") for _ in range(4)]
    check_sizes(*sizes, variables)
    if has_tolerance(announced, options):
        read(float, "tolerance")
    for _ in range(sizes[1]):
        read(float, "dual value")
    x = [read(float, "value") for _ in range(sizes[3])]
    match = re.fullmatch(r"objno\s+-?\d{1,9}\s+(-?\d{1,9})\s*", lines[at + 1], re.A)
    if not match:
        raise Garbage(f"'{lines[at + 1]:.40}' where objno belongs")
    return message, int(match[1]), x or None


def sol_binary(data, variables):
    at = 14

    def record():
        nonlocal at
        (length,) = struct.unpack_from("<I", data, at)
        content = data[at + 4 : at + 4 + length]
        if struct.unpack_from("<I", data, at + 4 + length)[0] != length:
            raise Garbage("a record's two lengths differ")
        at += 8 + length
        return content

    message = b""
    while part := record():
        message += part
    options = record()
    if not options.startswith(b"Options"):
        raise Garbage("no record of options")
    numbers = [v for (v,) in struct.iter_unpack("<i", options[7 : 7 + (len(options) - 7) // 4 * 4])]
    announced, numbers = numbers[0], numbers[1:]
    first = announced - (2 if has_tolerance(announced, numbers) else 0)
    if not 0 <= announced <= 11 or len(numbers) < first + 4:
        raise Garbage("its record of options is short")
    sizes = numbers[first : first + 4]
    check_sizes(*sizes, variables)
    duals, values = record(), record()
    if len(duals) != 8 * sizes[1] or len(values) != 8 * sizes[3]:
        raise Garbage("a record of values has another length")
    objno = struct.unpack_from("<ii", record())
    x = [v for (v,) in struct.iter_unpack("<d", values)]
    return message.decode("utf-8", "replace"), objno[1], x or None


def with_tolerance(command, tol):
    """{tol} filled in; all other braces, ${tol} too, are the shell's."""
    return re.sub(r"(?<!\$)\{tol\}", lambda _: repr(tol), command)


class CellRunner:
    """Makes cells; `folder` is for the files of its processes, a folder below it for each cell that is being made."""

    def __init__(self, campaign, program, folder):
        self.campaign, self.program, self.folder = campaign, program.path, folder
        self.grace = min(max(0.1 * campaign["time_limit"], 0.5), 2.0)

    def request(self, *words, others=False):
        """`perp WORDS`; `others`: it is no run of a method."""
        limit, memory = self.campaign["time_limit"], self.campaign["memory_limit_mb"]
        seconds = max(LEAST_FOR_OTHERS, 2 * limit) if others else limit
        return Request([self.program, *words], seconds, self.grace, 2 * memory if others else memory)

    def answer(self, what, *words):
        """JSON of a helper process, or its End where it refused."""
        end = yield self.request(*words, others=True)
        answer = answer_of(end)
        if answer is None or end.code not in (0, 1, 2):
            how = "no answer in time" if end.why == "time" else "too much memory" if end.why == "memory" else end.words()
            raise Environment(f"{what}: {how}; {one_line(end.err.decode('utf-8', 'replace')[-300:])}")
        return answer

    def judge(self, source, x, folder):
        """(natural residual, is it as near as rounding lets it be?) of a point."""
        if not all(map(math.isfinite, x)):
            return math.inf, False
        point = os.path.join(folder, "x.mtx")
        with open(point, "w", encoding="ascii") as file:
            file.write(vector_text(x))
        words = ("judge", source, point, "--tol", repr(self.campaign["tol"]), "--json", "-")
        answer = yield from self.answer(f"the judge of {source}", *words)
        if "residual" not in answer:
            raise Environment(f"the judge of {source}: {answer.get('message')}")
        return number(answer["residual"]["natural"]), answer["to_rounding"]

    def start_of(self, problem, start, run):
        """The perturbed point from which a run begins; None for the first one."""
        if run == 0:
            return None
        source = problem.get("file") or problem["name"]
        point = yield from self.answer(f"the start of {source}", "judge", source, "--start", str(start), "--full", "--json", "-")
        return perturbed(point, f"{self.campaign['seed']} {problem['name']} {start}", run)

    def solve(self, method, problem, start, run, folder):
        source, tol = problem.get("file") or problem["name"], self.campaign["tol"]
        if method["affine"] and not problem["affine"]:
            message = "the method is for affine problems, and this one does not say it is one"
            return Attempt(not_applicable=True, message=message)
        limit = self.campaign["time_limit"]
        margin = min(max(0.02 * limit, 0.05), 1.0)
        own = float(method["in_force"].get("time_limit", "inf"))
        words = ["solve", source, "--json", "-", "--log-level", "quiet", "--time-limit", repr(min(own, max(1e-3, limit - margin)))]
        for option in (f"method={method['name']}", f"convergence_tolerance={tol!r}", *method["options"]):
            words += ["--option", option]
        point = yield from self.start_of(problem, start, run)
        if point is None:
            words += ["--start", str(start)]
        else:
            with open(os.path.join(folder, "start.mtx"), "w", encoding="ascii") as file:
                file.write(vector_text(point))
            words += ["--start-at", os.path.join(folder, "start.mtx")]
        end = yield self.request(*words)
        return attempt_of(end, f"{method['label']} on {problem['name']}")

    def external(self, method, problem, start, run, folder):
        """One run of somebody else's program, on a private copy of the model."""
        stub = os.path.join(folder, "model")
        point = yield from self.start_of(problem, start, run)
        not_for_it = Attempt(not_applicable=True, message="neither an .nl file nor written as one")
        if problem.get("file", "").endswith(".nl"):
            for ending in (".nl", ".col", ".row"):
                if os.path.isfile(problem["file"][:-3] + ending):
                    shutil.copyfile(problem["file"][:-3] + ending, stub + ending)
        else:
            source = problem.get("file") or problem["name"]
            end = yield self.request("export", source, "--start", str(start), "-o", stub + ".nl", others=True)
            if end.why != "itself" or end.code not in (0, 2):
                raise Environment(f"writing {source} as .nl file: {end.words()}")
            if end.code == 2:
                self.probe(folder)
                return not_for_it
        if point is not None:
            with open(stub + ".nl", encoding="latin-1") as file:
                text = nl_with_start(file.read(), point)
            if text is None:
                return Attempt(refused="the initial guess of a binary .nl file is not changed")
            with open(stub + ".nl", "w", encoding="latin-1") as file:
                file.write(text)
        described = yield from self.answer(f"the size of {stub}", "judge", stub + ".nl", "--json", "-")
        if "own_variables" not in described:
            return Attempt(refused=described.get("message", ""))
        command = with_tolerance(method["command"], self.campaign["tol"])
        request = self.request()
        request.arguments, request.tree = [sys.executable, "-S", "-E", process.__file__, command, stub], True
        end = yield request
        return self.of_sol(end, stub, described["own_variables"], folder, method["label"])

    def of_sol(self, end, stub, variables, folder, name):
        result = Attempt(why=end.why, process_seconds=end.seconds, seconds=end.seconds, peak_mb=end.peak_mb)
        answer = answer_of(end)
        if answer is None:
            if end.why == "itself":
                raise Environment(f"the guard of {name}: {end.words()}; {one_line(end.err.decode('utf-8', 'replace'))}")
            result.complete = False
            return result
        result.seconds, result.peak_mb = answer["seconds"], answer["peak_mb"]
        told = process.End(status=answer["status"])
        if end.why == "itself":
            check_seen(told, name)
        said = told.words() + (f"; it said: {answer['said']}" if answer["said"] else "")
        if told.signal:
            result.crashed = said
            return result
        try:
            if not os.path.isfile(stub + ".sol"):
                raise Garbage("there is none")
            with open(stub + ".sol", "rb") as file:
                message, code, x = read_sol(file.read(), variables)
            if code in range(200) and x is None and variables > 0:
                raise Garbage("it claims a solution and gives no values")
        except Garbage as error:
            self.probe(folder)
            number_of = told.code - 128
            if 0 < number_of < 65 and signal.strsignal(number_of):
                result.crashed = f"{signal_name(number_of)} of what it ran; {said}"
            else:
                result.garbage = f".sol file: {error}; {said}"
            return result
        result.status, result.message, result.x = f"solve_result_num {code}", message, [] if variables == 0 else x
        result.claimed, result.to_rounding = code in range(100), code in range(100, 200)
        result.infeasible, result.not_applicable = code in range(200, 300), code == 590
        return result

    @staticmethod
    def probe(folder):
        """Where files cannot be written, what is missing or torn is nobody's answer."""
        path = os.path.join(folder, "probe")
        with open(path, "wb") as file:
            file.write(b"0" * (1 << 20))
            file.flush()
            os.fsync(file.fileno())
        os.unlink(path)

    def attempt(self, method, problem, start, run):
        folder = os.path.join(self.folder, f"{abs(hash((method['label'], problem['name'], start))):x}")
        shutil.rmtree(folder, ignore_errors=True)
        os.makedirs(folder)
        make = self.external if method["external"] else self.solve
        result = yield from make(method, problem, start, run, folder)
        if result.x is not None:
            judged = yield from self.judge(problem.get("file") or problem["name"], result.x, folder)
            result.natural, result.judged_to_rounding = judged
        shutil.rmtree(folder, ignore_errors=True)
        return result

    def cell(self, method, problem, start):
        first = yield from self.attempt(method, problem, start, 0)
        outcome = after = first.outcome(problem, self.campaign)
        restarts = 0
        while problem["solvable"] and restarts < self.campaign["restarts"] and is_failure(after):
            restarts += 1
            further = yield from self.attempt(method, problem, start, restarts)
            after = further.outcome(problem, self.campaign)
        message = one_line(first.words(outcome, problem, self.campaign))
        values = (method["label"], problem["name"], start, outcome, first.status, first.claimed, first.natural, *first.counts)
        rest = (first.seconds, first.peak_mb, restarts, after, message, list(first.curve))
        return dict(zip(KEYS, (*values, *rest)))


def settle(campaign, cells):
    """What cells say of each other's problems. A method of perp that says infeasible has a proof: it settles a problem of
    which nobody knew, unless somebody has a solution. The files are not touched; whoever shows cells calls this first."""
    of = {}
    for cell in cells:
        of.setdefault(cell["problem"], []).append(cell)
    for problem in campaign["problems"]:
        these = of.get(problem["name"], [])
        deniers = [c for c in these if "infeasible" in (c["outcome"], c["outcome_after_restarts"])]
        if not problem["solvable"] or not deniers:
            continue
        found = ("solved", "solved-to-rounding", "unclaimed")
        solvers = [
            c for c in these if c["natural"] <= campaign["tol"] or c["outcome"] in found or c["outcome_after_restarts"] in found
        ]
        if not solvers:
            problem["denied_by"], problem["solvable"] = deniers[0]["method"], False
            problem["no_solution"] = f"proven by {problem['denied_by']}"
        for cell in deniers if solvers else ():
            for key_of in ("outcome", "outcome_after_restarts"):
                if cell[key_of] == "infeasible":
                    cell[key_of] = "false-infeasible"
            cell["message"] = f"{solvers[0]['method']} has a solution; it says: {cell['message']}"
