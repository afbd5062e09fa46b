"""Whether groups partition a team within budgets: a search in integers."""

from __future__ import annotations

from bisect import bisect_right
from typing import TYPE_CHECKING

from ratt_opt.certificates.verifier.lower_end.group_costs import mask_of, robots_of
from ratt_opt.certificates.verifier.work import tick
from ratt_opt.errors import UndecidedError

if TYPE_CHECKING:
    from ratt_opt.certificates.verifier.lower_end.group_costs import Group, Groups

__all__ = ["Partitions"]

TRIED = 2
"""Flows, the first ones, that bound what the last group of a partition costs."""

MOST_STEPS = 1_000_000
"""Steps of the search of partitions: up to a minute."""


class Partitions:
    """Partitions of n robots into groups, and one more or none, within budgets of costs, needs and links.

    Groups are bits of masks: of those that hold a robot, and of those within what is left of each budget.
    """

    def __init__(self, listed: list[Group], about: Groups) -> None:
        self.groups, self.about = sorted(listed, key=lambda group: group.cost), about
        self.costs, self.nodes, n = [group.cost for group in self.groups], 0, len(about.robot)
        self.holds = [mask_of(k for k, group in enumerate(self.groups) if group.robots >> i & 1) for i in range(n)]

    def first(self, most: int = MOST_STEPS) -> list[Group] | None:
        """The first partition found; ``None`` without one.

        Raises
        ------
        UndecidedError : neither after so many steps.
        """
        budgets = self.about.slack, self.about.most, 2 * self.about.about.alpha_c
        blinded, cut = (range(budget + 1) for budget in budgets[1:])
        self._needs = [mask_of(k for k, group in enumerate(self.groups) if group.need <= x) for x in blinded]
        self._links = [mask_of(k for k, group in enumerate(self.groups) if group.links <= x) for x in cut]
        self.nodes, self._most = 0, most
        everything = (1 << len(self.groups)) - 1, self.about.everyone
        return None if budgets[0] < 0 else self._search(*everything, 0, budgets)

    def _search(self, usable: int, left: int, together: int, budgets: tuple[int, int, int]) -> list[Group] | None:
        """Cover ``left`` by usable groups and one with all robots ``together``, if there are any."""
        tick()
        self.nodes += 1
        if self.nodes > self._most:
            raise UndecidedError(f"not decided within {self._most} partitions into groups")
        cost, blinded, cut = budgets
        usable &= self._needs[blinded] & self._links[cut] & (1 << bisect_right(self.costs, cost)) - 1
        together |= mask_of(i for i in robots_of(left) if not usable & self.holds[i])
        if together and self._is_dear(together, self.about.everyone & ~left, cost, blinded):
            return None
        if left == together:
            rest = self.about.group_of(left)
            fits = rest is not None and rest.cost <= cost and rest.need <= blinded and rest.links <= cut
            return [rest] if rest is not None and fits else None if left else []
        i = min(robots_of(left & ~together), key=lambda i: (usable & self.holds[i]).bit_count())
        for k in robots_of(usable & self.holds[i]):
            group, disjoint = self.groups[k], usable
            for j in robots_of(group.robots):
                disjoint &= ~self.holds[j]
            spent = cost - group.cost, blinded - group.need, cut - group.links
            cover = self._search(disjoint, left & ~group.robots, together, spent)
            if cover is not None:
                return [group, *cover]
        return self._search(usable & ~self.holds[i], left, together | 1 << i, budgets)

    def _is_dear(self, inside: int, outside: int, cost: int, blinded: int) -> bool:
        """Whether no group with these robots, and without those, is within what is left."""
        if self.about.need(inside) > blinded or self.about.impossible(inside, outside):
            return True
        flows = range(min(len(self.about.flows), TRIED))
        return any(self.about.least(inside, outside, flow, 0) > cost for flow in flows)
