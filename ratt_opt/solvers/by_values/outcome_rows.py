"""Outcomes of known attacks as rows: the share of every robot that each leaves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt.problem import Attack, Problem
    from ratt_opt.solvers.by_values.plan_attacks import PlanAttacks
    from ratt_opt.solvers.by_values.plan_tree import Pooled

__all__ = ["OutcomeRows", "blinds_alone"]


def blinds_alone(problem: Problem) -> bool:
    """Tell whether every attack leaves one group: no link can be cut, and the network is in one piece."""
    return problem.threat.n_cut == 0 and len(problem.communication.groups()) == 1


class OutcomeRows:
    """Outcomes that differ, in the order in which their attacks were found.

    ``left`` : (O, N) share of each robot that is left; ``attacks`` : one of each outcome
    ``pooled`` : bounds what a group is worth under any plan; ``None`` if every attack leaves one group
    """

    def __init__(self, problem: Problem, known: PlanAttacks, pooled: Pooled | None) -> None:
        self._known, self._pooled = known, pooled
        self.left = np.zeros((0, problem.n_robots))
        self.attacks: list[Attack] = []
        self._taken = 0
        self._caps: dict[frozenset[int], float] = {}

    @property
    def leaves_out(self) -> bool:
        """True if groups of some outcomes may be left out, as they are worth no more than the best plan."""
        return self._pooled is not None

    def take_over(self) -> None:
        """Take over the attacks that were found since the last time."""
        known = list(self._known.known.items())
        for attack, groups in known[self._taken :]:
            self._add(attack, groups)
        self._taken = len(known)

    def _add(self, attack: Attack, groups: list[frozenset[int]]) -> None:
        """Add the robots of all groups that may be worth more than the best plan known."""
        left = np.zeros(self.left.shape[1])
        left[[i for group in groups if self._may_win(group) for i in group]] = 1.0
        if not any(np.array_equal(left, one) for one in self.left):
            self.left = np.concatenate([self.left, left[None]])
            self.attacks.append(attack)

    def _may_win(self, group: frozenset[int]) -> bool:
        if self._pooled is None:
            return True
        if group not in self._caps:
            self._caps[group] = self._pooled(group)
        return self._caps[group] > self._known.lower
