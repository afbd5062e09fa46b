"""Which sizes the group with the most seeing robots can have, as far as the scores of groups of a size say.

Of each vector of prices: what groups of at most a seeing robots, c together, with x blinded ones together score at most
is a table over c and x; groups of one size more are added one by one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ratt_opt.certificates.verifier.version1.link_scores import NONE
from ratt_opt.certificates.verifier.work import tick

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.certificates.verifier.version1.link_scores import LinkScores

__all__ = ["LargestGroup", "largest_groups"]


@dataclass(frozen=True, slots=True)
class LargestGroup:
    """Robots that see and that are blinded in the group, and what it must score by each vector of prices."""

    seeing: int
    blinded: int
    need: tuple[int, ...]


def largest_groups(scores: list[LinkScores], n_blinded: int, size: int) -> list[LargestGroup]:
    """Those of fewer than ``size`` seeing robots that can be left where ``n_blinded`` robots are blinded."""
    n_seeing = len(scores[0].most) - 1 - n_blinded
    size = min(size, n_seeing + 1)
    tables, found = [list(_others(one.most, n_seeing, n_blinded, size)) for one in scores], []
    for seeing in range(size):
        for blinded in range(n_blinded + 1):
            others = [table[seeing][n_blinded - blinded] for table in tables]
            needs = [max(one.need - other, one.least) for one, other in zip(scores, others, strict=True)]
            if all(one.most[seeing + blinded] >= score for one, score in zip(scores, needs, strict=True)):
                found.append(LargestGroup(seeing, blinded, tuple(map(int, needs))))
    return found


def _others(most: list[float], n_seeing: int, n_blinded: int, size: int) -> Iterator[list[float]]:
    """For a largest group of 0, 1, ... seeing robots: what the others score at most, by blinded ones among them."""
    best = [[NONE] * (n_blinded + 1) for _ in range(n_seeing + 1)]
    best[0][0] = 0
    for largest in range(size):
        for count in range(largest, n_seeing + 1):
            tick()
            fewer = best[count - largest]
            for x in range(n_blinded + 1):
                joined = (fewer[x - y] + most[largest + y] for y in range(not largest, x + 1))
                best[count][x] = max(best[count][x], *joined, NONE)
        yield list(best[n_seeing - largest])
