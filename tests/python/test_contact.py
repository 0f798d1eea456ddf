# SPDX-License-Identifier: Apache-2.0
"""perp.contact: a block on a plane, by its closed form, and files."""

from pathlib import Path

import numpy as np
import perp
import pytest
import scipy.sparse as sp

FILES = Path(__file__).resolve().parents[2] / "data" / "contact"


@pytest.mark.parametrize("wrap", [np.asarray, sp.csc_matrix, sp.csr_matrix])
@pytest.mark.parametrize("push, state", [(0.3, "stick"), (0.9, "slip")])
def test_a_block_sticks_or_slips(wrap, push, state):
    """W = I, pressed on by 1 and pushed along: it sticks while |push| <= mu r_N = 0.5."""
    r = perp.contact.solve(wrap(np.eye(3)), [-1.0, push, 0.0], [0.5])
    assert r.success and r.status == "Solved" and r.states == [state]
    friction = min(push, 0.5)
    np.testing.assert_allclose(r.r, [1, -friction, 0], atol=1e-7)
    np.testing.assert_allclose(r.u, [0, push - friction, 0], atol=1e-7)
    assert r.residual["siconos"] <= 1e-8 and r.stats["time_s"] >= 0


def test_two_dimensions_and_an_open_contact():
    r = perp.contact.solve(np.eye(2), [1.0, 0.2], [0.5])
    assert r.states == ["open"] and np.abs(r.r).max() <= 1e-8


def test_a_ball_rolls_on():
    """2 kg and 4/5 kg m^2: r_N = 6, friction holds the slide, and mu_r r_N = 0.6 stops a part of q_R = (3, -4)."""
    W, q = np.diag([0.5, 0.5, 0.5, 1.25, 1.25]), [-3, 0.6, -0.8, 3, -4]
    problem = perp.contact.problem(W, q, [0.4], [0.1])
    assert problem.dimension == 5 and problem.mu_r[0] == 0.1
    r = problem.solve()
    assert r.success and r.states == ["roll"]
    assert np.abs(r.r - [6, -1.2, 1.6, -0.36, 0.48]).max() <= 1e-6
    assert perp.contact.solve(W[::2, ::2], [-3, 0.6, 0], [0.4], mu_r=[0.1]).success
    assert perp.contact.problem(np.eye(3), [-1, 0, 0], [0.5]).mu_r is None
    with pytest.raises(ValueError, match="3 or 5"):
        perp.contact.problem(np.eye(2), [-1, 0], [0.5], [0.1])


def test_variants_and_the_judge():
    problem = perp.contact.problem(np.eye(3), [-1.0, 0.9, 0.0], [0.5])
    assert (problem.dimension, problem.contacts) == (3, 1)
    for variant in ("glocker+path", "inner:8+lemke"):
        assert problem.solve(variant).success, variant
    assert problem.judge([1.0, -0.5, 0.0])[0] and not problem.judge([1.0, 0.5, 0.0])[0]
    # Eight facets touch the disc where the push points: the same forces as Coulomb's law.
    np.testing.assert_allclose(problem.solve("inner:8").r, [1, -0.5, 0], atol=1e-7)


def test_files():
    paths = sorted(path for path in FILES.rglob("*") if path.suffix in (".hdf5", ".dat"))
    if not paths:
        pytest.skip("there are no contact problems in data/contact")
    problem = perp.contact.read(paths[0])
    assert problem.q.shape == (problem.dimension * problem.contacts,) and problem.W.shape[0] == problem.q.size
    r = problem.solve(time_limit=20)
    assert problem.judge(r.r)[0] == r.success


def test_sensitivity_of_a_block_that_slips():
    """W = I, q = (-1, 0.9, 0), mu = 0.5: r = (1, -0.5, 0), u_T = 0.4. By hand: r_T = mu q_N, across slip r_T / |u_T|
    turns. Would catch columns in another order, dW that does not arrive, one direction for another."""
    problem = perp.contact.problem(np.eye(3), [-1.0, 0.9, 0.0], [0.5])
    r = problem.solve().r
    s = problem.sensitivity(r)
    assert s.known and s.status == "Differentiable" and s.regions == ["slip"] and s.strongly_regular
    assert s.dr.shape == s.du.shape == (3, 4)
    np.testing.assert_allclose(s.dr[:, [0, 1, 3]], [[-1, 0, 0], [0.5, 0, -1], [0, 0, 0]], atol=1e-6)
    np.testing.assert_allclose(s.dr[2, 2], -0.5 / 0.4 * s.du[2, 2], atol=1e-6)
    by_mu = problem.sensitivity(r, dmu=[1.0])
    np.testing.assert_allclose(by_mu.dr, s.dr[:, 3:], atol=1e-12)
    dW = sp.csc_matrix(([1.0], ([0], [0])), shape=(3, 3))  # r_N = 1 / W_NN
    by_W = problem.sensitivity(r, dq=np.zeros((3, 2)), dW=[np.zeros((3, 3)), dW])
    np.testing.assert_allclose(by_W.dr, [[0, -1], [0, 0.5], [0, 0]], atol=1e-6)
    one_way = problem.sensitivity(r, direction=[0, 0, 0, 2.0])
    np.testing.assert_allclose(one_way.dr, 2 * by_mu.dr, atol=1e-12)


def test_sensitivity_at_a_kink_is_one_sided():
    """At the edge, q_T = mu: a larger push slips, a smaller one changes the friction."""
    problem = perp.contact.problem(np.eye(3), [-1.0, 0.5, 0.0], [0.5])
    r = [1.0, -0.5, 0.0]
    both = problem.sensitivity(r)
    assert not both.known and both.status == "Degenerate" and both.dr.shape == (0, 0) and both.degenerate.tolist() == [0]
    for push, dr, du in ((1.0, 0.0, 1.0), (-1.0, 1.0, 0.0)):
        s = problem.sensitivity(r, dq=[0.0, 1.0, 0.0], direction=[push])
        assert s.known and s.status == "Directional" and s.regions == ["edge"]
        np.testing.assert_allclose([s.dr[1, 0], s.du[1, 0]], [dr, du], atol=1e-9)
    with pytest.raises(ValueError, match="dW: has 1 matrices, and must have 2"):
        problem.sensitivity(r, dq=np.zeros((3, 2)), dW=[np.eye(3)])
    with pytest.raises(ValueError, match="direction"):
        problem.sensitivity(r, dq=[0.0, 1.0, 0.0], direction=[1.0, 2.0])


def simulations(count, seed=1):
    """W, and q of `count` simulations at two times, of a wall that is pushed a little."""
    wall, random = perp.contact.scene("wall", 12), np.random.default_rng(seed)
    size = np.abs(wall.q).max()
    first = wall.q + 0.02 * size * random.normal(size=(count, len(wall.q)))
    return wall.W.toarray(), wall.mu, (first, first + 0.002 * size * random.normal(size=first.shape))


# Catches a start that is another simulation's, and memory that threads share: the bits would differ.
def test_a_batch_of_steps_depends_on_neither_order_nor_threads():
    W, mu, times = simulations(30)
    order = np.random.default_rng(2).permutation(30)
    one, other = perp.contact.Batch(30), perp.contact.Batch(30)
    for k, q in enumerate(times):
        a = one.step(W, q, mu, threads=1)
        b = other.step(np.repeat(W[None], 30, axis=0), q[order], np.repeat(mu[None], 30, axis=0), threads=2)
        assert a.success.all() and a.status == ["Solved"] * 30 and a.residual.max() <= 1e-8
        np.testing.assert_array_equal(a.r[order], b.r)
        np.testing.assert_array_equal(a.u[order], b.u)
        if k == 0:
            np.testing.assert_array_equal(a.r[7], perp.contact.solve(W, q[7], mu).r)
    problem = perp.contact.problem(W, times[1][3], mu)
    assert problem.judge(a.r[3])[0]
    np.testing.assert_allclose(a.u[3], W @ a.r[3] + times[1][3], atol=1e-9)


def test_a_batch_of_polygons_and_its_refusals():
    batch = perp.contact.Batch(2, "inner:8", convergence_tolerance=1e-9)
    r = batch.step(np.eye(3), [[-1.0, 0.9, 0.0], [1.0, 0.0, 0.0]], [0.5])
    np.testing.assert_allclose(r.r, [[1, -0.5, 0], [0, 0, 0]], atol=1e-8)
    for arguments, what in (
        ((np.eye(3), np.zeros((3, 3)), [0.5]), "q: has 3 problems, and there are 2"),
        ((np.eye(2), np.zeros((2, 3)), [0.5]), "W: has shape"),
        ((np.eye(3), np.zeros((2, 4)), [0.5]), "q: has 4 entries"),
        ((np.eye(3), np.zeros((2, 3)), [-0.5]), "mu: entry"),
        ((np.eye(3), np.full((2, 3), np.nan), [0.5]), "q: entry"),
    ):
        with pytest.raises(ValueError, match=what):
            batch.step(*arguments)
    with pytest.raises(ValueError, match="count"):
        perp.contact.Batch(0)
    with pytest.raises(ValueError, match="variant"):
        perp.contact.Batch(2, "glockr")
