"""Claims about sizes, groups and patterns, decided by exhaustive enumeration.

An arrangement of N robots says how many baits and how many greedy robots each group has.
"""

from __future__ import annotations

from functools import partial
from itertools import combinations_with_replacement, product
from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.entry import EntryKind, EnumeratedEntry, Reference
from ratt_opt.audit.appendix.theorems import THEOREM1
from ratt_opt.audit.enumeration.arrangements import arrangements, caa_groups, is_pattern1, is_pattern2, splits, text_of
from ratt_opt.audit.enumeration.setting import LARGEST, Setting, counted, every_link_budget, every_setting
from ratt_opt.graph.caa import caa

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.audit.appendix.entry import Counted
    from ratt_opt.audit.enumeration.arrangements import Arrangement

__all__ = ["arrangement_entries"]

CLAIM = EntryKind.CLAIM
OTHERS = Reference("nd_other_patterns", CLAIM)
ALL_PATTERNS = Reference("nd1", EntryKind.CUMULATIVE)
LARGEST_FOR_CAA = 12
LARGEST_FOR_VALUES = 5
"""Robots whose values 1 to 3 are packed in groups in every way: 0.3 s; six take 4.6 s."""


CAA_IS_EXACT = Reference("caa_largest_group", CLAIM)
_claim = partial(EnumeratedEntry, kind=CLAIM, chain="patterns", hypotheses="RATT's and CAA's definitions")


def arrangement_entries() -> Iterator[EnumeratedEntry]:
    """Yield the claims about groups, patterns and distributions."""
    text = "CAA's n_max is the smallest possible largest group"
    yield _claim(label=CAA_IS_EXACT.label, statement=text, enumerate_cases=_caa_is_exact)
    of_caa = partial(_claim, survives_by=THEOREM1, serves_by=CAA_IS_EXACT)
    text = "a worst link attack leaves groups of the sizes CAA computes"
    yield of_caa(label="caa_determines_groups", statement=text, enumerate_cases=_caa_sizes_are_worst)
    text = "CAA's q_n and r_n give the number of groups left"
    yield of_caa(label="caa_counts_groups", statement=text, enumerate_cases=_caa_counts_groups)
    for pattern in (1, 2):
        text, run = f"the example of Pattern {pattern} is consistent", partial(_figure, pattern - 1)
        yield _claim(label=f"fig:p{pattern}_3d", statement=text, enumerate_cases=run)
    cover = "every arrangement is Pattern 1 or Pattern 2"
    of_patterns = partial(
        EnumeratedEntry,
        chain="patterns",
        hypotheses="RATT's and CAA's definitions",
        enumerate_cases=_patterns_cover,
        survives_by=ALL_PATTERNS,
        serves_by=OTHERS,
    )
    yield of_patterns(label="patterns_cover", kind=CLAIM, statement=cover)
    text, reading = f"the bound holds for all arrangements, as {cover}", "from Patterns 1 and 2 alone"
    yield of_patterns(label="nd1", kind=EntryKind.STEP, statement=text, reading=reading)
    yield _claim(
        label="pattern2_distributions_cover",
        statement="Distributions 1 to 3 of Pattern 2 cover every sensing attack (with at least one of alpha_s^1 in V1)",
        enumerate_cases=_distributions,
        survives_by=Reference("nd_p2", EntryKind.CUMULATIVE),
        serves_by=OTHERS,
    )


def _caa_is_exact() -> Counted:
    def fault(n_robots: int, alpha_c: int) -> str:
        least = min(max(sizes) for sizes in splits(n_robots, alpha_c))
        wrong = least != caa(n_robots, alpha_c).n_max
        return f"N = {n_robots}, alpha_c = {alpha_c}: smallest possible largest group {least}" if wrong else ""

    faults = (fault(*budget) for budget in every_link_budget(1, LARGEST_FOR_CAA))
    return counted(faults, f"N <= {LARGEST_FOR_CAA}, every alpha_c", "pairs (N, alpha_c)")


def _caa_sizes_are_worst() -> Counted:
    def faults() -> Iterator[str]:
        for n_robots, alpha_c in every_link_budget(2, LARGEST_FOR_VALUES):
            split, allowed = caa_groups(n_robots, alpha_c), splits(n_robots, alpha_c)
            for weights in combinations_with_replacement(range(1, 4), n_robots):
                by_caa = _best_packing(weights, split)
                least, sizes = min((_best_packing(weights, sizes), sizes) for sizes in allowed)
                text = (
                    f"N = {n_robots}, alpha_c = {alpha_c}, additive f with values {weights}: CAA's groups {split} "
                    f"leave at least {by_caa}, groups {sizes} leave {least}"
                )
                yield text if least < by_caa else ""

    return counted(faults(), f"N <= {LARGEST_FOR_VALUES}, additive f with values 1 to 3", "functions and budgets")


def _best_packing(weights: tuple[int, ...], sizes: tuple[int, ...]) -> int:
    """Least possible value of the best group over all ways to fill groups of these sizes, f additive."""
    groups = range(len(sizes))
    return min(
        max(sum(w for w, home in zip(weights, homes, strict=True) if home == k) for k in groups)
        for homes in product(groups, repeat=len(weights))
        if all(homes.count(k) == size for k, size in enumerate(sizes))
    )


def _caa_counts_groups() -> Counted:
    def fault(n_robots: int, alpha_c: int) -> str:
        split = caa_groups(n_robots, alpha_c)
        finer = [sizes for sizes in splits(n_robots, alpha_c, split[0]) if len(sizes) > len(split)]
        text = f"N = {n_robots}, alpha_c = {alpha_c}: CAA's groups {split}, but"
        return f"{text} {finer[0]} is within the budget" if finer else ""

    faults = (fault(*budget) for budget in every_link_budget(2, LARGEST))
    return counted(faults, f"N <= {LARGEST}", "pairs (N, alpha_c)")


def _patterns_cover() -> Counted:
    def fault(groups: Arrangement, setting: Setting) -> str:
        covered = is_pattern1(groups, setting) or is_pattern2(groups, setting)
        return "" if covered else f"{setting.text()}: groups {text_of(groups)}"

    settings = (setting for setting in every_setting(LARGEST) if setting.n_greedy > 0)
    faults = (fault(groups, setting) for setting in settings for groups in arrangements(setting))
    return counted(faults, f"N <= {LARGEST}, N > alpha, CAA's own groups", "arrangements")


def _distributions() -> Counted:
    """Pattern 2: the text lists all blinded robots in V1, all in V2, or part in V1 and the rest elsewhere."""
    faults = (
        "" if total in (v1, v2) or 0 < v1 < total else f"alpha_s = {total}: {v1} in V1, {v2} in V2, {v3} in V3"
        for total in range(1, 4)
        for v1, v2, v3 in product(range(total + 1), repeat=3)
        if v1 + v2 + v3 == total
    )
    return counted(faults, "three groups, alpha_s <= 3", "distributions")


def _figure(n_bait_in_second: int) -> Counted:
    """N = 10, alpha_s = 2, alpha_c = 29: three groups, the largest of 5, 7 baits and 3 greedy robots."""
    s = Setting(10, 2, 29)
    good = [sizes for sizes in splits(10, 29, 5) if len(sizes) == 3 and sizes[0] == 5 and sizes[1] > n_bait_in_second]
    fine = bool(good) and (s.n_max, s.alpha_cs, s.alpha) == (5, 5, 7)
    fault = "" if fine else f"n_max = {s.n_max}, alpha_cs = {s.alpha_cs}, alpha = {s.alpha}, three groups: {good}"
    what = "splits into three groups with the largest of 5"
    return counted([fault] * max(len(good), 1), "N = 10, alpha_s = 2, alpha_c = 29", what)
