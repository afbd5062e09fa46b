"""Theorem 1, the lines that close its proof, and the pattern-free theorem that is stronger."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.bounds import CUBED, KEPT, KEPT_OVER_ONE_PLUS_K, SQUARED, Factor, every_group, one_group
from ratt_opt.audit.appendix.entry import ClaimEntry, EntryKind, Reference, SizedClaim
from ratt_opt.audit.appendix.team_lines import OPT, TEAM
from ratt_opt.audit.engine.claim import Claim, FunctionClass, Ground, Inequality
from ratt_opt.audit.engine.polynomial import ONE, T, constant

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

__all__ = ["PATTERN_FREE_ND", "PATTERN_FREE_SUB", "THEOREM1", "THEOREM1_SUB", "closing_lines", "theorems"]

ND, SUB = FunctionClass.TOTAL_CURVATURE, FunctionClass.CURVATURE
STEP, CUMULATIVE, CLAIM = EntryKind.STEP, EntryKind.CUMULATIVE, EntryKind.CLAIM
THEOREM1 = Reference("eqn:appro_non_descrease", EntryKind.THEOREM)
THEOREM1_SUB = Reference("eqn:appro_submodular", EntryKind.THEOREM)
PATTERN_FREE_ND = Reference("pattern_free_nd", EntryKind.THEOREM)
PATTERN_FREE_SUB = Reference("pattern_free_sub", EntryKind.THEOREM)
GROUPS = "the class and RATT's choices only; every set S of surviving robots, hence every graph, attack and budget"
LARGEST_GROUP = 4
"""Baits in a group of baits only."""
LARGEST_TEAM = 5
"""Robots in play in a group of any pattern: with six the sets of a claim are 4,096."""


SURVIVING = "f(u on S) >= {} f(u* on S)"
_theorem = partial(ClaimEntry, kind=EntryKind.THEOREM, chain="theorems")


def closing_lines() -> Iterator[ClaimEntry]:
    """Yield nd1, nd2, nd, sub2 and sub: the cumulative claims, and the steps that are linear."""
    every_nd = tuple(every_group(ND, CUBED, largest=LARGEST_TEAM))
    every_sub = tuple(every_group(SUB, KEPT_OVER_ONE_PLUS_K, largest=LARGEST_TEAM))
    nd, sub = SURVIVING.format("(1-c)^3"), SURVIVING.format("(1-k)/(1+k)")
    yield from _all_bait("nd2", "f(u) >= (1-c)^2 f(u*) in every group", ND, SQUARED)
    for label in ("nd1", "nd"):
        text = f"{nd}, which gives min[(1-c)^3, (1-c)^2/alpha_cs] for the team"
        yield _line(label, CUMULATIVE, text, every_nd, GROUPS)
    parts = {"Pattern 1": CUBED, "Pattern 2": CUBED, "any other pattern": CUBED}
    given = "the bounds of Patterns 1 and 2 and of the patterns left out"
    joined = _line("nd1", STEP, "all patterns together", _joined(ND, parts), given)
    yield replace(joined, reading="with the omitted patterns")
    text = f"in every other pattern too, {nd}: 'the same approximation bound or a better one'"
    yield _line("nd_other_patterns", EntryKind.CLAIM, text, every_nd, GROUPS)
    yield from _all_bait("sub2", "f(u) >= (1-k) f(u*) in every group", SUB, KEPT)
    text = f"in every other pattern and distribution too, {sub}"
    yield _line("sub_other_patterns", EntryKind.CLAIM, text, every_sub, GROUPS)
    text = f"{sub}, which gives min[(1-k)/(1+k), (1-k)/alpha_cs] for the team"
    yield _line("sub", CUMULATIVE, text, every_sub, GROUPS)
    given = "the bounds of N > alpha and N <= alpha"
    for label, kind, more, fewer in (("nd", ND, CUBED, SQUARED), ("sub", SUB, KEPT_OVER_ONE_PLUS_K, KEPT)):
        claims = _joined(kind, {"N > alpha": more, "N <= alpha": fewer})
        yield _line(label, STEP, "both cases together", claims, given)


def _line(label: str, kind: EntryKind, text: str, claims: Iterable[SizedClaim], given: str) -> ClaimEntry:
    return ClaimEntry(label=label, kind=kind, chain=label, statement=text, hypotheses=given, claims=tuple(claims))


def _all_bait(label: str, text: str, function_class: FunctionClass, factor: Factor) -> Iterator[ClaimEntry]:
    claims = tuple(one_group(function_class, [factor] * LARGEST_GROUP, all_bait=True))
    for kind in (STEP, CUMULATIVE):
        yield _line(label, kind, text, claims, "every robot is bait (N <= alpha)")


def _joined(function_class: FunctionClass, parts: dict[str, Factor]) -> Iterator[SizedClaim]:
    """The first part's bound follows from each part's (opt >= 0)."""
    weakest = next(iter(parts.values())).gap(TEAM, OPT)
    for name, factor in parts.items():
        given = (Inequality(f"the bound for {name}", factor.gap(TEAM, OPT)), Inequality("opt >= 0", OPT))
        ground = Ground(("u",), (0,))
        claim = Claim(function_class=function_class, ground=ground, premises=given, conclusion=weakest)
        yield SizedClaim(size=name, robots=1, claim=claim)


def theorems() -> Iterator[ClaimEntry]:
    """Yield Theorem 1, the pattern-free theorem, and the better bounds of groups of baits."""
    for name, kind, factor, text in (
        (THEOREM1, ND, CUBED, "Theorem 1: at least (1-c)^3 >= min[(1-c)^3, (1-c)^2/alpha_cs]"),
        (
            THEOREM1_SUB,
            SUB,
            KEPT_OVER_ONE_PLUS_K,
            "Theorem 1: at least (1-k)/(1+k) >= min[(1-k)/(1+k), (1-k)/alpha_cs]",
        ),
        (PATTERN_FREE_ND, ND, SQUARED, "pattern-free: at least (1-c)^2 of the optimum"),
        (PATTERN_FREE_SUB, SUB, KEPT, "pattern-free: at least 1-k of the optimum"),
    ):
        statement = f"{text}: f(u on S) >= factor f(o on S) for every S and every plan o"
        claims = tuple(every_group(kind, factor, largest=LARGEST_TEAM))
        yield _theorem(label=name.label, statement=statement, claims=claims, hypotheses=GROUPS)
    sizes = range(1, LARGEST_GROUP + 1)
    for label, kind, better, share in (
        ("all_bait_sub", SUB, map(_better_sub, sizes), "(1+(g-1)(1-k))/g"),
        ("all_bait_nd", ND, map(_better_nd, sizes), "(1+(g-1)(1-c))/(1+(g-1)/(1-c))"),
    ):
        text = f"an all-bait group of g robots keeps {share} of the optimum"
        kept = one_group(kind, [*better], all_bait=True)
        yield _theorem(label=label, statement=text, claims=tuple(kept), hypotheses="all surviving robots are bait")


def _better_sub(size: int) -> Factor:
    return Factor(ONE + constant(size - 1) * T, constant(size))


def _better_nd(size: int) -> Factor:
    return Factor((ONE + constant(size - 1) * T) * T, T + constant(size - 1))
