# SPDX-License-Identifier: Apache-2.0
"""perp.lcp and perp.mcp_affine: forms of M, and that it stays where it is."""

import subprocess
import sys

import numpy as np
import perp
import pytest
import scipy.sparse as sp
from perp import _arrays
from problems import natural


def example(n=60, seed=1):
    """Diagonally dominant and unsymmetric: one solution."""
    M = sp.random(n, n, 0.1, random_state=seed, format="csc") + 5 * sp.eye(n, format="csc")
    return sp.csc_matrix(M), np.random.default_rng(seed).normal(size=n)


def unsorted(M):
    M = M.copy()
    for j in range(M.shape[1]):
        part = slice(M.indptr[j], M.indptr[j + 1])
        M.indices[part] = M.indices[part][::-1].copy()
        M.data[part] = M.data[part][::-1].copy()
    M.has_sorted_indices = True  # a lie, which must not be believed
    return M


def doubled(M):
    coo = M.tocoo()
    order = np.lexsort((np.tile(coo.row, 2), np.tile(coo.col, 2)))
    N = sp.csc_matrix(M.shape)
    N.data = np.tile(coo.data / 2, 2)[order]
    N.indices = np.tile(coo.row, 2)[order].astype(np.int32)
    N.indptr = 2 * M.indptr
    return N


def wide(M):
    N = M.copy()
    N.indptr, N.indices = N.indptr.astype(np.int64), N.indices.astype(np.int64)
    return N


def strided(M):
    N = M.copy()
    N.data = np.repeat(N.data, 2)[::2]
    assert not N.data.flags.c_contiguous
    return N


FORMS = {
    "csc": lambda M: M,
    "csr": lambda M: M.tocsr(),
    "coo": lambda M: M.tocoo(),
    "lil": lambda M: M.tolil(),
    "dia": lambda M: M.todia(),
    "bsr": lambda M: M.tobsr(),
    "csc_array": lambda M: sp.csc_array(M),
    "dense": lambda M: M.toarray(),
    "fortran": lambda M: np.asfortranarray(M.toarray()),
    "matrix": lambda M: M.todense(),
    "lists": lambda M: M.toarray().tolist(),
    "view": lambda M: np.repeat(np.repeat(M.toarray(), 2, 0), 2, 1)[::2, ::2],
    "int64": wide,
    "strided": strided,
    "unsorted": unsorted,
    "doubled": doubled,
}


@pytest.mark.parametrize("form", FORMS)
def test_every_form_is_the_same_problem(form):
    """Unsorted and doubled entries, wide indices: what scipy takes for M is M."""
    M, q = example()
    given = FORMS[form](M)
    r = perp.lcp(given, q)
    assert r.success
    assert natural(r.x, M @ r.x + q) <= 1e-9
    np.testing.assert_allclose(r.x, perp.lcp(M, q).x, atol=1e-9)


def test_a_converted_matrix_is_left_as_it_was():
    M, q = example()
    given = unsorted(M)
    before = given.indices.copy()
    perp.lcp(given, q)
    np.testing.assert_array_equal(given.indices, before)


def test_integers_and_float32():
    r = perp.lcp(np.array([[2, 1], [1, 2]]), [-5, -6])
    np.testing.assert_allclose(r.x, [4 / 3, 7 / 3])
    np.testing.assert_allclose(perp.lcp(np.array([[2, 1], [1, 2]], dtype=np.float32), np.float32([-5, -6])).x, r.x)


def test_bounds_of_an_affine_problem():
    M, q = example()
    low, high = np.full(60, -0.05), np.full(60, 0.05)
    r = perp.mcp_affine(M, q, low, high)
    assert r.success and natural(r.x, M @ r.x + q, low, high) <= 1e-9
    assert {0, 2} <= set(r.basis if r.basis is not None else (0, 2))
    free = perp.mcp_affine(M, q, -np.inf, np.inf)
    np.testing.assert_allclose(M @ free.x, -q, atol=1e-9)


def test_infeasible_is_a_status():
    r = perp.lcp([[-1.0]], [-1.0])
    assert r.status == "Infeasible" and not r.success
    assert "row F[0] and the bounds contradict each other" in str(r)
    assert "rows F[0] and F[1] contradict each other" in str(perp.mcp_affine([[1, -1], [1, -1]], [-1, -3], -np.inf))


@pytest.mark.parametrize("method", ["lemke", "block-pivoting", "path"])
def test_methods_of_affine_problems(method):
    M, q = example()
    assert natural((r := perp.lcp(M, q, method=method)).x, M @ r.x + q) <= 1e-8


def test_an_affine_problem_is_kept():
    M, q = example()
    p = perp.affine_problem(M, q)
    assert p.affine and p.size == 60 and p.nonzeros == M.nnz
    np.testing.assert_allclose(p.F(np.ones(60)), M @ np.ones(60) + q)
    np.testing.assert_array_equal(p.jac(np.ones(60)).toarray(), M.toarray())
    assert p.solve().success
    facts = p.inspect()
    assert facts.classes["P"] is True and facts.structural_rank == 60 and "guarantee" in str(facts)


MEMORY = """
import resource, sys
import numpy as np, scipy.sparse as sp, perp
n = 100_000
M = sp.diags([np.full(n, 8.0), *[np.full(n - k, -0.01) for k in range(1, 61)]], list(range(61)), format="csc")
M.sort_indices()
if sys.argv[1] == "int64":
    M.indptr, M.indices = M.indptr.astype(np.int64), M.indices.astype(np.int64)
q = np.ones(n)
def now():
    return int(open("/proc/self/statm").read().split()[1]) * resource.getpagesize()
before = now()
p = perp.affine_problem(M, q)
print((now() - before) / (M.data.nbytes + M.nnz * 4))
"""


def test_the_matrix_is_not_copied():
    """10^5 rows and 6 10^6 entries, 73 MB: a problem of it takes its vectors; one of int64 indices takes a copy, which
    shows that the measurement sees one."""
    def share(kind):
        run = subprocess.run([sys.executable, "-c", MEMORY, kind], capture_output=True, text=True, check=True)
        return float(run.stdout)

    assert share("int32") < 0.15
    assert share("int64") > 0.8


def test_a_function_declared_affine_is_as_good_as_its_matrix():
    """min -x - y, x + y + s = 1 as optimality conditions, and one without a solution: classes, proof and certificate of a
    function that is declared affine are those of M and q. Catches a function that stays nonlinear."""
    lower = np.array([0, 0, 0, -np.inf])
    for A in ([[1.0, 1.0, 1.0]], [[-1.0, -1.0, -1.0]]):
        A = np.array(A)
        M = sp.csc_matrix(np.block([[np.zeros((3, 3)), -A.T], [A, np.zeros((1, 1))]]))
        q = np.array([-1.0, -1.0, 0.0, -1.0])
        by_matrix = perp.mcp_affine(M, q, lower)
        declared = perp.solve(lambda x: M @ x + q, np.zeros(4), lower, jac=lambda x: M, affine=True)
        assert declared.status == by_matrix.status == ("Solved" if A[0, 0] > 0 else "Infeasible")
        assert (declared.certificate is None) == (by_matrix.certificate is None)
        problem = perp.problem(lambda x: M @ x + q, np.zeros(4), lower, jac=lambda x: M, affine=True)
        assert problem.affine and problem.inspect().classes
    assert not perp.problem(lambda x: M @ x + q, np.zeros(4), lower, jac=lambda x: M).affine
    assert perp.problem(lambda x: np.ones(2), np.zeros(2), jac=lambda x: sp.csc_matrix((2, 2)), affine=True).affine
    with pytest.raises(ValueError, match="affine: goes with jac"):
        perp.solve(lambda x: x, np.zeros(2), affine=True)


@pytest.mark.parametrize("J", [sp.csc_matrix((2, 2)), sp.csc_matrix([[1.0, 0.0], [0.0, 2.0]]), sp.csc_matrix([[1.0, 1.0], [0.0, 3.0]])])
def test_a_promise_of_affine_that_is_not_kept_is_refused(J):
    """x + y = 3, 2 y = 2 with another matrix than its own: once "proven to have no solution" from the promise alone."""
    with pytest.raises((ValueError, RuntimeError), match="not as linear as the problem declares"):
        perp.solve(lambda x: np.array([x[0] + x[1] - 3, 2 * x[1] - 2]), np.ones(2), jac=lambda x: J, affine=True)


def test_a_matrix_that_changes_is_no_promise_kept():
    with pytest.raises((ValueError, RuntimeError), match="not as (linear|constant) as the problem declares"):
        perp.solve(lambda x: x**2 - 2, np.ones(2), jac=lambda x: sp.diags(2 * x, format="csc"), affine=True)


def test_the_matrix_of_an_affine_function_may_be_given_as_such():
    for M in (np.array([[2.0, 1.0], [1.0, 2.0]]), [[2, 1], [1, 2]], sp.csr_matrix([[2.0, 1.0], [1.0, 2.0]])):
        r = perp.solve(lambda x, q: np.array([[2, 1], [1, 2]]) @ x + q, np.zeros(2), jac=M, affine=True, args=(-3.0,))
        np.testing.assert_allclose(r.x, [1, 1])


# Catches an array of another layout: the library would read from anywhere.
def test_the_place_of_an_array_is_what_numpy_says():
    whole = np.arange(24.0).reshape(4, 6)
    for array in (whole, whole[1:, 2:], whole[::2], whole.T, np.zeros(0), np.int8([1, 2]), np.array(3.0), np.ones(2, dtype="f4")):
        assert _arrays.address(array) == array.__array_interface__["data"][0]
    whole.flags.writeable = False
    assert _arrays.address(whole) == whole.__array_interface__["data"][0]
