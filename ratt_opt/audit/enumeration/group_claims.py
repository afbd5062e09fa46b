"""Claims about sizes, groups and patterns, decided by exhaustive enumeration.

An arrangement of N robots says how many baits and how many greedy robots each group has.
"""

from __future__ import annotations

from functools import partial
from itertools import combinations_with_replacement, product
from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.entry import EnumeratedEntry
from ratt_opt.audit.enumeration.setting import (
    LARGEST,
    Budgets,
    arrangements,
    caa_split,
    counted,
    cut_size,
    every_budget,
    is_pattern1,
    is_pattern2,
    partitions,
)
from ratt_opt.graph.caa import caa

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from ratt_opt.audit.appendix.entry import Counted

__all__ = ["arrangement_entries"]

THEOREM, OTHERS = "eqn:appro_non_descrease/theorem", "nd_other_patterns/claim"
LARGEST_GROUP = "caa_largest_group/claim"
ALONE = "from Patterns 1 and 2 alone"


def _caa_is_exact() -> Counted:
    bad, count = [], 0
    for n_robots in range(1, 13):
        for alpha_c in range(n_robots * (n_robots - 1) // 2 + 1):
            count += 1
            least = min(max(sizes) for sizes in partitions(n_robots, n_robots) if cut_size(sizes) <= alpha_c)
            if least != caa(n_robots, alpha_c).n_max:
                bad.append(f"N = {n_robots}, alpha_c = {alpha_c}: smallest possible largest group {least}")
    return counted(bad, "N <= 12, every alpha_c", count, "pairs (N, alpha_c)")


def _best_packing(weights: tuple[int, ...], sizes: tuple[int, ...]) -> int:
    """Least possible value of the best group over all ways to fill groups of these sizes, f additive."""
    best = sum(weights)
    for homes in product(range(len(sizes)), repeat=len(weights)):
        if all(homes.count(k) == size for k, size in enumerate(sizes)):
            best = min(
                best, max(sum(w for w, h in zip(weights, homes, strict=True) if h == k) for k in range(len(sizes)))
            )
    return best


def _caa_determines_groups() -> Counted:
    bad, count = [], 0
    for n_robots in range(2, 6):
        for alpha_c in range(n_robots * (n_robots - 1) // 2 + 1):
            split = caa_split(n_robots, caa(n_robots, alpha_c).n_max)
            allowed = [sizes for sizes in partitions(n_robots, n_robots) if cut_size(sizes) <= alpha_c]
            for weights in combinations_with_replacement(range(1, 4), n_robots):
                count += 1
                by_caa = _best_packing(weights, split)
                worst = min((_best_packing(weights, sizes), sizes) for sizes in allowed)
                if worst[0] < by_caa:
                    bad.append(
                        f"N = {n_robots}, alpha_c = {alpha_c}, additive f with values {weights}: CAA's groups {split} "
                        f"leave at least {by_caa}, groups {worst[1]} leave {worst[0]}"
                    )
    return counted(bad, "N <= 5, additive f with values 1 to 3", count, "functions and budgets")


def _caa_counts_groups() -> Counted:
    bad, count = [], 0
    for n_robots in range(2, LARGEST + 1):
        for alpha_c in range(n_robots * (n_robots - 1) // 2 + 1):
            count += 1
            split = caa_split(n_robots, caa(n_robots, alpha_c).n_max)
            finer = [s for s in partitions(n_robots, split[0]) if cut_size(s) <= alpha_c and len(s) > len(split)]
            if finer:
                bad.append(
                    f"N = {n_robots}, alpha_c = {alpha_c}: CAA's groups {split}, but {finer[0]} is within the budget"
                )
    return counted(bad, f"N <= {LARGEST}", count, "pairs (N, alpha_c)")


def _patterns_cover() -> Counted:
    bad, count = [], 0
    for budgets in every_budget(LARGEST):
        if budgets.alpha >= budgets.n_robots:
            continue
        for arrangement in arrangements(budgets):
            count += 1
            if not is_pattern1(arrangement, budgets) and not is_pattern2(arrangement, budgets):
                groups = ", ".join(f"{b} bait + {g} greedy" for b, g in arrangement)
                bad.append(f"{budgets.text()}: groups {groups}")
    return counted(bad, f"N <= {LARGEST}, N > alpha, CAA's own groups", count, "arrangements")


def _distributions() -> Counted:
    """Pattern 2: the text lists all blinded robots in V1, all in V2, or part in V1 and the rest elsewhere."""
    bad, count = [], 0
    for total in range(1, 4):
        for v1, v2, v3 in product(range(total + 1), repeat=3):
            if v1 + v2 + v3 == total:
                count += 1
                if not (total in (v1, v2) or 0 < v1 < total):
                    bad.append(f"alpha_s = {total}: {v1} in V1, {v2} in V2, {v3} in V3")
    return counted(bad, "three groups, alpha_s <= 3", count, "distributions")


def _figure(n_bait_in_second: int) -> Counted:
    """N = 10, alpha_s = 2, alpha_c = 29: three groups, the largest of 5, 7 baits and 3 greedy robots."""
    b = Budgets(10, 2, 29)
    good = [s for s in partitions(10, 5) if len(s) == 3 and s[0] == 5 and cut_size(s) <= 29 and s[1] > n_bait_in_second]
    fine = bool(good) and (b.n_max, b.alpha_cs, b.alpha) == (5, 5, 7)
    cases = [] if fine else [f"n_max = {b.n_max}, alpha_cs = {b.alpha_cs}, alpha = {b.alpha}, three groups: {good}"]
    return counted(
        cases, "N = 10, alpha_s = 2, alpha_c = 29", len(good), "splits into three groups with the largest of 5"
    )


def arrangement_entries() -> Iterator[EnumeratedEntry]:
    """Yield the claims about groups, patterns and distributions."""
    cover = "every arrangement is Pattern 1 or Pattern 2"
    spread = "Distributions 1 to 3 of Pattern 2 cover every sensing attack (with at least one of alpha_s^1 in V1)"
    yield _entry("caa_largest_group", "CAA's n_max is the smallest possible largest group", _caa_is_exact)
    yield _entry(
        "caa_determines_groups",
        "a worst link attack leaves groups of the sizes CAA computes",
        _caa_determines_groups,
        survives_by=THEOREM,
        serves_by=LARGEST_GROUP,
    )
    yield _entry(
        "caa_counts_groups",
        "CAA's q_n and r_n give the number of groups left",
        _caa_counts_groups,
        survives_by=THEOREM,
        serves_by=LARGEST_GROUP,
    )
    yield _entry("fig:p1_3d", "the example of Pattern 1 is consistent", partial(_figure, 0))
    yield _entry("fig:p2_3d", "the example of Pattern 2 is consistent", partial(_figure, 1))
    yield _entry("patterns_cover", cover, _patterns_cover, survives_by="nd1/cumulative", serves_by=OTHERS)
    yield _entry(
        "nd1",
        f"the bound holds for all arrangements, as {cover}",
        _patterns_cover,
        survives_by="nd1/cumulative",
        serves_by=OTHERS,
        kind="step",
        reading=ALONE,
    )
    yield _entry(
        "pattern2_distributions_cover", spread, _distributions, survives_by="nd_p2/cumulative", serves_by=OTHERS
    )


def _entry(
    label: str,
    statement: str,
    run: Callable[[], Counted],
    *,
    survives_by: str = "",
    serves_by: str = "",
    kind: str = "claim",
    reading: str = "",
) -> EnumeratedEntry:
    return EnumeratedEntry(
        label=label,
        kind=kind,
        chain="patterns",
        statement=statement,
        hypotheses="RATT's and CAA's definitions",
        enumerate_cases=run,
        reading=reading,
        survives_by=survives_by,
        serves_by=serves_by,
    )
