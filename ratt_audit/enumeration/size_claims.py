"""The appendix's sizes and counts: which sets have how many robots, for every budget with N > alpha."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from ratt_audit.appendix.entry import EntryKind, EntryName, EnumeratedEntry
from ratt_audit.appendix.theorems import PATTERN_FREE_ND
from ratt_audit.enumeration.setting import LARGEST, counted, every_setting

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from ratt_audit.appendix.entry import Counted
    from ratt_audit.enumeration.setting import Setting

    Check = Callable[[Setting], str]
    """Message of what is wrong at one setting, or the empty string."""

__all__ = ["size_entries"]

PART_ATTACKED = EntryName("nd_p1d3v1_7", EntryKind.CUMULATIVE)
MANY_BAITS = EntryName("sub_p2d1v1_10", EntryKind.CUMULATIVE)
LARGEST_FOR_BOUND = 5

_claim = partial(EnumeratedEntry, kind=EntryKind.CLAIM, chain="sizes", hypotheses="RATT's and CAA's definitions")


def size_entries() -> Iterator[EnumeratedEntry]:
    """Yield the claims about sizes; a claim that fails as printed is followed by its repair."""
    for label, statement, check in (
        ("pattern1_sizes", "|V1| = n_max when V1 has alpha_s baits and all greedy robots", _pattern1_size),
        ("pattern2_sizes", "|V1| = n_max gives |V1b| = alpha_s + |V2g| and |V2| <= alpha_cs", _pattern2_sizes),
        ("nd_p1d1v1_4_counts", "as many baits survive as greedy robots are blinded", _blinded_balance),
    ):
        yield _claim(label=label, statement=statement, enumerate_cases=partial(_all_settings, check))
    yield from _repaired(
        PART_ATTACKED,
        ("nd_p1d3v1_sizes", "|V1b1| = alpha - alpha_s^1", _safe_baits),
        ("|V1b1| = alpha_s - alpha_s^1 (repaired)", _safe_baits_repaired),
    )
    yield from _repaired(
        PART_ATTACKED,
        ("nd_p1d3v1_4_counts", "|V1b1\\A*| = number of blinded greedy robots (printed)", _wrong_balance),
        ("|V1b2\\A*| = number of blinded greedy robots (repaired)", _right_balance),
    )
    yield from _repaired(
        MANY_BAITS,
        ("sub_p2d1v1_sizes", "|V1b1| = alpha - alpha_s^1 in Pattern 2'", _safe_baits_submodular),
        ("|V1b1| = |V2g| in Pattern 2' (repaired)", _safe_baits_submodular_repaired),
    )
    yield _claim(
        label="bound_defined",
        statement="Theorem 1's bound is defined for every budget (alpha_cs > 0)",
        enumerate_cases=_no_division_by_zero,
        survives_by=PATTERN_FREE_ND,
        serves_by=PATTERN_FREE_ND,
    )


def _repaired(
    survives_by: EntryName, printed: tuple[str, str, Check], repair: tuple[str, Check]
) -> Iterator[EnumeratedEntry]:
    """The claim as printed, with its label, and its repair, which serves in its place."""
    (label, statement, check), (repaired, check_repaired) = printed, repair
    name = EntryName(f"{label}_repaired", EntryKind.CLAIM)
    run = partial(_all_settings, check)
    yield _claim(label=label, statement=statement, enumerate_cases=run, survives_by=survives_by, serves_by=name)
    yield _claim(label=name.label, statement=repaired, enumerate_cases=partial(_all_settings, check_repaired))


def _all_settings(check: Check) -> Counted:
    settings = (setting for setting in every_setting(LARGEST) if setting.n_greedy > 0)
    faults = (f"{setting.text()}: {fault}" if (fault := check(setting)) else "" for setting in settings)
    return counted(faults, f"N <= {LARGEST}, every alpha_s and alpha_c with N > alpha", "budgets")


def _no_division_by_zero() -> Counted:
    settings = every_setting(LARGEST_FOR_BOUND)
    faults = ("" if s.alpha_cs else f"{s.text()}: the bound divides by zero" for s in settings)
    return counted(faults, f"N <= {LARGEST_FOR_BOUND}, every budget", "budgets")


def _pattern1_size(s: Setting) -> str:
    size = s.alpha_s + s.n_greedy
    return "" if size == s.n_max else f"|V1| = {size}, n_max = {s.n_max}"


def _many_baits(s: Setting, g2: int) -> int:
    """Baits of V1 when it is of n_max robots and ``g2`` greedy robots are in V2."""
    return s.n_max - (s.n_greedy - g2)


def _pattern2_sizes(s: Setting) -> str:
    """V2 is in what V1 leaves."""
    greedy = range(1, s.n_greedy + 1)
    too_many = s.n_robots - s.n_max > s.alpha_cs
    return next((f"|V2g| = {g2}" for g2 in greedy if _many_baits(s, g2) != s.alpha_s + g2 or too_many), "")


def _blinded_balance(s: Setting) -> str:
    """V1 holds alpha_s baits and all greedy robots, and alpha_s of its robots are blinded."""
    baits, greedy = range(s.alpha_s), range(s.alpha_s, s.n_max)
    for hit in range(min(s.alpha_s, len(greedy)) + 1):
        blinded = {*greedy[:hit], *baits[: s.alpha_s - hit]}
        survivors = len(set(baits) - blinded)
        if len(blinded) != s.alpha_s or survivors != hit:
            return f"{survivors} baits survive, {hit} greedy robots are blinded"
    return ""


@dataclass(frozen=True, slots=True)
class _Spread:
    """Counts of Pattern 1, Distribution 3, if A* blinds ``part`` robots of V1, baits only of V1b2.

    ``safe`` : |V1b1|, the baits of V1 beyond V1b2; ``left`` : |V1b2 minus A*|; ``hit`` : blinded greedy robots.
    """

    part: int
    safe: int
    left: int
    hit: int


def _spreads(s: Setting) -> Iterator[_Spread]:
    """V1b has alpha_s baits, of which V1b2 are the first alpha_s^1."""
    for part in range(1, s.alpha_s):
        baits = range(s.alpha_s)
        touched = set(baits[:part])
        for hit in range(min(part, s.n_greedy) + 1):
            blinded = set(baits[: part - hit])
            yield _Spread(part, len(set(baits) - touched), len(touched - blinded), hit)


def _safe_baits(s: Setting) -> str:
    for one in _spreads(s):
        if one.safe != s.alpha - one.part:
            says = f"the text says alpha - alpha_s^1 = {s.alpha - one.part}"
            return f"alpha_s^1 = {one.part}: |V1b1| = {one.safe}, {says}"
    return ""


def _safe_baits_repaired(s: Setting) -> str:
    wrong = (one for one in _spreads(s) if one.safe != s.alpha_s - one.part)
    return next((f"alpha_s^1 = {one.part}: |V1b1| = {one.safe}" for one in wrong), "")


def _wrong_balance(s: Setting) -> str:
    """The reason of nd_p1d3v1_4 as printed, with V1b1 not blinded."""
    wrong = (one for one in _spreads(s) if one.safe != one.hit)
    return next(
        (f"alpha_s^1 = {one.part}: |V1b1\\A*| = {one.safe}, greedy robots blinded: {one.hit}" for one in wrong), ""
    )


def _right_balance(s: Setting) -> str:
    wrong = (one for one in _spreads(s) if one.left != one.hit)
    return next((f"alpha_s^1 = {one.part}, greedy robots blinded: {one.hit}" for one in wrong), "")


def _in_v2(s: Setting) -> range:
    """Numbers of greedy robots that V2 can have in Pattern 2'."""
    return range(1, min(s.n_greedy, s.alpha_cs - 1) + 1)


def _safe_baits_submodular(s: Setting) -> str:
    printed = s.alpha - s.alpha_s
    text = f"|V1b1|, the text says alpha - alpha_s^1 = {printed} (all alpha_s in V1)"
    return next((f"|V2g| = {g2} = {text}" for g2 in _in_v2(s) if printed != g2), "")


def _safe_baits_submodular_repaired(s: Setting) -> str:
    """V1b has alpha_s + |V2g| baits, of which V1b2 are alpha_s."""
    rest = (g2 for g2 in _in_v2(s) if len(set(range(_many_baits(s, g2))) - set(range(s.alpha_s))) != g2)
    return next((f"|V2g| = {g2}" for g2 in rest), "")
