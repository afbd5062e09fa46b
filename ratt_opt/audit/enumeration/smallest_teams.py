"""Where the appendix's patterns and distributions first occur, so that no claim is cut off below its smallest team.

With CAA's own groups, every arrangement of baits and greedy robots and every spread of the alpha_s blinded robots
over the groups is enumerated, smallest team first.
"""

from __future__ import annotations

from functools import partial
from itertools import permutations, product
from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.entry import Counted, EnumeratedEntry
from ratt_opt.audit.engine.decide import Verdict
from ratt_opt.audit.enumeration.setting import Arrangement, Budgets, arrangements, every_budget, pattern2_pairs

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    Situation = tuple[Arrangement, tuple[int, int], tuple[int, ...]]
    """Groups, the indices of V1 and V2, and how many robots are blinded in each group."""

__all__ = ["first_occurrence", "occurrence_entries"]

LARGEST = 8


def occurrence_entries() -> Iterator[EnumeratedEntry]:
    """Yield one entry a pattern and distribution, and one for each dominance claim."""
    where = {1: "all blinded robots in V1", 2: "all of them outside V1 (Pattern 2: in V2)", 3: "in V1 and elsewhere"}
    for pattern in (1, 2):
        for distribution, text in where.items():
            yield _entry(
                f"nd_p{pattern}d{distribution}_occurs",
                f"Pattern {pattern}, Distribution {distribution} occurs: {text}",
                partial(_is_distribution, pattern, distribution),
            )
    for distribution in (2, 3):
        yield _entry(
            f"nd_p2d{distribution}v2_dominance_occurs",
            f"Pattern 2, Distribution {distribution}: two or more robots of V2 survive, all of them greedy",
            partial(_is_dominance, distribution),
        )


def _entry(label: str, statement: str, occurs: Callable[[Budgets, Situation], bool]) -> EnumeratedEntry:
    return EnumeratedEntry(
        label=label,
        kind="claim",
        chain="smallest teams",
        statement=statement,
        hypotheses="N > alpha, alpha_s >= 1, CAA's own groups",
        enumerate_cases=partial(first_occurrence, occurs),
    )


def first_occurrence(occurs: Callable[[Budgets, Situation], bool]) -> Counted:
    """Enumerate situations, smallest team first, until one qualifies."""
    seen = 0
    for budgets in every_budget(LARGEST):
        for situation in _situations(budgets):
            seen += 1
            if occurs(budgets, situation):
                groups, pair, blinded = situation
                text = ", ".join(
                    f"{b} bait + {g} greedy ({hit} blinded)" for (b, g), hit in zip(groups, blinded, strict=True)
                )
                detail = f"smallest: {budgets.text()}; groups {text}; V1 is group {pair[0] + 1}, V2 group {pair[1] + 1}"
                return Counted(
                    verdict=Verdict.PROVED, sizes=f"{seen} situations, N <= {budgets.n_robots}", detail=detail
                )
    return Counted(verdict=Verdict.REFUTED, sizes=f"{seen} situations, N <= {LARGEST}", detail="none qualifies")


def _situations(budgets: Budgets) -> Iterator[Situation]:
    if not budgets.alpha_s or budgets.alpha >= budgets.n_robots:
        return
    for groups in arrangements(budgets):
        for blinded in product(*(range(b + g + 1) for b, g in groups)):
            if sum(blinded) == budgets.alpha_s:
                for pair in permutations(range(len(groups)), 2):
                    yield groups, pair, blinded


def _is_distribution(pattern: int, distribution: int, budgets: Budgets, situation: Situation) -> bool:
    groups, pair, blinded = situation
    if pattern == 1:
        fits = groups[pair[0]] == (budgets.alpha_s, budgets.n_robots - budgets.alpha)
    else:
        fits = groups[pair[1]][1] > 0 and pair in pattern2_pairs(groups, budgets)
    first, all_of_them = blinded[pair[0]], budgets.alpha_s
    outside = blinded[pair[1]] if pattern == 2 else all_of_them - first
    return fits and (first == all_of_them, outside == all_of_them, 0 < first < all_of_them)[distribution - 1]


def _is_dominance(distribution: int, budgets: Budgets, situation: Situation) -> bool:
    """V2 keeps two greedy robots at least when its blinded robots are its baits, and no more."""
    groups, pair, blinded = situation
    if not _is_distribution(2, distribution, budgets, situation):
        return False
    bait, greedy = groups[pair[1]]
    return bait <= blinded[pair[1]] and bait + greedy - blinded[pair[1]] >= 2
