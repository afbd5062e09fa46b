"""The search for the least weight of links whose cut leaves groups of at most a size.

From above, annealed partitions and an integer program over known groups; from below, prices that exact pricing proves.
Sparse networks are decided by :mod:`ratt_opt.attack.edge_cuts.elimination`, large ones before prices are asked.
If ends do not meet, a better partition uses only groups whose slack is within the gap: these are listed
(:mod:`ratt_opt.attack.edge_cuts.listed`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.edge_cuts.elimination import Elimination, TooManyStates
from ratt_opt.attack.edge_cuts.kept_links import groups_above, some_groups_above
from ratt_opt.attack.edge_cuts.listed import partition_that_keeps
from ratt_opt.attack.edge_cuts.program import KeptProgram
from ratt_opt.budget import Budget, OutOfBudget, Stop
from ratt_opt.graph.largest_group.annealed_cut import Cooling, PricedArcs

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.attack.edge_cuts.network import CutNetwork

__all__ = ["CutSearch", "SearchParams"]


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchParams:
    """Work of the parts of a search; each trades time against what the next part has to do.

    ``coolings`` : annealed partitions; ``moves`` : of each, per node; ``spare`` : groups more in each, of the fewest
    ``first_nodes`` : of a pricing, four times as many after one that found nothing
    ``smooth`` : how near to the best proved prices the next ones are asked, in [0, 1)
    ``integer_nodes`` : of HiGHS's integer program over known groups
    ``most_listed`` : groups within the gap
    ``priced_first`` : nodes of networks whose prices are asked before elimination: a certificate is made of prices
    """

    coolings: int = 6
    spare: float = 0.4
    moves: int = 6_000
    first_nodes: int = 2_000
    smooth: float = 0.5
    integer_nodes: int = 300
    most_listed: int = 300_000
    priced_first: int = 200


class CutSearch:
    """``label`` (n,) cuts ``upper``; no cut costs less than ``lower``, by ``prices`` (n,) if these are given.

    ``target`` : the search ends as soon as ``upper`` is at most, or ``lower`` above, this; unlimited by default
    ``label`` : a partition to begin with, each node by itself by default
    ``proved_by`` : what raised ``lower`` last
    """

    def __init__(
        self,
        network: CutNetwork,
        size: int,
        budget: Budget,
        *,
        target: int | None = None,
        label: IntArray | None = None,
        params: SearchParams | None = None,
    ) -> None:
        self.network, self.size, self.budget, self.target = network, size, budget, target
        self.params = params or SearchParams()
        self.label = np.arange(network.n_nodes) if label is None else label
        self.upper, self.lower = network.cut_of(self.label), 0
        self.prices: IntArray | None = None
        self.reason, self.limit, self.proved_by = "no cut costs less than nothing", "", "nothing"
        self._program = KeptProgram(network)

    @property
    def is_settled(self) -> bool:
        """Tell whether the bounds meet, or the target is decided."""
        on_target = self.target is not None and (self.upper <= self.target or self.lower > self.target)
        return self.lower >= self.upper or on_target

    def run(self) -> Stop:
        """Go through the parts until the ends meet or the budget is spent."""
        by_prices = self.raise_prices, self._choose_known
        eliminated = () if self.target is not None else (self._eliminate,)
        is_large = self.network.n_nodes > self.params.priced_first
        undecided = (*eliminated, *by_prices) if is_large else (*by_prices, *eliminated)
        parts = self._everything_fits, self._anneal, *undecided, self._list
        try:
            for part in parts:
                if self.is_settled:
                    break
                part()
        except OutOfBudget as spent:
            return spent.stop
        return Stop.CLOSED if self.is_settled else Stop.NODES

    def _everything_fits(self) -> None:
        if self.network.size.sum() <= self.size:
            self._offer(np.zeros(self.network.n_nodes, dtype=np.int64))

    def _offer(self, label: IntArray) -> bool:
        """Take a partition if it is better and within the size."""
        loads = np.bincount(label, self.network.size, minlength=1)
        cut = self.network.cut_of(label)
        if loads.max() > self.size or cut >= self.upper:
            return False
        self.upper, self.label = cut, label
        return True

    def _anneal(self) -> None:
        network, n = self.network, self.network.n_nodes
        arcs, rng = PricedArcs.weighted(network.ends, network.weight, n), np.random.default_rng(self.size)
        fewest = -(-int(network.size.sum()) // self.size)
        unit = float(network.weight.mean())
        for k in range(self.params.coolings):
            count = min(round(fewest * (1 + k * self.params.spare)), n)
            cooling = Cooling(arcs, network.size, rng.integers(0, count, n), count, self.size, rng, unit=unit)
            moves, at_once = self.params.moves * n, 20_000
            for first in range(0, moves, at_once):
                self.budget.nodes_left(1)
                cooling.run(
                    first, min(first + at_once, moves), moves, network.total + 1 if not first else cooling.fewest
                )
            if cooling.fewest <= network.total:
                _, label = np.unique(cooling.best, return_inverse=True)
                self._offer(label)
                self._program.add(label == np.arange(label.max() + 1)[:, None])
            if self.is_settled:
                return

    def _eliminate(self) -> None:
        """Decide by elimination whether less is cut, if bags are small and states few."""
        elimination, goal = Elimination(self.network), self.upper - 1
        try:
            label = elimination.least_cut(self.size, goal, self.budget)
        except TooManyStates as limit:
            self.limit = str(limit)
            return
        if label is not None:
            self._offer(label)
            goal = self.upper - 1
        self.lower = goal + 1
        self.reason, self.proved_by = elimination.reason, "elimination"

    def raise_prices(self) -> None:
        """Generate columns: prices between the best proved ones and the program's, until these meet.

        Raises
        ------
        OutOfBudget : the budget is spent; ``prices`` are the best ones proved.
        """
        network, unit = self.network, self.network.unit
        best: FloatArray | None = None
        smooth, nodes = self.params.smooth, self.params.first_nodes
        self._program.add(self.label == np.unique(self.label)[:, None])
        while (prices := self._program.prices(self.budget.seconds_left)) is not None and not self.is_settled:
            least = float(prices.sum())
            asked = prices if best is None else smooth * best + (1 - smooth) * prices
            whole = self._rounded_up(asked)
            found = some_groups_above(network, whole, self.size, self.budget, nodes)
            fresh = self._program.add(self._above(found.groups, prices))
            if found.is_complete and not len(found.groups):
                is_better = best is None or whole.sum() < best.sum() * unit
                best = whole / unit if is_better else best
                self._prove(whole)
                assert best is not None
                done = network.total - np.floor(least + 1e-6) <= self.lower
                if done or float(best.sum()) - least < 1e-4 * max(1.0, least):
                    return
                smooth = smooth if is_better else 0.5 * smooth
            elif not fresh:
                nodes *= 1 if len(found.groups) and smooth > 0 else 4
                if smooth == 0.0 and found.is_complete:
                    return  # by HiGHS's tolerance
                # If no column found is violated at the program's own prices, separate nearer to them.
                smooth = 0.0 if smooth < 0.02 else 0.5 * smooth

    def _rounded_up(self, prices: FloatArray) -> IntArray:
        """Prices in units, a little higher as long as their sum proves the same: that is easier to prove."""
        unit = self.network.unit
        whole = np.ceil(prices * unit).astype(np.int64)
        spare = (unit - 1 - int(whole.sum()) % unit) // len(whole)
        return np.asarray(whole + spare)

    def _above(self, groups: BoolArray, prices: FloatArray) -> BoolArray:
        """The groups that hold more than these prices."""
        return groups[self.network.kept(groups) - groups @ prices > 1e-7]

    def _prove(self, prices: IntArray) -> None:
        """Raise the lower bound: if every group keeps at most its prices, a partition keeps at most their sum."""
        lower = self.network.total - int(prices.sum()) // self.network.unit
        if lower > self.lower or self.prices is None:
            self.lower, self.prices = max(lower, 0), prices
            self.reason = "prices of robots: every group that fits keeps at most its prices"
            self.proved_by = "prices"

    def _choose_known(self) -> None:
        label = self._program.labels(self.params.integer_nodes, self.budget.seconds_left)
        self.budget.check()
        if label is not None:
            self._offer(label)

    def _list(self) -> None:
        """List the groups that a better partition may use, and look for it among these."""
        while not self.is_settled and self.prices is not None:
            goal = self.upper - 1 if self.target is None else min(self.target, self.upper - 1)
            room = int(self.prices.sum()) - self.network.unit * (self.network.total - goal)
            most = self.params.most_listed
            found = groups_above(self.network, self.prices, self.size, -room - 1, most, self.budget)
            if not found.is_complete:
                self.limit = f"more than {most:,} groups are within the gap that prices leave: too many to list"
                return
            need = self.network.total - goal
            label = partition_that_keeps(self.network, found.groups, self.prices, need, self.budget).label
            if label is None:
                self.lower = goal + 1
                self.reason = f"no partition into the {len(found.groups):,} groups that prices leave cuts less"
                self.proved_by = "listed groups"
            elif not self._offer(label):
                raise AssertionError("a partition that holds more cuts less")
