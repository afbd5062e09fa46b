"""Inequalities that define properties, and a sampled search for sets that break one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from ratt_opt._validation import check_integer
from ratt_opt.setfunctions.base import finite_values

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.setfunctions.base import SetFunction

__all__ = ["TRIALS", "NotFound", "Violation", "sample", "slack_of"]

Sets = TypeVar("Sets", "BoolArray", "IntArray")

INEQUALITIES = {
    "normalised": "f({}) = 0",
    "non-negative": "f(A) >= 0",
    "non-decreasing": "f(A | B) >= f(A)",
    "submodular": "f(A) + f(B) >= f(A | B) + f(A & B)",
    "modular": "f(A) + f(B) = f(A | B) + f(A & B)",
    "subadditive": "f(A) + f(B) >= f(A | B)",
}
TRIALS = 20_000
"""Default pairs of sets tried: half a second for a criterion of 120 elements and 15 targets."""
BATCH = 2_000
"""Pairs evaluated at once: bounds the memory, a membership row a pair."""
CLIMBS = 50
"""Most steps from the worst pair found, each to its best neighbour; it ends earlier where no neighbour is worse."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Violation:
    """Sets ``a`` and ``b`` that break ``inequality`` by ``-slack > tolerance`` (an absolute number).

    ``slack`` is the left side less the right one; for an equation, minus the absolute difference.
    """

    rule: str
    a: tuple[int, ...]
    b: tuple[int, ...]
    slack: float
    tolerance: float

    @property
    def inequality(self) -> str:
        """What the sets break."""
        return INEQUALITIES[self.rule]

    @property
    def sets(self) -> tuple[tuple[int, ...], ...]:
        """``a``, ``b``, their union and their intersection."""
        first, second = set(self.a), set(self.b)
        return self.a, self.b, tuple(sorted(first | second)), tuple(sorted(first & second))

    @property
    def elements(self) -> tuple[int, ...]:
        """Elements in exactly one of the two sets."""
        return tuple(sorted(set(self.a) ^ set(self.b)))


@dataclass(frozen=True, slots=True, kw_only=True)
class NotFound:
    """No violation found in ``trials`` pairs of sets; not a proof. ``smallest_slack``: the closest any came. False."""

    rule: str
    trials: int
    smallest_slack: float
    tolerance: float

    def __bool__(self) -> bool:
        """``False``: nothing was found."""
        return False


def slack_of(value: Callable[[Sets], FloatArray], rule: str, a: Sets, b: Sets) -> FloatArray:
    """(K,) slack of one inequality for K pairs of sets, as rows of membership (K, n) or as masks (K,) of a table."""
    first = finite_values(value(a))
    if rule == "non-negative":
        return first
    union = finite_values(value(a | b))
    if rule == "non-decreasing":
        return np.asarray(union - first)
    both = first + finite_values(value(b)) - union
    if rule == "subadditive":
        return np.asarray(both)
    slack = both - finite_values(value(a & b))
    return np.asarray(-np.abs(slack) if rule == "modular" else slack)


def sample(f: SetFunction, rule: str, tolerance: float, *, trials: int, seed: int) -> Violation | NotFound:
    """Try random pairs of sets of every size, then climb from the worst one by adding or removing elements.

    ``tolerance`` is relative to the largest absolute value seen.
    """
    trials = check_integer("trials", trials, low=1)
    rng = np.random.default_rng(seed)
    worst, scale, seen = np.inf, 0.0, 0
    pair = np.zeros((2, f.n), dtype=np.bool_)
    while seen < trials:
        a, b = _random_pairs(rng, rule, f.n, min(BATCH, trials - seen))
        slack = slack_of(f.evaluate, rule, a, b)
        scale = max(scale, float(np.abs(f.evaluate(a | b)).max()))
        seen += len(a)
        k = int(slack.argmin())
        if slack[k] < worst:
            worst, pair = float(slack[k]), np.stack([a[k], b[k]])
    worst, pair, climbed = _climb(f, rule, worst, pair)
    limit = tolerance * scale
    alone = float(slack_of(f.evaluate, rule, pair[:1], pair[1:])[0])  # afresh: a batch may round in another way
    if alone >= -limit:
        return NotFound(rule=rule, trials=seen + climbed, smallest_slack=worst, tolerance=limit)
    first, second = (tuple(np.flatnonzero(members).tolist()) for members in pair)
    return Violation(rule=rule, a=first, b=second, slack=alone, tolerance=limit)


def _random_pairs(rng: np.random.Generator, rule: str, n: int, count: int) -> tuple[BoolArray, BoolArray]:
    """Sets of uniform density; two neighbours of a common set, except for subadditivity."""
    density = rng.random((count, 1)) ** 2
    base = rng.random((count, n)) < density
    if rule == "subadditive":
        return base, rng.random((count, n)) < rng.random((count, 1))
    rows = np.arange(count)
    x, y = rng.integers(0, n, (2, count))
    base[rows, x] = base[rows, y] = False
    a, b = base.copy(), base.copy()
    if rule != "non-decreasing":
        a[rows, x] = True
    b[rows, y] = True
    return a, b


def _climb(f: SetFunction, rule: str, worst: float, pair: BoolArray) -> tuple[float, BoolArray, int]:
    """Flip one element in both sets at a time while that lowers the slack."""
    same = np.flatnonzero(pair[0] == pair[1])
    tried = 0
    for _ in range(CLIMBS if len(same) else 0):
        flips = np.zeros((len(same), f.n), dtype=np.bool_)
        flips[np.arange(len(same)), same] = True
        slack = slack_of(f.evaluate, rule, pair[0] ^ flips, pair[1] ^ flips)
        tried += len(same)
        k = int(slack.argmin())
        if slack[k] >= worst:
            break
        worst, pair = float(slack[k]), pair ^ flips[k]
    return worst, pair, tried
