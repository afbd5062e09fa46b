"""Theorem 1, the lines that close its proof, and the pattern-free theorem that is stronger."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.entry import ClaimEntry, EntryKind, Reference, SizedClaim
from ratt_opt.audit.appendix.factor import CUBED, KEPT, KEPT_OVER_ONE_PLUS_K, SQUARED, Factor
from ratt_opt.audit.appendix.groups import every_group, one_group
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


def closing_lines() -> Iterator[ClaimEntry]:
    """Yield nd1, nd2, nd, sub2 and sub: the cumulative claims, and the steps that are linear."""
    every_nd = tuple(every_group(ND, CUBED, largest=LARGEST_TEAM))
    every_sub = tuple(every_group(SUB, KEPT_OVER_ONE_PLUS_K, largest=LARGEST_TEAM))
    yield from _all_bait("nd2", "f(u) >= (1-c)^2 f(u*) in every group", ND, SQUARED)
    text = "f(u on S) >= (1-c)^3 f(u* on S), which gives min[(1-c)^3, (1-c)^2/alpha_cs] for the team"
    for label in ("nd1", "nd"):
        yield _entry(label, CUMULATIVE, text, every_nd, GROUPS)
    given = "the bounds of Patterns 1 and 2 and of the patterns left out"
    parts = {"Pattern 1": CUBED, "Pattern 2": CUBED, "any other pattern": CUBED}
    yield _entry("nd1", STEP, "all patterns together", _joined(ND, parts), given, reading="with the omitted patterns")
    text = "in every other pattern too, f(u on S) >= (1-c)^3 f(u* on S): 'the same approximation bound or a better one'"
    yield _entry("nd_other_patterns", CLAIM, text, every_nd, GROUPS)
    yield from _all_bait("sub2", "f(u) >= (1-k) f(u*) in every group", SUB, KEPT)
    text = "in every other pattern and distribution too, f(u on S) >= (1-k)/(1+k) f(u* on S)"
    yield _entry("sub_other_patterns", CLAIM, text, every_sub, GROUPS)
    text = "f(u on S) >= (1-k)/(1+k) f(u* on S), which gives min[(1-k)/(1+k), (1-k)/alpha_cs] for the team"
    yield _entry("sub", CUMULATIVE, text, every_sub, GROUPS)
    given = "the bounds of N > alpha and N <= alpha"
    for label, kind, more, fewer in (("nd", ND, CUBED, SQUARED), ("sub", SUB, KEPT_OVER_ONE_PLUS_K, KEPT)):
        parts = {"N > alpha": more, "N <= alpha": fewer}
        yield _entry(label, STEP, "both cases together", _joined(kind, parts), given)


def _all_bait(label: str, text: str, function_class: FunctionClass, factor: Factor) -> Iterator[ClaimEntry]:
    claims = tuple(one_group(function_class, lambda _: factor, all_bait=True, largest=LARGEST_GROUP))
    for kind in (STEP, CUMULATIVE):
        yield _entry(label, kind, text, claims, "every robot is bait (N <= alpha)")


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
    first = "Theorem 1: at least (1-c)^3 >= min[(1-c)^3, (1-c)^2/alpha_cs]"
    second = "Theorem 1: at least (1-k)/(1+k) >= min[(1-k)/(1+k), (1-k)/alpha_cs]"
    for label, kind, factor, text in (
        (THEOREM1.label, ND, CUBED, first),
        (THEOREM1_SUB.label, SUB, KEPT_OVER_ONE_PLUS_K, second),
        (PATTERN_FREE_ND.label, ND, SQUARED, "pattern-free: at least (1-c)^2 of the optimum"),
        (PATTERN_FREE_SUB.label, SUB, KEPT, "pattern-free: at least 1-k of the optimum"),
    ):
        statement = f"{text}: f(u on S) >= factor f(o on S) for every S and every plan o"
        yield _entry(
            label,
            EntryKind.THEOREM,
            statement,
            every_group(kind, factor, largest=LARGEST_TEAM),
            GROUPS,
            chain="theorems",
        )
    for label, kind, better, text in (
        ("all_bait_sub", SUB, _better_sub, "an all-bait group of g robots keeps (1+(g-1)(1-k))/g of the optimum"),
        (
            "all_bait_nd",
            ND,
            _better_nd,
            "an all-bait group of g robots keeps (1+(g-1)(1-c))/(1+(g-1)/(1-c)) of the optimum",
        ),
    ):
        claims = one_group(kind, better, all_bait=True, largest=LARGEST_GROUP)
        yield _entry(label, EntryKind.THEOREM, text, claims, "all surviving robots are bait", chain="theorems")


def _better_sub(size: int) -> Factor:
    return Factor(ONE + constant(size - 1) * T, constant(size))


def _better_nd(size: int) -> Factor:
    return Factor((ONE + constant(size - 1) * T) * T, T + constant(size - 1))


def _entry(
    label: str,
    kind: EntryKind,
    statement: str,
    claims: Iterable[SizedClaim],
    hypotheses: str,
    *,
    chain: str = "",
    reading: str = "",
) -> ClaimEntry:
    return ClaimEntry(
        label=label,
        kind=kind,
        chain=chain or label,
        statement=statement,
        hypotheses=hypotheses,
        claims=tuple(claims),
        reading=reading,
    )
