"""Sizes of the groups that an attack on a complete graph can leave: CAA, and those of the unblinded robots.

On a complete graph every robot and link is alike, so an outcome is feasible or not by its group sizes alone. ``b``
blinded robots still hold links and may stand in any group; the links kept, ``sum_k C(size_k, 2)``, are convex in where
they stand, so the cheapest place for all of them is the largest group.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import islice, pairwise
from math import comb, factorial
from typing import TYPE_CHECKING

from ratt_opt._validation import check_integer

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = [
    "FIRST",
    "CaaResult",
    "caa",
    "cheapest_cut",
    "first_non_dominated_sizes",
    "forced_group_size",
    "iterate_non_dominated_sizes",
    "labelled_count",
    "non_dominated_sizes",
    "sizes_of_largest",
]


FIRST = 5_001
"""Vectors of sizes that are listed at once; at 60 robots all of them, of a thousand in a third of a second."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CaaResult:
    """``n_max``: size of the largest group left; ``alpha_cs = N - n_max``: equivalent sensing attacks."""

    n_max: int
    alpha_cs: int


def links_within(n_robots: int, group: int) -> int:
    """Links kept when a complete graph is split into as many groups of size ``group`` as fit, and one of the rest.

    Source: ratt.tex, eq:bar_en.
    """
    full, rest = divmod(n_robots, group)
    return full * (group * (group - 1) // 2) + rest * (rest - 1) // 2


def caa(n_robots: int, alpha_c: int) -> CaaResult:
    """Return the smallest possible largest group of a complete graph with ``alpha_c`` links cut.

    Parameters
    ----------
    n_robots : N >= 1
    alpha_c : links the attacker may cut, in ``[0, N (N - 1) / 2]``

    Raises
    ------
    InputError : a number is out of range.

    Source: ratt.tex, Algorithm 2 (CAA). Exact for complete graphs: agrees with the
    enumeration of integer partitions for every N <= 30.
    """
    n_robots = check_integer("n_robots", n_robots, low=1)
    links = n_robots * (n_robots - 1) // 2
    alpha_c = check_integer("alpha_c", alpha_c, low=0, high=links)
    remaining = links - alpha_c
    n_max = next(n for n in range(1, n_robots + 1) if remaining <= links_within(n_robots, n))
    return CaaResult(n_max=n_max, alpha_cs=n_robots - n_max)


Sizes = tuple[int, ...]
"""Non-increasing positive group sizes; empty when every robot is blinded."""


def cheapest_cut(n_blinded: int, sizes: Sizes) -> int:
    """Fewest links to cut on a complete graph so that ``sizes`` unblinded robots stand apart."""
    if not sizes:
        return 0
    total = sum(sizes) + n_blinded
    return comb(total, 2) - comb(sizes[0] + n_blinded, 2) - sum(comb(size, 2) for size in sizes[1:])


def non_dominated_sizes(n_robots: int, n_blinded: int, alpha_c: int) -> list[Sizes]:
    """Feasible size vectors that no other feasible vector refines, in descending lexicographic order."""
    return list(iterate_non_dominated_sizes(n_robots, n_blinded, alpha_c))


def iterate_non_dominated_sizes(n_robots: int, n_blinded: int, alpha_c: int) -> Iterator[Sizes]:
    """Yield the same one by one, without going through the feasible vectors: there may be very many."""
    if n_robots == n_blinded:
        yield ()
    for first in range(n_robots - n_blinded, 0, -1):
        yield from sizes_of_largest(n_robots, n_blinded, alpha_c, first)


@lru_cache(maxsize=1)
def first_non_dominated_sizes(n_robots: int, n_blinded: int, alpha_c: int) -> tuple[Sizes, ...]:
    """The first ``FIRST`` of them, kept for the next search of the same team: each planner's plan is attacked."""
    return tuple(islice(iterate_non_dominated_sizes(n_robots, n_blinded, alpha_c), FIRST))


def sizes_of_largest(n_robots: int, n_blinded: int, alpha_c: int, first: int) -> Iterator[Sizes]:
    """Yield the non-dominated vectors whose largest group has ``first`` robots.

    Merging two groups of a feasible vector never cuts more links, so a vector is dominated exactly when splitting one
    of its groups in two is feasible. The split that keeps most links takes one robot off the smallest group
    of at least two, ``q`` robots and those blinded that stand with it: it loses ``q - 1`` links. So the links kept
    exceed those to keep by 0 to ``q - 2``, which leaves little to go through on the way down.
    """
    survivors = n_robots - n_blinded
    missing = comb(n_robots, 2) - alpha_c - comb(first + n_blinded, 2)
    if missing > 0:
        for rest in _tight(survivors - first, first, missing):
            yield (first, *rest)
    elif first == 1 or -missing < first + n_blinded - 1:
        # The largest group keeps enough on its own, and could not be split: the others stand alone.
        yield (first, *(1,) * (survivors - first))


def _tight(robots: int, largest: int, missing: int) -> Iterator[Sizes]:
    """Partitions of ``robots`` into parts up to ``largest`` that keep ``missing > 0`` links, and hardly more.

    The excess must stay below ``q - 1`` for the smallest part ``q >= 2``.
    """
    for part in range(min(robots, largest), 1, -1):
        # Equal parts as large as allowed keep the most links (convexity); smaller parts only keep fewer.
        if links_within(robots, part) < missing:
            return
        left = missing - comb(part, 2)
        if left <= 0:
            # Whatever follows keeps more: the others stand alone.
            if -left < part - 1:
                yield (part, *(1,) * (robots - part))
            continue
        for rest in _tight(robots - part, part, left):
            yield (part, *rest)


def forced_group_size(n_robots: int, n_blinded: int, alpha_c: int) -> int:
    """Largest ``k`` such that every attack leaves a group of at least ``k`` unblinded robots.

    Proof by integer partitions: ``k`` is the smallest first entry of a feasible size vector, and
    the cut of a vector whose groups all have at most ``p`` robots is least, by convexity, for as
    many groups of ``p`` as fit; so it suffices to test that one vector for each ``p``.
    """
    survivors = n_robots - n_blinded
    for largest in range(1, survivors + 1):
        full, rest = divmod(survivors, largest)
        sizes = (largest,) * full + ((rest,) if rest else ())
        if cheapest_cut(n_blinded, sizes) <= alpha_c:
            return largest
    return 0


def labelled_count(n_robots: int, n_free: int, n_blinded: int, sizes: Sizes) -> int:
    """Number of outcomes with these group sizes when ``n_free`` of the robots may be blinded."""
    ways = comb(n_free, n_blinded) * factorial(n_robots - n_blinded)
    for size in sizes:
        ways //= factorial(size)
    repeats = 1
    for first, second in pairwise(sizes):
        repeats = repeats + 1 if first == second else 1
        ways //= repeats
    return ways
