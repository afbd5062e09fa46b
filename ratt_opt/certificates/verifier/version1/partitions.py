"""Whether groups partition a team within budgets: a search in integers."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ratt_opt.certificates.verifier.version1.group_costs import mask_of, robots_of
from ratt_opt.certificates.verifier.work import tick
from ratt_opt.errors import UndecidedError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sized

    from ratt_opt.certificates.verifier.version1.group_costs import Group, Groups

__all__ = ["Partitions", "refuse_many"]

TRIED = 2
"""Flows, the first ones, that bound what the last group of a partition costs."""

MOST_STEPS = 1_000_000
"""Steps of the search of partitions: up to a minute."""
MOST_LISTED = 250_000
"""Groups to choose from, and so the memory of a check: at the prices of a short file millions may be cheap."""


def refuse_many(listed: Sized) -> None:
    """Raise ``UndecidedError`` where more groups are listed than a check may hold."""
    if len(listed) > MOST_LISTED:
        raise UndecidedError(f"not decided: more than {MOST_LISTED} groups are within the budgets")


@dataclass(frozen=True, slots=True)
class _Case:
    """Partitions still to be looked at.

    ``usable`` : groups that fit, as a mask; ``left`` : robots in no group yet; ``together`` : those of them that are in
    the one group that is not listed; ``budgets`` : cost, blinded robots and links left; ``chosen`` : groups so far
    """

    usable: int
    left: int
    together: int
    budgets: tuple[int, int, int]
    chosen: tuple[Group, ...]


class Partitions:
    """Partitions of n robots into groups, and one more or none, within budgets of costs, needs and links.

    Groups are bits of masks: of those that hold a robot, and of those within what is left of each budget.
    """

    def __init__(self, listed: list[Group], about: Groups) -> None:
        self.groups, self.about = sorted(listed, key=lambda group: group.cost), about
        self.costs, self.nodes, n = [group.cost for group in self.groups], 0, len(about.robot)
        self.holds = [self._mask(group.robots >> i & 1 for group in self.groups) for i in range(n)]

    @staticmethod
    def _mask(fits: Iterable[int]) -> int:
        """The mask of the groups that fit: by digits, as sums of bits take quadratic time."""
        tick()
        return int("0" + "".join("1" if fit else "0" for fit in fits)[::-1], 2)

    def first(self, most: int = MOST_STEPS) -> list[Group] | None:
        """The first partition found; ``None`` without one.

        Raises
        ------
        UndecidedError : neither after so many steps.
        """
        budgets = self.about.slack, self.about.most, 2 * self.about.about.alpha_c
        blinded, cut = (range(budget + 1) for budget in budgets[1:])
        self._needs = [self._mask(group.need <= x for group in self.groups) for x in blinded]
        self._links = [self._mask(group.links <= x for group in self.groups) for x in cut]
        self.nodes = 0
        root = _Case((1 << len(self.groups)) - 1, self.about.everyone, 0, budgets, ())
        waiting = [iter([root] if budgets[0] >= 0 else [])]
        while waiting:
            case = next(waiting[-1], None)
            if case is None:
                waiting.pop()
                continue
            tick()
            self.nodes += 1
            if self.nodes > most:
                raise UndecidedError(f"not decided within {most} partitions into groups")
            case = self._narrowed(case)
            if case is not None and case.left == case.together:
                if (rest := self._last_group(case)) is not None:
                    return [*case.chosen, *rest]
            elif case is not None:
                waiting.append(self._divided(case))
        return None

    def _narrowed(self, case: _Case) -> _Case | None:
        """The case without groups that no longer fit; ``None`` where the robots left together cost too much."""
        cost, blinded, cut = case.budgets
        fitting = self._needs[blinded] & self._links[cut] & (1 << bisect_right(self.costs, cost)) - 1
        usable = case.usable & fitting
        together = case.together | mask_of(i for i in robots_of(case.left) if not usable & self.holds[i])
        if together and self._is_dear(together, self.about.everyone & ~case.left, cost, blinded):
            return None
        return replace(case, usable=usable, together=together)

    def _last_group(self, case: _Case) -> list[Group] | None:
        """The group of the robots left, or none where none are left; ``None`` where it does not fit."""
        if not case.left:
            return []
        rest, (cost, blinded, cut) = self.about.group_of(case.left), case.budgets
        fits = rest is not None and rest.cost <= cost and rest.need <= blinded and rest.links <= cut
        return [rest] if rest is not None and fits else None

    def _divided(self, case: _Case) -> Iterator[_Case]:
        """The cases by the group of the robot that the fewest groups hold; last, that it is left together."""
        free, (cost, blinded, cut) = case.left & ~case.together, case.budgets
        i = min(robots_of(free), key=lambda i: (case.usable & self.holds[i]).bit_count())
        for k in robots_of(case.usable & self.holds[i]):
            group, disjoint = self.groups[k], case.usable
            for j in robots_of(group.robots):
                disjoint &= ~self.holds[j]
            spent = cost - group.cost, blinded - group.need, cut - group.links
            yield _Case(disjoint, case.left & ~group.robots, case.together, spent, (*case.chosen, group))
        yield replace(case, usable=case.usable & ~self.holds[i], together=case.together | 1 << i)

    def _is_dear(self, inside: int, outside: int, cost: int, blinded: int) -> bool:
        """Whether no group with these robots, and without those, is within what is left."""
        if self.about.need(inside) > blinded or self.about.impossible(inside, outside):
            return True
        if not self.about.sets:  # flows bound what a group costs by how many of a set may see
            return False
        flows = range(min(len(self.about.flows), TRIED))
        return any(self.about.least(inside, outside, flow, 0) > cost for flow in flows)
