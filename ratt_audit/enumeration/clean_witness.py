"""One small team with one control a robot on which sub_p2d1v1_10, the line that no reading saves, is seen to fail.

Additive values leave nothing to choose: every factor of the chain is 1, the optimum is RATT's plan, and so its worst
attack is the plan's and the team's as well. What remains of the line compares two sums.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_audit.appendix.entry import Counted, EntryKind, EntryName, EnumeratedEntry
from ratt_audit.engine.decide import Verdict
from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.budget import uninterrupted
from ratt_opt.problem import Attack, Problem
from ratt_opt.setfunctions.base import TableFunction
from ratt_opt.solvers.ratt import ratt

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["clean_witness_entries"]

VALUES = (10, 2, 2, 2, 1)
ALPHA_S, ALPHA_C = 1, 6
GROUPS = ((0, 1, 3), (2, 4))
"""V1 and V2 of Pattern 2': V1 has alpha_s + |V2g| = 2 baits and one greedy robot, V2 a bait and the other."""


def clean_witness_entries() -> Iterator[EnumeratedEntry]:
    """Yield the line on that team."""
    values = ", ".join(map(str, VALUES))
    yield EnumeratedEntry(
        label="sub_p2d1v1_10_additive",
        kind=EntryKind.CLAIM,
        chain="sub_p2d1v1",
        statement=f"sub_p2d1v1_10 on additive f with values {values}, one control a robot, (alpha_s, alpha_c) = (1, 6)",
        hypotheses="RATT's bait and the worst attack as the library finds them; curvature 0",
        survives_by=EntryName("sub_p2d1v1_10", EntryKind.CUMULATIVE),
        serves_by=EntryName("sub_p2d1v1_10", EntryKind.CUMULATIVE),
        enumerate_cases=_decided,
    )


def _decided() -> Counted:
    n = len(VALUES)
    table = sum(value * (np.arange(1 << n) >> i & 1) for i, value in enumerate(VALUES))
    problem = Problem(TableFunction(table), np.arange(n), None, ALPHA_S, ALPHA_C)
    plan = ratt(problem)
    first, second = GROUPS
    attack = Attack(frozenset({0}), problem.communication.links_between(GROUPS))
    worst = uninterrupted(worst_case_attack(problem, plan.elements))
    is_worst = problem.team_value(plan.elements, attack) == worst.upper == worst.lower
    greedy = sorted(set(range(n)) - set(plan.bait))
    on_greedy, on_first = sum(VALUES[i] for i in greedy), sum(VALUES[i] for i in first if i not in attack.sensing)
    text = (
        f"bait {plan.bait}, greedy {tuple(greedy)}; V1 = {first}, V2 = {second}, blinded 0; "
        f"the line says {on_greedy} >= {on_first}"
    )
    fails = is_worst and on_greedy < on_first
    return Counted(
        verdict=Verdict.REFUTED if fails else Verdict.UNDECIDED,
        sizes=f"N = {n}",
        detail=f"A* is a worst attack: it leaves {worst.upper:g}" if is_worst else "A* is no worst attack",
        cases=(text,) if fails else (),
    )
