# SPDX-License-Identifier: Apache-2.0
"""Input that makes no sense is an exception that names the argument; none of it ends the process."""

import numpy as np
import perp
import pytest
import scipy.sparse as sp
from problems import kojima, kojima_jac

M = sp.csc_matrix(np.array([[2.0, 1.0], [1.0, 2.0]]))
q = np.array([-5.0, -6.0])


def matrix(**parts):
    """M with other arrays, which scipy would not let one make."""
    wrong = M.copy()
    for name, value in parts.items():
        setattr(wrong, name, np.array(value))
    return wrong


def changed(wrong, **parts):
    """A matrix with other parts, which scipy would follow wherever they point."""
    for name, value in parts.items():
        setattr(wrong, name, value)
    return wrong


class Lookalike:
    """Neither an array nor one of scipy.sparse, but has some of its members."""

    def __init__(self, format="csc", shape=(2, 2)):
        self.format, self.shape, self.nnz = format, shape, 4

    def tocsc(self):
        return self


class Raising:
    def __array__(self, *_, **__):
        raise ZeroDivisionError("a mistake of the caller's")


BAD_MATRICES = {
    "text": ("M", TypeError),
    "none": (None, TypeError),
    "objects": (np.array([[object(), 1], [1, 2]]), TypeError),
    "strings": (np.array([["2", "1"], ["1", "2"]]), TypeError),
    "complex": (np.array([[2.0, 1j], [1, 2]]), TypeError),
    "complex sparse": (M * 1j, TypeError),
    "one dimension": (np.ones(4), ValueError),
    "three dimensions": (np.ones((2, 2, 1)), ValueError),
    "not square": (np.ones((2, 3)), ValueError),
    "not square sparse": (sp.csc_matrix((2, 3)), ValueError),
    "other size": (np.eye(3), ValueError),
    "ragged": ([[1.0, 2.0], [3.0]], TypeError),
    "nan": (np.array([[2.0, np.nan], [1, 2]]), ValueError),
    "inf sparse": (matrix(data=[2.0, np.inf, 1, 2]), ValueError),
    "row too large": (matrix(indices=np.int32([0, 7, 0, 1])), ValueError),
    "row negative": (matrix(indices=np.int32([0, -1, 0, 1])), ValueError),
    "row too large, int64": (matrix(indices=np.int64([0, 2**40, 0, 1]), indptr=np.int64([0, 2, 4])), ValueError),
    "rows are no integers": (matrix(indices=[0.0, 1.0, 0.0, 1.0]), ValueError),
    "starts descend": (matrix(indptr=np.int32([0, 4, 2])), ValueError),
    "starts end too far": (matrix(indptr=np.int32([0, 2, 400])), ValueError),
    "starts begin late": (matrix(indptr=np.int32([1, 2, 4])), ValueError),
    "starts too few": (matrix(indptr=np.int32([0, 4])), ValueError),
    "data too short": (matrix(data=[1.0]), ValueError),
    "unsigned row too large": (matrix(indices=np.uint32([0, 2**32 - 1, 0, 1])), ValueError),
    "unsigned row beyond int64": (matrix(indices=np.uint64([0, 2**64 - 1, 0, 1])), ValueError),
    "data in two dimensions": (matrix(data=[[2.0, 1], [1, 2]]), ValueError),
    "masked": (np.ma.array(np.eye(2), mask=[[0, 1], [0, 0]]), ValueError),
    "coo row too large": (changed(M.tocoo(), row=np.int32([0, 1, 10**6, 1])), ValueError),
    "coo column too large": (changed(M.tocoo(), col=np.int32([0, 0, 10**6, 1])), ValueError),
    "coo column negative": (changed(M.tocoo(), col=np.int32([0, 0, -1, 1])), ValueError),
    "coo data too short": (changed(M.tocoo(), data=np.ones(2)), ValueError),
    "lil column too large": (changed(M.tolil(), rows=np.array([[0, 77], [0, 1]] + [[]], dtype=object)[:2]), ValueError),
    "no matrix of scipy's": (Lookalike(), TypeError),
    "format that is no text": (Lookalike(format=3), TypeError),
    "shape that is none": (Lookalike(shape=None), ValueError),
    "raises": (Raising(), TypeError),
    "csr row too large": ((lambda m: (setattr(m, "indices", np.int32([0, 9, 0, 1])), m)[1])(M.tocsr()), ValueError),
}


@pytest.mark.parametrize("case", BAD_MATRICES)
def test_matrices(case):
    given, kind = BAD_MATRICES[case]
    with pytest.raises(kind, match=r"^M: "):
        perp.lcp(given, q)
    with pytest.raises(kind, match=r"^M: "):
        perp.affine_problem(given, q)


BAD_VECTORS = {
    "none": (None, TypeError),
    "text": ("ab", TypeError),
    "complex": ([1j, 2], TypeError),
    "objects": ([object(), 1], TypeError),
    "nan": ([1, np.nan], ValueError),
    "inf": ([1, np.inf], ValueError),
    "matrix": (np.ones((2, 1)), ValueError),
    "number": (3.0, ValueError),
    "empty": ([], ValueError),
    "dict": ({}, TypeError),
    "masked": (np.ma.array([1.0, 2.0], mask=[0, 1]), ValueError),
    "generator": ((v for v in (1.0, 2.0)), TypeError),
    "beyond doubles": ([10**400, 1], TypeError),
    "masked dates": (np.array(["2020-01-01", "2020-01-02"], dtype="M8[D]"), TypeError),
}


@pytest.mark.parametrize("case", BAD_VECTORS)
def test_vectors(case):
    given, kind = BAD_VECTORS[case]
    with pytest.raises(kind, match=r"^q: "):
        perp.lcp(M, given)
    with pytest.raises(kind, match=r"^x0: "):
        perp.solve(kojima, given)
    if given is not None:
        with pytest.raises(kind, match=r"^x0: "):
            perp.lcp(M, q, given)
    with pytest.raises((ValueError, TypeError), match=r"^x: "):
        perp.affine_problem(M, q).F(given)


def test_wrong_length():
    with pytest.raises(ValueError, match=r"^x0: has shape \(3,\), and must have shape \(2,\)"):
        perp.lcp(M, q, np.zeros(3))


@pytest.mark.parametrize(
    "bounds, name",
    [
        ({"lower": np.nan}, "lower"),
        ({"lower": np.inf}, "lower"),
        ({"upper": -np.inf}, "upper"),
        ({"lower": 2, "upper": 1}, "upper"),
        ({"lower": [0, 0, 0]}, "lower"),
        ({"upper": np.ones((2, 1))}, "upper"),
        ({"upper": "high"}, "upper"),
        ({"lower": [0, 1j]}, "lower"),
        ({"lower": np.ma.array([0.0, 0.0], mask=[0, 1])}, "lower"),
    ],
)
def test_bounds(bounds, name):
    with pytest.raises((ValueError, TypeError), match=f"^{name}: "):
        perp.mcp_affine(M, q, **bounds)
    with pytest.raises((ValueError, TypeError), match=f"^{name}: "):
        perp.solve(lambda x: x, [0.0, 0.0], **bounds)


@pytest.mark.parametrize(
    "returned, kind",
    [
        (None, TypeError),
        ("abcd", TypeError),
        (np.ones(3), ValueError),
        (np.ones((4, 1)), ValueError),
        (2.0, ValueError),
        (np.ones(4) * 1j, TypeError),
        ([1, 2, 3, None], TypeError),
        (sp.csc_matrix(np.ones((4, 1))), TypeError),
        (np.ma.array(np.ones(4), mask=[0, 0, 0, 1]), ValueError),
        (Raising(), TypeError),
    ],
)
def test_what_F_returns(returned, kind):
    with pytest.raises(kind, match=r"^F: "):
        perp.solve(lambda x: returned, np.ones(4))


@pytest.mark.parametrize(
    "returned",
    [None, "J", np.ones(4), np.ones((4, 3)), sp.eye(3), np.eye(4) * 1j, sp.eye(4) * 1j, [[1, 2], [3]]]
    + [np.ma.array(np.eye(4), mask=np.eye(4)), Lookalike(), Lookalike(format=3), Lookalike(shape=None)],
    ids=str,
)
def test_what_jac_returns(returned):
    def later(x):
        return kojima_jac(x) if (x == 1).all() else returned

    for jac in (lambda x: returned, later):
        with pytest.raises((ValueError, TypeError), match=r"^jac: "):
            perp.solve(kojima, np.ones(4), jac=jac)


def test_sparse_results_of_jac_that_would_be_read_beyond_their_end():
    def broken(**parts):
        J = sp.csc_matrix(np.ones((4, 4)))
        for name, value in parts.items():
            setattr(J, name, value)
        return J

    wrong = [
        broken(indptr=np.int32([0, 4, 8, 12, 10**6])),
        broken(indptr=np.int32([0, 4, 8, 12])),
        broken(indptr=np.int32([0, 4, 2, 12, 16])),
        broken(indices=np.int32([-1] + [0] * 15)),
        broken(indices=np.int32([10**6] * 16)),
        broken(data=np.ones(3)),
        broken(data=np.ones((4, 4))),
        changed(sp.coo_matrix(np.ones((4, 4))), row=np.int32([10**6] * 16)),
        changed(sp.csr_matrix(np.ones((4, 4))), indptr=np.int32([0, 4, 8, 12, 10**6])),
    ]
    for J in wrong:
        with pytest.raises(ValueError, match=r"^jac: "):
            perp.solve(kojima, np.ones(4), jac=lambda x, J=J: J)
        with pytest.raises(ValueError, match=r"^jac: "):
            perp.solve(kojima, np.ones(4), jac=lambda x, J=J: J, pattern=np.ones((4, 4)))


def test_arguments_that_are_no_functions():
    for name, arguments in {
        "F": dict(F=3),
        "jac": dict(jac=np.eye(4)),
        "callback": dict(callback=3),
        "log": dict(log="file"),
        "pattern": dict(pattern=np.ones((3, 3))),
        "pattern ": dict(pattern=sp.eye(3)),
        "pattern  ": dict(pattern=changed(sp.coo_matrix(np.ones((4, 4))), col=np.int32([10**6] * 16))),
    }.items():
        with pytest.raises((ValueError, TypeError), match=rf"^{name.strip()}: "):
            perp.solve(**{"F": kojima, "x0": np.ones(4), **arguments})


def test_names():
    for name in ("variable_names", "equation_names"):
        with pytest.raises(ValueError, match=rf"^{name}: has 1 names"):
            perp.problem(kojima, np.ones(4), **{name: ["a"]})
        for wrong in ([1, 2, 3, 4], "abcd", 3, [b"a", b"b", b"c", b"d"]):
            with pytest.raises(TypeError, match=rf"^{name}: "):
                perp.problem(kojima, np.ones(4), **{name: wrong})
    with pytest.raises(ValueError, match=r"^name: .*surrogates"):
        perp.problem(kojima, np.ones(4), name="\ud800")
    with pytest.raises(TypeError, match=r"^name: is of type int"):
        perp.problem(kojima, np.ones(4), name=3)
    with pytest.raises(TypeError, match=r"^name: is of type int"):
        perp.collection(3)
    with pytest.raises(TypeError, match=r"^variant: is of type int"):
        perp.contact.solve(np.eye(3), [-1.0, 0, 0], [0.5], variant=3)


@pytest.mark.parametrize("given", [2**40, 2**32, [2**32, 0, 0, 0], np.uint64([2**63, 0, 0, 0]), [-1, 0, 0, 0]])
def test_a_basis_of_other_numbers(given):
    """Would catch numbers that are cut to fewer bits, and are then those of a cell."""
    with pytest.raises(ValueError, match="^basis: "):
        perp.solve(kojima, np.ones(4), basis=given)


def test_numbers_of_options_and_other_arguments():
    tol = perp.lcp(M, q, convergence_tolerance=np.array(1e-6))  # a number in an array without dimensions
    assert tol.success
    with pytest.raises((TypeError, perp.OptionError), match="convergence_tolerance"):
        perp.lcp(M, q, convergence_tolerance=np.array([1e-6, 1]))
    for wrong, kind in ((0, ValueError), (2**40, ValueError), (1.5, TypeError), ("2", TypeError), (None, TypeError)):
        with pytest.raises(kind, match=r"^solutions: "):
            perp.solve_all(lambda x: x, [1.0], solutions=wrong)
    contact = perp.contact.problem(np.eye(3), [-1.0, 0, 0], [0.5])
    for wrong, kind in ((0, ValueError), (-1, ValueError), (np.nan, ValueError), ("a", TypeError), (None, TypeError)):
        with pytest.raises(kind, match=r"^tolerance: "):
            contact.judge([1.0, 0, 0], wrong)
    for wrong in (1.0, np.ones((1, 1, 1))):
        with pytest.raises(ValueError, match=r"^dF: .*and must have shape \(1, m\)"):
            perp.sensitivity(lambda x: x - 2.0, [2.0], dF=wrong)


def test_a_callback_whose_answer_is_neither_true_nor_false():
    """Would catch numpy's error taken for a wish to stop."""
    with pytest.raises(ValueError, match="truth value of an array"):
        perp.solve(kojima, np.ones(4), callback=lambda row, x: np.array([1, 2]))


def test_unsigned_indices_are_indices():
    for kind in (np.uint32, np.uint64, np.int16):
        given = matrix(indices=M.indices.astype(kind), indptr=M.indptr.astype(kind))
        assert np.allclose(perp.lcp(given, q).x, [4 / 3, 7 / 3])
        assert perp.solve(lambda x: M @ x + q, np.ones(2), jac=lambda x, J=given: J).success


def test_empty_problems():
    with pytest.raises(ValueError, match="^q: is empty"):
        perp.lcp(np.zeros((0, 0)), [])
    with pytest.raises(ValueError, match="^x0: is empty"):
        perp.solve(lambda x: x, [])
    with pytest.raises(ValueError, match="^q: is empty"):
        perp.contact.solve(np.zeros((0, 0)), [], [])


def test_contact_arguments():
    W, q3, mu = np.eye(3), [-1.0, 0, 0], [0.5]
    for name, arguments in {
        "W": (np.eye(2), q3, mu),
        "q": (W, [1.0], mu),
        "mu": (W, q3, [-0.5]),
        "variant": (W, q3, mu, "glockr"),
    }.items():
        with pytest.raises(ValueError, match=rf"^{name}: "):
            perp.contact.solve(*arguments)
    with pytest.raises(perp.OptionError, match="tolerence"):
        perp.contact.solve(W, q3, mu, convergence_tolerence=1)


def test_files(tmp_path):
    with pytest.raises(FileNotFoundError, match="path"):
        perp.read_nl(tmp_path / "none")
    for read in (perp.read_nl, perp.contact.read):
        with pytest.raises(TypeError, match="^path: is of type NoneType"):
            read(None)
    bad = tmp_path / "bad.nl"
    bad.write_text("g3 0 1 0\n 1 nonsense\n")
    with pytest.raises(perp.FileError, match="bad.nl"):
        perp.read_nl(bad)
    with pytest.raises(FileNotFoundError, match="path"):
        perp.contact.read(tmp_path / "none.hdf5")
    with pytest.raises(perp.FileError, match="bad.nl"):
        perp.contact.read(bad)
    with pytest.raises(ValueError, match="josephy"):
        perp.collection("josefy")
