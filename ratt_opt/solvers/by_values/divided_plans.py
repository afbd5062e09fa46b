"""Branch and bound over plans: parts of them by the largest value that each may have, beside the attacks on plans."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Generic, NamedTuple, TypeVar

import numpy as np

from ratt_opt.search.branch_and_bound import divide_next
from ratt_opt.search.open_nodes import OpenNodes

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.budget import Budget, Stop
    from ratt_opt.solvers.by_values.plan_attacks import PlanAttacks

__all__ = ["DividedPlans"]

P = TypeVar("P")


class _PlansLeft(NamedTuple):
    """Some plans: none is worth more than ``-bound``; of one bound, the earlier ones go first."""

    bound: float
    number: int
    plans: object


class DividedPlans(ABC, Generic[P]):
    """The parts of the plans that are left; valid at any moment. A search says how one part is divided.

    ``most`` : parts kept by their bounds
    """

    def __init__(self, plans: P, upper: float, attacks: PlanAttacks, most: float = np.inf) -> None:
        self._attacks, self._budget = attacks, attacks.budget
        self._nodes = OpenNodes([_PlansLeft(-upper, 0, plans)], most)
        self._count, self._settled = 0, -np.inf

    @property
    def largest(self) -> float:
        """The largest bound of a part that is left, or settled: less than the best plan's worst case if all closed."""
        return float(max(self._settled, -self._nodes.bound))

    @property
    def upper(self) -> float:
        """No plan is worth more, unless it is worth no more than the best plan known."""
        return max(self.largest, self._attacks.lower)

    @property
    def is_finished(self) -> bool:
        """True if dividing can prove no more: the plans left are those of which attacks prove no more."""
        return bool(self._settled >= -self._nodes.bound)

    @property
    def is_at_root(self) -> bool:
        """True if nothing is divided yet."""
        return self._count == 0 and bool(self._nodes)

    def divide(self, budget: Budget) -> None:
        """Take the part of the largest bound: drop it or divide it; raises ``OutOfBudget``, and it is taken again."""
        self._budget = budget
        divide_next(self._nodes, self)

    def stop(self) -> Stop | None:
        """Return why not to divide on: the budget is spent."""
        return self._budget.stop()

    def bound(self, node: _PlansLeft) -> list[tuple[float, P]] | None:
        """Divide a part unless it is worth no more than the best plan known."""
        if -node.bound <= self._attacks.lower:
            return None
        self._budget.nodes += 1
        return self._divided(node.plans, -node.bound, self._budget)  # type: ignore[arg-type]

    def branch(self, bounded: list[tuple[float, P]]) -> Iterator[_PlansLeft]:
        """Return the parts of a part as nodes."""
        for bound, plans in bounded:
            self._count += 1
            yield _PlansLeft(-bound, self._count, plans)

    @abstractmethod
    def _divided(self, plans: P, bound: float, budget: Budget) -> list[tuple[float, P]]:
        """Parts of a part and their bounds; those that are worth no more than the best plan known may be missing."""

    def _lower(self, bound: float) -> None:
        """Lower the bound of the part in hand."""
        self._nodes.raise_bound(self._nodes.take()._replace(bound=-bound))

    def _settle(self, bound: float) -> None:
        """Leave a plan of which attacks prove no more than that it is worth at most ``bound``."""
        self._settled = max(self._settled, bound)
