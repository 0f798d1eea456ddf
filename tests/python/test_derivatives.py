# SPDX-License-Identifier: Apache-2.0
"""jac="jax" and jac="casadi": ten functions against Jacobians by hand, to 1e-12, and their patterns. Each is skipped where its
package is not installed. A pattern that lacks an entry, or a colouring that mixes two columns, gives a wrong J here."""

import subprocess
import sys
import warnings

import numpy as np
import perp
import pytest
from pages import run_examples
from problems import is_kojima_solution, kojima_jac
from scipy import sparse

N = 12
A = np.random.default_rng(1).normal(size=(N, N))
BAND = np.diag(np.arange(1.0, N + 1)) + np.diag(np.ones(N - 2), 2)
ORDER = np.random.default_rng(2).permutation(N)


class Jax:
    def __init__(self):
        self.np = pytest.importorskip("jax.numpy")

    def join(self, *parts):
        return self.np.concatenate([self.np.atleast_1d(part) for part in parts])

    def product(self, matrix, x):
        return matrix @ x

    def take(self, x, order):
        return x[order]


class Casadi:
    def __init__(self):
        self.np = pytest.importorskip("casadi")

    def join(self, *parts):
        return self.np.vertcat(*parts)

    def product(self, matrix, x):
        return self.np.mtimes(self.np.DM(matrix), x)

    def take(self, x, order):
        return x[order.tolist()]


def tridiagonal(below, at, above):
    return np.diag(at) + np.diag(below, -1) + np.diag(above, 1)


def neighbours(k, x):
    """The sum of both."""
    return k.join(x[1], x[:-2] + x[2:], x[N - 2])


def murphy(k, x):
    """Marginal profits of Murphy, Sherali & Soyster's oligopoly."""
    total = x[0] + x[1] + x[2] + x[3] + x[4]
    p = (5000 / total) ** (1 / 1.1)
    c, b = (10, 8, 6, 4, 2), (1.2, 1.1, 1.0, 0.9, 0.8)
    return [c[i] + (x[i] / 5) ** (1 / b[i]) - p + p / 1.1 * x[i] / total for i in range(5)]


def murphy_jac(x):
    c, b = np.array((10, 8, 6, 4, 2)), np.array((1.2, 1.1, 1.0, 0.9, 0.8))
    total, g = x.sum(), 1 / 1.1
    p = (5000 / total) ** g
    shared = g * p / total - g * (g + 1) * p * x / total**2
    return shared[:, None] + np.diag((x / 5) ** (1 / b - 1) / (5 * b) + g * p / total)


def trigonometric(x):
    return 2 * np.sin(x) * np.cos(x)


MODELS = {  # F(k, x), J(x), x, entries of the pattern
    "kojima": (lambda k, x: list(kojima_of(x)), kojima_jac, np.array([0.7, 1.2, -0.4, 2.1]), 16),
    "obstacle": (lambda k, x: 2 * x - neighbours(k, x), lambda x: tridiagonal(-np.ones(N - 1), np.full(N, 2.0), -np.ones(N - 1)), None, 3 * N - 2),
    "bratu": (
        lambda k, x: 2 * x - neighbours(k, x) - 0.1 * k.np.exp(x),
        lambda x: tridiagonal(-np.ones(N - 1), 2 - 0.1 * np.exp(x), -np.ones(N - 1)),
        None,
        3 * N - 2,
    ),
    "oligopoly": (murphy, murphy_jac, np.array([20.0, 30.0, 25.0, 40.0, 35.0]), 25),
    "dense": (lambda k, x: k.product(A, x) + 1, lambda x: A, None, N * N),
    "band": (lambda k, x: k.product(BAND, x) ** 2, lambda x: 2 * (BAND @ x)[:, None] * BAND, None, 2 * N - 2),
    "sine": (lambda k, x: k.np.sin(x) ** 2, lambda x: np.diag(trigonometric(x)), None, N),
    "order": (lambda k, x: k.take(x, ORDER) ** 3 / x, lambda x: order_jac(x), None, int(2 * N - (ORDER == np.arange(N)).sum())),
    "quotient": (
        lambda k, x: k.join(x[0] / x[1], k.np.log(x[1] * x[2]), x[2] * k.np.sqrt(x[0])),
        lambda x: np.array(
            [[1 / x[1], -x[0] / x[1] ** 2, 0], [0, 1 / x[1], 1 / x[2]], [x[2] / 2 / np.sqrt(x[0]), 0, np.sqrt(x[0])]]
        ),
        np.array([0.3, 0.9, 1.7]),
        6,
    ),
    "mean": (lambda k, x: k.join(x[:-1] * x[N - 1], mean(k, x) * x[0]), lambda x: mean_jac(x), None, 2 * (N - 1) + N),
}


def kojima_of(x):
    a, b, c, d = (x[i] for i in range(4))
    return (
        3 * a * a + 2 * a * b + 2 * b * b + c + 3 * d - 6,
        2 * a * a + a + b * b + 10 * c + 2 * d - 2,
        3 * a * a + a * b + 2 * b * b + 2 * c + 9 * d - 9,
        a * a + 3 * b * b + 2 * c + 3 * d - 3,
    )


def order_jac(x):
    J = np.diag(-x[ORDER] ** 3 / x**2)
    for i in range(N):
        J[i, ORDER[i]] += 3 * x[ORDER[i]] ** 2 / x[i]
    return J


def mean(k, x):
    return (k.np.sum if isinstance(k, Jax) else k.np.sum1)(x) / N


def mean_jac(x):
    J = np.diag(np.append(np.full(N - 1, x[-1]), x[0] / N))
    J[:-1, -1] = x[:-1]
    J[-1] = x[0] / N
    J[-1, 0] += x.mean()
    return J


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("kind", [Jax, Casadi])
def test_hand_written(kind, name):
    F, jac, x, entries = MODELS[name]
    k = kind()
    x = np.random.default_rng(3).uniform(0.5, 2, N) if x is None else x
    p = perp.problem(lambda x: F(k, x), x, lower=-np.inf, jac=kind.__name__.lower())
    expected = jac(x)
    J = p.jac(x)
    assert np.abs(J.toarray() - expected).max() <= 1e-12 * max(1, np.abs(expected).max())
    assert p.nonzeros == entries
    other = x * 1.1  # no value of the first point is kept
    assert np.abs(p.jac(other).toarray() - jac(other)).max() <= 1e-12 * max(1, np.abs(jac(other)).max())


@pytest.mark.parametrize("kind", ["jax", "casadi"])
def test_a_solve(kind):
    pytest.importorskip(kind)
    r = perp.solve(lambda x: list(kojima_of(x)), np.ones(4), jac=kind, convergence_tolerance=1e-12)
    assert r.success and is_kojima_solution(r.x) and r.stats["J_F_evals"] == 0


def test_operations_of_jax():
    """Scatter, reductions, branches, loops, cumsum, dynamic indices: no entry is missing, where the truth is from jacfwd."""
    jax = pytest.importorskip("jax")
    jnp = jax.numpy

    def functions():
        yield "set", lambda x: (x**2).at[1:3].set(x[5:7] ** 3), 6
        yield "add", lambda x: (x**2).at[jnp.array([0, 0, 3])].add(x[3:6]), 9
        yield "where", lambda x: jnp.where(x > 1, x[::-1], x**2), 12
        yield "max", lambda x: jnp.maximum(x, 2 * jnp.roll(x, 1)), 12
        yield "blocks", lambda x: jnp.sum(x.reshape(3, 2) ** 2, axis=1).repeat(2) * x, 12
        yield "outer", lambda x: jnp.array([x[0] * x[1]] * 6), 12
        yield "loop", lambda x: jax.lax.fori_loop(0, 3, lambda k, y: y * x, x), 36
        yield "cumsum", lambda x: jnp.cumsum(x**2), 36
        yield "index", lambda x: x[jnp.argmax(x)] + x, 36
        yield "jit", lambda x: jax.jit(lambda y: y**2)(x) + jnp.linalg.norm(x[:2]), 6 * 3 - 2
        yield "constant", lambda x: jnp.ones(6), 0
        yield "pad", lambda x: jnp.pad(x[1:] ** 2, (0, 1)), 5
        yield "product of matrices", lambda x: (x.reshape(2, 3).T @ jnp.eye(2)).ravel() ** 2, 6

    x = np.array([0.5, 2.0, 0.9, 1.4, 0.3, 1.1])
    for name, F, most in functions():
        with jax.enable_x64(True) if hasattr(jax, "enable_x64") else jax.experimental.enable_x64():
            truth = np.asarray(jax.jacfwd(F)(x))
        p = perp.problem(F, x, lower=-np.inf, jac="jax")
        assert np.allclose(p.jac(x).toarray(), truth, atol=1e-14, rtol=0), name
        assert p.nonzeros <= most, (name, p.nonzeros)


def test_a_large_sparse_one():
    """2000 variables: three groups of columns, not 2000."""
    jax = pytest.importorskip("jax")
    n = 2000
    F = lambda x: (2 * x - 1e-3).at[1:].add(-x[:-1]).at[:-1].add(-x[1:])
    p = perp.problem(F, np.zeros(n), upper=5, jac="jax")
    assert p.nonzeros == 3 * n - 2
    from perp._derivatives import colours

    assert colours(sparse.csc_matrix(sparse.diags([1, 1, 1], [-1, 0, 1], shape=(n, n)))).max() == 2
    assert p.solve().success


def test_the_setting_of_jax_stays_and_float32_is_told():
    jax = pytest.importorskip("jax")
    before = jax.config.jax_enable_x64
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        r = perp.solve(lambda x: x**3 - 8, np.ones(2), jac="jax", convergence_tolerance=1e-13)
    assert r.success and jax.config.jax_enable_x64 == before
    with pytest.warns(perp.Float32Warning, match="float32"):
        perp.problem(lambda x: x - jax.numpy.ones(2, "float32") / 3, np.ones(2), jac="jax")


@pytest.mark.parametrize("kind", ["jax", "casadi"])
def test_a_wrong_number_of_entries_is_refused(kind):
    pytest.importorskip(kind)
    with pytest.raises(ValueError, match="^F: returned"):
        perp.problem(lambda x: x[:2], np.ones(3), jac=kind)


def test_a_package_that_is_missing_is_named():
    code = (
        "import sys; sys.modules['jax'] = sys.modules['casadi'] = None\nimport numpy as np, perp\nfor kind in ('jax', 'casadi'):\n"
        "    try: perp.solve(lambda x: x, np.ones(1), jac=kind)\n    except ModuleNotFoundError as e: print(e)"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert out.splitlines() == [f"jac: '{kind}' needs the package {kind}, which is not installed" for kind in ("jax", "casadi")]


def test_the_page():
    """The examples of docs/python-derivatives.md, in turn."""
    pytest.importorskip("jax")
    pytest.importorskip("casadi")
    run_examples("docs/python-derivatives.md")
