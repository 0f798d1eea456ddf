# SPDX-License-Identifier: Apache-2.0
"""Pyomo's solver `perp`: writes the model as an .nl file, runs the program, and brings back what it says."""

from __future__ import annotations

import json
import logging
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import weakref
from contextlib import ExitStack, suppress
from typing import Any, Callable, Iterator, Mapping

from pyomo.common import Executable
from pyomo.common.collections import Bunch
from pyomo.common.errors import ApplicationError
from pyomo.core.base import Suffix, SymbolMap, value
from pyomo.core.base.block import BlockData
from pyomo.core.staleflag import StaleFlagManager
from pyomo.opt import Solution, SolverFactory, SolverResults, SolverStatus, TerminationCondition
from pyomo.opt.base.solvers import _extract_version
from pyomo.opt.solver import SystemCallSolver

from perp._result import contradiction
from perp.pyomo._explain import Explanation, explanation_of
from perp.pyomo._expression import ModelError
from perp.pyomo._model import CompiledModel, Contents
from perp.pyomo._rows import Auxiliary

logger = logging.getLogger("pyomo.solvers")

# How Perp ended, in Pyomo's words.
_OUTCOMES: dict[str, tuple[SolverStatus, TerminationCondition]] = {
    "Solved": (SolverStatus.ok, TerminationCondition.optimal),
    "SolvedToRounding": (SolverStatus.warning, TerminationCondition.feasible),
    "Infeasible": (SolverStatus.warning, TerminationCondition.infeasible),
    "Unbounded": (SolverStatus.warning, TerminationCondition.unbounded),
    "IterationLimit": (SolverStatus.warning, TerminationCondition.maxIterations),
    "TimeLimit": (SolverStatus.warning, TerminationCondition.maxTimeLimit),
    "Interrupted": (SolverStatus.aborted, TerminationCondition.userInterrupt),
    "OutOfMemory": (SolverStatus.aborted, TerminationCondition.resourceInterrupt),
    "EvaluationFailed": (SolverStatus.warning, TerminationCondition.error),
    "LinearAlgebraFailed": (SolverStatus.warning, TerminationCondition.solverFailure),
    "NotApplicable": (SolverStatus.error, TerminationCondition.invalidProblem),
    "InputError": (SolverStatus.error, TerminationCondition.invalidProblem),
}
_NO_SOLUTION = (SolverStatus.warning, TerminationCondition.noSolution)  # the method came to its end without one

_IGNORED = ("symbolic_solver_labels", "suffixes", "warmstart", "io_options", "use_signal_handling", "available", "report_timing")


@SolverFactory.register("perp", doc="Mixed complementarity problems, by the program perp")
class Perp(SystemCallSolver):  # type: ignore[misc]
    """SolverFactory("perp", executable=...): the program is that of the same environment, else that on the PATH."""

    def __init__(self, **keywords: Any) -> None:
        keywords["type"] = "perp"
        super().__init__(**keywords)
        self._capabilities = Bunch(linear=True, quadratic_constraint=True)

    def _default_executable(self) -> str | None:
        beside = os.path.join(os.path.dirname(sys.executable), "perp.exe" if os.name == "nt" else "perp")
        if os.access(beside, os.X_OK):
            return beside
        found = Executable("perp")
        if not found:
            logger.warning("the program perp is neither beside %s nor on the PATH: give executable=", sys.executable)
            return None
        return str(found.path())

    def _get_version(self) -> Any:
        program = self.executable()
        if program is None:
            return _extract_version("")
        return _extract_version(subprocess.run([program, "-v"], capture_output=True, text=True, timeout=10).stdout)

    def warm_start_capable(self) -> bool:
        return True  # every solve starts from the values of the variables

    def solve(
        self, model: Any, *, tee: bool = False, load_solutions: bool = True, logfile: str | None = None, keepfiles: bool = False,
        timelimit: float | None = None, options: Mapping[str, Any] | None = None, options_string: str = "", **others: Any,
    ) -> Any:
        """Solves the model from the values that its variables have, and gives them those of the solution.

        Raises ModelError, a ValueError, if the model is refused (with load_solutions=False the results say so instead),
        and ApplicationError if the program cannot be run.
        """
        unknown = sorted(set(others).difference(_IGNORED))
        if unknown:
            raise ValueError(f"the solver perp does not know the keyword {', '.join(unknown)}")
        if not isinstance(model, BlockData):
            raise TypeError(f"the solver perp takes a ConcreteModel or a Block, not {type(model).__name__}")
        if not model.is_constructed():
            raise ValueError(f"the model {model.name} has no data yet: call create_instance()")
        all_options = {**self.options, **(options or {}), **self._options_string_to_dict(options_string)}
        if timelimit is not None:
            all_options["time_limit"] = timelimit
        begun = time.perf_counter()
        try:
            kept = _compile(model)
            compiled = kept.compiled
            text = compiled.nl()
            compiled.check()
        except ValueError as error:  # Pyomo's own say what is not initialised
            return _refused({"status": "InputError", "message": str(error)}, load_solutions)
        files = Files(keep=True) if keepfiles else kept.files
        if keepfiles:
            print(f"perp: the files of {model.name} are {files.stub}.*")
        answer = self._run(files, compiled, text, all_options, tee, logfile)
        return _results(model, compiled, answer, load_solutions, time.perf_counter() - begun)

    def explain(self, model: Any, *, timelimit: float = 30) -> Explanation:
        """Why the model has no solution, which constraint is the cause, and what would mend it, in the model's components.
        In at most so many seconds."""
        kept = _compile(model)
        text = kept.compiled.nl()
        kept.compiled.check()
        stub = kept.files.write(kept.compiled, text)
        command = [self._program(), "explain", stub + ".nl", "--json", "-", "--time-limit", str(timelimit)]
        document, said, code = _execute(command, stub + ".err")
        return explanation_of(kept.compiled, _parsed(document, said, code))

    def _program(self) -> str:
        program = self.executable()
        if program is None:
            raise ApplicationError("the program perp was not found: give executable=, or install it where the PATH leads")
        return str(program)

    def _run(
        self, files: Files, compiled: CompiledModel, text: str, options: Mapping[str, Any], tee: bool, logfile: str | None
    ) -> dict[str, Any]:
        stub = files.write(compiled, text)
        shows = tee or logfile
        command = [self._program(), "solve", stub + ".nl"]
        command += ["--json", stub + ".json"] if shows else ["--json", "-", "--log-level", "quiet"]
        for key, setting in options.items():
            command += ["--option", f"{key}={_word(setting)}"]
        document = ""
        if shows:
            said, code = _execute_and_show(command, tee, logfile)
            with suppress(OSError), open(stub + ".json", encoding="utf-8") as file:
                document = file.read()
        else:
            document, said, code = _execute(command, stub + ".err")
        return _parsed(document, said, code)


def _parsed(document: str, said: str, code: int) -> dict[str, Any]:
    try:
        answer: dict[str, Any] = json.loads(document)
    except ValueError:
        raise ApplicationError(f"perp ended with code {code} and no answer: {said.strip() or 'it said nothing'}") from None
    answer["message"] = re.sub(r"^.*?model\.nl(:\d+)?: ", "", answer["message"])
    return answer


class Files:
    """The folder of a model's files. The names of its rows and columns are written once."""

    def __init__(self, keep: bool = False) -> None:
        self._process = os.getpid()
        folder = tempfile.mkdtemp(prefix="perp-")
        if not keep:
            weakref.finalize(self, _remove, folder, self._process)
        self._named: CompiledModel | None = None
        self.stub = os.path.join(folder, "model")

    def usable(self) -> bool:
        """A process that was forked needs files of its own, and some systems tidy up in their folder for such files."""
        return self._process == os.getpid() and os.path.isdir(os.path.dirname(self.stub))

    def write(self, compiled: CompiledModel, text: str) -> str:
        parts = [(".nl", text)]
        if self._named is not compiled:
            parts += [(".row", compiled.row_names), (".col", compiled.column_names)]
        for ending, content in parts:
            with open(self.stub + ending, "w", encoding="utf-8", newline="\n", opener=_overwrite) as file:
                file.write(content)
                file.truncate()
        self._named = compiled
        return self.stub


def _overwrite(name: str, flags: int) -> int:
    """Opens a file without emptying it: some file systems write one to the disk at once that is emptied and filled again."""
    return os.open(name, flags & ~os.O_TRUNC, 0o600)


def _remove(folder: str, process: int) -> None:
    if process == os.getpid():  # not that of the process from which this one was forked
        shutil.rmtree(folder, ignore_errors=True)


class Kept:
    """What is kept of a model between solves."""

    def __init__(self, contents: Contents) -> None:
        self.compiled = CompiledModel(contents)
        self.files = Files()


_kept: weakref.WeakKeyDictionary[Any, Kept] = weakref.WeakKeyDictionary()


def _compile(model: Any) -> Kept:
    """The compiled form of the model, that from the last solve if it still fits."""
    contents = Contents(model)
    kept = _kept.get(model)
    if kept is None or not kept.compiled.still_fits(contents):
        kept = _kept[model] = Kept(contents)
    if not kept.files.usable():
        kept.files = Files()
    return kept


def _word(setting: Any) -> str:
    if isinstance(setting, bool):
        return "yes" if setting else "no"
    return str(setting)


def _execute(command: list[str], errors: str) -> tuple[str, str, int]:
    """Runs the program: the document that it writes, what it says besides, and its exit code.

    What it says goes by way of a file: two pipes are watched in a loop that costs more than the reading.
    """
    with open(errors, "w+", encoding="utf-8", errors="replace") as file:
        with _started(command, file) as process:
            document, _ = _to_the_end(process, process.communicate)
        file.seek(0)
        return document, file.read(), process.returncode


def _execute_and_show(command: list[str], tee: bool, logfile: str | None) -> tuple[str, int]:
    """Runs the program and shows what it says, line by line. What it said, and its exit code."""
    lines: list[str] = []
    with ExitStack() as stack:
        file = stack.enter_context(open(logfile, "w", encoding="utf-8")) if logfile else None
        process = stack.enter_context(_started(command, subprocess.STDOUT))

        def show() -> None:
            for line in process.stdout:
                lines.append(line)
                if tee:
                    sys.stdout.write(line)
                    sys.stdout.flush()
                if file:
                    file.write(line)

        _to_the_end(process, show)
    return "".join(lines), process.returncode


def _started(command: list[str], errors: Any) -> Any:
    try:
        return subprocess.Popen(  # Python's own files are not inherited anyway
            command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=errors, encoding="utf-8", errors="replace", close_fds=False
        )
    except OSError as error:
        raise ApplicationError(f"{command[0]} cannot be run: {error}") from None


def _to_the_end(process: Any, read: Callable[[], Any]) -> Any:
    try:
        answer = read()
        process.wait()
        return answer
    except BaseException:  # Ctrl-C
        process.kill()
        raise


def _refused(answer: dict[str, Any], load_solutions: bool) -> Any:
    if load_solutions:
        raise ModelError(answer["message"]) from None
    results = SolverResults()
    _set_outcome(results, answer)
    return results


def _set_outcome(results: Any, answer: dict[str, Any]) -> None:
    solver = results.solver
    solver.name = "perp"
    solver.status, solver.termination_condition = _OUTCOMES.get(answer["status"], _NO_SOLUTION)
    solver.termination_message = answer["status"]
    solver.message = answer["message"]


def _message(answer: dict[str, Any], notes: list[str]) -> str:
    lines = [f"{answer['status']}: {answer['message']}"]
    if answer.get("certificate"):
        lines.append(f"Proof: {contradiction(answer['certificate'])}")
    if answer.get("advice"):
        lines.append(f"Try: {answer['advice']}")
    return "\n".join(lines + [f"Note: {note}" for note in notes])


def _results(model: Any, compiled: CompiledModel, answer: dict[str, Any], load_solutions: bool, seconds: float) -> Any:
    if "variables" not in answer:
        if fixed := compiled.fixed_beyond_need():
            answer["message"] += f"; a fixed variable is none of these, and its equation stays: fixed are {', '.join(fixed[:5])}"
        return _refused(answer, load_solutions)
    results = SolverResults()
    _set_outcome(results, answer)
    results.solver.time = answer["stats"]["time_s"]
    results.solver.wallclock_time = seconds
    problem = results.problem
    problem.name = model.name
    problem.number_of_variables = len(compiled.columns)
    problem.number_of_constraints = len(compiled.rows)
    entries = answer["variables"][: len(compiled.columns)]
    point, F = ([_number(entry[key]) for entry in entries] for key in ("value", "F"))
    loads = load_solutions and all(map(math.isfinite, point))
    if loads:
        _load(model, compiled, point, F, answer["variables"])
    elif not load_solutions:
        _keep(compiled, point, results)
    warnings = compiled.warnings(F)
    results.solver.message = _message(answer, answer["notes"] + warnings + (compiled.notes() if loads else []))
    if load_solutions:
        if results.solver.status != SolverStatus.ok:
            logger.warning("perp: %s", results.solver.message)
            return results
        told = [] if compiled.warned else warnings
        compiled.warned = compiled.warned or bool(warnings)
        if _number(answer["residual"]["relative"]) > 1e-3:  # solved by being small: the notes say so
            told = answer["notes"] + told
        for warning in told:
            logger.warning("perp: %s", warning)
    return results


def _number(written: Any) -> float:
    return math.nan if written is None else float(written)


def _load(model: Any, compiled: CompiledModel, point: list[float], F: list[float], entries: list[Any]) -> None:
    """Gives the variables their values, and the suffixes dual, slack and rc, where the model imports them, theirs."""
    StaleFlagManager.mark_all_as_stale()
    for variable, number in zip(compiled.columns, point):
        if not isinstance(variable, Auxiliary):
            variable.set_value(number, skip_validation=True)
    suffixes = {
        suffix.local_name: suffix
        for suffix in model.component_objects(Suffix, active=True, descend_into=False)
        if suffix.import_enabled() and suffix.local_name in ("dual", "slack", "rc")
    }
    for suffix in suffixes.values():
        suffix.clear()
    if not suffixes:
        return
    found: dict[str, list[tuple[Any, float]]] = {"dual": [], "slack": [], "rc": []}
    for i, row in compiled.pairs.items():
        column = compiled.column[i]
        found["dual"].append((row.component, point[column]))
        found["slack"].append((row.component, F[column]))
        if not isinstance(compiled.columns[column], Auxiliary):
            found["rc"].append((compiled.columns[column], F[column]))
    for dropped in compiled.dropped:
        number = dropped.F(compiled.tape)
        found["dual"].append((dropped.condition, value(dropped.variable)))
        found["slack"].append((dropped.condition, number))
        found["rc"].append((dropped.variable, number))
    found["dual"].extend(_multipliers(compiled, entries))
    for name, suffix in suffixes.items():
        suffix.update(found[name])


def _multipliers(compiled: CompiledModel, entries: list[Any]) -> Iterator[tuple[Any, float]]:
    """Those of the rows of a polyhedron, which are the last variables: one of an equation, else one of each side."""
    rows = [row for row in compiled.rows if row.polyhedron]
    sides = [[None if n is None else compiled.tape.number(n) for n in (row.lower, row.upper)] for row in rows]
    signs = [[1.0] if low == high else [1.0] * (low is not None) + [-1.0] * (high is not None) for low, high in sides]
    numbers = iter(_number(entry["value"]) for entry in entries[len(entries) - sum(map(len, signs)) :])
    for row, of_row in zip(rows, signs):
        yield row.component, sum(sign * next(numbers) for sign in of_row)


def _keep(compiled: CompiledModel, point: list[float], results: Any) -> None:
    """Keeps the point in the results, for model.solutions.load_from(results)."""
    symbols = SymbolMap()
    solution = Solution()
    for k, (variable, number) in enumerate(zip(compiled.columns, point)):
        if not isinstance(variable, Auxiliary):
            symbols.addSymbol(variable, f"v{k}")
            solution.variable[f"v{k}"] = {"Value": number}
    results.solution.insert(solution)
    results._smap_id = None
    results._smap = symbols
