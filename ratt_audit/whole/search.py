"""Decide a refuted line among whole instances, team by team: branch on the requirements that a counterexample breaks.

A node is the line with some alternatives of requirements as premises. If a linear program finds a counterexample that
meets all requirements, the line fails in a whole instance. If it breaks one, the node has a child for each alternative.
If no counterexample exists, a proof from the premises closes the node; once all are closed the line holds.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING

from ratt_audit.engine.claim import Linear
from ratt_audit.engine.decide import Verdict, curvatures_tried
from ratt_audit.engine.evidence import values_of
from ratt_audit.engine.prover import find_proof
from ratt_audit.engine.refuter import find_witness
from ratt_audit.whole.replay import replay
from ratt_audit.whole.requirements import requirements
from ratt_audit.whole.teams import whole_teams

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from ratt_audit.appendix.roles import Side, SizedClaim
    from ratt_audit.engine.claim import Claim, Ground, Inequality
    from ratt_audit.engine.evidence import Witness
    from ratt_audit.whole.replay import WholeInstance
    from ratt_audit.whole.requirements import Requirement
    from ratt_audit.whole.teams import WholeTeam

    Node = tuple[Inequality, ...]

__all__ = ["Decided", "WholeSearch", "decide_team", "on_whole_team", "ordered_teams", "smallest_instance"]


@dataclass(frozen=True, slots=True, kw_only=True)
class WholeSearch:
    """Limits of the search for whole instances.

    ``largest`` : robots at most; a robot more has four times as many sets.
    ``programs`` : linear programs a team at most; a team that needs more is left undecided.
    ``programs_in_all`` : linear programs a line at most; larger teams are left out then.
    ``curvature`` : at which counterexamples are looked for.
    """

    largest: int = 5
    programs: int = 25
    programs_in_all: int = 120
    curvature: Fraction = Fraction(1, 2)


@dataclass(frozen=True, slots=True, kw_only=True)
class Decided:
    """One line on one whole team: refuted by an instance, proved, or left open; ``programs`` were solved."""

    whole: WholeTeam
    verdict: Verdict
    programs: int
    instance: WholeInstance | None = None


def smallest_instance(
    chain: str, sizes: Iterable[SizedClaim], worst_for: Side, search: WholeSearch
) -> tuple[Decided, ...]:
    """Decide a line on whole teams, smallest first, until an instance refutes it."""
    decided: list[Decided] = []
    left = search.programs_in_all
    for sized, whole in ordered_teams(chain, sizes, search.largest):
        decided.append(decide_team(sized, whole, worst_for, replace(search, programs=min(left, search.programs))))
        left -= decided[-1].programs
        if decided[-1].instance is not None or left <= 0:
            break
    return tuple(decided)


def ordered_teams(chain: str, sizes: Iterable[SizedClaim], largest: int) -> list[tuple[SizedClaim, WholeTeam]]:
    """Whole teams of a line with at most ``largest`` robots, smallest first: the order of the search."""
    teams = ((sized, whole) for sized in sizes for whole in whole_teams(chain, sized, largest=largest))
    return sorted(teams, key=lambda pair: pair[1].size)


def decide_team(sized: SizedClaim, whole: WholeTeam, worst_for: Side, search: WholeSearch) -> Decided:
    """Decide one line on one whole team."""
    claim, needed = on_whole_team(sized, whole), tuple(requirements(whole, worst_for))
    nodes: list[Node] = [()]
    is_proved, solved = True, 0
    while nodes and solved < search.programs:
        given, solved = nodes.pop(), solved + 1
        node = replace(claim, premises=(*claim.premises, *given))
        witness = find_witness(node, curvature=search.curvature)
        if witness is None:
            is_proved = is_proved and _is_closed(node)
            continue
        broken = _first_broken(needed, witness)
        if broken is None:
            instance = replay(whole, worst_for, node, witness)
            return Decided(whole=whole, verdict=Verdict.REFUTED, programs=solved, instance=instance)
        nodes.extend((*given, *each) for each in _least_broken_last(broken, witness))
    verdict = Verdict.PROVED if is_proved and not nodes else Verdict.UNDECIDED
    return Decided(whole=whole, verdict=verdict, programs=solved)


def _is_closed(node: Claim) -> bool:
    """Try to prove the line from the premises, for all curvatures or for those of the grid."""
    if find_proof(node, feasible=False) is not None:
        return True
    return all(find_proof(node, feasible=False, curvature=c) is not None for c in curvatures_tried(node))


def on_whole_team(sized: SizedClaim, whole: WholeTeam) -> Claim:
    """Return the line on the elements of the whole team, from RATT's choices alone."""
    assert sized.team is not None
    conclusion = _renamed(sized.claim.conclusion, sized.team.ground, whole.team.ground)
    return whole.team.claim(sized.claim.function_class, conclusion)


def _renamed(expression: Linear, old: Ground, new: Ground) -> Linear:
    def moved(key: int | str) -> int | str:
        return new.mask(old.names[e] for e in old.members(key)) if isinstance(key, int) else key

    return Linear({moved(key): value for key, value in expression.terms.items()})


def _first_broken(needed: Iterable[Requirement], witness: Witness) -> Requirement | None:
    """The broken requirement with the fewest alternatives."""
    broken = [r for r in needed if all(_slack(each, witness) < 0 for each in r.alternatives)]
    return min(broken, key=lambda r: len(r.alternatives), default=None)


def _slack(inequalities: Node, witness: Witness) -> Fraction:
    """Least slack of a conjunction; ``opt`` is 0 as long as no premise speaks of it."""
    known = values_of(witness.values, {"opt": Fraction(0), **witness.auxiliary})
    t = 1 - (witness.curvature or Fraction(0))
    return min((each.expression.value(known, t) for each in inequalities), default=Fraction(0))


def _least_broken_last(broken: Requirement, witness: Witness) -> Iterator[Node]:
    yield from sorted(broken.alternatives, key=lambda each: _slack(each, witness))
