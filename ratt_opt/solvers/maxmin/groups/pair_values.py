"""Values of all pairs of elements, and what follows for a plan none of whose pairs may be weak.

Where an attack may leave any two robots together and every other seeing robot alone, a plan's worst case is at most the
value of its weakest pair. Plans whose pairs are all above a level are the solutions of a binary constraint
problem: one element a robot, every two of them compatible.

- An element that no remaining element of some other robot is compatible with can be left out. Repeated until
  nothing changes (arc consistency; Mackworth 1977), this often leaves a robot without element: there is no such plan.
- Otherwise robots are decided one after the other, the one with the fewest elements first, and the same is
  repeated. Bisection over the values of pairs so finds the plan whose weakest pair is strongest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["Elimination", "PairValues"]

LARGEST_TABLE = 20_000_000
"""Most pairs of elements times targets that are evaluated: below a second."""
PLAN_NODES = 500
"""Nodes after which a plan above a level is taken not to exist; only costs quality."""
ROUNDING = 1e-11
"""Relative to the largest value: pairs so little below a level are not counted on to be proved below it."""
NEVER = np.iinfo(np.int64).max


@dataclass(frozen=True, slots=True, kw_only=True)
class Elimination:
    """None of the ``elements`` of ``robot`` is above the level together with an element of ``because`` that is left."""

    robot: int
    elements: IntArray
    because: int


class PairValues:
    """``values`` (N, N, D, D) of robots i and k with their a-th and b-th element; D the largest number of elements.

    ``elements`` (N, D) repeats a robot's first element where it has fewer; infinite for i = k.
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
        return (len(choices) * max(map(len, choices))) ** 2 * objective.n_targets <= LARGEST_TABLE

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
        """A plan all of whose pairs are compatible, depth first, or ``None`` where none is found."""
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
        Where such a plan does not exist, only what is needed to leave the last robot without element is returned.
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
    """(N, D) round in which each element was left out: 0 where it was not there, ``NEVER`` where it stays.

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
