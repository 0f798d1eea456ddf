# SPDX-License-Identifier: Apache-2.0
"""What people bring along from scipy, notebooks and JAX: spellings, warnings, how results look."""

import inspect
import os
import pickle
import pydoc
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import perp
import pytest
import scipy.optimize
import scipy.sparse as sp
from problems import is_kojima_solution, kojima, kojima_jac

PACKAGE = Path(perp.__file__).resolve().parent


def shifted(x):
    return x - np.array([0.5, 2.0, -3.0])


@pytest.mark.parametrize(
    "bounds",
    [
        [(0, 1), (None, None), (-1, None)],
        np.array([[0, 1], [-np.inf, np.inf], [-1, np.inf]]),
        scipy.optimize.Bounds([0, -np.inf, -1], [1, np.inf, np.inf]),
    ],
    ids=["pairs", "array", "Bounds"],
)
def test_bounds_of_scipy(bounds):
    np.testing.assert_allclose(perp.solve(shifted, np.zeros(3), bounds=bounds).x, [0.5, 2, -1], atol=1e-8)
    r = perp.mcp_affine(np.eye(3), [-0.5, -2.0, 3.0], bounds=bounds)
    np.testing.assert_allclose(r.x, [0.5, 2, -1], atol=1e-8)


def test_bad_bounds_are_named():
    for wrong in (3, "ab", [(0, 1, 2)], [("a", 1)], [0, 1, 2]):
        with pytest.raises(TypeError, match="^bounds: "):
            perp.solve(shifted, np.zeros(3), bounds=wrong)
    with pytest.raises(TypeError, match="^bounds: is given, and so are lower or upper"):
        perp.solve(shifted, np.zeros(3), lower=-1, bounds=[(0, 1)] * 3)
    with pytest.raises(ValueError, match=r"^lower: has shape \(2,\)"):
        perp.solve(shifted, np.zeros(3), bounds=[(0, 1)] * 2)


def test_args_of_scipy():
    r = perp.solve(lambda x, a, b: a * x - b, [1.0], args=(2.0, 6.0), jac=lambda x, a, b: [[a]])
    assert r.x[0] == pytest.approx(3)
    assert perp.solve(lambda x, a: x - a, [1.0], args=3.0).x[0] == pytest.approx(3)


def test_jac_of_scipy():
    def both(x):
        calls.append(x)
        return kojima(x), sp.csc_matrix(kojima_jac(x))

    calls = []
    r = perp.solve(both, np.ones(4), jac=True, pattern=np.ones((4, 4)))
    assert is_kojima_solution(r.x)
    assert len(calls) <= r.stats["F_calls"] + 2  # F' comes with F, and is not computed again
    assert perp.solve(kojima, np.ones(4), jac="2-point").success and perp.solve(kojima, np.ones(4), jac=False).success
    with pytest.raises(ValueError, match="^jac: '3-point' is not offered"):
        perp.solve(kojima, np.ones(4), jac="3-point")
    with pytest.raises(TypeError, match="^F: returned ndarray, and with jac=True must return a pair"):
        perp.solve(kojima, np.ones(4), jac=True)


def test_float32_is_noticed():
    """Once, and only where it is: numbers of seven digits end in NoProgress, and nobody knows why."""
    with pytest.warns(perp.Float32Warning, match="float32") as heard:
        perp.solve(lambda x: kojima(x).astype(np.float32), np.ones(4))
    assert sum(issubclass(one.category, perp.Float32Warning) for one in heard) == 1
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        perp.solve(kojima, np.ones(4))
        perp.solve(lambda x: (x - 1).astype(int), [1.0])


def test_a_solution_that_is_small_only_is_no_quiet_one():
    """x^2 + 1 in units of 1e10: every x near 0 meets the tolerance, and none solves the equation in its own units."""
    with pytest.warns(perp.SolutionWarning):
        r = perp.solve(lambda x: 1e-10 * (x**2 + 1.0), [0.0], -np.inf, method="semismooth")
    assert r.success and r.relative > 1e-3


def test_names_count_from_zero():
    p = perp.problem(lambda x: np.array([np.log(x[1]), x[0]]), [1.0, 1.0], -np.inf)
    assert p.variable_names == ["x[0]", "x[1]"] and p.equation_names == ["F[0]", "F[1]"]
    r = p.solve([1.0, 0.5])
    assert "x[1] = 1" in repr(r)
    named = perp.problem(shifted, np.zeros(3), -np.inf, variable_names=["p", "q", "r"]).solve()
    assert "q = 2" in repr(named) and "q = 2" in named._repr_html_()
    again = pickle.loads(pickle.dumps(named))
    assert "q = 2" in repr(again) and again.stats == named.stats and (again.log.array == named.log.array).all()


def test_everything_has_a_notebook_form_and_explains_its_fields():
    p = perp.affine_problem(np.eye(2), [-1.0, 1.0])
    contact = perp.contact.solve(np.eye(3), [-1.0, 0.9, 0.0], [0.5])
    answers = [p.solve(verify=True), perp.solve_all(kojima, np.ones(4)), p.inspect(), p.check_jacobian(),
               p.verify([1.0, 0.0]), p.sensitivity([1.0, 0.0], dF=-np.eye(2)), contact,
               perp.contact.problem(np.eye(3), [-1.0, 0.9, 0.0], [0.5]).existence(),
               perp.contact.problem(np.eye(3), [-1.0, 0.9, 0.0], [0.5]).sensitivity([1.0, -0.5, 0.0])]  # fmt: skip
    answers += [answers[0].verified, answers[1][0]]
    for answer in answers:
        assert "<table>" in answer._repr_html_() and "\n" in repr(answer), type(answer)
        copy = pickle.loads(pickle.dumps(answer))
        assert repr(copy) == repr(answer)
        help_ = pydoc.render_doc(type(answer), renderer=pydoc.plaintext)
        for name in answer._fields:
            assert inspect.getdoc(inspect.getattr_static(type(answer), name)) in help_.replace("\n |      ", "\n"), name
    assert "<table>" in answers[0].log._repr_html_()
    coins = np.array([[1.0, -1.0], [-1.0, 1.0]])
    games = [perp.bimatrix(coins, -coins), *perp.finite_game([coins, -coins], starts=3)]
    games.append(perp.lq_game([1, 1], [np.eye(2), np.eye(2)], [[-1.0, 0], [0, -1.0]]))
    for answer in (*games, *games[0].subsets):
        assert "<table>" in answer._repr_html_(), type(answer)


def test_inspect_warns():
    p = perp.problem(lambda x: np.array([x[0], x[0]]), [1.0, 1.0], -np.inf, pattern=[[1, 0], [1, 0]])
    said = " ".join(p.inspect().warnings)
    assert "x[1]" in said and "singular" in said
    assert perp.collection("kojshin").inspect().classes == {}


def test_the_collection_at_any_size():
    p = perp.collection("obstacle:6x4")
    assert p.size == 24 and p.solve().success and "obstacle:" in {e.name: e.sizes for e in perp.collection_entries()}["obstacle"]
    with pytest.raises(ValueError, match="^name: .*obstacle"):
        perp.collection("obstacle:6xx")
    with pytest.raises(ValueError, match="^name: .*one size"):
        perp.collection("josephy:7")


def test_matrix_market_files(tmp_path):
    import scipy.io

    M, q = sp.csc_matrix([[2.0, 1], [1, 2]]), np.array([[-5.0], [-6]])
    scipy.io.mmwrite(tmp_path / "M.mtx", M)
    scipy.io.mmwrite(tmp_path / "q.mtx", q)
    p = perp.read_matrix(tmp_path / "M.mtx", tmp_path / "q.mtx")
    np.testing.assert_allclose(p.solve().x, [4 / 3, 7 / 3])
    with pytest.raises(FileNotFoundError, match="^q: "):
        perp.read_matrix(tmp_path / "M.mtx", tmp_path / "none.mtx")
    (tmp_path / "bad.mtx").write_text("nonsense")
    with pytest.raises(perp.FileError, match="bad.mtx"):
        perp.read_matrix(tmp_path / "bad.mtx", tmp_path / "q.mtx")


def test_a_kept_solver():
    kept = perp.KeptSolver()
    M = sp.csc_matrix([[2.0, 1], [1, 2]])
    ways = []
    for demand in (5.0, 5.1, 5.2):
        r = kept.solve(perp.affine_problem(M, [-demand, -6.0]))
        np.testing.assert_allclose(M @ r.x, [demand, 6], atol=1e-8)
        ways.append(r.kept_by)
    assert ways == ["anew", "kept", "kept"]
    kept.forget()
    assert kept.solve(perp.affine_problem(M, [-5.0, -6.0])).kept_by == "anew"
    with pytest.raises(TypeError, match="^problem: "):
        kept.solve(M)


def test_a_result_outlives_its_problem():
    """Its arrays are the library's: would catch memory that is read after it was freed."""
    import gc

    x = perp.solve(kojima, np.ones(4), jac=kojima_jac).x
    gc.collect()
    for _ in range(100):
        perp.lcp([[2.0]], [-1.0])
    assert is_kojima_solution(x)
    r = perp.solve(kojima, np.ones(4))
    first = r.x
    del r
    gc.collect()
    assert is_kojima_solution(first)


WITHOUT = "import perp; print(perp.LibraryError.__name__)\ntry:\n    perp.lcp([[1.0]], [1.0])\nexcept ImportError as error:\n    print(error)\n"


def test_without_the_library(tmp_path):
    """perp itself is imported where there is no library; its first use says what is missing."""
    folder = tmp_path / "perp"
    folder.mkdir()
    for file in PACKAGE.glob("*.py"):
        (folder / file.name).write_text(file.read_text(encoding="utf-8"), encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": str(tmp_path), "PERP_LIBRARY": str(tmp_path / "none.so")}
    run = subprocess.run([sys.executable, "-c", WITHOUT], capture_output=True, text=True, env=environment)
    assert run.returncode == 0, run.stderr
    assert "LibraryError" in run.stdout and "none.so" in run.stdout and "PERP_LIBRARY" in run.stdout


def test_a_library_of_another_version(tmp_path, monkeypatch):
    from perp import _library

    monkeypatch.setattr(_library, "INTERFACE", _library.INTERFACE + 1000)
    with pytest.raises(perp.LibraryError, match="different versions"):
        _library.Library()
