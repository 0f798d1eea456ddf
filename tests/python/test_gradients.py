# SPDX-License-Identifier: Apache-2.0
"""perp.jax and perp.torch: gradients of solutions by parameters against differences of solutions, on 50 generated models, at
points where bounds hold and where they do not. Each is skipped where its package is not installed."""

import warnings

import numpy as np
import perp
import pytest
from pages import run_examples

TIGHT = {"convergence_tolerance": 1e-12}
N, P = 6, 4
UPPER = np.array([np.inf, 0.3, np.inf, 0.3, 0.3, np.inf])


def model(seed):
    """F = M x + Q p + a tanh(x), M strongly diagonally dominant: strongly monotone, with one solution. Half of the variables have
    an upper bound. All numbers in one vector: JAX compiles F once."""
    random = np.random.default_rng(seed)
    M = random.normal(size=(N, N))
    M += np.diag(1 + np.abs(M).sum(axis=0) + np.abs(M).sum(axis=1))
    parts = random.normal(size=P), M, random.normal(size=(N, P)) * 6, random.uniform(0, 2, N), np.zeros(N)
    return np.concatenate([part.ravel() for part in parts]), random.normal(size=N)


def F(xp, x, t):
    """The last N parameters are a shift."""
    M, Q = t[P : P + N * N].reshape(N, N), t[P + N * N : -2 * N].reshape(N, P)
    return M @ x + Q @ t[:P] + t[-2 * N : -N] * xp.tanh(x) + t[-N:]


def solve(t, upper=UPPER):
    """By numpy, with a Jacobian by hand."""
    M, a = t[P : P + N * N].reshape(N, N), t[-2 * N : -N]
    r = perp.solve(lambda x: F(np, x, t), np.zeros(N), 0, upper, lambda x: M + np.diag(a / np.cosh(x) ** 2), **TIGHT)
    assert r.success
    return r.x


def difference(t, v, h, one_sided=False):
    steps = h * np.eye(len(t))[:P]
    return np.array([v @ (solve(t + e) - solve(t if one_sided else t - e)) / (h if one_sided else 2 * h) for e in steps])


def jax_function(F, upper, n):
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    solution = pytest.importorskip("perp.jax").solution
    x = solution(lambda x, p: F(jax.numpy, x, p), np.zeros(n), 0, upper, **TIGHT)
    return lambda p: np.asarray(x(p)), lambda p, v: np.asarray(jax.grad(lambda p: x(p) @ v)(jax.numpy.asarray(p)))


def torch_function(F, upper, n):
    torch = pytest.importorskip("torch")
    solution = pytest.importorskip("perp.torch").solution

    def of(x, p):
        return F(torch, x, p)

    x = solution(of, np.zeros(n), 0, upper, **TIGHT)

    def gradient(p, v):
        q = torch.tensor(p, dtype=torch.float64, requires_grad=True)
        (x(q) @ torch.from_numpy(v)).backward()
        return q.grad.numpy()

    return lambda p: x(torch.from_numpy(p)).numpy(), gradient


KINDS = [jax_function, torch_function]


@pytest.fixture(autouse=True)
def the_setting_of_jax():
    yield
    try:
        import jax
    except ImportError:
        return
    jax.config.update("jax_enable_x64", False)


@pytest.mark.parametrize("kind", KINDS)
def test_50_models_against_differences(kind):
    x, gradient = kind(F, UPPER, N)
    at_bounds = 0
    for seed in range(50):
        t, v = model(seed)
        at = x(t)
        at_bounds += int(((at == 0) | (at == UPPER)).sum())
        with warnings.catch_warnings():
            warnings.simplefilter("error", UserWarning)
            found = gradient(t, v)[:P]
        assert np.allclose(found, difference(t, v, 1e-5), atol=1e-6, rtol=1e-6), seed
    assert 50 < at_bounds < 50 * N - 50


@pytest.mark.parametrize("kind", KINDS)
def test_a_kink(kind):
    """x = max(0, p_0), y = max(0, p_1 - p_0), at p = (0, 1): for growing p_0, dx = 1 and dy = -1. The flag is a warning."""

    def max_of(xp, x, p):
        return (xp.stack if hasattr(xp, "from_numpy") else xp.array)([x[0] - p[0], x[1] - p[1] + p[0]])

    from perp._implicit import KinkWarning

    _, gradient = kind(max_of, np.inf, 2)
    with pytest.warns(KinkWarning, match="kink"):
        assert np.allclose(gradient(np.array([0.0, 1.0]), np.array([3.0, 1.0])), [3 - 1, 1])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert np.allclose(gradient(np.array([-1.0, 1.0]), np.array([3.0, 1.0])), [-1, 1])  # x = 0 is at its bound


@pytest.mark.parametrize("kind", KINDS)
def test_kinks_of_generated_models(kind):
    """F is shifted so that x_0 is at 0 with F_0 = 0: one-sided differences."""
    x, gradient = kind(F, UPPER, N)
    for seed in range(5):
        t, v = model(seed)
        held = np.where(np.arange(N) == 0, 0.0, UPPER)
        t[-N] = -F(np, solve(t, held), t)[0]
        with pytest.warns(UserWarning, match="kink"):
            found = gradient(t, v)[:P]
        assert np.allclose(found, difference(t, v, 1e-6, one_sided=True), atol=1e-4, rtol=1e-4), seed


def test_jax_compiles_maps_and_takes_trees():
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    from perp.jax import solution

    x = solution(lambda x, p: p["slope"] * x - p["q"], np.zeros(3))
    p = {"slope": np.full(3, 2.0), "q": np.array([1.0, -1.0, 4.0])}
    of = lambda p: (x(p) ** 2).sum()  # x = max(0, q / slope): 0.5, 0, 2
    for gradient in (jax.grad(of)(p), jax.jit(jax.grad(of))(p)):
        assert np.allclose(gradient["q"], [0.5, 0, 2]) and np.allclose(gradient["slope"], [-0.25, 0, -4])
    assert np.allclose(jax.jacrev(x)(p)["q"], np.diag([0.5, 0, 0.5]))


def test_float32_is_told():
    jax = pytest.importorskip("jax")
    from perp.jax import solution

    x = solution(lambda x, p: x**3 - p, np.ones(1))
    with pytest.warns(perp.Float32Warning):
        gradient = jax.grad(lambda p: x(p)[0])(jax.numpy.array([8.0]))
    assert gradient.dtype == np.float32 and abs(gradient[0] - 1 / 12) < 1e-6


@pytest.mark.parametrize("kind", KINDS)
def test_no_solution_raises(kind):
    x, _ = kind(lambda xp, x, p: -1 - x * x + 0 * p, np.inf, 1)
    with pytest.raises(RuntimeError, match="no solution"):
        x(np.array([1.0]))


def test_the_page():
    """The examples of docs/gradients.md, in turn."""
    pytest.importorskip("jax")
    pytest.importorskip("torch")
    run_examples("docs/gradients.md")
