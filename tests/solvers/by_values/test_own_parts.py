"""Sums of one's own whose methods do not answer as asked: one line that names the method, the part and the rule."""

import re

import numpy as np
import pytest

import ratt_opt as ro

DISTANCE = abs(np.arange(6.0)[:, None] - np.arange(6.0))


class Median(ro.SumFunction):
    """The class of the guide, as long as nothing in it is replaced."""

    is_submodular = is_non_decreasing = True

    def __init__(self):
        self.saved = np.tile(DISTANCE.max() - DISTANCE, (3, 1))
        super().__init__(len(self.saved), parts=6)

    def touching(self, part):
        return np.flatnonzero(self.saved[:, part])

    def part_values(self, part, membership):
        return (membership * self.saved[self.touching(part), part]).max(axis=1, initial=0.0)


FAULTS = {
    "no number": ("part_values", lambda *_: None, "part_values(0, membership) must be an array of one number"),
    "one number": ("part_values", lambda *_: 1.0, "got float of shape ()"),
    "a column": ("part_values", lambda _, __, m: np.ones((len(m), 1)), "got float64 array of shape (2, 1)"),
    "one too many": ("part_values", lambda _, __, m: np.ones(len(m) + 1), "got float64 array of shape (3,)"),
    "complex": ("part_values", lambda _, __, m: np.ones(len(m)) + 0j, "got complex128 array"),
    "nan": ("part_values", lambda _, __, m: np.full(len(m), np.nan), "f must have finite values; got nan"),
    "a mask": ("touching", lambda f, j: f.saved[:, j] > 0, "touching(0) must be an array of ascending element indices"),
    "too large": ("touching", lambda *_: np.array([0, 18]), "in [0, 17], each once; got [0, 18]"),
    "twice": ("touching", lambda *_: np.array([0, 1, 1]), "each once; got [0, 1, 1]"),
    "descending": ("touching", lambda *_: np.array([2, 1]), "got [2, 1]"),
    "nothing": ("touching", lambda *_: None, "got object array of shape ()"),
    "no start": ("__init__", lambda _: None, "objective must call super().__init__(n, parts)"),
}


def choose(f, lost=1):
    return ro.Problem(f, np.repeat(np.arange(3), 6), None, lost, 0)


@pytest.mark.parametrize("fault", FAULTS)
def test_a_method_that_does_not_answer_as_asked_is_named(fault):
    method, wrong, text = FAULTS[fault]
    f = type("Wrong", (Median,), {method: wrong})
    with pytest.raises(ro.InputError, match=re.escape(text)):
        ro.solve_maxmin(choose(f()))


@pytest.mark.parametrize("n", [18.0, lambda _: 18])
def test_a_size_that_is_no_integer_is_refused(n):
    f = type("Wrong", (Median,), {"n": n})()
    with pytest.raises(ro.InputError, match=r"objective\.n must be an integer"):
        choose(f)


def test_plans_that_are_enumerated_count_as_nodes():
    problem = choose(Median())
    assert ro.solve_maxmin(problem, max_nodes=1).stop is ro.Stop.NODES
    assert ro.solve_maxmin(problem, max_nodes=216).stop is ro.Stop.EXHAUSTED


def test_parts_may_be_negative():
    """What a part is worth without elements is subtracted everywhere; a search of large parts once failed on it."""
    shifted = type("Shifted", (Median,), {"part_values": lambda f, j, m: Median.part_values(f, j, m) - 5.0})
    plain, less = (ro.solve_maxmin(choose(f()), max_nodes=9) for f in (Median, shifted))
    assert less.lower == pytest.approx(plain.lower - 30.0)
    assert less.upper >= less.lower
    rng = np.random.default_rng(0)
    bound = shifted().overestimator(0, rng.random(len(shifted().touching(0))))
    sets = rng.random((50, len(bound.gains))) < 0.3
    assert (bound.constant + sets @ bound.gains >= shifted().part_values(0, sets) - 1e-12).all()
