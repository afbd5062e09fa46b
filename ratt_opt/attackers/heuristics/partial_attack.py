"""What the heuristic attackers build: blinded robots first, then robots cut off one by one."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.task import AttackResult, outward
from ratt_opt.budget import Stop

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import FloatArray
    from ratt_opt.attackers.task import PlanValues
    from ratt_opt.graph.communication import Link
    from ratt_opt.problem import Attack, Problem

__all__ = ["PartialAttack", "heuristic_result", "team_values"]


@dataclass(frozen=True, slots=True)
class PartialAttack:
    """Robots blinded and links cut so far; ``parts`` are the connected groups this leaves, blinded robots included.

    :meth:`cut_off` relies on whole robots having been cut off so far: no link inside a part is cut.
    """

    problem: Problem
    blinded: frozenset[int]
    cut: frozenset[Link]
    parts: tuple[frozenset[int], ...]

    @classmethod
    def of(
        cls, problem: Problem, blinded: frozenset[int] = frozenset(), cut: frozenset[Link] = frozenset()
    ) -> PartialAttack:
        """The attack that blinds and cuts the given ones."""
        return cls(problem, blinded, cut, problem.communication.groups(cut))

    def blind(self, robot: int) -> PartialAttack:
        """Blind one more robot."""
        return replace(self, blinded=self.blinded | {robot})

    def cut_off(self, robot: int) -> PartialAttack | None:
        """Cut all links that robot still has; ``None`` where one is protected or the budget is too small."""
        communication = self.problem.communication
        links = communication.links_of(robot)
        if links & self.problem.protected_links or len(self.cut | links) > self.problem.alpha_c:
            return None
        home = next(part for part in self.parts if robot in part)
        left = communication.groups_among(home - {robot}) if len(home) > 1 else ()
        others = tuple(part for part in self.parts if part is not home)
        return replace(self, cut=self.cut | links, parts=(*others, frozenset([robot]), *left))

    def groups(self) -> list[frozenset[int]]:
        """Robots of each group that still see."""
        return [part - self.blinded for part in self.parts]


def team_values(values: PlanValues, candidates: Sequence[PartialAttack]) -> FloatArray:
    """(C,) team value under each candidate, by one batch of evaluations."""
    groups = [candidate.groups() for candidate in candidates]
    membership = np.zeros((sum(map(len, groups)), values.n), dtype=np.bool_)
    for row, group in enumerate(group for family in groups for group in family):
        membership[row, sorted(group)] = True
    starts = np.concatenate([[0], np.cumsum([len(family) for family in groups])[:-1]])
    return np.asarray(np.maximum.reduceat(values.evaluate(membership), starts))


def heuristic_result(problem: Problem, values: PlanValues, attack: Attack) -> AttackResult:
    """The result of a heuristic: its attack's value, and the value of no measurement as lower bound."""
    lower, evaluations = problem.objective(()), values.evaluations
    upper = problem.team_value(values.plan, attack)
    found = AttackResult(attack=attack, lower=lower, upper=upper, stop=Stop.HEURISTIC, evaluations=evaluations)
    return outward(problem, values.plan, found)
