"""Lines that the text admits several readings of: whose worst attack A* is, which robots a set holds, who is replaced.

Here the readings differ in the statement itself; if they differ in a premise only, they stand with their line.

The dominance claim of Pattern 2 (Distributions 2 and 3, ii) says that baits of V1 beat greedy survivors of V2. With
its stated reason only, it is one linear claim. "A* is the worst attack" adds one disjunction
per attack outcome: some group of that outcome still reaches the team value under A*, which is
``f(u on V2\\A*)`` if the claim fails. One outcome suffices: V1's surviving baits together, each greedy
survivor alone. It gives one linear claim per group, and the entry is proved when all of them are.

The smallest team in which V2\\A* holds two greedy robots (one is beaten by any single bait) has
alpha_s = 1, |V1| = |V2| = 3, hence N = 6; with part of the attack in V1, alpha_s = 2 and N = 7.
"""

from __future__ import annotations

from functools import partial
from itertools import combinations, product
from typing import TYPE_CHECKING

from ratt_audit.appendix.entry import ClaimEntry, EntryKind, EntryName
from ratt_audit.appendix.patterns import BAITS, GROUP, beside_v2
from ratt_audit.appendix.roles import ONE_PLUS_K, Side, SizedClaim, Team, attacks_on, team_of, worst_for
from ratt_audit.appendix.theorems import PATTERN_FREE_ND, THEOREM1
from ratt_audit.engine.claim import Inequality, Linear
from ratt_audit.engine.polynomials import T
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.outcomes import non_dominated_outcomes
from ratt_opt.graph.threat import Threat
from ratt_opt.worst_ratio.function_class import FunctionClass

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_audit.appendix.roles import Robots

__all__ = ["LEFT_SIDE", "SETTINGS", "dominance_entries", "readings_of_sets", "readings_of_the_attack"]

PLAN, OPTIMUM = "A* is the plan's worst attack", "A* is the optimum's worst attack"
ND = FunctionClass.TOTAL_CURVATURE
STEP, AS_WRITTEN, CUMULATIVE = EntryKind.STEP, EntryKind.AS_WRITTEN, EntryKind.CUMULATIVE


LEFT_SIDE = "worst_case_left_side"
"""Label of ours: from the value under A*, which the appendix bounds, to the worst-case value, of which Theorem 1 is."""


def readings_of_the_attack() -> Iterator[ClaimEntry]:
    """Yield eq:team_subgroup and eq:opt_team_subgroup under both readings of A*, and what Theorem 1 needs beside them.

    The first, as printed, says what RATT's value under A* is: an identity. The second says that the optimum's worst
    case is its value under A*, of which the proof uses "at most". Theorem 1 is about RATT's worst case: that this is no
    less than RATT's value under A* is used without a line of its own.
    """
    label = "opt_team_subgroup"
    for worst, reading in ((Side.RATT, PLAN), (Side.OPTIMUM, OPTIMUM)):
        identity = partial(_reading, label="team_subgroup", claims=tuple(_left()), reading=reading)
        for kind in (STEP, AS_WRITTEN, CUMULATIVE):
            text = "RATT's value under A* = that of the best group A* leaves"
            yield identity(kind=kind, statement=text, serves_by=PATTERN_FREE_ND)
        above, below = tuple(_other_attacks(worst, Side.OPTIMUM)), tuple(_below(Side.OPTIMUM))
        for kind, relation, claims in (
            (STEP, "<=", below),
            (AS_WRITTEN, "=", above + below),
            (CUMULATIVE, "<=", below),
        ):
            text = f"the optimum's worst-case value {relation} its value under A*"
            serves_by = EntryName(label, STEP)
            yield _reading(label=label, kind=kind, statement=text, claims=claims, reading=reading, serves_by=serves_by)
        text = "RATT's worst-case value, of which Theorem 1 is, >= its value under A*, which the appendix bounds"
        claims = tuple(_other_attacks(worst, Side.RATT))
        yield _reading(
            label=LEFT_SIDE,
            kind=EntryKind.CLAIM,
            statement=text,
            claims=claims,
            reading=reading,
            serves_by=PATTERN_FREE_ND,
        )


_reading = partial(ClaimEntry, chain="readings", hypotheses="RATT's choices", survives_by=THEOREM1)


def _left() -> Iterator[SizedClaim]:
    """The value under A* is the best group's. One group is left here, so both ways agree, by definition."""
    team, under = team_of(1, 1), Linear.of("value")
    for attacked in attacks_on(team.robots, 1):
        best = team.chosen(set(team.robots) - set(attacked))
        defined = Inequality("the value is the best group's", under - best), Inequality("and no more", best - under)
        for gap in (under - best, best - under):
            yield SizedClaim(size=team.text(attacked), robots=2, claim=team.claim(ND, gap, defined), team=team)


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
                yield SizedClaim(size=text, robots=len(team.robots), claim=claim, team=team, attacked=attacked)


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
            survives_by=EntryName("sub_p2d1v1_10", CUMULATIVE),
            serves_by=EntryName("sub_p2d1v1_9", kind, ""),
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
            survives_by=EntryName("nd_p2d1v1", CUMULATIVE),
            serves_by=EntryName("nd_p2d1v1", CUMULATIVE),
        )


def _swaps(side: Side) -> Iterator[SizedClaim]:
    """A bait of V1 stands in for a greedy robot x1 of V2: does RATT's value not rise, or the optimum's not fall?"""
    for team in beside_v2(("b1",)):
        whole, swapped = team.value(side, ("b1", "g1")), team.value(side, ("x1", "g1"))
        left, right = (whole, swapped) if side is Side.RATT else (swapped, whole)
        text = f"b1 replaced by x1 beside g1; greedy order {','.join(team.greedy)}"
        yield SizedClaim(size=text, robots=3, claim=team.comparison(ND, left, right), team=team)


def _every_subset(*, from_start: bool) -> Iterator[SizedClaim]:
    """V1 = {b1, b2} or {b1, b2, g1}, one of it blinded; x1 is the greedy robot in V2."""
    for group, team in ((BAITS, Team(BAITS, ("x1",))), *((GROUP, team) for team in beside_v2(BAITS))):
        for attacked in ("b1", *group[2:]):
            above = team.chosen(r for r in group if r != attacked) if from_start else team.chosen(team.greedy) * T
            for chosen in combinations(group, len(team.greedy)):
                claim = team.comparison(FunctionClass.CURVATURE, above * ONE_PLUS_K, team.compared(chosen) * T)
                text = f"{team.text((attacked,))}; W = {{{','.join(chosen)}}}; order {','.join(team.greedy)}"
                yield SizedClaim(size=text, robots=len(team.robots), claim=claim, team=team, attacked=(attacked,))


SETTINGS = {2: (6, 1, 9), 3: (7, 2, 12)}
"""Distribution -> (N, alpha_s, alpha_c): CAA gives n_max = 3 and 4, so groups (3, 3) and (4, 3)."""
SURVIVORS = ("b1", "b2", "b3")
RIVALS = ("g1", "g2")
FAMILIES = {FunctionClass.TOTAL_CURVATURE: "total curvature", FunctionClass.CURVATURE: "submodular"}


def dominance_entries() -> Iterator[ClaimEntry]:
    """Yield the claim with its stated reason, and with "A* is the worst attack" added, for both classes."""
    for distribution, function_class in product(SETTINGS, FAMILIES):
        yield from _dominance(distribution, function_class)


def _dominance(distribution: int, function_class: FunctionClass) -> Iterator[ClaimEntry]:
    n_robots, alpha_s, alpha_c = SETTINGS[distribution]
    bait = team_of(n_robots - len(RIVALS), 0).bait
    # One control per robot: RATT's plan is the only plan, so nothing else is in play.
    team = Team(bait, RIVALS, without_optimum=frozenset((*bait, *RIVALS)))
    size = f"N = {n_robots}, alpha_s = {alpha_s}, alpha_c = {alpha_c}: 3 baits of V1 and 2 greedy of V2 left"
    family, label = FAMILIES[function_class], f"nd_p2d{distribution}v2_dominance"

    def sized(premises: tuple[Inequality, ...], case: str = "") -> SizedClaim:
        claim = team.comparison(function_class, team.chosen(SURVIVORS), team.chosen(RIVALS), premises)
        return SizedClaim(size=size + case, robots=n_robots, claim=claim, team=team)

    def given_that(group: Robots) -> SizedClaim:
        name = f"{{{','.join(group)}}}"
        reason = f"the best group of the other attack is {name}, and A* is no better for the team"
        reaches = Inequality(reason, team.chosen(group) - team.chosen(RIVALS))
        return sized((*team.premises, reaches), f"; other attack's best group {name}")

    entry = partial(
        ClaimEntry,
        label=label,
        kind=EntryKind.CLAIM,
        chain="dominance",
        statement="f(u on V1\\A*) >= f(u on V2\\A*) when only greedy robots of V2 survive",
        survives_by=EntryName(f"nd_p2d{distribution}v2", EntryKind.CUMULATIVE),
    )
    proved, reading = f"A* is the worst attack; {family}", f"stated reason only; {family}"
    text = f"more baits than greedy robots survive, each bait is individually better; {function_class.value}"
    serves_by, claims = EntryName(label, EntryKind.CLAIM, proved), (sized(team.bait_premises()),)
    yield entry(hypotheses=text, claims=claims, reading=reading, serves_by=serves_by)
    text = f"RATT's choices, and A* is the worst attack on its plan; {function_class.value}"
    threat = Threat(CommunicationGraph.complete(n_robots), alpha_s, alpha_c)
    cases = tuple(given_that(group) for group in _deciding_outcome(team, threat))
    yield entry(hypotheses=text, claims=cases, reading=proved)


def _deciding_outcome(team: Team, threat: Threat) -> tuple[Robots, ...]:
    """The outcome used, after checking that the library finds it among the attacks of this setting."""
    groups = (SURVIVORS, *((rival,) for rival in RIVALS))
    outcome = {frozenset(team.robots.index(name) for name in group) for group in groups}
    assert any(set(found) == outcome for found in non_dominated_outcomes(threat)), "the outcome is within the budgets"
    return groups
