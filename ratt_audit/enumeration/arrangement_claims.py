"""Claims about sizes, groups and patterns, decided by exhaustive enumeration.

Each pattern and distribution is also shown to occur, with the smallest team, so that no claim is cut off below it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from itertools import combinations_with_replacement, permutations, product
from typing import TYPE_CHECKING

from ratt_audit.appendix.entry import Counted, EntryKind, EntryName, EnumeratedEntry
from ratt_audit.appendix.theorems import THEOREM1
from ratt_audit.engine.decide import Verdict
from ratt_audit.enumeration.setting import (
    LARGEST,
    Setting,
    caa_groups,
    counted,
    every_link_budget,
    every_setting,
    splits,
)
from ratt_opt.graph.survivor_sizes import caa

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


__all__ = ["Arrangement", "arrangement_entries", "arrangements", "first_occurrence", "is_pattern1",
           "is_pattern2", "smallest_team_entries"]  # fmt: skip

CLAIM = EntryKind.CLAIM
OTHERS = EntryName("nd_other_patterns", CLAIM)
ALL_PATTERNS = EntryName("nd1", EntryKind.CUMULATIVE)
LARGEST_FOR_CAA = 12
LARGEST_FOR_VALUES = 5
"""Robots whose values 1 to 3 are packed in groups in every way: 0.3 s; six take 4.6 s."""
CAA_IS_EXACT = EntryName("caa_largest_group", CLAIM)
Arrangement = tuple[tuple[int, int], ...]
"""Groups as (baits, greedy robots)."""

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
    of_patterns = partial(_claim, enumerate_cases=_patterns_cover, survives_by=ALL_PATTERNS, serves_by=OTHERS)
    yield of_patterns(label="patterns_cover", statement=cover)
    text, reading = f"the bound holds for all arrangements, as {cover}", "from Patterns 1 and 2 alone"
    yield of_patterns(label="nd1", kind=EntryKind.STEP, statement=text, reading=reading)
    yield _claim(
        label="pattern2_distributions_cover",
        statement="Distributions 1 to 3 of Pattern 2 cover every sensing attack (with at least one of alpha_s^1 in V1)",
        enumerate_cases=_distributions,
        survives_by=EntryName("nd_p2", EntryKind.CUMULATIVE),
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
        return "" if covered else f"{setting.text()}: groups {_text_of(groups)}"

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


@dataclass(frozen=True, slots=True)
class Situation:
    """Groups, which two are V1 and V2, and how many robots are blinded in each group."""

    setting: Setting
    groups: Arrangement
    v1: int
    v2: int
    blinded: tuple[int, ...]

    def text(self) -> str:
        """The situation in words."""
        spread = zip(self.groups, self.blinded, strict=True)
        groups = ", ".join(f"{b} bait + {g} greedy ({hit} blinded)" for (b, g), hit in spread)
        return f"{self.setting.text()}; groups {groups}; V1 is group {self.v1 + 1}, V2 group {self.v2 + 1}"


_occurs = partial(_claim, chain="smallest teams", hypotheses="N > alpha, alpha_s >= 1, CAA's own groups")


def smallest_team_entries() -> Iterator[EnumeratedEntry]:
    """Yield one entry a pattern and distribution, and one for each dominance claim."""
    where = {1: "all blinded robots in V1", 2: "all of them outside V1 (Pattern 2: in V2)", 3: "in V1 and elsewhere"}
    for pattern, distribution in product((1, 2), where):
        text = f"Pattern {pattern}, Distribution {distribution} occurs: {where[distribution]}"
        run = partial(first_occurrence, partial(_is_distribution, pattern, distribution))
        yield _occurs(label=f"nd_p{pattern}d{distribution}_occurs", statement=text, enumerate_cases=run)
    for distribution in (2, 3):
        text = f"Pattern 2, Distribution {distribution}: two or more robots of V2 survive, all of them greedy"
        run = partial(first_occurrence, partial(_is_dominance, distribution))
        yield _occurs(label=f"nd_p2d{distribution}v2_dominance_occurs", statement=text, enumerate_cases=run)


def first_occurrence(occurs: Callable[[Situation], bool]) -> Counted:
    """Enumerate situations, smallest team first, until one qualifies."""
    seen = 0
    for setting in every_setting(LARGEST):
        for situation in _situations(setting):
            seen += 1
            if occurs(situation):
                sizes = f"{seen} situations, N <= {setting.n_robots}"
                return Counted(verdict=Verdict.PROVED, sizes=sizes, detail=f"smallest: {situation.text()}")
    return Counted(verdict=Verdict.REFUTED, sizes=f"{seen} situations, N <= {LARGEST}", detail="none qualifies")


def _situations(setting: Setting) -> Iterator[Situation]:
    if not setting.alpha_s or setting.n_greedy <= 0:
        return
    for groups in arrangements(setting):
        for blinded in product(*(range(b + g + 1) for b, g in groups)):
            if sum(blinded) == setting.alpha_s:
                for v1, v2 in permutations(range(len(groups)), 2):
                    yield Situation(setting, groups, v1, v2, blinded)


def _is_distribution(pattern: int, distribution: int, at: Situation) -> bool:
    setting, groups = at.setting, at.groups
    if pattern == 1:
        fits = groups[at.v1] == (setting.alpha_s, setting.n_greedy)
    else:
        fits = groups[at.v2][1] > 0 and (at.v1, at.v2) in _pattern2_pairs(groups, setting)
    first, all_of_them = at.blinded[at.v1], setting.alpha_s
    outside = at.blinded[at.v2] if pattern == 2 else all_of_them - first
    return fits and (first == all_of_them, outside == all_of_them, 0 < first < all_of_them)[distribution - 1]


def _is_dominance(distribution: int, at: Situation) -> bool:
    """V2 keeps two greedy robots at least when its blinded robots are its baits, and no more."""
    bait, greedy = at.groups[at.v2]
    left = bait + greedy - at.blinded[at.v2]
    return _is_distribution(2, distribution, at) and bait <= at.blinded[at.v2] and left >= 2


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


def _text_of(arrangement: Arrangement) -> str:
    """The groups in words."""
    return ", ".join(f"{b} bait + {g} greedy" for b, g in arrangement)


def is_pattern1(arrangement: Arrangement, setting: Setting) -> bool:
    """Tell whether one group holds alpha_s baits and all greedy robots."""
    return (setting.alpha_s, setting.n_greedy) in arrangement


def is_pattern2(arrangement: Arrangement, setting: Setting) -> bool:
    """Tell whether two groups are the V1 and V2 of Pattern 2."""
    return any(True for _ in _pattern2_pairs(arrangement, setting))


def _pattern2_pairs(arrangement: Arrangement, setting: Setting) -> Iterator[tuple[int, int]]:
    """Yield the indices of the groups that can be V1 and V2 of Pattern 2."""
    for (i, (b1, g1)), (j, (b2, g2)) in permutations(enumerate(arrangement), 2):
        fits = g1 + g2 == setting.n_greedy and b1 == setting.alpha_s + g2
        if fits and b2 + g2 <= setting.alpha_cs and b2 > 0:
            yield i, j
