"""What an earlier plan or result still says about a problem: a plan, outcomes, cuts.

Nothing is believed. A plan is attacked again, an attack has to be within the budgets, and of a cut only the point is
used at which it touched: a tangent at any point bounds every plan (``bounds/cuts.py``). If the scenario moved by a
step, such tangents are nearly as good as those the search would find again.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ratt_opt.errors import InputError
from ratt_opt.problem import Plan
from ratt_opt.solvers.maxmin.proof import Leaf
from ratt_opt.solvers.result import MaxMinResult

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ratt_opt._validation import IntArray
    from ratt_opt.problem import Attack, Problem
    from ratt_opt.solvers.maxmin.outcome_pool import OutcomePool
    from ratt_opt.solvers.maxmin.proof import TangentCut, UpperProof
    from ratt_opt.solvers.maxmin.relaxation import CutStore

__all__ = ["WarmStart"]

MOST_CUTS = 300
"""Cuts taken over, those that most leaves weigh first: each costs a tangent and a row of the first programs."""


@dataclass(frozen=True, slots=True)
class WarmStart:
    """``plan`` : (N,) elements, or ``None``; ``proof`` : of an earlier upper bound, or ``None``."""

    plan: IntArray | None = None
    proof: UpperProof | None = None

    @classmethod
    def of(cls, problem: Problem, start: ArrayLike | Plan | MaxMinResult | None) -> WarmStart:
        """What can be taken over from ``start``; of a result, only what the problem still allows.

        Raises ``InputError`` : a plan is not one element per robot.
        """
        if start is None:
            return cls()
        if not isinstance(start, MaxMinResult):
            return cls(problem.check_plan(start.elements if isinstance(start, Plan) else start))
        try:
            plan = problem.check_plan(start.elements)
        except InputError:
            plan = None
        return cls(plan, start.proof)

    def add_outcomes(self, pool: OutcomePool) -> dict[int, int]:
        """Add the outcomes that cuts of the proof's leaves are about; attack of the proof -> outcome of the pool."""
        if self.proof is None:
            return {}
        attacks = sorted({self.proof.cuts[k].attack for k in self._used_cuts()})
        known = ((a, self.proof.attacks[a]) for a in attacks)
        return {a: pool.add(attack) for a, attack in known if _is_allowed(pool.problem, attack)}

    def add_cuts(self, cuts: CutStore, outcomes: dict[int, int]) -> list[int]:
        """Add tangents where the cuts of the proof's leaves touched; return their numbers in the store.

        ``outcomes`` : as :meth:`add_outcomes` returned them
        """
        if self.proof is None:
            return []
        number = {group: g for g, group in enumerate(cuts.pool.groups)}
        added = []
        for cut in (self.proof.cuts[k] for k in self._used_cuts()[:MOST_CUTS]):
            group = number.get(cut.group)
            outcome = outcomes.get(cut.attack)
            if outcome is not None and group in cuts.pool.of_outcome[outcome] and _fits(cuts, cut):
                added.append(cuts.tangent(outcome, group, cut.point, cut.target))
        return added

    def _used_cuts(self) -> list[int]:
        """Cuts of the proof that a leaf weighs, those of the most leaves first."""
        assert self.proof is not None
        leaves = (node for node in self.proof.tree if isinstance(node, Leaf))
        return [k for k, _ in Counter(k for leaf in leaves for k in leaf.cuts).most_common()]


def _is_allowed(problem: Problem, attack: Attack) -> bool:
    try:
        problem.check_attack(attack)
    except InputError:
        return False
    return True


def _fits(cuts: CutStore, cut: TangentCut) -> bool:
    prior = cuts.task.objective.prior
    return cut.point.shape == prior.shape and (cut.target is None or cut.target < len(prior))
