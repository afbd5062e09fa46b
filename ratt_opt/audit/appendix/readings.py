"""Lines that the text admits several readings of: whose worst attack A* is, which robots a set holds, who is replaced.

Here the readings differ in the statement itself; where they differ in a premise only, they stand with their line.
"""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.bounds import ONE_PLUS_K
from ratt_opt.audit.appendix.entry import ClaimEntry, EntryKind, Reference, SizedClaim
from ratt_opt.audit.appendix.pattern2 import beside_v2
from ratt_opt.audit.appendix.roles import Side, attacks_on, team_of, worst_for
from ratt_opt.audit.appendix.submodular import GROUP
from ratt_opt.audit.appendix.theorems import PATTERN_FREE_ND, THEOREM1
from ratt_opt.audit.engine.claim import FunctionClass, Inequality, Linear
from ratt_opt.audit.engine.polynomial import T

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["readings_of_sets", "readings_of_the_attack"]

ND = FunctionClass.TOTAL_CURVATURE
STEP, AS_WRITTEN, CUMULATIVE = EntryKind.STEP, EntryKind.AS_WRITTEN, EntryKind.CUMULATIVE


def readings_of_the_attack() -> Iterator[ClaimEntry]:
    """Yield eq:team_subgroup and eq:opt_team_subgroup under both readings of A*, as used and as written.

    The proof uses "RATT's worst-case value >= its value under A*" and "the optimum's <= its value under A*".
    """
    optimum = "opt_team_subgroup"
    lines = (
        ("team_subgroup", Side.RATT, ">=", "RATT's", PATTERN_FREE_ND),
        (optimum, Side.OPTIMUM, "<=", "the optimum's", Reference(optimum, STEP)),
    )
    for worst, reading in (
        (Side.RATT, "A* is the plan's worst attack"),
        (Side.OPTIMUM, "A* is the optimum's worst attack"),
    ):
        for label, side, used, who, serves_by in lines:
            above, below = tuple(_other_attacks(worst, side)), tuple(_below(side))
            as_used = above if used == ">=" else below
            for kind, relation, claims in (
                (STEP, used, as_used),
                (AS_WRITTEN, "=", above + below),
                (CUMULATIVE, used, as_used),
            ):
                yield ClaimEntry(
                    label=label,
                    kind=kind,
                    chain="readings",
                    statement=f"{who} worst-case value {relation} its value under A*",
                    hypotheses="RATT's choices",
                    claims=claims,
                    reading=reading,
                    survives_by=THEOREM1,
                    serves_by=serves_by,
                )


def _other_attacks(worst: Side, side: Side) -> Iterator[SizedClaim]:
    """Blind one of two or three robots in one group: if A* hurts ``worst`` most, is it the least for ``side``?"""
    for n_greedy in (1, 2):
        team = team_of(1, n_greedy)
        for attacked in attacks_on(team.robots, 1):
            premises = team.premises + worst_for(team, team.robots, attacked, side=worst)
            here = team.value(side, set(team.robots) - set(attacked))
            for other in (robot for robot in team.robots if robot not in attacked):
                claim = team.claim(ND, team.value(side, set(team.robots) - {other}) - here, premises)
                text = f"{team.text(attacked)}, against blinding {other}"
                yield SizedClaim(size=text, robots=len(team.robots), claim=claim, team=team)


def _below(side: Side) -> Iterator[SizedClaim]:
    """A worst-case value, at most every attack's value, is at most A*'s: true for any A*."""
    team, worst = team_of(1, 1), Linear.of("worst")
    gaps = {robot: team.value(side, set(team.robots) - {robot}) - worst for robot in team.robots}
    bounds = tuple(Inequality(f"worst <= value without {robot}", gap) for robot, gap in gaps.items())
    for robot, gap in gaps.items():
        yield SizedClaim(size=team.text((robot,)), robots=2, claim=team.claim(ND, gap, team.premises + bounds))


def readings_of_sets() -> Iterator[ClaimEntry]:
    """Yield sub_p2d1v1_9 read "for all W in V1 with |W| = |Vg|", and the substitution that Pattern 2, i) speaks of."""
    for kind, origin in ((STEP, "the line before"), (CUMULATIVE, "the start of its chain")):
        yield ClaimEntry(
            label="sub_p2d1v1_9",
            kind=kind,
            chain="sub_p2d1v1",
            statement=f"from {origin}: >= (1-k)/(1+k) f(u* on W)",
            hypotheses="f normalised, non-decreasing, submodular, curvature <= k; RATT's choices",
            claims=tuple(_every_subset(from_start=kind is CUMULATIVE)),
            reading="for every set W of |Vg| robots of V1, as the line says",
            survives_by=Reference("sub_p2d1v1_10", CUMULATIVE),
            serves_by=Reference("sub_p2d1v1_9", kind, ""),
        )
    for side, text in (
        (Side.RATT, "f(u on V1) >= f(u on V1 with a bait replaced by x1)"),
        (Side.OPTIMUM, "f(u* on V1 with a bait replaced by x1) >= f(u* on V1)"),
    ):
        yield ClaimEntry(
            label="nd_p2_substitution",
            kind=EntryKind.CLAIM,
            chain="nd_p2d1v1",
            statement=f"the bait is individually better than x1, hence {text}",
            hypotheses="total curvature <= c; all of RATT's choices",
            claims=tuple(_swaps(side)),
            reading=side.value,
            survives_by=Reference("nd_p2d1v1", CUMULATIVE),
            serves_by=Reference("nd_p2d1v1", CUMULATIVE),
        )


def _swaps(side: Side) -> Iterator[SizedClaim]:
    """A bait of V1 stands in for a greedy robot x1 of V2: does RATT's value not rise, or the optimum's not fall?"""
    for team in beside_v2(("b1",)):
        whole, swapped = team.value(side, ("b1", "g1")), team.value(side, ("x1", "g1"))
        left, right = (whole, swapped) if side is Side.RATT else (swapped, whole)
        text = f"b1 replaced by x1 beside g1; greedy order {','.join(team.greedy)}"
        yield SizedClaim(size=text, robots=3, claim=team.comparison(ND, left, right), team=team)


def _every_subset(*, from_start: bool) -> Iterator[SizedClaim]:
    """V1 = {b1, b2, g1}, one of it blinded; x1 is the greedy robot in V2, so |Vg| = 2."""
    for team in beside_v2(("b1", "b2")):
        for attacked in ("b1", "g1"):
            above = team.chosen(r for r in GROUP if r != attacked) if from_start else team.chosen(team.greedy) * T
            for chosen in combinations(GROUP, 2):
                claim = team.comparison(FunctionClass.CURVATURE, above * ONE_PLUS_K, team.compared(chosen) * T)
                text = f"{team.text((attacked,))}; W = {{{','.join(chosen)}}}; order {','.join(team.greedy)}"
                yield SizedClaim(size=text, robots=4, claim=claim, team=team)
