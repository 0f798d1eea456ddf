# SPDX-License-Identifier: Apache-2.0
"""Finite games. Equilibria by hand or published, all regrets computed here; support enumeration as another method for games that
are not degenerate. Games of Gambit's repository are compared with pygambit where GAMBIT_GAMES names a folder of .nfg files and
pygambit is installed."""

import itertools
import os
from fractions import Fraction as Q
from pathlib import Path

import numpy as np
import perp
import pytest
from pages import run_examples


def regret(A, B, x, y):
    """In fractions: 0 exactly at equilibria."""
    A, B = (np.array([[Q(one) for one in row] for row in M], dtype=object) for M in (A, B))
    x, y = np.array(x, dtype=object), np.array(y, dtype=object)
    assert sum(x) == 1 == sum(y) and min(x) >= 0 and min(y) >= 0
    return max(max(A @ y) - x @ A @ y, max(x @ B) - x @ B @ y)


def points(found):
    return {(tuple(x), tuple(y)) for x, y in found.extreme}


def test_battle_of_the_sexes():
    found = perp.bimatrix([[2, 0], [0, 1]], [[1, 0], [0, 2]])
    assert points(found) == {((1, 0), (1, 0)), ((0, 1), (0, 1)), ((Q(2, 3), Q(1, 3)), (Q(1, 3), Q(2, 3)))}
    assert len(found.subsets) == len(found.components) == 3 and all(one.single for one in found.subsets)
    assert any(np.allclose(x, [2 / 3, 1 / 3]) for x, _ in found.arrays)


def test_rock_paper_scissors():
    A = np.array([[0, -1, 1], [1, 0, -1], [-1, 1, 0]])
    third = (Q(1, 3),) * 3
    assert points(perp.bimatrix(A, -A)) == {(third, third)}


def test_von_stengel():
    """von Stengel 2002, "Computing equilibria for two-person games", (2.9): three equilibria."""
    found = perp.bimatrix([[3, 3], [2, 5], [0, 6]], [[3, 2], [2, 6], [3, 1]])
    assert points(found) == {
        ((1, 0, 0), (1, 0)),
        ((Q(4, 5), Q(1, 5), 0), (Q(2, 3), Q(1, 3))),
        ((0, Q(1, 3), Q(2, 3)), (Q(1, 3), Q(2, 3))),
    }


def test_a_degenerate_game():
    """The same with B_12 = 3: the first row and any y with y_1 >= 2/3 are equilibria, a segment, and the third point stays."""
    found = perp.bimatrix([[3, 3], [2, 5], [0, 6]], [[3, 3], [2, 6], [3, 1]])
    segment = {((1, 0, 0), (1, 0)), ((1, 0, 0), (Q(2, 3), Q(1, 3)))}
    assert points(found) == segment | {((0, Q(1, 3), Q(2, 3)), (Q(1, 3), Q(2, 3)))}
    assert sorted((len(one.first), len(one.second)) for one in found.subsets) == [(1, 1), (1, 2)]
    assert len(found.components) == 2


def test_a_game_of_nothing():
    """Every pair of strategies is an equilibrium: one subset, with all pure strategies as vertices."""
    found = perp.bimatrix(np.zeros((3, 4)), np.zeros((3, 4)))
    (subset,) = found.subsets
    assert (len(subset.first), len(subset.second)) == (3, 4)


def test_subsets_that_meet():
    """A = B = ((1, 1), (1, 0)): the best responses to row 1 are both columns, and so the other way: an L of two segments."""
    found = perp.bimatrix([[1, 1], [1, 0]], [[1, 1], [1, 0]])
    assert points(found) == {((1, 0), (1, 0)), ((1, 0), (0, 1)), ((0, 1), (1, 0))}
    assert len(found.subsets) == 2 and len(found.components) == 1


def by_supports(A, B):
    """Of games that are not degenerate: supports of one size, linear equations."""
    m, n = A.shape
    found = set()
    for k in range(1, min(m, n) + 1):
        for rows, columns in itertools.product(itertools.combinations(range(m), k), itertools.combinations(range(n), k)):
            parts = []
            for M in (A[np.ix_(rows, columns)], B[np.ix_(rows, columns)].T):
                system = np.block([[M, -np.ones((k, 1))], [np.ones((1, k)), np.zeros((1, 1))]])
                if abs(np.linalg.det(system)) < 1e-9:
                    break
                parts.append(np.linalg.solve(system, np.append(np.zeros(k), 1)))
            if len(parts) < 2 or min(parts[0][:k].min(), parts[1][:k].min()) < -1e-12:
                continue
            x, y = np.zeros(m), np.zeros(n)
            x[list(rows)], y[list(columns)] = parts[1][:k], parts[0][:k]
            if (A @ y).max() <= parts[0][k] + 1e-9 and (x @ B).max() <= parts[1][k] + 1e-9:
                found.add((tuple(x.round(6)), tuple(y.round(6))))
    return found


def test_against_support_enumeration():
    """40 games with payoffs of three digits, up to 5 x 5; without degeneracy the number of equilibria is odd (Wilson 1971)."""
    for seed in range(40):
        random = np.random.default_rng(seed)
        m, n = random.integers(2, 6, size=2)
        A, B = random.integers(0, 1000, size=(2, m, n))
        found = perp.bimatrix(A, B)
        assert {(tuple(x.round(6)), tuple(y.round(6))) for x, y in found.arrays} == by_supports(A.astype(float), B.astype(float))
        assert len(found.extreme) % 2 == 1


def test_degenerate_games_have_no_regret():
    """100 games with payoffs 0, 1 and 2: all vertices, and mixtures of those of a subset; and no pure equilibrium is missing."""
    for seed in range(100):
        random = np.random.default_rng(seed)
        m, n = random.integers(2, 5, size=2)
        A, B = random.integers(0, 3, size=(2, m, n))
        found = perp.bimatrix(A, B)
        assert found.extreme and all(regret(A, B, x, y) == 0 for x, y in found.extreme)
        for one in found.subsets:
            x = [sum(entries) / Q(len(one.first)) for entries in zip(*one.first)]
            y = [sum(entries) / Q(len(one.second)) for entries in zip(*one.second)]
            assert regret(A, B, x, y) == 0
        assert sum(len(group) for group in found.components) == len(found.subsets)
        for i, j in itertools.product(range(m), range(n)):
            if A[i, j] == A[:, j].max() and B[i, j] == B[i].max():
                pure = tuple(Q(int(k == i)) for k in range(m)), tuple(Q(int(k == j)) for k in range(n))
                assert pure in points(found)


def test_fractions_and_refusals():
    third = Q(1, 3)
    assert points(perp.bimatrix([[third, 0], [0, third]], [[0, third], [third, 0]])) == {((Q(1, 2),) * 2, (Q(1, 2),) * 2)}
    for A, B, words in (
        ([[1, 2]], [[1], [2]], "^B: has shape"),
        ([1, 2], [1, 2], "^A: has shape"),
        ([[np.inf]], [[0]], "^A: has an entry"),
        ([[0]], [[np.nan]], "^B: has an entry"),
    ):
        with pytest.raises(ValueError, match=words):
            perp.bimatrix(A, B)


# More players


def volunteers():
    """Diekmann 1985, three players: 2 for all if somebody volunteers, which costs 1."""
    shape = (2, 2, 2)
    payoffs = [np.zeros(shape) for _ in range(3)]
    for profile in itertools.product((0, 1), repeat=3):
        for i in range(3):
            payoffs[i][profile] = 2 * (0 in profile) - (profile[i] == 0)
    return payoffs


def test_three_players():
    """Pure: one volunteers. Mixed: two stay mixed only with (1 - p)^2 = 1/2 for all, or (1 - p) = 1/2 for two, the third idle."""
    found = perp.finite_game(volunteers(), starts=40)
    pure = [one for one in found if all(x.max() == 1 for x in one.strategies)]
    assert len(pure) == 3 and all(one.regret <= 1e-8 for one in found)
    p = 1 - np.sqrt(0.5)
    assert any(all(abs(x[0] - p) < 1e-7 for x in one.strategies) for one in found)
    assert any(np.allclose(one.payoffs, 1, atol=1e-7) for one in found if one not in pure)


def test_what_is_found_is_an_equilibrium():
    """Ten random games 3 x 2 x 3 and ten of four players: at least one each, and the regret computed here by einsum."""
    for seed in range(20):
        random = np.random.default_rng(seed)
        shape = (3, 2, 3) if seed < 10 else (2, 2, 2, 2)
        u = [random.normal(size=shape) for _ in shape]
        found = perp.finite_game(u)
        assert found, seed
        letters = "abcd"[: len(shape)]
        for one in found:
            for i, payoff in enumerate(u):
                operands = [one.strategies[k] for k in range(len(shape)) if k != i]
                rest = ",".join(letters[k] for k in range(len(shape)) if k != i)
                answer = np.einsum(f"{letters},{rest}->{letters[i]}", payoff, *operands)
                assert answer.max() - answer @ one.strategies[i] <= 1e-7
                assert abs(answer @ one.strategies[i] - one.payoffs[i]) < 1e-9


def test_two_players_both_ways():
    """What the path search finds is among all, for games that are not degenerate."""
    for seed in range(10):
        A, B = np.random.default_rng(seed).normal(size=(2, 4, 4))
        every = [np.concatenate(one) for one in perp.bimatrix(A, B).arrays]
        found = perp.finite_game([A, B])
        assert found and all(min(np.abs(np.concatenate(one.strategies) - e).max() for e in every) < 1e-6 for one in found)


def test_bad_payoffs_are_refused():
    with pytest.raises(ValueError, match="^payoffs: must have one array for each player"):
        perp.finite_game([np.zeros((2, 2)), np.zeros((2, 3))])


# Files


def test_a_file_of_payoffs(tmp_path):
    file = tmp_path / "a.nfg"
    file.write_text('NFG 1 R "Two by three" { "Ann" "Bob" }\n{ { "u" "d" } { "l" "m" "r" } }\n"a comment"\n1 1/2 2 0 3 0 4 0 5 0 6 -1.5\n')
    game = perp.read_nfg(file)
    assert game.title == "Two by three" and game.players == ["Ann", "Bob"]
    assert game.payoffs[0].tolist() == [[1, 3, 5], [2, 4, 6]]
    assert game.payoffs[1][0, 0] == Q(1, 2) and game.payoffs[1][1, 2] == Q(-3, 2)
    # Row d is better everywhere, and there the columns l and m are equally good.
    assert points(perp.bimatrix(*game.payoffs)) == {((0, 1), (1, 0, 0)), ((0, 1), (0, 1, 0))}


def test_a_file_of_outcomes(tmp_path):
    file = tmp_path / "b.nfg"
    file.write_text('NFG 1 R "b" { "1" "2" } { 2 2 }\n{ { "win, lose" 1, -1 } { "" -1 1 } }\n1 2 2 0\n')
    first, second = perp.read_nfg(file).payoffs
    assert first.tolist() == [[1, -1], [-1, 0]] and second.tolist() == [[-1, 1], [1, 0]]


@pytest.mark.parametrize(
    "text, why",
    [
        ("EFG 2 R", "EFG where NFG"),
        ('NFG 1 R "t" { "a" "b" } { 2 2 } 1 2 3', "has 3 payoffs, and must have 8"),
        ('NFG 1 R "t" { "a" "b" } { 2 2 ', "ends where"),
        ('NFG 1 R "t" { "a" } { 1 } x', "x is no number"),
        ('NFG 1 R "t" { "a" } { 1 } { { "o" 1 } } 2', "outcome that does not exist"),
    ],
)
def test_files_that_make_no_sense(tmp_path, text, why):
    file = tmp_path / "c.nfg"
    file.write_text(text)
    with pytest.raises(perp.FileError, match=why):
        perp.read_nfg(file)


def test_games_of_gambit():
    """Extreme equilibria are those of pygambit 17's enummixed; for more players every regret is small."""
    folder = os.environ.get("GAMBIT_GAMES")
    if not folder:
        pytest.skip("GAMBIT_GAMES does not name a folder of .nfg files")
    gambit = pytest.importorskip("pygambit")
    compared = 0
    for file in sorted(Path(folder).rglob("*.nfg")):
        game, theirs = perp.read_nfg(file), gambit.read_nfg(str(file))
        if len(game.players) != 2:
            found = perp.finite_game(game.payoffs, starts=5)
            assert all(one.regret <= 1e-6 * max(1, float(np.abs(np.array(game.payoffs, float)).max())) for one in found)
            continue
        answer = gambit.nash.enummixed_solve(theirs, rational=True)
        expected = set()
        for one in answer.equilibria:
            expected.add(tuple(tuple(Q(int(p.numerator), int(p.denominator)) for _, p in mixed) for mixed in one))
        assert points(perp.bimatrix(*game.payoffs)) == expected, file.name
        compared += 1
    assert compared


def test_the_page():
    """The examples of docs/games.md, in turn."""
    run_examples("docs/games.md")
