# SPDX-License-Identifier: Apache-2.0
"""Problems from files and from the collection, several solutions, derivatives of solutions."""

from pathlib import Path

import numpy as np
import perp
import pytest
import scipy.sparse as sp
from problems import SOLUTIONS, is_kojima_solution, kojima, kojima_jac, natural

MODELS = Path(__file__).resolve().parents[2] / "data" / "models"


def test_the_collection():
    names = [entry.name for entry in perp.collection_entries()]
    assert "josephy" in names and len(names) > 50
    for name in ("josephy", "kojshin", "mathinum"):
        if name not in names:
            continue
        p = perp.collection(name)
        r = p.solve()
        assert r.success and natural(r.x, p.F(r.x), p.lower, p.upper) <= 1e-8, name
        assert p.residual(r.x) == r.residual


def test_what_a_problem_says_of_itself():
    p = perp.problem(kojima, np.ones(4), jac=kojima_jac, name="mine", variable_names=list("abcd"))
    assert (p.name, p.size, p.nonzeros, p.affine) == ("mine", 4, 16, False)
    assert p.variable_names == ["a", "b", "c", "d"] and p.equation_names[0] == "F[0]" and "mine" in repr(p)
    np.testing.assert_array_equal(p.x0, np.ones(4))
    np.testing.assert_array_equal(p.upper, np.full(4, np.inf))
    facts = p.inspect()
    assert facts.bounds["lower"] == 4 and facts.structural_rank == 4 and facts.classes == {}
    assert facts.residual == pytest.approx(natural(np.ones(4), kojima(np.ones(4))))
    assert "<table>" in facts._repr_html_()


def test_inspect_names_what_is_singular():
    p = perp.problem(lambda x: np.array([x[0] - 1, x[0] + 1]), [1.0, 1.0], -np.inf, pattern=[[1, 0], [1, 0]])
    facts = p.inspect()
    assert facts.structural_rank == 1 and "x[1]" in facts.singular


def test_nl_files():
    files = sorted(MODELS.rglob("*.nl"))
    assert files
    p = perp.read_nl(files[0])
    assert p.size > 0 and p.source == str(files[0])
    assert perp.read_nl(str(files[0]).removesuffix(".nl")).size == p.size
    r = p.solve()
    assert r.x.shape == (p.size,) and r.residual == p.residual(r.x)


def test_remarks_on_a_model_are_notes_as_in_the_program():
    """The objective of a square model is not used: shared/cases/ignored-objective."""
    model = Path(__file__).parents[3] / "shared/cases/ignored-objective/square-with-objective.nl"
    if not model.exists():
        pytest.skip("no ../shared")
    assert any("the objective is not used" in note for note in perp.read_nl(model).solve().notes)


def test_variables_that_alone_make_up_a_condition_are_computed(tmp_path):
    """profit = p - 3, 0 <= p _|_ profit >= 0: profit is no unknown. Catches a variable of the modeller's that is lost."""
    (tmp_path / "m.nl").write_text(
        "g3 1 1 0\n 2 2 0 0 1\n 0 0 1 0\n 0 0\n 0 0 0\n 0 0 0 1\n 0 0 0 0 0\n 3 0\n 0 0\n 0 0 0 0 0\n"
        "C0\nn0\nC1\nn0\nx0\nr\n5 1 1\n4 -3\nb\n2 0\n3\nk1\n1\nJ0 1\n1 1\nJ1 2\n0 -1\n1 1\n"
    )
    (tmp_path / "m.col").write_text("p\nprofit\n")
    (tmp_path / "m.row").write_text("entry.c\nentry.bc\n")
    r = perp.read_nl(tmp_path / "m.nl").solve()
    assert r.x == pytest.approx([3]) and r.computed == {"profit": pytest.approx(0, abs=1e-8)} and "profit" in repr(r)


def test_where_F_is_not_defined_it_is_nan():
    p = perp.problem(lambda x: np.log(x), [1.0], -np.inf)
    with np.errstate(all="ignore"):
        assert np.isnan(p.F([-1.0])).all() and p.residual([-1.0]) == np.inf


def test_both_solutions_are_found():
    found = perp.solve_all(kojima, np.ones(4), jac=kojima_jac)
    assert len(found) == 2 and all(is_kojima_solution(one.x) for one in found)
    assert {int(np.abs(one.x - SOLUTIONS[0]).max() < 1e-6) for one in found} == {0, 1}
    assert found.message and found.first.success and found[0].result.success
    assert len(perp.solve_all(perp.collection("josephy"), solutions=1)) == 1
    with pytest.raises(ValueError, match="^solutions: "):
        perp.solve_all(kojima, np.ones(4), solutions=0)


def test_sensitivity():
    """x(p) = max(0, p) of F = x - p."""
    s = perp.sensitivity(lambda x: x - np.array([2.0, -1.0]), [2.0, 0.0], dF=-np.eye(2))
    assert s.known and s.status == "Differentiable" and s.strongly_regular
    np.testing.assert_allclose(s.dx, [[1, 0], [0, 0]], atol=1e-12)
    np.testing.assert_allclose(s.dF, [[0, 0], [0, -1]], atol=1e-12)
    assert s.degenerate.size == 0


def test_sensitivity_where_there_are_only_directions():
    p = perp.affine_problem(np.eye(1), [0.0])
    refused = p.sensitivity([0.0], dF=[-1.0])
    assert refused.status == "Degenerate" and not refused.known and list(refused.degenerate) == [0]
    for dp, dx in ((1.0, 1.0), (-1.0, 0.0)):
        s = p.sensitivity([0.0], dF=sp.csc_matrix([[-1.0]]), direction=[dp])
        assert s.known and s.dx[0, 0] == pytest.approx(dx, abs=1e-12)


def test_sensitivity_of_bounds_and_its_refusals():
    p = perp.affine_problem(np.eye(1), [3.0], lower=1.0)
    assert p.sensitivity([1.0], dF=[0.0], dlower=[1.0]).dx[0, 0] == 1
    assert p.sensitivity([1.5], dF=[0.0]).status == "NotASolution"
    for name, arguments in {"dF": {"dF": np.ones((2, 1))}, "direction": {"dF": [0.0], "direction": [1.0, 2.0]}}.items():
        with pytest.raises(ValueError, match=rf"^{name}: "):
            p.sensitivity([1.0], **arguments)


def test_verify():
    """sqrt(8) of x^2 = 8 is affine no more: affine problems and models have ranges, functions of Python have none."""
    M, q = np.array([[2.0, 1], [1, 2]]), [-5.0, -6]
    proof = perp.verify(perp.affine_problem(M, q), [4 / 3, 7 / 3])
    assert proof.unique and (np.abs(proof.x - [4 / 3, 7 / 3]) <= proof.radius + 1e-15).all()
    assert 0 < proof.radius.max() < 1e-12
    far = perp.verify(perp.affine_problem(M, q), [1.0, 0.0])
    assert not far.unique or (np.abs(far.x - [4 / 3, 7 / 3]) <= far.radius + 1e-15).all()
    no = perp.verify(perp.problem(kojima, np.ones(4), jac=kojima_jac), SOLUTIONS[0])
    assert not no.unique and no.why_not
    with pytest.raises(ValueError, match="^x: "):
        perp.verify(perp.affine_problem(M, q), [1.0])
