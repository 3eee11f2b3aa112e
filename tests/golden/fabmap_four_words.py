# SPDX-License-Identifier: BSD-3-Clause
"""The numbers of tests/frontend/fabmap/observation_model_test.cpp, in exact fractions and straight from the definitions.

    python3 tests/golden/fabmap_four_words.py
"""
from fractions import Fraction as F
from math import log

D, FALSE = F(39, 100), F(1, 100)  # p(z=1|e=1), p(z=1|e=0)
# word: parent, p(z=1), p(z=1|parent), p(z=1|no parent)
TREE = {0: (None, F(3, 10), F(3, 10), F(3, 10)), 1: (0, F(1, 5), F(2, 5), F(4, 35)),
        2: (0, F(1, 4), F(1, 10), F(11, 35)), 3: (2, F(1, 10), F(3, 10), F(1, 30))}


def p_z_given_e(z, e):
    p = D if e else FALSE
    return p if z else 1 - p


def p_present(q, visits):
    """Bayes' rule, visit by visit; `visits` are the sets of words seen."""
    p = (TREE[q][1] - FALSE) / (D - FALSE)
    for words in visits:
        here, absent = p * p_z_given_e(q in words, True), (1 - p) * p_z_given_e(q in words, False)
        p = here / (here + absent)
    return p


def p_z(q, z, parent_z, e):
    """p(z | e, z_parent) is proportional to p(z | e) p(z | z_parent) / p(z), normalised over z."""
    def weight(value):
        _, p, p1, p0 = TREE[q]
        marginal = p if value else 1 - p
        conditional = p1 if parent_z else p0
        return p_z_given_e(value, e) * (conditional if value else 1 - conditional) / marginal
    return weight(z) / (weight(True) + weight(False))


def log_likelihood(words, visits):
    total = 0.0
    for q, (parent, _, _, _) in TREE.items():
        pe = p_present(q, visits)
        parent_z = parent is not None and parent in words
        total += log(p_z(q, q in words, parent_z, True) * pe + p_z(q, q in words, parent_z, False) * (1 - pe))
    return total


for name, words, visits in [("new place", {0, 1}, []), ("one visit", {0, 1}, [{0, 2}]), ("two visits", {0, 1}, [{0, 2}, {1, 2}]),
                            ("the same image", {0, 2}, [{0, 2}]), ("no words", set(), [{0, 2}])]:
    print(f"{name}: {log_likelihood(words, visits):.15f}")
