"""The dominance claim of Pattern 2 (Distributions 2 and 3, ii): baits of V1 beat greedy survivors of V2.

With its stated reason only, it is one linear claim. "A* is the worst attack" adds one disjunction
per attack outcome: some group of that outcome still reaches the team value under A*, which is
``f(u on V2\\A*)`` if the claim fails. One outcome suffices: V1's surviving baits together, each greedy
survivor alone. It gives one linear claim per group, and the entry is proved when all of them are.

The smallest team in which V2\\A* holds two greedy robots (one is beaten by any single bait) has
alpha_s = 1, |V1| = |V2| = 3, hence N = 6; with part of the attack in V1, alpha_s = 2 and N = 7.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.entry import ClaimEntry, EntryKind, Reference, SizedClaim
from ratt_opt.audit.appendix.roles import Team, team_of
from ratt_opt.audit.engine.claim import FunctionClass, Inequality
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.outcomes import non_dominated_outcomes
from ratt_opt.graph.threat import Threat

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["SETTINGS", "deciding_outcome", "dominance_entries"]

SETTINGS = {2: (6, 1, 9), 3: (7, 2, 12)}
"""Distribution -> (N, alpha_s, alpha_c): CAA gives n_max = 3 and 4, so groups (3, 3) and (4, 3)."""
SURVIVORS = ("b1", "b2", "b3")
RIVALS = ("g1", "g2")
STATED, WORST = "stated reason only", "A* is the worst attack"
FAMILIES = {FunctionClass.TOTAL_CURVATURE: "total curvature", FunctionClass.CURVATURE: "submodular"}


def _team(distribution: int) -> Team:
    """One control per robot: RATT's plan is the only plan, so nothing else is in play."""
    bait = team_of(SETTINGS[distribution][0] - 2, 0).bait
    return Team(bait, RIVALS, without_optimum=frozenset((*bait, *RIVALS)))


def deciding_outcome(distribution: int) -> tuple[tuple[str, ...], ...]:
    """The outcome used, after checking that the library finds it among the attacks of this setting."""
    n_robots, alpha_s, alpha_c = SETTINGS[distribution]
    groups = (SURVIVORS, *((rival,) for rival in RIVALS))
    robots = _team(distribution).robots
    outcome = {frozenset(robots.index(name) for name in group) for group in groups}
    threat = Threat(CommunicationGraph.complete(n_robots), alpha_s, alpha_c)
    assert any(set(found) == outcome for found in non_dominated_outcomes(threat)), "the outcome is within the budgets"
    return groups


def dominance_entries() -> Iterator[ClaimEntry]:
    """Yield the claim with its stated reason, and with "A* is the worst attack" added, for both classes."""
    for distribution in SETTINGS:
        team = _team(distribution)
        for kind in FAMILIES:
            text = f"more baits than greedy robots survive, each bait is individually better; {kind.value}"
            stated = _sized(distribution, kind, team.bait_premises())
            yield _entry(distribution, kind, STATED, text, (stated,))
            text = f"RATT's choices, and A* is the worst attack on its plan; {kind.value}"
            yield _entry(distribution, kind, WORST, text, tuple(_cases(distribution, kind)))


def _cases(distribution: int, function_class: FunctionClass) -> Iterator[SizedClaim]:
    team = _team(distribution)
    for group in deciding_outcome(distribution):
        name = f"{{{','.join(group)}}}"
        reason = f"the best group of the other attack is {name}, and A* is no better for the team"
        reaches = Inequality(reason, team.chosen(group) - team.chosen(RIVALS))
        case = f"; other attack's best group {name}"
        yield _sized(distribution, function_class, (*team.premises, reaches), case)


def _sized(
    distribution: int, function_class: FunctionClass, premises: tuple[Inequality, ...], case: str = ""
) -> SizedClaim:
    n_robots, alpha_s, alpha_c = SETTINGS[distribution]
    team = _team(distribution)
    return SizedClaim(
        size=f"N = {n_robots}, alpha_s = {alpha_s}, alpha_c = {alpha_c}: 3 baits of V1 and 2 greedy of V2 left{case}",
        robots=n_robots,
        claim=team.comparison(function_class, team.chosen(SURVIVORS), team.chosen(RIVALS), premises),
        team=team,
    )


def _entry(
    distribution: int, function_class: FunctionClass, reading: str, hypotheses: str, claims: tuple[SizedClaim, ...]
) -> ClaimEntry:
    family, label = FAMILIES[function_class], f"nd_p2d{distribution}v2_dominance"
    proved = Reference(label, EntryKind.CLAIM, f"{WORST}; {family}")
    return ClaimEntry(
        label=label,
        kind=EntryKind.CLAIM,
        chain="dominance",
        statement="f(u on V1\\A*) >= f(u on V2\\A*) when only greedy robots of V2 survive",
        hypotheses=hypotheses,
        claims=claims,
        reading=f"{reading}; {family}",
        survives_by=Reference(f"nd_p2d{distribution}v2", EntryKind.CUMULATIVE),
        serves_by=None if reading == WORST else proved,
    )
