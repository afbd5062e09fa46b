"""The appendix's sizes and counts: which sets have how many robots, for every budget with N > alpha."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.entry import EnumeratedEntry
from ratt_opt.audit.enumeration.setting import LARGEST, Budgets, counted, every_budget

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from ratt_opt.audit.appendix.entry import Counted

__all__ = ["count_entries"]

PART_ATTACKED, MANY_BAITS = "nd_p1d3v1_7/cumulative", "sub_p2d1v1_10/cumulative"


def count_entries() -> Iterator[EnumeratedEntry]:
    """Yield the claims about sizes; a claim that fails as printed is followed by its repair."""
    rows: tuple[tuple[str, str, Callable[[Budgets], str], str], ...] = (
        ("pattern1_sizes", "|V1| = n_max when V1 has alpha_s baits and all greedy robots", _pattern1_size, ""),
        ("pattern2_sizes", "|V1| = n_max gives |V1b| = alpha_s + |V2g| and |V2| <= alpha_cs", _pattern2_sizes, ""),
        ("nd_p1d1v1_4_counts", "as many baits survive as greedy robots are blinded", _blinded_balance, ""),
        ("nd_p1d3v1_sizes", "|V1b1| = alpha - alpha_s^1", _safe_baits, PART_ATTACKED),
        ("nd_p1d3v1_sizes_repaired", "|V1b1| = alpha_s - alpha_s^1 (repaired)", _safe_baits_repaired, ""),
        ("nd_p1d3v1_4_counts", "|V1b1\\A*| = number of blinded greedy robots (printed)", _wrong_balance, PART_ATTACKED),
        ("nd_p1d3v1_4_counts_repaired", "|V1b2\\A*| = number of blinded greedy robots (repaired)", _right_balance, ""),
        ("sub_p2d1v1_sizes", "|V1b1| = alpha - alpha_s^1 in Pattern 2'", _safe_baits_submodular, MANY_BAITS),
        ("sub_p2d1v1_sizes_repaired", "|V1b1| = |V2g| in Pattern 2' (repaired)", _safe_baits_submodular_repaired, ""),
    )
    repaired = {label for label, *_ in rows if label.endswith("_repaired")}
    for label, statement, check, survives_by in rows:
        serves_by = f"{label}_repaired/claim" if f"{label}_repaired" in repaired else ""
        yield _entry(label, statement, partial(_all_budgets, check), survives_by, serves_by)
    defined = "Theorem 1's bound is defined for every budget (alpha_cs > 0)"
    free = "pattern_free_nd/theorem"
    yield _entry("bound_defined", defined, _no_division_by_zero, free, free)


def _entry(label: str, statement: str, run: Callable[[], Counted], survives_by: str, serves_by: str) -> EnumeratedEntry:
    return EnumeratedEntry(
        label=label,
        kind="claim",
        chain="sizes",
        statement=statement,
        hypotheses="RATT's and CAA's definitions",
        enumerate_cases=run,
        survives_by=survives_by,
        serves_by=serves_by,
    )


def _all_budgets(check: Callable[[Budgets], str]) -> Counted:
    """``check`` returns what is wrong at one budget, or the empty string; budgets with N <= alpha are left out."""
    bad, count = [], 0
    for budgets in every_budget(LARGEST):
        if budgets.alpha < budgets.n_robots:
            count += 1
            if fault := check(budgets):
                bad.append(f"{budgets.text()}: {fault}")
    return counted(bad, f"N <= {LARGEST}, every alpha_s and alpha_c with N > alpha", count, "budgets")


def _no_division_by_zero() -> Counted:
    bad = [f"{b.text()}: the bound divides by zero" for b in every_budget(5) if b.alpha_cs == 0]
    return counted(bad, "N <= 5, every budget", sum(1 for _ in every_budget(5)), "budgets")


def _pattern1_size(b: Budgets) -> str:
    size = b.alpha_s + b.n_robots - b.alpha
    return "" if size == b.n_max else f"|V1| = {size}, n_max = {b.n_max}"


def _pattern2_sizes(b: Budgets) -> str:
    """With |V1| = n_max and g2 greedy robots in V2, V1 has n_max - (N - alpha - g2) baits; V2 is in the rest."""
    for g2 in range(1, b.n_robots - b.alpha + 1):
        if b.n_max - (b.n_robots - b.alpha - g2) != b.alpha_s + g2 or b.n_robots - b.n_max > b.alpha_cs:
            return f"|V2g| = {g2}"
    return ""


def _blinded_balance(b: Budgets) -> str:
    """V1 holds alpha_s baits and all greedy robots, and alpha_s of its robots are blinded."""
    baits, greedy = range(b.alpha_s), range(b.alpha_s, b.n_max)
    for hit in range(min(b.alpha_s, len(greedy)) + 1):
        blinded = {*greedy[:hit], *baits[: b.alpha_s - hit]}
        survivors = len(set(baits) - blinded)
        if len(blinded) != b.alpha_s or survivors != hit:
            return f"{survivors} baits survive, {hit} greedy robots are blinded"
    return ""


def _part_attacked(b: Budgets) -> Iterator[tuple[int, int, int, int]]:
    """Yield (alpha_s^1, |V1b1|, |V1b2 minus A*|, blinded greedy robots) of Pattern 1, Distribution 3.

    V1b has alpha_s baits. A* blinds alpha_s^1 robots of V1, baits only of V1b2; V1b1 is the rest of V1b.
    """
    for part in range(1, b.alpha_s):
        baits = range(b.alpha_s)
        touched = set(baits[:part])
        for hit in range(min(part, b.n_robots - b.alpha) + 1):
            blinded = set(baits[: part - hit])
            yield part, len(set(baits) - touched), len(touched - blinded), hit


def _safe_baits(b: Budgets) -> str:
    for part, safe, _, _ in _part_attacked(b):
        if safe != b.alpha - part:
            return f"alpha_s^1 = {part}: |V1b1| = {safe}, the text says alpha - alpha_s^1 = {b.alpha - part}"
    return ""


def _safe_baits_repaired(b: Budgets) -> str:
    wrong = (
        f"alpha_s^1 = {part}: |V1b1| = {safe}" for part, safe, _, _ in _part_attacked(b) if safe != b.alpha_s - part
    )
    return next(wrong, "")


def _wrong_balance(b: Budgets) -> str:
    """The reason of nd_p1d3v1_4 as printed, with V1b1, of which none is blinded."""
    for part, safe, _, hit in _part_attacked(b):
        if safe != hit:
            return f"alpha_s^1 = {part}: |V1b1\\A*| = {safe}, greedy robots blinded: {hit}"
    return ""


def _right_balance(b: Budgets) -> str:
    wrong = (
        f"alpha_s^1 = {part}, greedy robots blinded: {hit}" for part, _, left, hit in _part_attacked(b) if left != hit
    )
    return next(wrong, "")


def _safe_baits_submodular(b: Budgets) -> str:
    for g2 in range(1, min(b.n_robots - b.alpha, b.alpha_cs - 1) + 1):
        if b.alpha - b.alpha_s != g2:
            return f"|V2g| = {g2} = |V1b1|, the text says alpha - alpha_s^1 = {b.alpha - b.alpha_s} (all alpha_s in V1)"
    return ""


def _safe_baits_submodular_repaired(b: Budgets) -> str:
    """V1b has alpha_s + |V2g| baits, of which V1b2 are alpha_s."""
    for g2 in range(1, min(b.n_robots - b.alpha, b.alpha_cs - 1) + 1):
        baits = set(range(b.n_max - (b.n_robots - b.alpha - g2)))
        if len(baits - set(range(b.alpha_s))) != g2:
            return f"|V2g| = {g2}"
    return ""
