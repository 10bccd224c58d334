# SPDX-License-Identifier: GPL-3.0-or-later
"""Choices drawn by seed. Each has its own generator, so that one can be left out without a change to the others.
With `only`, these choices are taken and no others."""
import random


class Draw:
    def __init__(self, seed, without=(), only=None):
        self.seed, self.without, self.only = seed, set(without), only
        self.taken, self.values = [], {}

    def note(self, name):
        if name not in self.taken:
            self.taken.append(name)

    def rng(self, name):
        return random.Random(f"{self.seed} {name}")

    def drawn(self, name, chance):
        if name in self.without:
            return False
        return self.rng(name).random() < chance if self.only is None else name in self.only

    def yes(self, name, chance):
        if not self.drawn(name, chance):
            return False
        self.note(name)
        return True

    def pick(self, name, plain, others, chance=0.5):
        """`plain`, or with this chance one of the others."""
        if not self.drawn(name, chance):
            return plain
        value = self.rng(name + " value").choice(others)
        self.note(name)
        self.values[name] = value
        return value

    def described(self):
        return ", ".join(f"{n}={self.values[n]}" if n in self.values else n for n in self.taken)
