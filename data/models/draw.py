# SPDX-License-Identifier: Apache-2.0
"""Random numbers that are the same on every machine and in every version of Python."""

import random


class Draw:
    """Numbers of few digits: uniform on integers, on a grid of reals, on the items of a sequence."""

    def __init__(self, seed):
        self._random = random.Random(seed).random  # the only generator whose sequence Python promises to keep

    def integer(self, low, high):
        return low + int(self._random() * (high - low + 1))

    def real(self, low, high, digits=2):
        return round(low + (high - low) * self._random(), digits)

    def pick(self, items):
        return items[self.integer(0, len(items) - 1)]

    def chance(self, probability):
        return self._random() < probability

    def sample(self, items, count):
        """`count` different items, in their order."""
        left = list(range(len(items)))
        chosen = [left.pop(self.integer(0, len(left) - 1)) for _ in range(count)]
        return [items[i] for i in sorted(chosen)]
