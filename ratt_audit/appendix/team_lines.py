"""The lines that sum up a distribution or a pattern: from groups to the team.

``team`` is RATT's value under A*, the left side that the paper prints (eq:team_subgroup), and ``opt`` the optimum's
worst-case value, at most its value under A*. They are no function values, so they enter as auxiliary numbers with the
facts that define them. Each claim fixes which group wins for the optimum and uses that group's own factor, which is at
least the minimum the paper writes (opt >= 0).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ratt_audit.appendix.entry import ClaimEntry, EntryKind, EntryName
from ratt_audit.appendix.roles import CUBED, KEPT_OVER_ONE_PLUS_K, SQUARED, T2, Factor, SizedClaim, Team
from ratt_audit.engine.claim import Inequality, Linear
from ratt_audit.engine.polynomials import T, constant
from ratt_opt.worst_ratio.function_class import FunctionClass

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    Groups = tuple[tuple[str, ...], ...]

__all__ = ["OPT", "TEAM", "team_lines"]

TEAM, OPT = Linear.of("team"), Linear.of("opt")
STEP, CUMULATIVE = EntryKind.STEP, EntryKind.CUMULATIVE
HYPOTHESES = "the class, RATT's choices; team = RATT's value under A*, opt <= the compared plan's value under A*"
ALPHA_CS = constant(2)
"""alpha_cs of the groupings of Pattern 2."""


@dataclass(frozen=True, slots=True)
class _Grouping:
    """Groups left by A* (``left``), and each one's factor; in words (``size``)."""

    size: str
    team: Team
    left: Groups
    factors: tuple[Factor, ...]

    @property
    def bounds(self) -> tuple[Inequality, ...]:
        """Conclusions of the chains of the groups."""
        return tuple(
            Inequality(f"bound of group {k + 1}", factor.gap(self.team.chosen(group), self.team.compared(group)))
            for k, (group, factor) in enumerate(zip(self.left, self.factors, strict=True))
        )


@dataclass(frozen=True, slots=True)
class _Bound:
    """Statement of a summing-up line about its groupings, in symbols."""

    function_class: FunctionClass
    text: str
    factor: Factor


ND_1 = _Bound(FunctionClass.TOTAL_CURVATURE, "(1-c)^3", CUBED)
ND_2 = _Bound(FunctionClass.TOTAL_CURVATURE, "min[(1-c)^3, (1-c)^2/alpha_cs]", Factor(T2, ALPHA_CS))
SUB_2 = _Bound(FunctionClass.CURVATURE, "min[(1-k)/(1+k), (1-k)/alpha_cs]", Factor(T, ALPHA_CS))


def team_lines() -> Iterator[ClaimEntry]:
    """Yield the summing-up entries of the whole appendix, in its order."""
    for pattern, bound, groupings in (("nd_p1", ND_1, _pattern1()), ("nd_p2", ND_2, _pattern2(CUBED, ND_2.factor))):
        for number, grouping in enumerate(groupings):
            yield from _distribution(f"{pattern}_d{number + 1}", bound, grouping)
        yield from _overall(pattern, bound, groupings)
    yield from _distribution("sub_p2_d1", SUB_2, _pattern2(KEPT_OVER_ONE_PLUS_K, SUB_2.factor)[0])


def _pattern1() -> tuple[_Grouping, ...]:
    b1, b2, b3, g1 = ("b1",), ("b2",), ("b3",), ("g1",)
    small, large, factors = Team(b1 + b2, g1), Team(b1 + b2 + b3, g1), (CUBED, SQUARED)
    third = "V1 = {b1,b2,g1}, V2 = {b3,..}, one blinded in each, A* hits b1"
    return (
        _Grouping("V1 = {b1,g1}, V2 = {b2}, A* = {g1}", small, (b1, b2), factors),
        _Grouping("V1 = {b1,g1}, V2 = {b2,b3}, A* = {b2}", large, (b1 + g1, b3), factors),
        _Grouping(third, large, (b2 + g1, b3), factors),
    )


def _pattern2(many: Factor, few: Factor) -> tuple[_Grouping, ...]:
    """V1 = {b1, b2, g1}, V2 = {b3, x1}; alpha_cs = 2."""
    b1, b3, x1 = ("b1",), ("b3",), ("x1",)
    team, factors = Team(b1 + b3, x1), (many, few)
    third = "V1 = {b1,..}, V2 = {b3,x1}, one blinded in each, A* hits x1"
    return (
        _Grouping("V1 = {b1,b2}, V2 = {b3,x1}, A* = {b2}", team, (b1, b3 + x1), factors),
        _Grouping("V1 = {b1,..}, V2 = {b3,x1}, A* = {b3}", team, (b1, x1), factors),
        _Grouping(third, team, (b1, b3), factors),
    )


def _distribution(label: str, bound: _Bound, grouping: _Grouping) -> Iterator[ClaimEntry]:
    text = f"RATT's value under A* >= {bound.text} of the optimum's worst case"
    given, alone = (tuple(_claims(bound.function_class, grouping, is_step=is_step)) for is_step in (True, False))
    step = _line(label, STEP, f"the bounds of its groups: {text}", given)
    yield replace(step, survives_by=EntryName(label, CUMULATIVE))
    yield _line(label, CUMULATIVE, f"RATT's choices alone: {text}", alone)


def _line(label: str, kind: EntryKind, text: str, claims: tuple[SizedClaim, ...]) -> ClaimEntry:
    text = f"from {text}"
    return ClaimEntry(label=label, kind=kind, chain=label, statement=text, hypotheses=HYPOTHESES, claims=claims)


def _claims(function_class: FunctionClass, grouping: _Grouping, *, is_step: bool) -> Iterator[SizedClaim]:
    team = grouping.team
    given = grouping.bounds if is_step else team.premises
    worth = tuple(Inequality("team >= RATT's value in a group", TEAM - team.chosen(group)) for group in grouping.left)
    for winner, group in enumerate(grouping.left):
        loses = (Inequality("opt <= the optimum's best group", team.compared(group) - OPT),)
        claim = team.claim(function_class, grouping.factors[winner].gap(TEAM, OPT), given + worth + loses)
        size = f"{grouping.size}; the optimum's best group is V{winner + 1}"
        yield SizedClaim(size=size, robots=len(team.robots), claim=claim, team=team)


def _overall(label: str, bound: _Bound, groupings: Sequence[_Grouping]) -> Iterator[ClaimEntry]:
    """A line that repeats the bound of its parts: the step is the bound itself; cumulatively, all parts again."""
    team, kind = groupings[0].team, bound.function_class
    part = bound.factor.gap(TEAM, OPT)
    same = team.claim(kind, part, (Inequality("the bound of the part", part),))
    step = (SizedClaim(size="each part", robots=len(team.robots), claim=same),)
    again = tuple(claim for grouping in groupings for claim in _claims(kind, grouping, is_step=False))
    text = f"RATT's value under A* >= {bound.text} of the optimum's worst case"
    yield _line(label, STEP, f"Distributions 1 to 3: {text}", step)
    yield _line(label, CUMULATIVE, f"RATT's choices alone: {text}", again)
