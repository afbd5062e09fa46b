"""Sets of one size that are weak and pay more than a limit: all are ruled out, or some are found.

Where the worst axis of a target decides, ``paying_axes.py`` searches, target by target, and else ``paying_tree.py``.

Imported only where a large team is attacked: compiling takes seconds, once per machine (cached).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.attackers.by_size.family_prices.axis_nodes import AxisNodes
from ratt_opt.attackers.by_size.family_prices.paying_axes import search_axes
from ratt_opt.attackers.by_size.family_prices.paying_pairs import FINISHED, FOUND, Question
from ratt_opt.attackers.by_size.family_prices.paying_tree import BETWEEN_LOOKS, ENOUGH, PayingTree
from ratt_opt.attackers.weakest_set.pair_bound import views, weakest_bound
from ratt_opt.attackers.weakest_set.weakest_axis import weakest_axis

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt._validation import BoolArray
    from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
    from ratt_opt.attackers.weakest_set.pair_bound import View
    from ratt_opt.budget import Budget

__all__ = ["PayingSets", "Question", "Sets"]


@dataclass(frozen=True, slots=True)
class Sets:
    """``found`` sets (N,) that answer a question; with none, no answer is worth less than ``lower``, which is infinite
    where all sets are ruled out.
    """

    found: list[BoolArray]
    lower: float

    @property
    def is_complete(self) -> bool:
        """Whether no set answers the question."""
        return not self.found and self.lower == np.inf


class PayingSets:
    """Answers questions about one team; a node is a node of the search."""

    def __init__(self, team: PackedTeam) -> None:
        self._team, self._views = team, views(team)
        self.is_by_axis: bool = team.objective.states("planar_levels")
        self._n_robots = len(team.single)
        self._floors: dict[int, list[float]] = {}
        self._trees: dict[int, PayingTree] = {}

    def sizes(self, threshold: float, most: int) -> Iterator[int]:
        """Sizes of which sets may be worth less than a threshold, up to ``most``: larger sets contain smaller ones."""
        for size in range(1, most + 1):
            if size not in self._floors:
                self._floors[size] = self._weakest(size)
            if min(self._floors[size]) >= threshold:
                return
            yield size

    def _weakest(self, size: int) -> list[float]:
        """No set of a size that is weak in a view is worth less, view by view."""
        if self.is_by_axis:
            bound = weakest_axis(self._team.family(np.arange(self._n_robots), size)).bound
            return [bound] * len(self._views)
        return [weakest_bound(view, size) for view in self._views]

    def of_size(self, question: Question, size: int, budget: Budget, nodes: int, *, goes_on: bool = False) -> Sets:
        """Search the sets of a size of :meth:`sizes` for at most so many nodes of the budget.

        ``goes_on`` : where the last search of this size ended, of the same question; not along axes

        Raises
        ------
        OutOfBudget : the time is up, or no node is left.
        """
        found: list[BoolArray] = []
        if not self.is_by_axis:
            (view,) = self._views
            tree = self._trees.setdefault(size, PayingTree(self._team, view, size))
            if not goes_on:
                tree.ask(question)
            return Sets(found, tree.search(budget, nodes, found))
        for view, floor in zip(self._views, self._floors[size], strict=True):
            if floor >= question.threshold:
                continue
            before = budget.nodes
            lower = self._search_axes(view, question, size, budget, nodes, found)
            if lower < np.inf or len(found) >= ENOUGH:
                return Sets(found, lower if len(self._views) == 1 else -np.inf)
            nodes -= budget.nodes - before
        return Sets(found, np.inf)

    def _search_axes(  # noqa: PLR0917
        self, view: View, question: Question, size: int, budget: Budget, nodes: int, found: list[BoolArray]
    ) -> float:
        """Search one target until all is decided (infinite), enough is found or the nodes are spent."""
        search: Any = search_axes
        state = AxisNodes.of(view, size, question.threshold)
        chunk = max(BETWEEN_LOOKS // (self._n_robots**2 * len(view.weights)), 1)
        members, last = np.zeros(self._n_robots, dtype=np.bool_), budget.nodes + max(nodes, 1)
        while budget.nodes < last:
            most, before = budget.nodes_left(min(chunk, last - budget.nodes)), int(state.position[1])
            code = search(view, question, state, most, members)
            budget.nodes += int(state.position[1]) - before
            if code == FINISHED:
                return np.inf
            if code == FOUND:
                found.append(members.copy())
                # Sets found next shall pay more: cheaper ones say less of what the prices should be.
                question = question._replace(limit=max(question.limit, float(question.prices[members].sum())))
                if len(found) >= ENOUGH:
                    break
        return -np.inf
