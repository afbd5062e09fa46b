"""Budgets, what RATT and CAA derive from them, and how groups can be filled: shared by the enumerated claims."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations, product
from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.entry import Counted
from ratt_opt.audit.engine.decide import Verdict
from ratt_opt.graph.caa import caa

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

__all__ = [
    "LARGEST",
    "Arrangement",
    "Budgets",
    "arrangements",
    "caa_split",
    "counted",
    "cut_size",
    "every_budget",
    "is_pattern1",
    "is_pattern2",
    "partitions",
    "pattern2_pairs",
]

LARGEST = 8
"""Largest team enumerated."""


@dataclass(frozen=True, slots=True)
class Budgets:
    """One instance's numbers: N, alpha_s, alpha_c and what RATT derives from them."""

    n_robots: int
    alpha_s: int
    alpha_c: int

    @property
    def alpha_cs(self) -> int:
        """Equivalent sensing attacks."""
        return caa(self.n_robots, self.alpha_c).alpha_cs

    @property
    def alpha(self) -> int:
        """Number of baits, when smaller than N."""
        return self.alpha_s + self.alpha_cs

    @property
    def n_max(self) -> int:
        """Largest group by CAA."""
        return self.n_robots - self.alpha_cs

    def text(self) -> str:
        """The numbers in words."""
        return f"N = {self.n_robots}, alpha_s = {self.alpha_s}, alpha_c = {self.alpha_c}, alpha_cs = {self.alpha_cs}"


def partitions(total: int, largest: int) -> Iterator[tuple[int, ...]]:
    """Integer partitions of ``total`` with parts at most ``largest``, largest first."""
    if total == 0:
        yield ()
        return
    for part in range(min(total, largest), 0, -1):
        for rest in partitions(total - part, part):
            yield (part, *rest)


def cut_size(sizes: tuple[int, ...]) -> int:
    """Links between groups of these sizes in a complete graph."""
    total = sum(sizes)
    return total * (total - 1) // 2 - sum(s * (s - 1) // 2 for s in sizes)


def every_budget(largest: int) -> Iterator[Budgets]:
    """Yield all budgets of 2 to ``largest`` robots, by N, then alpha_c, then alpha_s."""
    for n_robots in range(2, largest + 1):
        for alpha_c in range(n_robots * (n_robots - 1) // 2 + 1):
            for alpha_s in range(n_robots + 1):
                yield Budgets(n_robots, alpha_s, alpha_c)


def counted(cases: Sequence[str], sizes: str, checked: int, what: str) -> Counted:
    """The outcome of an enumeration of ``checked`` items; ``cases`` break the claim. Nothing seen proves nothing."""
    verdict = Verdict.REFUTED if cases else Verdict.PROVED if checked else Verdict.UNDECIDED
    return Counted(
        verdict=verdict,
        sizes=sizes,
        detail=f"{checked} {what} enumerated, {len(cases)} break the claim",
        cases=tuple(cases[:3]),
    )


def caa_split(n_robots: int, n_max: int) -> tuple[int, ...]:
    """CAA's groups: as many of ``n_max`` robots as fit, and the rest."""
    full, rest = divmod(n_robots, n_max)
    return (n_max,) * full + ((rest,) if rest else ())


Arrangement = tuple[tuple[int, int], ...]
"""Groups as (baits, greedy robots)."""


def arrangements(budgets: Budgets) -> Iterator[Arrangement]:
    """Every way to fill CAA's own groups with RATT's baits and greedy robots (the paper's most favourable reading)."""
    sizes = caa_split(budgets.n_robots, budgets.n_max)
    seen = set()
    for greedy in product(*(range(size + 1) for size in sizes)):
        if sum(greedy) == budgets.n_robots - budgets.alpha:
            arrangement = tuple(sorted(((s - g, g) for s, g in zip(sizes, greedy, strict=True)), reverse=True))
            if arrangement not in seen:
                seen.add(arrangement)
                yield arrangement


def is_pattern1(arrangement: Arrangement, budgets: Budgets) -> bool:
    """Whether one group holds alpha_s baits and all greedy robots."""
    rest = budgets.n_robots - budgets.alpha
    return any(b == budgets.alpha_s and g == rest for b, g in arrangement)


def is_pattern2(arrangement: Arrangement, budgets: Budgets) -> bool:
    """Whether two groups are the V1 and V2 of Pattern 2."""
    return any(True for _ in pattern2_pairs(arrangement, budgets))


def pattern2_pairs(arrangement: Arrangement, budgets: Budgets) -> Iterator[tuple[int, int]]:
    """Yield the indices of the groups that can be V1 and V2 of Pattern 2."""
    rest = budgets.n_robots - budgets.alpha
    for (i, (b1, g1)), (j, (b2, g2)) in permutations(enumerate(arrangement), 2):
        if g1 + g2 == rest and b1 == budgets.alpha_s + g2 and b2 + g2 <= budgets.alpha_cs and b2 > 0:
            yield i, j
