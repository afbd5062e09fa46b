"""How groups can be sized and filled: partitions, CAA's own groups, and the paper's patterns."""

from __future__ import annotations

from itertools import permutations, product
from typing import TYPE_CHECKING

from ratt_opt.graph.caa import caa

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.audit.enumeration.setting import Setting

__all__ = [
    "Arrangement",
    "arrangements",
    "caa_groups",
    "is_pattern1",
    "is_pattern2",
    "pattern2_pairs",
    "splits",
    "text_of",
]

Arrangement = tuple[tuple[int, int], ...]
"""Groups as (baits, greedy robots)."""


def splits(n_robots: int, alpha_c: int, largest: int | None = None) -> list[tuple[int, ...]]:
    """Group sizes, largest first, that cutting ``alpha_c`` links of a complete graph can leave; at most ``largest``."""
    sizes = _partitions(n_robots, n_robots if largest is None else largest)
    return [split for split in sizes if n_robots**2 - sum(s * s for s in split) <= 2 * alpha_c]


def _partitions(total: int, largest: int) -> Iterator[tuple[int, ...]]:
    if total == 0:
        yield ()
        return
    for part in range(min(total, largest), 0, -1):
        for rest in _partitions(total - part, part):
            yield (part, *rest)


def caa_groups(n_robots: int, alpha_c: int) -> tuple[int, ...]:
    """CAA's groups: as many of ``n_max`` robots as fit, and the rest."""
    n_max = caa(n_robots, alpha_c).n_max
    full, rest = divmod(n_robots, n_max)
    return (n_max,) * full + ((rest,) if rest else ())


def arrangements(setting: Setting) -> Iterator[Arrangement]:
    """Every way to fill CAA's own groups with RATT's baits and greedy robots (the paper's most favourable reading)."""
    sizes = caa_groups(setting.n_robots, setting.alpha_c)
    seen = set()
    for greedy in product(*(range(size + 1) for size in sizes)):
        if sum(greedy) == setting.n_greedy:
            arrangement = tuple(sorted(((s - g, g) for s, g in zip(sizes, greedy, strict=True)), reverse=True))
            if arrangement not in seen:
                seen.add(arrangement)
                yield arrangement


def text_of(arrangement: Arrangement) -> str:
    """The groups in words."""
    return ", ".join(f"{b} bait + {g} greedy" for b, g in arrangement)


def is_pattern1(arrangement: Arrangement, setting: Setting) -> bool:
    """Whether one group holds alpha_s baits and all greedy robots."""
    return (setting.alpha_s, setting.n_greedy) in arrangement


def is_pattern2(arrangement: Arrangement, setting: Setting) -> bool:
    """Whether two groups are the V1 and V2 of Pattern 2."""
    return any(True for _ in pattern2_pairs(arrangement, setting))


def pattern2_pairs(arrangement: Arrangement, setting: Setting) -> Iterator[tuple[int, int]]:
    """Yield the indices of the groups that can be V1 and V2 of Pattern 2."""
    for (i, (b1, g1)), (j, (b2, g2)) in permutations(enumerate(arrangement), 2):
        fits = g1 + g2 == setting.n_greedy and b1 == setting.alpha_s + g2
        if fits and b2 + g2 <= setting.alpha_cs and b2 > 0:
            yield i, j
