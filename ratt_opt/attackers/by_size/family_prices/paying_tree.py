"""Sets of one size that are weak and pay more than a limit, by bounds on pairs of robots and by affine minorants.

Pairs (``paying_pairs.py``) are sharp for few robots, and a node takes half a millisecond: all sets of 12 of 60 robots
are ruled out by some hundreds. For 18 robots of 60 they lack 31 of 248 where a minorant of value and prices together
(``weakest_set/by_targets/decomposition.py``) lacks 2, and takes a tenth of a second, at first half a second. There a
best-first search divides nodes by minorants, which decide some robots for their children, and pairs end the smallest
ones. Leaving every node to the pairs for a while took five times as long for sets of 12.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.attackers.by_size.family_prices.paying_pairs import (
    FINISHED,
    FOUND,
    PairNodes,
    search_pairs,
    slack_of_pairs,
)
from ratt_opt.attackers.weakest_set.branch_and_bound import SetNode
from ratt_opt.attackers.weakest_set.by_targets.decomposition import decomposed
from ratt_opt.attackers.weakest_set.by_targets.slope_meshes import Meshes

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt._validation import BoolArray
    from ratt_opt.attackers.by_size.family_prices.paying_pairs import Question
    from ratt_opt.attackers.weakest_set.by_targets.decomposition import Decomposition
    from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
    from ratt_opt.attackers.weakest_set.pair_bound import View
    from ratt_opt.budget import Budget

__all__ = ["PayingTree"]

ENOUGH = 6
"""Sets found of one size before the prices are asked again; each pays more than those before."""
FIRST_TRIED, SMALL, SHARPER = 500, 13, (0.15, 0.5)
"""Nodes that pairs have for a question before a minorant of all sets is made, and the share of what pairs lack that it
may lack at most to be worth its time: for sets of up to so many robots, and for larger ones. At 60 robots, log-det,
60 s, (0, 1454), groups of about ten, leaves 1.3 % with the first and 3.0 % with the second, (8, 999) 2.3 and 0.8 %."""
FAR = 0.08
"""Share of the threshold that pairs may lack to be asked before minorants."""
TRIED, FEWEST, MOST, MORE, LESS = 30, 8, 3_000, 1.5, 0.7
"""Nodes of pairs before further minorants: at first, at least, at most; their growth where they end a node, and where
not."""
MINORANT_NODES = 200
"""Nodes of pairs that take as long as a minorant."""
BETWEEN_LOOKS = 10_000_000
"""Criteria of single targets between two looks at the clock: less than a tenth of a second."""


class PayingTree:
    """Answers questions about the sets of one size, one after the other; each search begins with the last minorant."""

    def __init__(self, team: PackedTeam, view: View, size: int) -> None:
        self._team, self._view, self._size = team, view, size
        self._root: Decomposition | None = None
        self._meshes = Meshes.of(len(team.weights))
        self._has_sharper_minorants = False
        self._tried, self._serial = TRIED, 0
        self._question: Question | None = None
        self._pairs: PairNodes | None = None
        self._waiting: list[SetNode[Decomposition]] | None = None
        """Nodes left, the one of the least bound first; ``None`` before there is a minorant of all sets."""

    def ask(self, question: Question) -> None:
        """Ask another question; what is left of the last one is forgotten."""
        self._question, self._pairs, self._waiting = question, None, None

    def search(self, budget: Budget, nodes: int, found: list[BoolArray]) -> float:
        """Go on until all is decided, enough is found, or the nodes, and a minorant's more, are spent.

        Returns what no set is worth less than that is left undecided: infinite where none is. Not to be gone on with
        where sets were found: others like them were left out.

        Raises
        ------
        OutOfBudget : the time is up, or no node is left; the question is to be asked anew.
        """
        assert self._question is not None
        run = _Run(self._question, budget, budget.nodes + max(nodes, 1), found)
        root: SetNode[Decomposition] = SetNode(-np.inf, 0, frozenset(), frozenset(), self._root)
        if self._pairs is None:
            self._pairs = self._pairs_of(root, run.question)
            if self._is_ended_soon(run):
                self._waiting = []
                return np.inf
            if run.is_over:
                return -np.inf
        if self._waiting is None:
            self._waiting = self._divided(root, run)
            if self._waiting and self._size > 2:
                slack, lacking = self._waiting[0].bound - run.question.threshold, self._lacking(run.question)
                self._has_sharper_minorants = slack >= SHARPER[self._size > SMALL] * lacking
        if self._has_sharper_minorants or self._size <= 2:
            self._search_nodes(self._waiting, run)
        elif self._waiting and self._is_ended_by_pairs(self._pairs, run, nodes):
            self._waiting = []
        return self._waiting[0].bound if self._waiting else np.inf

    def _is_ended_soon(self, run: _Run) -> bool:
        """Whether pairs decide the question, which are not asked where they lack far too much."""
        if self._has_sharper_minorants or (
            self._size > 2 and self._lacking(run.question) < -run.question.threshold * FAR
        ):
            return False
        assert self._pairs is not None
        return self._is_ended_by_pairs(self._pairs, run, FIRST_TRIED)

    def _lacking(self, question: Question) -> float:
        """By how much pairs of all robots exceed the threshold, if they do."""
        root: SetNode[Decomposition] = SetNode(-np.inf, 0, frozenset(), frozenset(), self._root)
        return float(slack_of_pairs(self._view, question, self._pairs_of(root, question)))

    def _search_nodes(self, waiting: list[SetNode[Decomposition]], run: _Run) -> None:
        """Decide or divide one node after the other."""
        while waiting and not run.is_over:
            node = heapq.heappop(waiting)
            if not self._is_ended(node, run):
                for child in [node] if run.is_over else self._divided(node, run):
                    heapq.heappush(waiting, child)

    def _is_ended(self, node: SetNode[Decomposition], run: _Run) -> bool:
        """Leave a node to the pairs for a while."""
        if len(node.inside) == self._size:
            self._keep(node.inside, run)
            return True
        if self._size + len(node.outside) == len(self._view.information):
            self._keep(frozenset(range(len(self._view.information))) - node.outside, run)
            return True
        is_ended = self._is_ended_by_pairs(self._pairs_of(node, run.question), run, self._tried)
        self._tried = int(np.clip(self._tried * (MORE if is_ended else LESS), FEWEST, MOST))
        return is_ended

    def _pairs_of(self, node: SetNode[Decomposition], question: Question) -> PairNodes:
        """Where pairs begin with a node."""
        inside, outside = (np.array(sorted(robots), dtype=np.int64) for robots in (node.inside, node.outside))
        left = self._size - len(inside)
        known = 0.0 if node.minorant is None else node.minorant.multiplier
        return PairNodes.of(self._view, question, left, (inside, outside), known or question.threshold / left**2)

    def _is_ended_by_pairs(self, pairs: PairNodes, run: _Run, nodes: int) -> bool:
        """Whether pairs come to an end within so many nodes."""
        n_robots, n_targets = self._view.information.shape[:2]
        search: Any = search_pairs
        chunk, members = max(BETWEEN_LOOKS // (n_robots**2 * n_targets), 1), np.zeros(n_robots, dtype=np.bool_)
        last = min(run.last, run.budget.nodes + nodes)
        while run.budget.nodes < last and len(run.found) < ENOUGH:
            most, before = run.budget.nodes_left(min(chunk, last - run.budget.nodes)), int(pairs.position[1])
            code = search(self._view, run.asked(), pairs, most, members)
            run.budget.nodes += int(pairs.position[1]) - before
            if code == FOUND:
                run.found.append(members.copy())
            elif code == FINISHED:
                return True
        return False

    def _keep(self, robots: Iterable[int], run: _Run) -> None:
        """Add a set to those found if it is an answer."""
        members = np.isin(np.arange(len(self._view.information)), list(robots))
        paid = float(run.question.prices[members].sum())
        if paid > run.asked().limit and self._team.value(np.flatnonzero(members)) < run.question.threshold:
            run.found.append(members)

    def _divided(self, node: SetNode[Decomposition], run: _Run) -> list[SetNode[Decomposition]]:
        """Nothing where a minorant closes the node; else one or two nodes with some more robots decided."""
        question, budget = run.question, run.budget
        budget.nodes += budget.nodes_left(MINORANT_NODES)
        robots, left = node.undecided(self._team), self._size - len(node.inside)
        if not 0 < left < len(robots):
            return [node]
        limit = question.limit - float(question.prices[list(node.inside)].sum())
        family = replace(self._team.family(robots, left, node.inside), lacking=limit / left - question.prices[robots])
        minorant = decomposed(family, question.threshold, budget, node.minorant, self._meshes)
        if not (node.inside or node.outside):
            self._root = minorant
        bound = max(node.bound, minorant.bound(left))
        if bound >= question.threshold:
            return []
        suggested = robots[np.lexsort((minorant.scores, -minorant.fraction))[:left]]
        self._keep([*node.inside, *suggested.tolist()], run)
        node, robots = replace(node, bound=bound, minorant=minorant).fixed(robots, left, question.threshold)
        left, self._serial = self._size - len(node.inside), self._serial + 2
        if not 0 < left < len(robots):
            return [replace(node, serial=self._serial)]
        return list(node.split(robots, bound, self._serial))


@dataclass(frozen=True, slots=True)
class _Run:
    """One search: the question, the budget, its nodes at the end, and what is found."""

    question: Question
    budget: Budget
    last: int
    found: list[BoolArray]

    @property
    def is_over(self) -> bool:
        """Whether the nodes are spent or enough is found."""
        return self.budget.nodes >= self.last or len(self.found) >= ENOUGH

    def asked(self) -> Question:
        """For sets that pay more than those found: cheaper ones say less of what the prices should be."""
        paid = [float(self.question.prices[members].sum()) for members in self.found]
        return self.question._replace(limit=max([self.question.limit, *paid]))
