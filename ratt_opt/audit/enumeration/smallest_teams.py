"""Where the appendix's patterns and distributions first occur, so that no claim is cut off below its smallest team.

With CAA's own groups, every arrangement of baits and greedy robots and every spread of the alpha_s blinded robots
over the groups is enumerated, smallest team first.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from itertools import permutations, product
from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.entry import Counted, EntryKind, EnumeratedEntry
from ratt_opt.audit.engine.decide import Verdict
from ratt_opt.audit.enumeration.arrangements import Arrangement, arrangements, pattern2_pairs
from ratt_opt.audit.enumeration.setting import LARGEST, Setting, every_setting

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["Situation", "first_occurrence", "smallest_team_entries"]


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


_claim = partial(
    EnumeratedEntry,
    kind=EntryKind.CLAIM,
    chain="smallest teams",
    hypotheses="N > alpha, alpha_s >= 1, CAA's own groups",
)


def smallest_team_entries() -> Iterator[EnumeratedEntry]:
    """Yield one entry a pattern and distribution, and one for each dominance claim."""
    where = {1: "all blinded robots in V1", 2: "all of them outside V1 (Pattern 2: in V2)", 3: "in V1 and elsewhere"}
    for pattern, distribution in product((1, 2), where):
        text = f"Pattern {pattern}, Distribution {distribution} occurs: {where[distribution]}"
        run = partial(first_occurrence, partial(_is_distribution, pattern, distribution))
        yield _claim(label=f"nd_p{pattern}d{distribution}_occurs", statement=text, enumerate_cases=run)
    for distribution in (2, 3):
        text = f"Pattern 2, Distribution {distribution}: two or more robots of V2 survive, all of them greedy"
        run = partial(first_occurrence, partial(_is_dominance, distribution))
        yield _claim(label=f"nd_p2d{distribution}v2_dominance_occurs", statement=text, enumerate_cases=run)


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
        fits = groups[at.v2][1] > 0 and (at.v1, at.v2) in pattern2_pairs(groups, setting)
    first, all_of_them = at.blinded[at.v1], setting.alpha_s
    outside = at.blinded[at.v2] if pattern == 2 else all_of_them - first
    return fits and (first == all_of_them, outside == all_of_them, 0 < first < all_of_them)[distribution - 1]


def _is_dominance(distribution: int, at: Situation) -> bool:
    """V2 keeps two greedy robots at least when its blinded robots are its baits, and no more."""
    bait, greedy = at.groups[at.v2]
    left = bait + greedy - at.blinded[at.v2]
    return _is_distribution(2, distribution, at) and bait <= at.blinded[at.v2] and left >= 2
