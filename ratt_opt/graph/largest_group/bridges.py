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
            if seen[root] < 0:
                left = self._hang(root, seen, without, most, cuts)
                if left is None:
                    return None
        return cuts

    def bridges(self) -> set[tuple[int, int]]:
        """All of them."""
        cuts: Cuts = []
        found: set[tuple[int, int]] = set()
        seen = [-1] * self.n
        for root in range(self.n):
            if seen[root] < 0:
                self._hang(root, seen, frozenset(), self.n, cuts, found)
        return found

    def _hang(  # noqa: PLR0917
        self,
        root: int,
        seen: list[int],
        without: frozenset[Link],
        most: int,
        cuts: Cuts,
        found: set[tuple[int, int]] | None = None,
    ) -> int | None:
        """Robots left with the root, once its parts are cut off as they must be; ``None`` if a part is too heavy.

        ``seen`` : order in which robots are met, of those met; ``found`` : takes all bridges
        """
        order, parent, low = [root], {root: (-1, (-1, -1))}, {}
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
                    order.append(j)
                    stack.append((j, iter(self.near[j])))
                else:
                    low[i] = min(low[i], seen[j])
                continue
            stack.pop()
            above, link = parent[i]
            is_bridge = above >= 0 and low[i] == seen[i]
            if is_bridge and found is not None:
                found.add(link)
            if above >= 0:
                low[above] = min(low[above], low[i])
            if above >= 0 and (not is_bridge or link in self.protected):
                robots[above] += robots[i]
                hanging[above] += hanging[i]
                continue
            left = _lightened(robots[i], hanging[i], most, cuts)
            if left is None:
                return None
            if above >= 0:
                hanging[above].append(_Hanging(left, link))
        return left


def _lightened(robots: int, hanging: list[_Hanging], most: int, cuts: Cuts) -> int | None:
    """Cut off what is heaviest until at most ``most`` robots are left: how many are; ``None`` if that cannot be."""
    total = robots + sum(part.robots for part in hanging)
    for part in sorted(hanging, reverse=True):
        if total <= most:
            break
        cuts.append(part.link)
        total -= part.robots
    return total if total <= most else None


def _choices(threat: Threat, beside: int) -> int:
    """How many choices of links beside bridges there are to try."""
    return sum(comb(beside, k) for k in range(min(_links_cut(threat), _cycles(threat) + 1)))


def _cycles(threat: Threat) -> int:
    """Links that could be cut without anything falling apart."""
    graph = threat.graph
    return len(graph.links) - graph.n_robots + len(graph.groups())


def _links_cut(threat: Threat) -> int:
    return min(threat.alpha_c, len(threat.graph.links) - len(threat.protected_links))


def is_nearly_a_tree(threat: Threat) -> bool:
    """Whether all choices of links beside bridges can be tried."""
    beside = len(threat.graph.links) - len(_Sparse(threat).bridges() | threat.protected_links)
    return _choices(threat, beside) <= MOST_CHOICES


def by_bridges(threat: Threat, budget: Budget) -> LargestGroup:
    """Try all choices of links beside bridges; the bracket by counting, and the best cut, if the budget ends before.

    A node is a choice.
    """
    sparse, cut = _Sparse(threat), frozenset[tuple[int, int]]()
    beside = sorted(threat.graph.links - sparse.bridges() - threat.protected_links)
    smallest, allowed, cycles = max(map(len, threat.graph.groups())), _links_cut(threat), _cycles(threat)
    try:
        for k in range(min(allowed, cycles + 1)):
            for choice in combinations(beside, k):
                budget.spend()
                without = frozenset(choice)
                while smallest > 1:
                    cuts = sparse.fewest_bridges(without, smallest - 1)
                    if cuts is None or len(cuts) > allowed - k:
                        break
                    cut = without | frozenset(cuts)
                    smallest = max(map(len, threat.graph.groups(cut)))
    except OutOfBudget:
        return split_result(threat, cut, counting_bound(threat), "enumeration", COUNTED)
    return split_result(threat, cut, smallest, "enumeration", "no choice of bridges and other links leaves less")
