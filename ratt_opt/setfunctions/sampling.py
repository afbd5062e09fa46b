"""Inequalities that define properties, and a sampled search for sets that break one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from ratt_opt._validation import check_integer
from ratt_opt.budget import Budget, OutOfBudget, Stop
from ratt_opt.setfunctions.base import finite_values
from ratt_opt.setfunctions.metered import Metered
from ratt_opt.setfunctions.property_params import DEFAULT

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.setfunctions.base import SetFunction
    from ratt_opt.setfunctions.property_params import PropertyParams

__all__ = ["INEQUALITIES", "NotFound", "Violation", "sample", "slack_of"]

Sets = TypeVar("Sets", "BoolArray", "IntArray")

INEQUALITIES = {
    "normalised": "f({}) = 0",
    "non-negative": "f(A) >= 0",
    "non-decreasing": "f(A | B) >= f(A)",
    "submodular": "f(A) + f(B) >= f(A | B) + f(A & B)",
    "modular": "f(A) + f(B) = f(A | B) + f(A & B)",
    "subadditive": "f(A) + f(B) >= f(A | B)",
}


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
        """Inequality that the sets violate."""
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
    """No violation found in ``trials`` pairs of sets. It is not a proof; its truth value is False.

    ``smallest_slack`` : the closest any came. ``stop`` : ``HEURISTIC`` if all ``trials`` pairs were tried.
    """

    rule: str
    trials: int
    smallest_slack: float
    tolerance: float
    stop: Stop = Stop.HEURISTIC

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


@dataclass(slots=True)
class _Worst:
    """The pair (2, n) with the smallest slack so far, how many were tried, and the largest value among them."""

    pair: BoolArray
    slack: float = np.inf
    scale: float = 0.0
    tried: int = 0

    def offer(self, a: BoolArray, b: BoolArray, slack: FloatArray) -> bool:
        """Keep the worst of some pairs if it is worse; return whether it is."""
        self.tried += len(a)
        k = int(slack.argmin())
        if better := bool(slack[k] < self.slack):
            self.slack, self.pair = float(slack[k]), np.stack([a[k], b[k]])
        return better


def sample(
    f: SetFunction,
    rule: str,
    tolerance: float,
    *,
    rounding: float,
    trials: int,
    seed: int,
    budget: Budget | None = None,
    params: PropertyParams = DEFAULT,
) -> Violation | NotFound:
    """Try random pairs of sets of every size, then climb from the worst one by adding or removing elements.

    ``tolerance`` is relative to the largest absolute value seen, ``rounding`` is absolute: a slack may be off by it.
    A spent ``budget`` ends it early.
    """
    trials = check_integer("trials", trials, low=1)
    own, worst, stop = budget or Budget(), _Worst(np.zeros((2, f.n), dtype=np.bool_)), Stop.HEURISTIC
    metered, rng = Metered(f, own), np.random.default_rng(seed)
    try:
        batch = 1 if own.seconds_left < np.inf else params.batch  # a first few pairs before time is up
        while worst.tried < trials:
            a, b = _random_pairs(rng, rule, f.n, min(batch, trials - worst.tried))
            worst.offer(a, b, slack_of(metered.evaluate, rule, a, b))
            worst.scale = max(worst.scale, float(np.abs(metered.evaluate(a | b)).max()))
            batch = min(2 * batch, params.batch)
        _climb(metered, rule, worst, params)
    except OutOfBudget as out:
        stop = out.stop
    if not worst.tried:
        return NotFound(rule=rule, trials=0, smallest_slack=np.inf, tolerance=0.0, stop=stop)
    limit = max(tolerance * worst.scale, rounding)
    alone = float(slack_of(f.evaluate, rule, *worst.pair[:, None])[0])  # afresh: a batch may round in another way
    if alone >= -limit:
        return NotFound(rule=rule, trials=worst.tried, smallest_slack=worst.slack, tolerance=limit, stop=stop)
    first, second = (tuple(np.flatnonzero(members).tolist()) for members in worst.pair)
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


def _climb(f: SetFunction, rule: str, worst: _Worst, params: PropertyParams) -> None:
    """Flip one element in both sets at a time while that lowers the slack."""
    same = np.flatnonzero(worst.pair[0] == worst.pair[1])
    better, left = bool(len(same)), params.climbs
    while better and left:
        better, left, pair = False, left - 1, worst.pair
        for start in range(0, len(same), params.batch):
            some = same[start : start + params.batch]
            flips = np.zeros((len(some), f.n), dtype=np.bool_)
            flips[np.arange(len(some)), some] = True
            a, b = pair[0] ^ flips, pair[1] ^ flips
            better = worst.offer(a, b, slack_of(f.evaluate, rule, a, b)) or better
