"""The families of groups of one vector of sizes: is one of them worth less than a threshold?

All sets of each size below the threshold are listed, largest size first. A linear program bounds the families
(``cover_bound.py``) and says what each set costs against the bound; few sets cost less than the room. They are
searched for disjoint ones (``disjoint_sets.py``).
"""

from __future__ import annotations

from collections import Counter
from math import comb
from typing import TYPE_CHECKING

from ratt_opt.attack.size_vectors.cover_bound import SetClasses, cover_bound
from ratt_opt.attack.size_vectors.disjoint_sets import DisjointSets, Rest, list_sets
from ratt_opt.budget import OutOfBudget

if TYPE_CHECKING:
    from collections.abc import Sequence

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
            self._known[size] = list_sets(self.team, self.order, size, threshold, budget)
        known = self._known[size]
        return None if known is None else known.below(threshold)

    def is_cheap(self, size: int) -> bool:
        """Tell whether a list is known, or sure to be short."""
        return size in self._known or comb(len(self.order), size) <= self.team.params.families.few_sets

    def robots(self, mask: int) -> frozenset[int]:
        """The robots of a mask."""
        return frozenset(int(robot) for k, robot in enumerate(self.order.tolist()) if mask >> k & 1)


Groups = tuple[frozenset[int], ...]


class FamilySearch:
    """Search for a family of ``sizes`` among the robots of ``lists`` that is worth less than ``threshold``.

    ``n_blinded`` : of the robots outside the groups; ``must`` : mask of those that cannot be blinded
    """

    def __init__(self, lists: SetLists, sizes: tuple[int, ...], *, n_blinded: int, must: int, threshold: float) -> None:
        self._lists, self._threshold, self._params = lists, threshold, lists.team.params
        self._larger = sorted(Counter(size for size in sizes if size > 1).items(), reverse=True)
        n_rest = len(lists.order) - sum(size * count for size, count in self._larger)
        self._rest = Rest(n_rest, n_blinded, lists.single, must)
        self._is_open = False
        """A list is too long."""

    def run(self, budget: Budget) -> tuple[Groups | None, bool]:
        """The groups of a family, robots left alone among them, if one is found; and whether that is decided.

        Raises
        ------
        OutOfBudget : the time is up, or no node is left.
        """
        if not self._larger:
            return self._alone(), True
        classes = self._listed(budget)
        if classes is None:
            return None, not self._is_open
        budget.spend()
        bound = cover_bound(classes, self._threshold, budget, self._params.family_bound)
        if bound.bound >= self._threshold:
            return None, True
        search = DisjointSets(bound.columns(self._threshold), self._rest, self._threshold, self._params.disjoint)
        try:
            search.run(budget)
        except OutOfBudget:
            if not search.family():
                raise
        return self._groups(search.family()) if search.family() else None, True

    def _alone(self) -> Groups | None:
        """Every robot that is not blinded is alone: one family is the best."""
        everyone = (1 << len(self._lists.order)) - 1
        possible = self._rest.must.bit_count() <= self._rest.size - self._rest.n_blinded
        return self._groups(()) if possible and self._rest.alone(everyone) < self._threshold else None

    def _listed(self, budget: Budget) -> SetClasses | None:
        """The sets below the threshold, largest size first; ``None`` : no family is, or a list is too long."""
        classes, lists = SetClasses(len(self._lists.order)), self._lists
        for k, (size, count) in enumerate(self._larger):
            if k and not lists.is_cheap(size):
                bound = cover_bound(classes, self._threshold, budget, self._params.family_bound)
                if bound.bound >= self._threshold:
                    return None
                room = bound.room(self._threshold)
                low = list_sets(
                    lists.team, lists.order, size, self._threshold, budget, costs=bound.rest_costs, room=room
                )
            else:
                low = lists.of(size, self._threshold, budget)
            if low is None:
                self._is_open = True
                return None
            classes = classes.and_sets(low, count)
            if classes.is_empty:
                return None
        return classes

    def _groups(self, family: Sequence[int]) -> Groups:
        """The groups of a family of masks, and the robots left alone."""
        taken = sum(family)
        groups, blinded = [self._lists.robots(mask) for mask in family], 0
        for k, robot in enumerate(self._lists.order.tolist()):
            if taken >> k & 1:
                continue
            if blinded < self._rest.n_blinded and not self._rest.must >> k & 1:
                blinded += 1
            else:
                groups.append(frozenset([robot]))
        return tuple(groups)
