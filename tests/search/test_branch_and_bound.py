"""The loop against all solutions: least sums of one number of each list, with limits and interrupts at any moment."""

from itertools import product
from typing import NamedTuple

import numpy as np
import pytest

from ratt_opt import Stop
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.search.branch_and_bound import divide_nodes
from ratt_opt.search.open_nodes import OpenNodes


class Prefix(NamedTuple):
    """The first numbers that are chosen; a sum is at least theirs and the least of each list that is left."""

    bound: float
    serial: int
    chosen: tuple[float, ...]


class LeastSum:
    """The least sum that is not below a floor: a choice of one number of each list."""

    def __init__(self, lists, floor, most, stops):
        self.lists, self.floor, self.stops, self.best, self.serial = lists, floor, stops, np.inf, 0
        self.nodes, self.budget, self.bounds = OpenNodes([self._node(())], most), Budget(), []

    def _node(self, chosen):
        self.serial += 1
        return Prefix(sum(chosen) + sum(min(own) for own in self.lists[len(chosen) :]), self.serial, chosen)

    def stop(self):
        return Stop.CLOSED if self.nodes.bound >= self.best else self.budget.stop()

    def bound(self, node):
        self.budget.spend()
        if self.stops():
            raise OutOfBudget(Stop.TIME)
        if len(node.chosen) < len(self.lists):
            return node if node.bound < self.best else None
        if node.bound >= self.floor:
            self.best = min(self.best, node.bound)
        return None

    def branch(self, node):
        for number in self.lists[len(node.chosen)]:
            if self.stops():
                raise KeyboardInterrupt
            yield self._node((*node.chosen, number))

    def trace(self):
        self.bounds.append(min(self.best, self.nodes.bound))


@pytest.mark.parametrize("most", [0, 2, np.inf])
@pytest.mark.parametrize("share", [0.0, 0.1])
def test_the_loop_finds_the_least_solution_and_its_bounds_hold_whatever_ends_it(most, share):
    for seed in range(60):
        rng = np.random.default_rng([seed, 66])
        lists = [rng.integers(0, 9, int(rng.integers(1, 4))).astype(float).tolist() for _ in range(4)]
        sums = [sum(chosen) for chosen in product(*lists)]
        floor = rng.choice(sums)
        search, ends = LeastSum(lists, floor, most, lambda rng=rng: rng.random() < share), []
        while not ends:
            search.budget.max_nodes = search.budget.nodes + 5
            try:
                stop = divide_nodes(search.nodes, search, search.trace)
                ends = [] if stop is Stop.NODES else [stop]
            except (OutOfBudget, KeyboardInterrupt):
                assert search.nodes.in_hand is not None
        assert search.best == floor
        assert ends == [Stop.CLOSED]
        assert all(bound <= floor for bound in search.bounds)
