"""Known outcomes of attacks and the values of plans and relaxed selections under them."""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.graph.outcomes import non_dominated_outcomes, realise
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.graph.outcomes import Outcome
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.maxmin.params import OutcomeListParams

__all__ = ["OutcomePool"]


class OutcomePool:
    """Attacks with the groups of non-blinded robots they leave; equal outcomes are kept once.

    Outcome ``o`` leaves the groups ``groups[g]`` for ``g`` in ``of_outcome[o]``. ``complete`` : whether
    all outcomes that matter are known.
    """

    def __init__(self, problem: Problem) -> None:
        self.problem, self.objective = problem, problem.information_objective
        self.complete = False
        self._attacks: list[Attack | Outcome] = []
        self.groups: list[tuple[int, ...]] = []
        self.of_outcome: list[tuple[int, ...]] = []
        self._number: dict[tuple[int, ...], int] = {}
        self._known: dict[tuple[int, ...], int] = {}
        self._membership = np.zeros((0, problem.n_robots))
        self._flat = np.zeros(0, dtype=np.int64)
        self._starts = np.zeros(0, dtype=np.int64)

    def __len__(self) -> int:
        return len(self.of_outcome)

    def attack(self, outcome: int) -> Attack:
        """An attack with this outcome."""
        known = self._attacks[outcome]
        if not isinstance(known, Attack):
            known = self._attacks[outcome] = Attack(*realise(self.problem.threat, known))
        return known

    def add(self, attack: Attack) -> int:
        """Add the outcome of one attack and return its index, new or old."""
        return self._add(self.problem.groups_left(attack), attack)

    def add_outcome(self, outcome: Outcome) -> int:
        """Add an outcome that some attack has; the attack is found when it is needed."""
        return self._add(outcome, outcome)

    def list_all(self, params: OutcomeListParams) -> None:
        """Add all non-dominated outcomes if there are few."""
        if self.problem.n_robots > params.robots or not self.problem.threat.is_symmetric:
            return
        outcomes = list(islice(non_dominated_outcomes(self.problem.threat), params.outcomes + 1))
        if len(outcomes) <= params.outcomes:
            for outcome in outcomes:
                self.add_outcome(outcome)
            self.complete = True

    def _add(self, left: Iterable[frozenset[int]], origin: Attack | Outcome) -> int:
        numbers = tuple(sorted({self._group(tuple(sorted(group))) for group in left if group} or {self._group(())}))
        if numbers not in self._known:
            self._known[numbers] = len(self)
            self._attacks.append(origin)
            self.of_outcome.append(numbers)
        return self._known[numbers]

    def _group(self, group: tuple[int, ...]) -> int:
        if group not in self._number:
            self._number[group] = len(self.groups)
            self.groups.append(group)
        return self._number[group]

    def membership(self) -> FloatArray:
        """(G, N) 1 if the robot belongs to the group."""
        known = len(self._membership)
        if known < len(self.groups):
            rows = np.zeros((len(self.groups) - known, self.problem.n_robots))
            for row, group in zip(rows, self.groups[known:], strict=True):
                row[list(group)] = 1.0
            self._membership = np.concatenate([self._membership, rows])
        return self._membership

    def group_points(self, of_robot: FloatArray) -> FloatArray:
        """(G, M, d, d) posterior information of every group, each robot contributing ``of_robot[i]`` (M, d, d)."""
        flat = of_robot.reshape(len(of_robot), -1)
        sums = (self.membership() @ flat).reshape(-1, *self.objective.prior.shape)
        return np.asarray(sums + self.objective.prior_information)

    def group_values(self, of_robot: FloatArray) -> FloatArray:
        """(G,) value of every group; concave in ``of_robot`` (N, M, d, d)."""
        return self.objective.value(self.group_points(of_robot))

    def outcome_values(self, group_values: FloatArray) -> FloatArray:
        """(O,) team value of every outcome: the best of its groups; works along the last axis."""
        if not self.of_outcome:
            return np.full((*group_values.shape[:-1], 0), np.inf)
        if len(self._starts) < len(self.of_outcome):
            self._flat = np.array([g for numbers in self.of_outcome for g in numbers], dtype=np.int64)
            self._starts = np.cumsum([0, *(len(numbers) for numbers in self.of_outcome[:-1])])
        return np.asarray(np.maximum.reduceat(group_values[..., self._flat], self._starts, axis=-1))

    def plan_value(self, elements: IntArray) -> float:
        """Smallest team value of a plan under the known outcomes: an upper bound on its worst case."""
        values = self.outcome_values(self.group_values(self.objective.information[elements]))
        return float(values.min(initial=np.inf))
