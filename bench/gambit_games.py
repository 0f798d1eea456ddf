# SPDX-License-Identifier: Apache-2.0
"""The finite games of Gambit's repository beside pygambit (PyPI, 17): `python bench/gambit_games.py FOLDER`, FOLDER with .nfg
files, perp and pygambit to be imported.

Two players: the extreme equilibria of perp.bimatrix and of enummixed_solve, both in exact fractions, are compared as sets. More
players: perp.finite_game from 20 starts; every pure equilibrium of enumpure_solve should be among what it finds. CPU seconds."""

import sys
import time
from fractions import Fraction
from pathlib import Path

import numpy as np

import perp

try:
    import pygambit
except ImportError:
    sys.exit("bench/gambit_games.py needs pygambit (PyPI)")


def timed(run):
    begin = time.process_time()
    answer = run()
    return time.process_time() - begin, answer


def fractions(equilibria):
    return {tuple(tuple(Fraction(int(p.numerator), int(p.denominator)) for _, p in mixed) for mixed in one) for one in equilibria}


def main(folder):
    same, points, ours, theirs = 0, 0, [], []
    print("| game | sizes | found | largest regret | pure ones found, of | s |")
    print("|---|---|---|---|---|---|")
    files = sorted(Path(folder).rglob("*.nfg"))
    for file in files:
        game, other = perp.read_nfg(file), pygambit.read_nfg(str(file))
        if len(game.players) == 2:
            seconds, found = timed(lambda: perp.bimatrix(*game.payoffs))
            ours.append(seconds)
            seconds, answer = timed(lambda: pygambit.nash.enummixed_solve(other, rational=True))
            theirs.append(seconds)
            mine, expected = {(tuple(x), tuple(y)) for x, y in found.extreme}, fractions(answer.equilibria)
            same, points = same + (mine == expected), points + len(expected)
            if mine != expected:
                print(f"{file.name}: {len(mine)} here, {len(expected)} there", file=sys.stderr)
            continue
        seconds, found = timed(lambda: perp.finite_game(game.payoffs))
        pure = fractions(pygambit.nash.enumpure_solve(other).equilibria)
        mine = {tuple(tuple(map(Fraction, np.round(x, 9))) for x in one.strategies) for one in found}
        regret = max((one.regret for one in found), default=np.nan)
        sizes = " x ".join(map(str, game.payoffs[0].shape))
        row = file.stem, sizes, len(found), f"{regret:.0e}", f"{len(pure & mine)}, {len(pure)}", f"{seconds:.2f}"
        print("| " + " | ".join(map(str, row)) + " |")
    print(f"\n{len(files)} files; {len(ours)} of two players: {same} with the same extreme equilibria, {points} in all;")
    print(f"{sum(ours):.2f} s here, {sum(theirs):.2f} s there; largest {max(ours):.2f} s and {max(theirs):.2f} s")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]) if len(sys.argv) == 2 else __doc__)
