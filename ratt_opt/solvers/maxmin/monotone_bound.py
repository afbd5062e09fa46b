"""Bound by monotonicity: no plan gives a group more information than all elements of its robots together.

The criteria do not decrease with information. As a proof it is one tangent a group, which touches there: what a plan
lacks of that information only lowers it. Several groups are cases; one of them wins.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.maxmin.proof import Leaf, TangentCut, UpperProof, WinnerBranch

if TYPE_CHECKING:
    from ratt_opt.problem import Attack, Problem

__all__ = ["MonotoneBound", "monotone_bound"]


@dataclass(frozen=True, slots=True, kw_only=True)
class MonotoneBound:
    """Claim: ``Phi* <= upper``, as ``proof`` shows."""

    upper: float
    proof: UpperProof


def monotone_bound(problem: Problem, attack: Attack) -> MonotoneBound:
    """Bound the worst-case value of every plan by what all elements of a group are worth under one attack.

    Relies on an information criterion, whose values do not decrease with information.

    Parameters
    ----------
    attack : within the budgets
    """
    objective = problem.information_objective
    groups = tuple(sorted(tuple(sorted(group)) for group in problem.groups_left(attack) if group)) or ((),)
    of_robot = np.array([objective.information[choice].sum(axis=0) for choice in problem.choices])
    points = [np.asarray(objective.prior_information + of_robot[list(group)].sum(axis=0)) for group in groups]
    targets = [objective.tangent_targets(point, -np.inf, 1)[0] for point in points]
    cuts = (
        TangentCut(attack=0, group=group, point=point, target=target)
        for group, point, target in zip(groups, points, targets, strict=True)
    )
    leaves = (Leaf(cuts=(k,), weights=(1.0,)) for k in range(len(groups)))
    above = () if len(groups) == 1 else (WinnerBranch(attack=0, parts=groups),)
    return MonotoneBound(
        upper=float(objective.value(np.array(points)).max()) + objective.rounding,
        proof=UpperProof(attacks=(attack,), cuts=tuple(cuts), tree=(*above, *leaves)),
    )
