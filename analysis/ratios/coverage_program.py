"""Bad instances for teams too large for a program over all set functions: coverage functions alone.

A weighted coverage function of few kinds of items has a weight for each instead of a value for each subset, so the
program of a whole team of seven robots is small. Its optimum is the ratio of an instance, hence no less than the worst
ratio, and for three and four robots left the same as that of the full program if both were computed.
"""

from __future__ import annotations

from contextlib import suppress
from fractions import Fraction
from itertools import combinations
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import readonly
from ratt_opt.errors import ProofError
from ratt_opt.worst_ratio.program import Inequality, RatioProgram, rational_points
from ratt_opt.worst_ratio.ratio_search import skeleton
from ratt_opt.worst_ratio.witness import RatioQuestion, RatioWitness, replay, scaled_values

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

__all__ = ["coverage_instance"]

Item = int
"""Bit mask of the elements that cover it, named as in ``ratio_search.py``: RATT's, then the other plan's."""


def coverage_instance(size: int, swapped: int, curvature: Fraction) -> tuple[Fraction, RatioWitness] | None:
    """Return a bad coverage function for ``N = g + p``, ``alpha_s = p``, no link cut, with its ratio; replayed.

    Parameters
    ----------
    size, swapped : g robots are left and p blinded, which are the first greedy robots; N is at most 7
    curvature : k in [0, 1)

    ``None`` if the solver's solution does not verify without rounding.
    """
    n = size + swapped
    question = RatioQuestion(n_robots=n, alpha_s=swapped, alpha_c=0, curvature=curvature, family="submodular")
    items = list(dict.fromkeys(_items(n, swapped)))
    program = RatioProgram(1 + len(items))
    program.add(_rows(question, items))
    claimed = program.solve(inf)
    if claimed is None:
        return None
    found: list[tuple[Fraction, RatioWitness]] = []
    for point in rational_points(program, claimed):
        weights = scaled_values([max(weight, Fraction(0)) for weight in point[1:]])
        if weights is None or not weights.any():
            continue
        masks = np.arange(4**n)
        values = sum(int(w) * (masks & item != 0) for item, w in zip(items, weights, strict=True) if w)
        witness = question.witness(readonly(np.asarray(values, dtype=np.int64)))
        with suppress(ProofError):  # rounded weights may exceed the curvature, or break a tie
            found.append((replay(witness), witness))
    return min(found, key=lambda item: item[0], default=None)


def _items(n: int, bait: int) -> Iterator[Item]:
    """Alone; an element of each plan; all bait with some greedy robots and at most one element of the other plan."""
    together = (1 << bait) - 1
    left = range(2 * bait, n)
    yield from (1 << e for e in range(2 * n))
    yield from (1 << u | 1 << n + o for u in range(n) for o in range(n))
    for others in (0, *(1 << n + o for o in range(n))):
        yield together | others
        yield from (together | 1 << v | others for v in left)
        yield from (1 << r | 1 << v | others for r in range(bait, 2 * bait) for v in left)
    yield from (together | 1 << v | 1 << w for v, w in combinations(left, 2))


def _rows(question: RatioQuestion, items: Sequence[Item]) -> Iterator[Inequality]:
    """Curvature, RATT's choices, what is left once the first greedy robots are blinded, the other plan's sets."""
    n, bait, kept = question.n_robots, question.alpha_s, 1 - question.curvature

    def f(mask: int) -> dict[int, Fraction]:
        return {1 + i: Fraction(1) for i, item in enumerate(items) if item & mask}

    for e in range(2 * n):
        yield Inequality(_difference({1 + items.index(1 << e): Fraction(1)}, f(1 << e), kept))
    for larger, smaller in skeleton(n, bait, 0, bait).comparisons:
        yield Inequality(_difference(f(larger), f(smaller)))
    left = sum(1 << i for i in range(n) if not bait <= i < 2 * bait)
    yield Inequality(_difference({0: Fraction(1)}, f(left)))
    for group in combinations(range(n), n - bait):
        yield Inequality(f(sum(1 << n + i for i in group)), Fraction(1))


def _difference(
    first: dict[int, Fraction], second: dict[int, Fraction], times: Fraction = Fraction(1)
) -> dict[int, Fraction]:
    total = dict(first)
    for column, value in second.items():
        total[column] = total.get(column, Fraction(0)) - times * value
    return {column: value for column, value in total.items() if value}
