"""The exact attacker of large teams on a complete graph, two-dimensional targets.

Outcomes are told apart by their group sizes (``graph/survivor_sizes.py``). Exchanges find a weak family of groups of
each vector of sizes; then vector by vector, most promising first, all families are decided (``vector_search.py``)
where the sets of a size can be listed.

Elsewhere the sets of each size of the largest group are searched (``largest_first.py``). Where several groups are about
alike, or there are too many vectors, ``family_prices`` bounds all families at once.
"""

from __future__ import annotations

from contextlib import contextmanager
from itertools import islice
from math import comb
from operator import attrgetter
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.by_size.family_prices.family_search import FamilySearch
from ratt_opt.attackers.by_size.family_prices.threshold_bound import LARGEST
from ratt_opt.attackers.by_size.largest_first import LargestFirst
from ratt_opt.attackers.by_size.low_lists import MOST_ROBOTS
from ratt_opt.attackers.by_size.vector_search import LowLists, VectorSearch
from ratt_opt.attackers.by_size.weak_families import WeakFamilies, weakest_of
from ratt_opt.attackers.staging import Stage, run_stages
from ratt_opt.budget import Stop
from ratt_opt.graph.outcomes import realise
from ratt_opt.graph.survivor_sizes import (
    FIRST,
    first_non_dominated_sizes,
    forced_group_size,
    iterate_non_dominated_sizes,
    sizes_of_largest,
)
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from ratt_opt.attackers.by_size.group_exchanges import GroupExchanges
    from ratt_opt.attackers.task import AttackTask
    from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
    from ratt_opt.graph.survivor_sizes import Sizes

__all__ = ["SizeVectorSearch"]

MOST_VECTORS = FIRST - 1
"""Vectors of sizes that are searched; there are at most 90 at 30 robots, 2,813 at 60 of the budgets of the benchmark.
Where there are more, some make attacks, and the bound is that of the forced size and of prices."""

PRICED_SIZES, PRICED_SHARE = 10_000_000, 0.1
"""Vectors that prices know at most, times robots, and of the time left, for listing them: a hundred thousand take a
second and some tens of MiB. Beyond, links are counted. At 100 robots (28, 4066) has 8,413, (0, 4066) 97,873, (0, 4702)
more than 240,000."""

OF_EACH_SIZE, SOME_VECTORS = 4, 200
"""Vectors with each size of the largest group, and in all, that make attacks where there are too many."""

LISTED_SHARE, LARGEST_SHARE, NEARLY, ALIKE = 0.4, (0.05, 0.1), 0.02, 0.8
"""Of the time left, for families whose sets can be listed, where these are not all, and for a first search by the
largest group, before prices of families; and the value of the second best group of an attack, over the best, from which
prices are asked: below, it is the largest group that decides."""

LATER_SHAKES = 400
"""Shakes of vectors that the bounds leave open: rather than going through families of an incumbent too strong."""

MAYBE_SHORT = 2 * 10**8
"""Sets of the smallest largest group of which those below an attack may be listed in no time: all sizes of 30 robots.
Measured on RATT's plans at the paper's budgets: 2 ms instead of 6.5 at 20 robots, 13 instead of 34 at 30; at other
budgets of 30 robots 44 instead of 56."""

LISTED_WHOLE = 34
"""Up to so many robots, sets of any size are listed."""

LONGEST_LIST = 10**8
"""Sets of the largest group that are gone through, in larger teams: a few seconds."""


class SizeVectorSearch:
    """Closes the task's bracket; relies on a non-decreasing objective.

    ``vectors`` : of sizes to search; those that the budgets allow by default
    """

    def __init__(self, task: AttackTask, team: PackedTeam, vectors: list[Sizes] | None = None) -> None:
        self.task, self.team, self.bracket = task, team, task.bracket
        self.threat = task.problem.threat
        n_robots, n_blinded, alpha_c = len(team.single), self.threat.n_blinded, self.threat.alpha_c
        self._given = vectors
        allowed = first_non_dominated_sizes(n_robots, n_blinded, alpha_c) if vectors is None else vectors
        self.vectors = list(allowed[: MOST_VECTORS + 1])
        self.has_all_vectors = len(self.vectors) <= MOST_VECTORS
        self.weak = WeakFamilies(task, team)
        self.lists = LowLists(team, np.argsort(-team.single, kind="stable"))
        self.bounds: dict[Sizes, float] = dict.fromkeys(self.vectors, -np.inf)
        """What the families of each vector that is open are worth at least."""
        self.families: list[GroupExchanges] = []
        self._is_about_families = False
        self._by_largest = LargestFirst(task, team, self._accept)

    def run(self) -> Stop:
        """Search every vector; the bracket is valid whenever this stops."""
        return run_stages(STAGES, self) or self.task.budget.stop() or Stop.HEURISTIC

    # -- what the stages ask -------------------------------------------------------------------------------------

    def blinds_everyone(self) -> bool:
        """Everybody may be blinded."""
        return self.vectors == [()]

    def has_few_vectors(self) -> bool:
        """Vectors of sizes can be searched one by one."""
        return self.has_all_vectors

    def has_many_vectors(self) -> bool:
        """Too many vectors of sizes."""
        return not self.has_all_vectors

    def lists_in_share(self) -> bool:
        """Several groups about alike, more than 34 robots."""
        return self.is_about_families() and len(self.team.single) > LISTED_WHOLE

    def lists_at_once(self) -> bool:
        """Vectors can be searched one by one; one group decides, or at most 34 robots."""
        return self.has_all_vectors and not self.lists_in_share()

    def is_about_families(self) -> bool:
        """Several groups about alike, limit of time."""
        return self._is_about_families and self.has_all_vectors

    def is_nearly_closed(self) -> bool:
        """Several groups about alike, at most 2 % left."""
        return self.is_about_families() and self.bracket.upper - self.bracket.lower <= NEARLY * abs(self.bracket.upper)

    # -- the stages ----------------------------------------------------------------------------------------------

    def blind_everyone(self) -> Stop:
        """Nobody sees anything."""
        self._accept((frozenset(),))
        self.bracket.lower = self.bracket.upper
        return Stop.CLOSED

    def exchange(self) -> None:
        """The weakest families that exchanges find, of each vector or of some."""
        self.families = self.weak.exchanged(self.vectors if self.has_all_vectors else self._some_vectors())
        self._accept(weakest_of(self.families))
        self._is_about_families = self._are_alike(self.families)

    def families_without_vectors(self) -> Stop:
        """Annealed attacks, dives and dual prices of families, without vectors."""
        return FamilySearch(self.task, self.team, self.families, self._priced_vectors()).run()

    def narrow_families(self) -> None:
        """Annealed attacks, dives and dual prices of the vectors that are open, as long as they prove something."""
        FamilySearch(self.task, self.team, self.families, list(self.bounds)).narrow()

    def _are_alike(self, families: list[GroupExchanges]) -> bool:
        """Whether an attack leaves groups that are about alike, and a limit of time is to be shared."""
        budget = self.task.budget
        if self._given is not None or budget.max_nodes is not None or not np.isfinite(budget.seconds_left):
            return False
        second, best = sorted([0.0, *map(self.team.value, weakest_of(families))])[-2:]
        return second >= ALIKE * best

    def _priced_vectors(self) -> list[Sizes] | None:
        """All vectors, or ``None`` where they are too many for prices to know them."""
        n_robots, part, vectors = len(self.team.single), self.task.budget.part(PRICED_SHARE), list(self.vectors)
        every = self._given or iterate_non_dominated_sizes(n_robots, self.threat.n_blinded, self.threat.alpha_c)
        for sizes in islice(every, len(vectors), None) if n_robots <= LARGEST else ():
            if len(vectors) >= PRICED_SIZES // n_robots or part.is_over:
                return None
            vectors.append(sizes)
        return vectors if n_robots <= LARGEST else None

    def _some_vectors(self) -> list[Sizes]:
        """A few vectors of each size of the largest group, the smallest sizes first."""
        n_robots, budgets = len(self.team.single), (self.threat.n_blinded, self.threat.alpha_c)
        vectors: list[Sizes] = []
        for first in range(forced_group_size(n_robots, *budgets), n_robots - budgets[0] + 1):
            vectors.extend(islice(sizes_of_largest(n_robots, *budgets, first), OF_EACH_SIZE))
            if len(vectors) >= SOME_VECTORS:
                break
        return vectors

    def list_least(self) -> None:
        """The least sets that decide, if they are listed in no time, and families around the weakest of them.

        They often decide. Like exchanges, this costs no nodes.
        """
        smallest = min(sizes[0] for sizes in self.vectors)
        if not self._may_be_short(smallest) or not (families := self.weak.deciding(self.vectors, smallest)):
            return
        self._accept(weakest_of(families))
        low = self.lists.at_once(smallest, self.bracket.goal, self.task.budget.part())
        if low is None:
            return
        self.weak.start_from(families, map(self.lists.robots, low.masks.tolist()))
        self._accept(weakest_of(families))
        self.bracket.raise_lower(float(low.values.min(initial=self.bracket.goal)))

    def _accept(self, groups: Iterable[frozenset[int]]) -> bool:
        outcome = tuple(sorted(groups, key=lambda group: min(group, default=0)))
        return self.task.offer(Attack(*realise(self.threat, outcome)))

    # -- vectors whose sets can be listed ----------------------------------------------------------------------

    def decide_listed(self) -> None:
        """Decide the families of every vector, as far as its sets can be listed."""
        if len(self.team.single) > MOST_ROBOTS:
            return
        families, lists = self.families, self.lists
        must = sum(1 << k for k, robot in enumerate(lists.order.tolist()) if robot in self.threat.protected_robots)
        searches = {
            sizes: VectorSearch(lists, sizes, n_blinded=self.threat.n_blinded, must=must, threshold=self.bracket.goal)
            for sizes in dict.fromkeys([*(family.sizes for family in families), *self.vectors])
            if self._is_listed(sizes[0])
        }
        self._bound_all(lists, min(sizes[0] for sizes in self.vectors))
        for sizes, search in searches.items():
            if sizes not in self.bounds:
                break
            with self._noting(sizes, search):
                search.bound(self.task.budget)
        for family in families:
            if family.sizes in searches and family.sizes in self.bounds:
                self.task.budget.spend()
                family.shake(LATER_SHAKES, self.task.budget)
                if family.value < self.bracket.goal:
                    self._accept(family.groups())
        order = [family.sizes for family in sorted(families, key=attrgetter("value"))]
        for sizes in dict.fromkeys([*order, *searches]):
            if sizes not in searches or sizes not in self.bounds:
                continue
            with self._noting(sizes, searches[sizes]) as search:
                search.threshold = self.bracket.goal
                for groups in search.run(self.task.budget):
                    self._accept(groups)
                    search.threshold = min(search.threshold, self.bracket.goal)

    def _bound_all(self, lists: LowLists, smallest: int) -> None:
        """Every family has a group that holds a set of the smallest size that a largest group may have."""
        low = lists.of(smallest, self.bracket.goal, self.task.budget) if self._is_listed(smallest) else None
        if low is not None:
            weakest = float(low.values.min(initial=self.bracket.goal))
            self.bounds = {sizes: max(bound, weakest) for sizes, bound in self.bounds.items()}
            self._raise_lower()
            if weakest >= self.bracket.goal:
                self.bounds.clear()

    @contextmanager
    def _noting(self, sizes: Sizes, search: VectorSearch) -> Iterator[VectorSearch]:
        """Whatever happens, what the search has proved counts."""
        try:
            yield search
        finally:
            self.bounds[sizes] = max(self.bounds[sizes], search.lower)
            self._raise_lower()
            if self.bounds[sizes] >= self.bracket.goal:
                del self.bounds[sizes]

    def _may_be_short(self, size: int) -> bool:
        n_robots = len(self.team.single)
        return n_robots <= MOST_ROBOTS and comb(n_robots, size) <= MAYBE_SHORT

    def _is_listed(self, largest: int) -> bool:
        n_robots = len(self.team.single)
        return n_robots <= LISTED_WHOLE or comb(n_robots, largest) <= LONGEST_LIST

    def _raise_lower(self) -> None:
        self.bracket.raise_lower(min([self.bracket.goal, *self.bounds.values()]))

    def decide_by_largest(self) -> Stop:
        """The vectors that are open, by their largest group."""
        self.vectors = list(self.bounds)
        return self._by_largest.run(self.vectors, self.task.budget)


STAGES: tuple[Stage[SizeVectorSearch], ...] = (
    Stage("nobody left", SizeVectorSearch.blind_everyone, SizeVectorSearch.blinds_everyone),
    Stage("least sets", SizeVectorSearch.list_least, SizeVectorSearch.has_few_vectors),
    Stage("exchanges of families", SizeVectorSearch.exchange),
    Stage("families", SizeVectorSearch.families_without_vectors, SizeVectorSearch.has_many_vectors),
    Stage("listed sets", SizeVectorSearch.decide_listed, SizeVectorSearch.lists_in_share, LISTED_SHARE),
    Stage("listed sets", SizeVectorSearch.decide_listed, SizeVectorSearch.lists_at_once),
    Stage("largest group", SizeVectorSearch.decide_by_largest, SizeVectorSearch.is_about_families, LARGEST_SHARE[0]),
    Stage("largest group", SizeVectorSearch.decide_by_largest, SizeVectorSearch.is_nearly_closed, LARGEST_SHARE[1]),
    Stage("families", SizeVectorSearch.narrow_families, SizeVectorSearch.is_about_families),
    Stage("listed sets", SizeVectorSearch.decide_listed, SizeVectorSearch.lists_in_share),
    Stage("largest group", SizeVectorSearch.decide_by_largest, SizeVectorSearch.has_few_vectors),
)
"""Of an attack on a complete graph, by vectors of sizes."""
