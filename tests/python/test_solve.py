# SPDX-License-Identifier: Apache-2.0
"""perp.solve: what a user's functions may return, and what becomes of options."""

import pickle

import numpy as np
import perp
import pytest
import scipy.sparse as sp
from problems import is_kojima_solution, kojima, kojima_jac, natural


@pytest.mark.parametrize(
    "jac",
    [
        kojima_jac,
        lambda x: sp.csc_matrix(kojima_jac(x)),
        lambda x: sp.csr_matrix(kojima_jac(x)),
        lambda x: sp.coo_matrix(kojima_jac(x)),
        lambda x: np.asfortranarray(kojima_jac(x)),
        lambda x: kojima_jac(x).tolist(),
        None,
    ],
    ids=["dense", "csc", "csr", "coo", "fortran", "lists", "differences"],
)
def test_every_kind_of_jacobian(jac):
    """Catches transposed Jacobians: F' of Kojima's problem is not symmetric, and quadratic convergence needs it."""
    r = perp.solve(kojima, np.ones(4), jac=jac)
    assert r.success and r.status == "Solved"
    assert is_kojima_solution(r.x)
    np.testing.assert_allclose(r.F, kojima(r.x))
    assert natural(r.x, r.F) <= 1e-8 and r.residual == pytest.approx(natural(r.x, r.F), abs=1e-14)
    assert r.stats["iterations"] <= 15


@pytest.mark.parametrize("jac", [kojima_jac, lambda x: sp.csr_matrix(kojima_jac(x))])
def test_the_jacobian_taken_is_the_one_returned(jac):
    p = perp.problem(kojima, np.ones(4), jac=jac)
    x = np.array([0.3, 0.7, 1.1, 1.3])
    np.testing.assert_array_equal(p.jac(x).toarray(), kojima_jac(x))
    assert p.check_jacobian(x).ok


def test_a_wrong_jacobian_is_named():
    p = perp.problem(kojima, np.ones(4), jac=lambda x: kojima_jac(x).T)
    check = p.check_jacobian(np.array([0.3, 0.7, 1.1, 1.3]))
    assert not check.ok and "F[" in check.message


def tridiagonal(x):
    F = 2 * x + 0.1 * x**3 - 1
    F[1:] -= x[:-1]
    F[:-1] -= x[1:]
    return F


def test_coloured_differences_take_three_evaluations_a_jacobian():
    """Catches a colouring that is none: 50 columns of a tridiagonal matrix need three groups."""
    n = 50
    pattern = sp.diags([1, 1, 1], [-1, 0, 1], shape=(n, n))
    r = perp.solve(tridiagonal, np.zeros(n), pattern=pattern)
    assert r.success and natural(r.x, tridiagonal(r.x)) <= 1e-8
    assert r.stats["difference_groups"] == 3
    calls = []
    p = perp.problem(lambda x: calls.append(0) or tridiagonal(x), np.zeros(n), pattern=pattern)
    x = np.linspace(0, 1, n)
    p.jac(x)
    assert len(calls) == 1 + 3
    exact = np.diag(2 + 0.3 * x**2) - np.diag(np.ones(n - 1), 1) - np.diag(np.ones(n - 1), -1)
    np.testing.assert_allclose(p.jac(x).toarray(), exact, atol=1e-6)


def test_differences_stay_where_F_is_defined():
    """x = 0 is the upper bound, and F is not defined beyond it."""
    r = perp.solve(lambda x: 1 - np.sqrt(-x), [0.0], lower=-np.inf, upper=0)
    assert r.success and abs(r.x[0] + 1) < 1e-6


def test_a_sparse_jacobian_whose_pattern_changes_order():
    """csr here, unsorted csc there, entries in halves: the same matrix, whatever arrays it comes in."""
    calls = []

    def jac(x):
        calls.append(0)
        J = kojima_jac(x)
        if len(calls) % 3 == 0:
            i, j = np.nonzero(np.ones((4, 4)))
            halves = np.concatenate([J[i, j] / 2, J[i, j] / 2])
            twice = sp.csc_matrix((4, 4))
            coo = sp.coo_matrix((halves, (np.tile(i, 2), np.tile(j, 2))), shape=(4, 4))
            order = np.lexsort((-coo.row, coo.col))
            twice.data, twice.indices = coo.data[order], coo.row[order].astype(np.int32)
            twice.indptr = np.arange(0, 33, 8, dtype=np.int32)
            return twice
        return (sp.csr_matrix if len(calls) % 3 == 1 else sp.csc_matrix)(J)

    pattern = np.ones((4, 4))
    p = perp.problem(kojima, np.ones(4), jac=jac, pattern=pattern)
    x = np.array([0.3, 0.7, 1.1, 1.3])
    for _ in range(7):
        np.testing.assert_allclose(p.jac(x).toarray(), kojima_jac(x), rtol=1e-15)


def test_an_entry_outside_of_the_pattern_is_an_error():
    """Dropped zeros at the start would else be zeros for ever."""
    start = np.zeros(4)  # J has zeros there
    with pytest.raises(ValueError, match=r"jac: .*not in the pattern"):
        perp.solve(kojima, start, jac=lambda x: sp.csc_matrix(kojima_jac(x)))
    assert perp.solve(kojima, start, jac=lambda x: sp.csc_matrix(kojima_jac(x)), pattern=np.ones((4, 4))).success
    with pytest.raises(ValueError, match=r"jac: .*not in the pattern"):
        perp.solve(kojima, np.ones(4), jac=kojima_jac, pattern=np.eye(4))


def test_jac_is_not_called_twice_at_the_start():
    at = []
    p = perp.problem(kojima, np.ones(4), jac=lambda x: at.append(tuple(x)) or kojima_jac(x))
    assert len(at) == 1  # for the pattern
    np.testing.assert_array_equal(p.jac(np.ones(4)).toarray(), kojima_jac(np.ones(4)))
    assert len(at) == 1


def test_bounds_broadcast_and_are_moved_into():
    r = perp.solve(lambda x: x - np.array([0.5, 2.0, -3.0]), [9, 9, 9], lower=-1, upper=[1, 1, 1])
    np.testing.assert_allclose(r.x, [0.5, 1, -1], atol=1e-8)
    assert perp.solve(lambda x: x**2 - 4, [1.0], lower=-np.inf).x[0] == pytest.approx(2)


def test_one_variable_may_be_a_number():
    assert perp.solve(lambda x: float(x[0]) ** 3 - 8, [0.5]).x[0] == pytest.approx(2)


def test_nan_is_not_defined_here():
    """log(x) beyond its domain: the search has to shorten its steps, not to stop."""
    with np.errstate(all="ignore"):
        r = perp.solve(lambda x: np.log(x) + 3, [8.0], lower=-np.inf)
    assert r.success and r.x[0] == pytest.approx(np.exp(-3))


def test_x_may_be_kept_and_changed_by_F():
    kept = []

    def F(x):
        kept.append(x)
        value = kojima(x)
        x[:] = -1  # ours
        return value

    assert is_kojima_solution(perp.solve(F, np.ones(4)).x)
    assert len({id(x) for x in kept}) == len(kept)


def test_options_by_keyword_and_dict():
    once = perp.solve(kojima, np.ones(4), major_iteration_limit=1, method="semismooth")
    assert once.status == "IterationLimit" and not once.success and once.advice
    assert perp.solve(kojima, np.ones(4), options={"major_iteration_limit": 1}, method="semismooth").status == once.status
    # A keyword goes before the dict; numpy's numbers and truth values are numbers and truth values.
    r = perp.solve(kojima, np.ones(4), options={"maj_iter": 1}, major_iteration_limit=np.int64(100))
    assert r.success
    assert perp.solve(kojima, np.ones(4), convergence_tolerance=np.float32(1e-6), check_derivatives=np.True_).success


def test_bad_options_say_what_is_wrong():
    with pytest.raises(perp.OptionError, match="convergence_tolerance"):
        perp.solve(kojima, np.ones(4), convergence_tolerence=1e-6)
    with pytest.raises(perp.OptionError, match="> 0"):
        perp.solve(kojima, np.ones(4), convergence_tolerance=-1.0)
    with pytest.raises(perp.OptionError, match="pat"):
        perp.solve(kojima, np.ones(4), method="pat")
    with pytest.raises(TypeError, match="options: time_limit"):
        perp.solve(kojima, np.ones(4), time_limit=[1])
    with pytest.raises(TypeError, match="options"):
        perp.solve(kojima, np.ones(4), options=[("time_limit", 1)])


def test_the_registry_is_the_one_list():
    names = {method.name for method in perp.methods()}
    assert {"auto", "path", "semismooth"} <= names
    for name in ("path", "semismooth", "smooth"):
        assert is_kojima_solution(perp.solve(kojima, np.ones(4), jac=kojima_jac, method=name).x), name
    assert "convergence_tolerance" in {option.key for option in perp.options()}


def test_a_basis_is_a_warm_start():
    p = perp.problem(kojima, np.ones(4), jac=kojima_jac)
    cold = p.solve(method="path")
    warm = p.solve(cold.x, method="path", basis=cold.basis)
    assert warm.success and cold.basis.dtype == np.int8 and cold.basis.shape == (4,)
    for basis, why in (([0, 1], "shape"), ([0, 1, 7, 0], "7"), ([0.5] * 4, "integers")):
        with pytest.raises((ValueError, TypeError), match=rf"basis: .*{why}"):
            p.solve(basis=basis)
    with pytest.raises(ValueError, match="basis: method semismooth"):
        p.solve(method="semismooth", basis=cold.basis)


def test_log_callback_and_table():
    lines, rows = [], []
    r = perp.solve(kojima, np.ones(4), log=lines.append, callback=lambda row, x: rows.append((row["k"], x)))
    assert any("Major Iteration Log" in line for line in lines) and lines[-1].startswith("Solved")
    assert len(rows) == len(r.log) and r.log["residual"][-1] == r.residual
    assert all(x is None or x.shape == (4,) for _, x in rows)
    assert r.log[0]["kind"] == "I" and r.log.columns[0] == "k" and len(str(r.log).splitlines()) == len(r.log) + 1
    assert "<table>" in r._repr_html_() and "<table>" in r.log._repr_html_() and "Solved" in repr(r)


def test_log_true_prints(capsys):
    perp.solve(kojima, np.ones(4), log=True)
    assert "Major Iteration Log" in capsys.readouterr().out


def stops(row, x):
    raise StopIteration


@pytest.mark.parametrize("stop", [lambda row, x: row["k"] >= 1, stops])
def test_a_callback_ends_the_solve(stop):
    r = perp.solve(kojima, np.full(4, 9.0), callback=stop, method="semismooth")
    assert r.status == "Interrupted" and not r.success and r.x.shape == (4,)


def test_results_are_pickled():
    r = pickle.loads(pickle.dumps(perp.solve(kojima, np.ones(4))))
    assert r.success and is_kojima_solution(r.x) and len(r.log) > 0


def test_the_same_twice_is_the_same():
    a, b = (perp.solve(kojima, np.full(4, 5.0)) for _ in range(2))
    assert a.x.tobytes() == b.x.tobytes() and a.message == b.message


def test_solved_to_rounding_is_no_success():
    """Terms of 1e12 cannot be summed to 1e-8: the point is as good as doubles allow, and not to the tolerance."""
    rng = np.random.default_rng(0)
    M = rng.normal(size=(5, 5)) * 1e12
    r = perp.mcp_affine(M, -M @ rng.normal(size=5) / 3, -np.inf, np.inf)
    assert r.status == "SolvedToRounding" and r.success is False and r.residual > 1e-8


def test_plot():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    axes = perp.plot(perp.solve(kojima, np.ones(4)))
    assert axes.get_yscale() == "log" and "Solved" in axes.get_title()
    with pytest.raises(TypeError, match="result"):
        perp.plot(3)


def test_fields_of_the_library_need_no_line_of_python():
    """Record.__getattr__ gives what has no documentation of its own. Catches a new field that nobody can read."""

    class Bare(perp._result.Record):
        pass

    r = perp.collection("kojshin").solve()
    bare = Bare(r._source)
    assert (bare.status, bare.residual, bare.worst) == (r.status, r.residual, r.worst)
    with pytest.raises(AttributeError, match="no_such_field"):
        _ = bare.no_such_field
