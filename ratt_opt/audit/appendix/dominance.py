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

from ratt_opt.audit.appendix.entry import Entry, SizedClaim
from ratt_opt.audit.appendix.roles import Team
from ratt_opt.audit.engine.claim import Claim, FunctionClass, Inequality
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.outcomes import non_dominated_outcomes
from ratt_opt.graph.threat import Threat

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["deciding_outcome", "dominance_entries"]

SETTINGS = {2: (6, 1, 9), 3: (7, 2, 12)}
"""Distribution -> (N, alpha_s, alpha_c): CAA gives n_max = 3 and 4, so groups (3, 3) and (4, 3)."""
SURVIVORS = ("b1", "b2", "b3")
RIVALS = ("g1", "g2")
WORST = "A* is the worst attack"


def _team(distribution: int) -> Team:
    """One control per robot: RATT's plan is the only plan, so nothing else is in play."""
    bait = tuple(f"b{i + 1}" for i in range(SETTINGS[distribution][0] - 2))
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


def dominance_entries() -> Iterator[Entry]:
    """Yield the claim with its stated reason, and with "A* is the worst attack" added, for both classes."""
    for distribution in SETTINGS:
        for kind in (FunctionClass.TOTAL_CURVATURE, FunctionClass.CURVATURE):
            team = _team(distribution)
            stated = f"more baits than greedy robots survive, each bait is individually better; {kind.value}"
            yield _entry(
                distribution, kind, "stated reason only", stated, (_sized(distribution, kind, team.bait_premises()),)
            )
            worst = f"RATT's choices, and A* is the worst attack on its plan; {kind.value}"
            claims = tuple(_cases(distribution, kind))
            yield _entry(distribution, kind, WORST, worst, claims)


def _cases(distribution: int, kind: FunctionClass) -> Iterator[SizedClaim]:
    team = _team(distribution)
    target = team.chosen(RIVALS)
    for group in deciding_outcome(distribution):
        reason = f"the best group of the other attack is {{{','.join(group)}}}, and A* is no better for the team"
        reaches = Inequality(reason, team.chosen(group) - target)
        yield _sized(
            distribution, kind, (*team.premises, reaches), f"; other attack's best group {{{','.join(group)}}}"
        )


def _sized(distribution: int, kind: FunctionClass, premises: tuple[Inequality, ...], case: str = "") -> SizedClaim:
    n_robots, alpha_s, alpha_c = SETTINGS[distribution]
    team = _team(distribution)
    left, right = team.chosen(SURVIVORS), team.chosen(RIVALS)
    return SizedClaim(
        size=f"N = {n_robots}, alpha_s = {alpha_s}, alpha_c = {alpha_c}: 3 baits of V1 and 2 greedy of V2 left{case}",
        robots=n_robots,
        claim=Claim(kind=kind, ground=team.ground, premises=premises, conclusion=left - right),
        left=left,
        right=right,
        team=team,
    )


def _entry(
    distribution: int, kind: FunctionClass, reading: str, hypotheses: str, claims: tuple[SizedClaim, ...]
) -> Entry:
    family = "total curvature" if kind is FunctionClass.TOTAL_CURVATURE else "submodular"
    label = f"nd_p2d{distribution}v2_dominance"
    return Entry(
        label=label,
        kind="claim",
        chain="dominance",
        statement="f(u on V1\\A*) >= f(u on V2\\A*) when only greedy robots of V2 survive",
        hypotheses=hypotheses,
        claims=claims,
        reading=f"{reading}; {family}",
        survives_by=f"nd_p2d{distribution}v2/cumulative",
        serves_by="" if reading == WORST else f"{label}/claim/{WORST}; {family}",
    )
