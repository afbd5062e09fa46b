"""The theorems about how few and how many robots an attack leaves together, for the sizes that the machine decides.

Their proofs for any size are in the documentation of ``group_size_bound`` and ``survivor_bound``. What is decided here
are their inequalities between values; which robots survive is a matter of counting, shown there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_audit.appendix.entry import ClaimEntry, EntryKind
from ratt_audit.appendix.roles import T2, Factor, SizedClaim, every_surviving_set, kept_by
from ratt_audit.engine.claim import Claim, Ground, Inequality, Linear
from ratt_audit.engine.polynomials import ONE, T, constant
from ratt_opt.worst_ratio.function_class import FunctionClass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["size_theorems"]

ND, SUB = FunctionClass.TOTAL_CURVATURE, FunctionClass.CURVATURE
LARGEST_GROUP, LARGEST_TEAM = 4, 4
"""Robots in a group of any plan; robots in play in a group that survives."""
SUB_SURVIVORS = "(1+(s-1)(1-k)^2)/s"
ND_SURVIVORS = "(1+(s-1)(1-c))/(1+(s-1)/(1-c))"


def size_theorems() -> Iterator[ClaimEntry]:
    """Yield, for both classes, the group-size theorem and the survivor theorem."""
    for label, kind, factor, share in (
        ("group_size_sub", SUB, lambda g: Factor(ONE, constant(g)), "1/g"),
        ("group_size_nd", ND, lambda g: Factor(T, T + constant(g - 1)), "(1-c)/(g-c)"),
    ):
        text = (
            f"a bait worth v survives, and an attack leaves any plan groups of at most g robots worth up to v: {share}"
        )
        claims = tuple(_against_one(kind, factor))
        given = "the class; alpha_cs >= 1; v is the largest bait value that a sensing attack cannot remove"
        yield _theorem(label, f"{text} of the optimum", claims, given)
    for label, kind, factor, share in (
        ("survivors_sub", SUB, lambda s: Factor(ONE + constant(s - 1) * T2, constant(s)), SUB_SURVIVORS),
        ("survivors_nd", ND, lambda s: Factor(T + constant(s - 1) * T2, T + constant(s - 1)), ND_SURVIVORS),
    ):
        text = f"RATT keeps {share} of the optimum if attacks leave groups of at most s unblinded robots"
        given = "the class and RATT's choices; S with a bait or the first greedy robot, else as many baits elsewhere"
        yield _theorem(label, text, (*_with_a_best(kind, factor), *_beside_baits(kind, factor)), given)


def _theorem(label: str, statement: str, claims: tuple[SizedClaim, ...], given: str) -> ClaimEntry:
    kind = EntryKind.THEOREM
    return ClaimEntry(label=label, kind=kind, chain="theorems", statement=statement, claims=claims, hypotheses=given)


def _against_one(function_class: FunctionClass, factor: Callable[[int], Factor]) -> Iterator[SizedClaim]:
    """One bait against any plan's group of g robots, each worth at most as much alone."""
    for size in range(1, LARGEST_GROUP + 1):
        yield _against(function_class, factor(size), 1, size, f"one bait, a group of {size}")


def _with_a_best(function_class: FunctionClass, factor: Callable[[int], Factor]) -> Iterator[SizedClaim]:
    """Surviving sets with a bait or the first greedy robot."""
    for team, group in every_surviving_set(largest=LARGEST_TEAM):
        if team.bait or group[0] == team.greedy[0]:
            yield kept_by(function_class, factor(len(group)), team, group)


def _beside_baits(function_class: FunctionClass, factor: Callable[[int], Factor]) -> Iterator[SizedClaim]:
    """A group of greedy robots without the first one: as many baits see elsewhere."""
    for size in range(1, LARGEST_GROUP):
        text = f"{size} greedy robots without the first, {size} baits in another group"
        yield _against(function_class, factor(size), size, size, text)


def _against(function_class: FunctionClass, factor: Factor, baits: int, size: int, text: str) -> SizedClaim:
    """``f(baits) >= factor f(o on the group)``, each bait being worth at least each of the compared elements."""
    bait = [f"b{i + 1}" for i in range(baits)]
    others = [f"o{i + 1}" for i in range(size)]
    ground = Ground((*bait, *others), tuple(range(baits + size)))

    def f(names: list[str]) -> Linear:
        return Linear.of(ground.mask(names))

    order = tuple(Inequality(f"bait: f({b}) >= f({o})", f([b]) - f([o])) for b in bait for o in others)
    gap = factor.gap(f(bait), f(others))
    claim = Claim(function_class=function_class, ground=ground, premises=order, conclusion=gap)
    return SizedClaim(size=text, robots=baits + size, claim=claim)
