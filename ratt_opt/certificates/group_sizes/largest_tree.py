"""A tree over who is in the largest group, and who sees in it: each is worth the threshold, or scores too little."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.certificates.group_sizes.score_bounds import CaseBounds
from ratt_opt.certificates.plan_sets import COVERING, NotClosedError
from ratt_opt.certificates.verifier.work import tell, tick
from ratt_opt.graph.communication import robots_of

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.certificates.group_sizes.score_bounds import ScoreBounds
    from ratt_opt.certificates.plan_sets import PlanSets
    from ratt_opt.certificates.verifier.sizes import GroupComposition

__all__ = ["Found", "grow_tree"]


@dataclass(frozen=True, slots=True)
class _Case:
    """Masks of the verifier's case; posterior of the unblinded robots; first multipliers; whether one more robot
    senses than in the case before."""

    posterior: FloatArray
    start: FloatArray
    seeing: int = 0
    others: int = 0
    inside: int = 0
    outside: int = 0
    grown: bool = True


@dataclass(frozen=True, slots=True)
class Found:
    """Bounds by number, each a vector of prices and a diagonal, and the nodes that trees have so far."""

    bounds: dict[tuple[int, tuple[int, ...]], int]
    most: int

    def number(self, bound: tuple[int, tuple[int, ...]]) -> int:
        """Return the number of a bound, old or new."""
        return self.bounds.setdefault(bound, len(self.bounds))


def grow_tree(sets: PlanSets, bounds: ScoreBounds, group: GroupComposition, found: Found) -> list[Any]:
    """Return the tree.

    Raises
    ------
    NotClosedError : a group of these sizes is worth less and scores enough, or the tree is too large.
    """
    return _Tree(sets, bounds, group, found).run()


class _Tree:
    """The weakest robot first sees in the group, or does not; when all are known that see, who else is inside."""

    def __init__(self, sets: PlanSets, bounds: ScoreBounds, group: GroupComposition, found: Found) -> None:
        self.group, self.found, self.bounds = group, found, CaseBounds(bounds, group)
        self.objective, self.threshold = sets.objective, sets.threshold
        self.own = self.objective.information[sets.elements]
        self.everyone = (1 << len(self.own)) - 1
        self.safe = sum(1 << i for i in sets.problem.threat.protected_robots)
        self.tree: list[Any] = []

    def run(self) -> list[Any]:
        stack = [_Case(self.objective.prior_information, self.bounds.start())]
        while stack:
            tick()
            tell(COVERING, len(self.tree))
            if len(self.tree) + len(self.found.bounds) * len(self.own) > self.found.most:
                raise NotClosedError
            self._expand(stack.pop(), stack)
        return self.tree

    def _expand(self, case: _Case, stack: list[_Case]) -> None:
        may_see = self.everyone & ~(case.seeing | case.others | case.outside)
        missing = self.group.sensing - case.seeing.bit_count()
        if self._is_impossible(case, missing, may_see):
            self.tree.append("budget")
            return
        if case.grown and self.objective.value(case.posterior) >= self.threshold:
            self.tree.append("worth")
            return
        waiting = np.array(robots_of(may_see if missing else 0), dtype=np.int64)
        values = np.asarray(self.objective.value(case.posterior + missing * self.own[waiting]))
        if missing and self._average(values, missing) >= self.threshold:
            self.tree.append("copies")
            return
        looked = self.bounds.look(case.inside, case.outside, case.start)
        if looked.diagonal:
            self.tree.append({"form": self.found.number((looked.vector, looked.diagonal))})
            return
        case = replace(case, start=looked.multipliers, grown=False)
        if missing:
            self._ask_sight(case, int(waiting[np.argmin(values)]), stack)
        else:
            self._ask_place(case, looked.place, stack)

    def _average(self, values: FloatArray, missing: int) -> float:
        """Average the ``missing`` least values, or return the least of all if the verifier cannot take averages."""
        values = np.sort(values)
        return float(values[:missing].mean() if self.objective.verifier_averages else values[0])

    def _is_impossible(self, case: _Case, missing: int, may_see: int) -> bool:
        """Test the verifier's conditions for a leaf beyond the budgets."""
        blinded, size = case.inside & case.others, self.group.sensing + self.group.blinded
        if missing < 0 or blinded.bit_count() > self.group.blinded or case.inside.bit_count() > size:
            return True
        return (self.everyone & ~case.outside).bit_count() < size or may_see.bit_count() < missing

    def _ask_sight(self, case: _Case, i: int, stack: list[_Case]) -> None:
        self.tree.append({"sense": i})
        gone = 1 << i & self.safe  # as it cannot be blinded
        stack.append(replace(case, others=case.others | 1 << i, outside=case.outside | gone))
        case = replace(case, seeing=case.seeing | 1 << i, inside=case.inside | 1 << i)
        stack.append(replace(case, posterior=case.posterior + self.own[i], grown=True))

    def _ask_place(self, case: _Case, place: FloatArray, stack: list[_Case]) -> None:
        """Branch on the robot that is least clearly inside or outside the best fractional group."""
        open_ = robots_of(self.everyone & ~(case.inside | case.outside))
        if not open_:
            raise NotClosedError
        i = min(open_, key=lambda robot: abs(place[robot] - 0.5))
        self.tree.append({"inside": i})
        stack.append(replace(case, outside=case.outside | 1 << i))
        stack.append(replace(case, inside=case.inside | 1 << i))
