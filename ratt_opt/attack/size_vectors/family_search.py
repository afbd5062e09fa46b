"""The families of groups of one vector of sizes: is one of them worth less than a threshold?

All sets of each size below the threshold are listed, largest size first. A linear program bounds the families
(``cover_bound.py``) and says what each set costs against the bound; few sets cost less than the room. They are
searched for disjoint ones (``disjoint_sets.py``). What takes long there is divided by whether two robots share a
group (Ryan and Foster, Integer programming approach to scheduling, 1981) and bounded again.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field, replace
from functools import partial
from math import comb
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.size_vectors.cover_bound import SetClasses, cover_bound
from ratt_opt.attack.size_vectors.disjoint_sets import DisjointSets, Rest, SetFilter, list_sets

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attack.size_vectors.disjoint_sets import SetList
    from ratt_opt.attack.team import Team
    from ratt_opt.budget import Budget

__all__ = ["FamilySearch", "SetLists"]


class SetLists:
    """Lists of the sets of some robots below a threshold, size by size, made when first asked for.

    ``order`` : (F,) the robots, strongest first; bit ``k`` of a mask is ``order[k]``
    """

    def __init__(self, team: Team, order: IntArray) -> None:
        self.team, self.order = team, order
        self.single: FloatArray = team.single[order]
        self._known: dict[int, SetList | None] = {}

    def of(self, size: int, threshold: float, budget: Budget) -> SetList | None:
        """All sets of a size below the threshold, which may only fall from call to call; ``None`` if too many."""
        if size not in self._known:
            self._known[size] = self.wanted(size, SetFilter.below(threshold, len(self.order)), budget)
        known = self._known[size]
        return None if known is None else known.below(threshold)

    def is_cheap(self, size: int) -> bool:
        """Tell whether a list is known, or sure to be short."""
        return size in self._known or comb(len(self.order), size) <= self.team.params.families.few_sets

    def wanted(self, size: int, wanted: SetFilter, budget: Budget) -> SetList | None:
        """The sets that a filter lets through, of this call only."""
        return list_sets(self.team, self.order, size, wanted, budget)

    def robots(self, mask: int) -> frozenset[int]:
        """The robots of a mask."""
        return frozenset(int(robot) for k, robot in enumerate(self.order.tolist()) if mask >> k & 1)


@dataclass(frozen=True, slots=True, order=True)
class _FamilyNode:
    """Families that hold the ``chosen`` sets and others of the ``classes``; none is worth less than ``bound``."""

    bound: float
    serial: int
    classes: SetClasses = field(compare=False)
    chosen: tuple[int, ...] = field(compare=False, default=())
    level: float = field(compare=False, default=-np.inf)
    """Largest value of a chosen set."""


class FamilySearch:
    """Searches the families of ``sizes`` among the robots of ``lists``, ``n_blinded`` of them blinded.

    ``threshold`` : only families below it count; may be lowered while :meth:`run` goes on
    ``lower`` : no family that is not decided yet is worth less
    ``is_open`` : whether the lists were too long to decide
    """

    def __init__(self, lists: SetLists, sizes: tuple[int, ...], *, n_blinded: int, must: int, threshold: float) -> None:
        self.lists, self.threshold = lists, threshold
        self._larger = sorted(Counter(size for size in sizes if size > 1).items(), reverse=True)
        n_rest = len(lists.order) - sum(size * count for size, count in self._larger)
        self._rest = Rest(n_rest, n_blinded, lists.single, must)
        self._open = [_FamilyNode(-np.inf, 0, SetClasses(len(lists.order)))]
        self._serial = 0
        self._is_listed = False
        self.is_open = False

    @property
    def lower(self) -> float:
        """No family still undecided is worth less; infinite once all are decided."""
        return min((node.bound for node in self._open), default=np.inf)

    def bound(self, budget: Budget) -> bool:
        """List the sets and bound all families; false if that leaves nothing to search.

        Raises
        ------
        OutOfBudget : the time is up; ``lower`` stays valid.
        """
        if not self._larger:
            self._open = [replace(self._open[0], bound=self._rest.alone((1 << len(self.lists.order)) - 1))]
            return True
        if self._list(budget):
            root = self._open[0]
            budget.spend()
            found = cover_bound(root.classes, self.threshold, budget, self.lists.team.params.family_bound)
            self._open = [replace(root, bound=max(root.bound, found.bound))]
            self._is_listed = found.bound < self.threshold
        if not self._is_listed and not self.is_open:
            self._open.clear()
        return self._is_listed

    def run(self, budget: Budget) -> Iterator[tuple[frozenset[int], ...]]:
        """Yield better and better families of groups until none is left; robots left alone are groups of one.

        Raises
        ------
        OutOfBudget : the time is up; ``lower`` stays valid.
        """
        if not self._larger:
            yield from self._alone()
            return
        if self._is_listed or self.bound(budget):
            while self._open and (node := min(self._open)).bound < self.threshold:
                children = yield from self._decide(node, budget)
                self._open = [*(other for other in self._open if other.serial != node.serial), *children]
        if not self.is_open:
            self._open.clear()

    def _alone(self) -> Iterator[tuple[frozenset[int], ...]]:
        """Every robot that is not blinded is alone: one family is the best."""
        everyone = (1 << len(self.lists.order)) - 1
        possible = self._rest.must.bit_count() <= self._rest.size - self._rest.n_blinded
        if possible and self._rest.alone(everyone) < self.threshold:
            yield self._groups(())
        self._open.clear()

    def _list(self, budget: Budget) -> bool:
        """List the sets, largest size first; false where that proves that no family is below the threshold."""
        classes = self._open[0].classes
        for k, (size, count) in enumerate(self._larger):
            threshold = self.threshold
            if k and not self.lists.is_cheap(size):
                bound = cover_bound(classes, threshold, budget, self.lists.team.params.family_bound)
                self._open = [replace(self._open[0], bound=bound.bound)]
                if bound.bound >= threshold:
                    return False
                low = self.lists.wanted(size, SetFilter(threshold, bound.rest_costs, bound.room(threshold)), budget)
            else:
                low = self.lists.of(size, threshold, budget)
                if not k and low is not None and len(low.masks):
                    self._open = [replace(self._open[0], bound=float(low.values[0]))]
            if low is None:
                self.is_open = True
                return False
            classes = classes.and_sets(low, count)
            if classes.is_empty:
                return False
        self._open = [replace(self._open[0], classes=classes)]
        return True

    def _decide(
        self, node: _FamilyNode, budget: Budget
    ) -> Generator[tuple[frozenset[int], ...], None, list[_FamilyNode]]:
        """Bound a node and search it; divide it if that takes long. Returns its children."""
        while node.level < self.threshold:
            classes = node.classes.where(lambda low: low.below(self.threshold))
            if classes.is_empty:
                break
            budget.spend()
            bound = cover_bound(classes, self.threshold, budget, self.lists.team.params.family_bound)
            node = replace(node, classes=classes, bound=max(node.bound, bound.bound))
            self._open = [node if other.serial == node.serial else other for other in self._open]
            if node.bound >= self.threshold:
                break
            search = DisjointSets(
                bound.columns(self.threshold), self._rest, self.threshold, self.lists.team.params.disjoint
            )
            children = self._divided(node, bound.together)
            try:
                finished = search.run(budget, self.lists.team.params.families.looks if children else np.inf)
            finally:
                if search.family():
                    self.threshold = max(search.value, node.level)
                    yield self._groups((*node.chosen, *search.family()))
            if finished:
                break
            if not search.family():
                return children
        return []

    def _divided(self, node: _FamilyNode, together: FloatArray) -> list[_FamilyNode]:
        """Branch on one of a few sets, else on whether two robots are together; no children if the node is integral."""
        classes = node.classes
        c = min(range(len(classes.lists)), key=lambda d: len(classes.lists[d].masks))
        low, children = classes.lists[c], []
        if len(low.masks) <= self.lists.team.params.families.few_choices and len(classes.lists) + classes.counts[c] > 2:
            for k in range(len(low.masks)):
                later = replace(low, masks=low.masks[k:], values=low.values[k:])
                lists = (*classes.lists[:c], later, *classes.lists[c + 1 :])
                mask, level = int(low.masks[k]), max(node.level, float(low.values[k]))
                left = replace(classes, lists=lists).having(c, mask)
                children.append(self._child(node, left, (*node.chosen, mask), level))
            return children
        pair = _pair(together, self.lists.team.params.families.clear)
        if pair is not None:
            first, second = (np.uint64(1) << np.uint64(bit) for bit in pair)
            for apart in (False, True):
                agrees = partial(_agreeing, first=first, second=second, apart=apart)
                left = classes.where(agrees)
                children.append(self._child(node, left, node.chosen, node.level))
        return children

    def _child(self, node: _FamilyNode, classes: SetClasses, chosen: tuple[int, ...], level: float) -> _FamilyNode:
        self._serial += 1
        return _FamilyNode(max(node.bound, level), self._serial, classes, chosen, level)

    def _groups(self, family: tuple[int, ...]) -> tuple[frozenset[int], ...]:
        """The groups of a family of masks, and the robots left alone."""
        taken = sum(family)
        groups, blinded = [self.lists.robots(mask) for mask in family], 0
        for k, robot in enumerate(self.lists.order.tolist()):
            if taken >> k & 1:
                continue
            if blinded < self._rest.n_blinded and not self._rest.must >> k & 1:
                blinded += 1
            else:
                groups.append(frozenset([robot]))
        return tuple(groups)


def _agreeing(low: SetList, first: np.uint64, second: np.uint64, *, apart: bool) -> SetList:
    """The sets that hold not both of two robots, or that hold both or none."""
    one, other = low.masks & first > 0, low.masks & second > 0
    return low.where(~(one & other) if apart else one == other)


def _pair(together: FloatArray, clear: float) -> tuple[int, int] | None:
    """The two robots that are together about half of the time; ``None`` if all are clear."""
    unclear = np.triu(np.minimum(together, 1 - together), 1)
    i, j = np.unravel_index(int(unclear.argmax()), unclear.shape)
    return (int(i), int(j)) if unclear[i, j] > clear else None
