"""The smallest largest group of graphs that are hardly more than trees: cuts of bridges, and of few links beside them.

Cutting a bridge divides a group; another link must go with others before anything falls apart. Which bridges to cut
for groups of at most p robots is soon decided: from the leaves on, what hangs on a part without bridges is cut off,
the heaviest first, until the part is light enough. No fewer cuts do (Kundu and Misra, SIAM J. Comput. 6(1), 1977).

Take a cut of k links. Of these take as many as can go without anything falling apart: at most k - 1, or the cut is of
no use. The others are bridges of what is left. So all choices of the former are tried, and the bridges are decided for
each. On a tree there is one choice, whatever the number of cuts.
"""

from __future__ import annotations

from itertools import combinations
from math import comb
from typing import TYPE_CHECKING, NamedTuple

from ratt_opt.budget import OutOfBudget
from ratt_opt.graph.largest_group.counting import COUNTED, counting_bound, split_result

if TYPE_CHECKING:
    from ratt_opt.budget import Budget
    from ratt_opt.graph.communication import Link
    from ratt_opt.graph.largest_group.counting import LargestGroup
    from ratt_opt.graph.threat import Threat

__all__ = ["by_bridges", "is_nearly_a_tree"]

MOST_CHOICES = 20_000
"""Choices of links beside bridges that are tried: a millisecond each at some hundred robots."""
Cuts = list[tuple[int, int]]


class _Hanging(NamedTuple):
    """A part below a bridge: how many robots hang on it that are not cut off, and the bridge."""

    robots: int
    link: tuple[int, int]


class _Sparse:
    """The links of a graph by robot, some of which cannot be cut."""

    def __init__(self, threat: Threat) -> None:
        self.n = threat.graph.n_robots
        self.protected = threat.protected_links
        self.near: list[list[tuple[int, tuple[int, int]]]] = [[] for _ in range(self.n)]
        for link in sorted(threat.graph.links):
            i, j = link
            self.near[i].append((j, link))
            self.near[j].append((i, link))

    def fewest_bridges(self, without: frozenset[Link], most: int) -> Cuts | None:
        """Fewest bridges to cut once some links are gone, so that groups have at most ``most`` robots, if any do."""
        cuts: Cuts = []
        seen = [-1] * self.n
        for root in range(self.n):
            if seen[root] < 0 and not self._cut_off(root, seen, without, most, cuts):
                return None
        return cuts

    def _cut_off(self, root: int, seen: list[int], without: frozenset[Link], most: int, cuts: Cuts) -> bool:
        """Cut off parts of the root's group as they must be; whether no part was too heavy.

        ``seen`` : order in which robots are met, of those met
        """
        parent, low = {root: (-1, (-1, -1))}, {}
        robots: dict[int, int] = {}
        hanging: dict[int, list[_Hanging]] = {}
        stack = [(root, iter(self.near[root]))]
        seen[root] = low[root] = len(parent)
        robots[root], hanging[root] = 1, []
        while stack:
            i, rest = stack[-1]
            step = next(rest, None)
            if step is not None:
                j, link = step
                if link == parent[i][1] or link in without:
                    continue
                if seen[j] < 0:
                    parent[j] = (i, link)
                    seen[j] = low[j] = len(parent)
                    robots[j], hanging[j] = 1, []
                    stack.append((j, iter(self.near[j])))
                else:
                    low[i] = min(low[i], seen[j])
                continue
            stack.pop()
            above, link = parent[i]
            is_bridge = above >= 0 and low[i] == seen[i]
            if above >= 0:
                low[above] = min(low[above], low[i])
            if above >= 0 and (not is_bridge or link in self.protected):
                robots[above] += robots[i]
                hanging[above] += hanging[i]
                continue
            left = _lightened(robots[i], hanging[i], most, cuts)
            if left is None:
                return False
            if above >= 0:
                hanging[above].append(_Hanging(left, link))
        return True


def _lightened(robots: int, hanging: list[_Hanging], most: int, cuts: Cuts) -> int | None:
    """Cut off what is heaviest until at most ``most`` robots are left: how many are; ``None`` if that cannot be."""
    total = robots + sum(part.robots for part in hanging)
    for part in sorted(hanging, reverse=True):
        if total <= most:
            break
        cuts.append(part.link)
        total -= part.robots
    return total if total <= most else None


def _are_few(threat: Threat, beside: int) -> bool:
    """Test whether all choices of links among ``beside`` links that are no bridges can be enumerated."""
    return sum(comb(beside, k) for k in range(min(threat.n_cut, _cycles(threat) + 1))) <= MOST_CHOICES


def _cycles(threat: Threat) -> int:
    """Links that could be cut without anything falling apart."""
    graph = threat.graph
    return len(graph.links) - graph.n_robots + len(graph.groups())


def is_nearly_a_tree(threat: Threat) -> bool:
    """Test whether all choices of links other than bridges can be enumerated."""
    at_least = max(_cycles(threat) - len(threat.protected_links), 0)  # on dense graphs that says enough
    return _are_few(threat, at_least) and _are_few(threat, len(_beside(threat)))


def _beside(threat: Threat) -> frozenset[Link]:
    """The links that can be cut and are no bridges."""
    return threat.graph.links - threat.graph.bridges() - threat.protected_links


def by_bridges(threat: Threat, budget: Budget) -> LargestGroup:
    """Try all choices of links beside bridges; the bracket by counting, and the best cut, if the budget ends before.

    A node is a choice.
    """
    sparse, cut = _Sparse(threat), frozenset[tuple[int, int]]()
    beside, smallest, allowed = sorted(_beside(threat)), max(map(len, threat.graph.groups())), threat.n_cut
    try:
        for k in range(min(allowed, _cycles(threat) + 1)):
            for choice in combinations(beside, k):
                budget.spend()
                without = frozenset(choice)
                while smallest > 1:
                    cuts = sparse.fewest_bridges(without, smallest - 1)
                    if cuts is None or len(cuts) > allowed - k:
                        break
                    cut = without | frozenset(cuts)
                    smallest = max(map(len, threat.graph.groups(cut)))
    except OutOfBudget as spent:
        return split_result(threat, cut, counting_bound(threat), "enumeration", COUNTED, stop=spent.stop)
    return split_result(threat, cut, smallest, "enumeration", "no choice of bridges and other links leaves less")
