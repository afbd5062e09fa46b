"""Outcomes that leave two robots together and every other one alone, used to narrow nodes of the search.

Such an outcome bounds all plans by the value of one pair if the lone robots are weak whatever they do. There is one
for every pair, so a plan's worst case is at most its weakest pair's value. Plans whose pairs are all above a level are
the solutions of a binary constraint problem, one element a robot, every two compatible:

- An element that no remaining element of some other robot is compatible with can be left out. Repeated until
  nothing changes (arc consistency; Mackworth 1977), this often leaves a robot without element: there is no such plan.
- Otherwise robots are decided one after the other, the one with the fewest elements first, and the same is
  repeated. Bisection over the values of pairs so finds the plan whose weakest pair is strongest.

Most such problems are decided without any linear program; every step enters the search tree as a division closed by
tangent cuts.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.graph.outcomes import realise
from ratt_opt.graph.survivor_sizes import sizes_of_largest
from ratt_opt.problem import Attack
from ratt_opt.solvers.maxmin.task import with_choice

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.setfunctions.information import InformationObjective
    from ratt_opt.solvers.maxmin.groups.winners import WinnerDivision
    from ratt_opt.solvers.maxmin.proof import TreeNode
    from ratt_opt.solvers.maxmin.task import Task

__all__ = ["Elimination", "PairOutcomes", "PairValues"]

MOST_VALUES = 20_000_000
"""Most pairs of elements times targets that are evaluated: below a second."""
PLAN_NODES = 500
"""Nodes after which a plan above a level is taken not to exist; only costs quality."""
ROUNDING = 1e-11
"""Relative to the largest value: pairs so little below a level are not counted on to be proved below it."""
NEVER = np.iinfo(np.int64).max
"""Round in which an element that stays is left out."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Elimination:
    """None of the ``elements`` of ``robot`` is above the level together with an element of ``because`` that is left."""

    robot: int
    elements: IntArray
    because: int


class PairValues:
    """``values`` (N, N, D, D) of robots i and k with their a-th and b-th element; D the largest number of elements.

    ``elements`` (N, D) repeats a robot's first element if it has fewer; infinite for i = k.
    """

    def __init__(self, objective: InformationObjective, choices: Sequence[IntArray]) -> None:
        widest = max(map(len, choices))
        self.elements = np.array([np.append(own, np.repeat(own[:1], widest - len(own))) for own in choices])
        self._present = np.arange(widest) < np.array([len(own) for own in choices])[:, None]
        self._slot = np.zeros((2, objective.n), dtype=np.int64)
        for i, own in enumerate(choices):
            self._slot[:, own] = np.full(len(own), i), np.arange(len(own))
        self.values = _pair_values(objective, self.elements)

    @staticmethod
    def affordable(objective: InformationObjective, choices: Sequence[IntArray]) -> bool:
        """Whether the table is small enough to be made."""
        return (len(choices) * max(map(len, choices))) ** 2 * objective.n_targets <= MOST_VALUES

    # -- plans above a level -----------------------------------------------------------------------------------

    def strongest_plan(self) -> IntArray:
        """(N,) elements whose weakest pair is as strong as the search finds; the strongest possible nearly always."""
        both = self._present[:, None, :, None] & self._present[None, :, None, :] & np.isfinite(self.values)
        levels = np.unique(self.values[both])
        plan, low, high = self.elements[:, 0], 0, len(levels)  # every plan reaches levels[0]
        while high - low > 1:
            middle = (low + high) // 2
            found = self._plan_within(self.values >= levels[middle])
            low, high = (low, middle) if found is None else (middle, high)
            plan = plan if found is None else found
        return np.array(plan)

    def _plan_within(self, compatible: BoolArray) -> IntArray | None:
        """A plan all of whose pairs are compatible, depth first, or ``None`` if none is found."""
        stack = [self._present]
        for _ in range(PLAN_NODES):
            if not stack:
                return None
            gone = _inconsistent(compatible, stack.pop())
            left = gone == NEVER
            count = left.sum(axis=1)
            if not count.all():
                continue
            if count.max() == 1:
                return np.array(self.elements[left])
            robot = int(np.where(count > 1, count, NEVER).argmin())
            support = (compatible[robot] & left[:, None, :]).sum(axis=(0, 2))
            for slot in sorted(np.flatnonzero(left[robot]).tolist(), key=lambda a: (support[a], -a)):
                child = left.copy()
                child[robot] = np.arange(len(child[robot])) == slot
                stack.append(child)  # the one with the most compatible elements comes off first
        return None

    # -- elements that no plan above a level has ---------------------------------------------------------------

    def eliminations(self, choices: Sequence[IntArray], level: float) -> list[Elimination]:
        """Elements that no plan within ``choices`` with all pairs above ``level`` has, in an order that proves it.

        The elements of an elimination are weak with all elements of the robot ``because`` that earlier ones leave.
        If such a plan does not exist, only what is needed to leave the last robot without element is returned.
        """
        remaining = np.zeros_like(self._present)
        remaining[tuple(self._slot[:, np.concatenate(choices)])] = True
        compatible = self.values > level - ROUNDING * float(np.abs(self.values[0, 1:]).max(initial=0.0))
        gone = _inconsistent(compatible, remaining)
        left = gone == NEVER
        empty = np.flatnonzero(~left.any(axis=1))
        wanted = remaining & ~left
        if len(empty):  # the robot that was left without element by the fewest rounds
            last = int(empty[np.where(remaining[empty], gone[empty], 0).max(axis=1).argmin()])
            wanted = wanted & (np.arange(len(remaining)) == last)[:, None]
        return self._ordered(_reasons(compatible, remaining, gone, wanted), gone)

    def _ordered(self, reasons: dict[tuple[int, int], int], gone: IntArray) -> list[Elimination]:
        together: dict[tuple[int, int, int], list[int]] = {}
        for (robot, slot), because in sorted(reasons.items()):
            together.setdefault((int(gone[robot, slot]), robot, because), []).append(slot)
        return [
            Elimination(robot=robot, elements=self.elements[robot, slots], because=because)
            for (_, robot, because), slots in sorted(together.items())
        ]


def _pair_values(objective: InformationObjective, elements: IntArray) -> FloatArray:
    n_robots, widest = elements.shape
    values = np.full((n_robots, n_robots, widest, widest), np.inf)
    for i in range(n_robots - 1):
        others = objective.information[elements[i + 1 :]]
        for a in range(widest):
            own = objective.prior_information + objective.information[elements[i, a]]
            values[i, i + 1 :, a] = objective.value(own + others)
        values[i + 1 :, i] = np.swapaxes(values[i, i + 1 :], 1, 2)
    return values


def _inconsistent(compatible: BoolArray, remaining: BoolArray) -> IntArray:
    """(N, D) round in which each element was left out: 0 if it was not there, ``NEVER`` if it stays.

    Ends with the first round that leaves a robot without element.
    """
    gone = np.where(remaining, NEVER, 0)
    rounds = 0
    while True:
        rounds += 1
        left = gone == NEVER
        supported = (compatible & left[None, :, None, :]).any(axis=3).all(axis=1)
        newly = left & ~supported
        gone[newly] = rounds
        if not newly.any() or not (left & supported).any(axis=1).all():
            return gone


def _reasons(
    compatible: BoolArray, remaining: BoolArray, gone: IntArray, wanted: BoolArray
) -> dict[tuple[int, int], int]:
    """Why the wanted elements, and those whose elimination that relies on, were left out: (robot, slot) -> robot.

    Of the possible reasons the one that relies on the fewest earlier eliminations.
    """
    reasons: dict[tuple[int, int], int] = {}
    others = ~np.eye(len(gone), dtype=np.bool_)
    stack = [(int(i), int(a)) for i, a in np.argwhere(wanted)]
    while stack:
        i, a = stack.pop()
        if (i, a) in reasons:
            continue
        partners = compatible[i, :, a] & remaining
        earlier = np.all(~partners | (gone < gone[i, a]), axis=1)
        because = int(np.where(earlier & others[i], partners.sum(axis=1), NEVER).argmin())
        reasons[i, a] = because
        stack.extend((because, int(b)) for b in np.flatnonzero(partners[because]))
    return reasons


class PairOutcomes:
    """The outcomes of one problem and the values of its pairs; :meth:`of` says whether there are any."""

    def __init__(self, task: Task, alone: int) -> None:
        self.task, self.alone = task, alone
        self.values = PairValues(task.objective, task.choices)
        strongest = [task.singles[choice].max() for choice in task.problem.choices]
        self._weakest_first = np.argsort(strongest, kind="stable").tolist()

    @classmethod
    def of(cls, task: Task) -> PairOutcomes | None:
        """``None`` if no attack leaves just one pair, robots differ to the adversary, or pairs are too many."""
        threat, n_robots = task.problem.threat, task.problem.n_robots
        if not threat.is_symmetric or not PairValues.affordable(task.objective, task.choices):
            return None
        alone = n_robots - threat.n_blinded - 2
        # Vectors of all sizes can be too many to list: 416,000 of 200 robots with a third of the links left.
        if alone < 0 or (2, *[1] * alone) not in sizes_of_largest(n_robots, threat.n_blinded, threat.alpha_c, 2):
            return None
        return cls(task, alone)

    def narrow(self, node: TreeNode, level: float, division: WinnerDivision) -> TreeNode | None:
        """Split off elements that are below ``level`` in some pair; return what remains, ``None`` if nothing does."""
        for step in self.values.eliminations(node.choices, level):
            outcome = division.pool.add(self._attack(step.robot, step.because))
            choice = node.choices[step.robot]
            left = np.setdiff1d(choice, step.elements)
            if not len(left):
                return None if division.close(node, outcome) else node
            weak = node.child(with_choice(node.choices, step.robot, np.setdiff1d(choice, left)))
            if len(left) < len(choice) and division.close(weak, outcome):
                rest = node.child(with_choice(node.choices, step.robot, left))
                node.divide(step.robot, [weak, rest], self.task)
                node = rest
        return node

    def _attack(self, robot: int, other: int) -> Attack:
        """The attack that leaves two robots together, and alone those of the others that are weakest at best."""
        pair = frozenset((robot, other))
        alone = [i for i in self._weakest_first if i not in pair][: self.alone]
        outcome = sorted((pair, *(frozenset((i,)) for i in alone)), key=min)
        return Attack(*realise(self.task.problem.threat, tuple(outcome)))
