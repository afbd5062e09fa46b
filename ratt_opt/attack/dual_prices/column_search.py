"""Columns of negative reduced cost, or the proof that no column has one: searches that may be gone on with."""

from __future__ import annotations

from dataclasses import dataclass
from time import monotonic
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from ratt_opt.attack.dual_prices.program import KnownGroup
from ratt_opt.attack.pricing import BLINDED, UNIT, Column, GroupSearch, Question

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import IntArray
    from ratt_opt.attack.pricing import DualPrices, Plan
    from ratt_opt.budget import Budget

__all__ = ["ColumnSearch", "Columns", "Listed", "question_of"]


T = TypeVar("T")

HALF = 2 * UNIT
"""Dual prices are about half links: each link that is cut leaves two groups."""
KEPT = 3
"""Searches that may be gone on with: one for each choice of prices."""
FIRST_CHUNK, GLANCE = 500, 0.02
"""Nodes before the first look at the clock, and seconds between two looks that chunks are cut for."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Columns:
    """``groups`` of negative reduced cost; ``is_complete`` : there are no others."""

    groups: list[KnownGroup]
    is_complete: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Listed:
    """Groups of small reduced cost: ``columns``; ``is_complete`` : no other has so little."""

    columns: list[Column]
    is_complete: bool


def question_of(prices: DualPrices, threshold: float, most: int, limit: float) -> Question:
    """The question for groups of reduced cost less than ``limit`` [links]; rounding makes every group cost no less."""
    return Question(
        threshold,
        most,
        _duals(prices),
        int(np.ceil(prices.blinded * HALF)),
        int(np.floor(limit * HALF)),
    )


class ColumnSearch:
    """Searches for groups of one plan that pay.

    If a search was in vain and the same prices are asked again, it goes on where it was.
    """

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self._begun: dict[tuple[float, int, int, bytes], GroupSearch] = {}

    def find(self, question: Question, budget: Budget, *, nodes: int, room: int) -> Columns:
        """Search for that many nodes, until ``room`` groups are found; counts its nodes in ``budget``.

        Raises
        ------
        OutOfBudget : the time is up.
        """
        below, groups = float(np.nextafter(question.threshold, -np.inf)), list[KnownGroup]()
        key = question.threshold, question.limit, question.blinding, question.duals.tobytes()
        search = self._begun.pop(key, None) or GroupSearch(self.plan, question, _dearest_first(question))
        pace = _Pace(search, nodes, budget)
        while not pace.is_over and len(groups) < room:
            column = pace.ask(search.next)
            if column is False:
                return Columns(groups=groups, is_complete=True)
            if column is not None:
                groups.append(KnownGroup(robots=column.robots, need=column.found, value=below))
        if not groups:
            self._begun[key] = search
            while len(self._begun) > KEPT:
                del self._begun[next(iter(self._begun))]
        return Columns(groups=groups, is_complete=False)

    def listed(self, question: Question, budget: Budget, nodes: int, room: int) -> Listed:
        """Groups of a question, at most ``room``, within that many nodes.

        Raises
        ------
        OutOfBudget : the time is up.
        """
        robots, count, is_complete = self.plan.robots, 0, False
        table = np.zeros((room, robots), np.int8), np.zeros((room, 4), np.int64)
        with GroupSearch(self.plan, question, _dearest_first(question)) as search:
            pace = _Pace(search, nodes, budget)
            while not (pace.is_over or is_complete or count == room):
                count, is_complete = pace.ask(lambda some: search.fill(some, table, count))  # noqa: B023
        rows = zip(table[0][:count], table[1][:count].tolist(), strict=True)
        columns = [
            Column(robots=part > 0, blinded=part == BLINDED, need=need, found=found, cost=cost)
            for part, (need, found, _, cost) in rows
        ]
        return Listed(columns=columns, is_complete=is_complete)


def _duals(prices: DualPrices) -> IntArray:
    return np.floor(prices.robot * HALF).astype(np.int64)


def _dearest_first(question: Question) -> IntArray:
    return np.argsort(-question.duals, kind="stable").astype(np.int64)


class _Pace:
    """Asks a search for as many nodes at a time as take some hundredths of a second; counts them in the budget."""

    def __init__(self, search: GroupSearch, nodes: int, budget: Budget) -> None:
        self._search, self._budget, self._chunk = search, budget, FIRST_CHUNK
        self._stop = search.nodes + budget.nodes_left(max(nodes - search.nodes, 0))

    @property
    def is_over(self) -> bool:
        return self._search.nodes >= self._stop

    def ask(self, go_on: Callable[[int], T]) -> T:
        """Raises :class:`OutOfBudget` : the time is up."""
        self._budget.check()
        before, began = self._search.nodes, monotonic()
        answer = go_on(min(self._chunk, self._stop - before))
        self._budget.nodes += self._search.nodes - before
        self._chunk = 2 * self._chunk if monotonic() - began < GLANCE else max(self._chunk // 2, 1)
        return answer
