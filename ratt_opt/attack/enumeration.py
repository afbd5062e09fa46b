"""Enumeration of every attack on a plan: if links and cuts are few, the quickest exact way.

Under a criterion, attacks are valued in batches. How many are few follows from the time that is left: what a batch
and a partition take is measured first.
"""

from __future__ import annotations

from functools import cached_property
from itertools import chain, combinations, islice
from math import comb
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.budget import Stop
from ratt_opt.graph.few_cuts import partitions_by_few_cuts
from ratt_opt.problem import Attack
from ratt_opt.setfunctions.metered import unmetered

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.attack.task import AttackTask
    from ratt_opt.budget import Budget
    from ratt_opt.graph.threat import Threat

__all__ = ["CriterionEnumeration", "enumerate_by_values"]


class CriterionEnumeration:
    """Enumeration of every attack that uses the whole budgets; relies on a non-decreasing objective."""

    def __init__(self, task: AttackTask) -> None:
        self._task, self._threat = task, task.problem.threat
        self._objective = task.problem.information_objective
        information = self._objective.information[task.values.plan]
        self._rows: FloatArray = np.ascontiguousarray(information.reshape(len(information), -1))
        self._free = sorted(set(range(len(information))) - self._threat.protected_robots)

    @cached_property
    def seconds(self) -> float:
        """Estimated seconds of trying all: every partition, and for each the largest group under all blinded sets.

        Most attacks leave more than the one in hand already there; the other groups are valued for the rest.
        """
        threat = self._threat
        cuts = comb(len(threat.graph.links) - len(threat.protected_links), threat.n_cut)
        blinded = comb(len(self._free), threat.n_blinded)
        began = perf_counter()
        threat.graph.groups(tuple(islice(sorted(threat.graph.links), threat.n_cut)))
        partition = perf_counter() - began
        rows = min(blinded, self._task.params.every_attack.batch)
        blind, value = np.zeros((rows, len(self._rows)), dtype=np.bool_), np.inf
        for _ in range(2):  # the first call is slower
            began = perf_counter()
            self._values(tuple(range(len(self._rows))), blind)
            value = min(value, (perf_counter() - began) / rows)
        return float(cuts * (partition + blinded * value))

    def is_soon(self, budget: Budget) -> bool:
        """Tell whether all attacks can be enumerated in a share of the remaining time."""
        left = budget.seconds_left
        most = self._task.params.every_attack.seconds if np.isinf(left) else self._task.params.every_attack.share * left
        return not _are_many(self._threat, len(self._free)) and self.seconds <= most

    def run(self, budget: Budget) -> Stop:
        """Find the worst attack of a plan.

        Raises
        ------
        OutOfBudget : the time is up, or no node is left; the bracket keeps the worst attack tried.
        """
        bracket = self._task.bracket
        for cut, groups in partitions_by_few_cuts(self._threat, budget):
            ordered = [tuple(sorted(group)) for group in sorted(groups, key=len, reverse=True)]
            for blinded in self._batches():
                budget.check()
                worst = self._worst(ordered, blinded, bracket.upper)
                if worst is not None:  # valued anew: the bracket holds what an attack leaves if it is valued alone
                    self._task.offer(Attack(frozenset(blinded[worst].tolist()), cut))
        bracket.raise_lower(bracket.upper)
        return Stop.CLOSED

    def _batches(self) -> Iterator[IntArray]:
        """(K, n_blinded) the sets of robots that may be blinded, some at a time."""
        every = combinations(self._free, self._threat.n_blinded)
        while some := list(islice(every, self._task.params.every_attack.batch)):
            yield np.array(some, dtype=np.int64).reshape(len(some), self._threat.n_blinded)

    def _worst(self, groups: list[tuple[int, ...]], blinded: IntArray, upper: float) -> int | None:
        """The blinded set that leaves least, if that is less than the attack in hand."""
        blind = np.zeros((len(blinded), len(self._rows)), dtype=np.bool_)
        blind[np.arange(len(blinded))[:, None], blinded] = True
        left, most = np.arange(len(blinded)), np.full(len(blinded), -np.inf)
        for group in groups:
            most[left] = np.maximum(most[left], self._values(group, blind[left]))
            left = left[most[left] < upper]
            if not len(left):
                return None
        return int(left[most[left].argmin()])

    def _values(self, group: tuple[int, ...], blind: BoolArray) -> FloatArray:
        """(K,) values of a group with some robots blinded. Sums, no differences: no digit is lost."""
        members = list(group)
        sums = (~blind[:, members]).astype(np.float64) @ self._rows[members]
        prior = self._objective.prior_information
        return self._objective.value(prior + sums.reshape(len(blind), *prior.shape))


def _are_many(threat: Threat, n_free: int) -> bool:
    """Tell whether there are too many attacks to enumerate on any machine."""
    cuts = comb(len(threat.graph.links) - len(threat.protected_links), threat.n_cut)
    return cuts * comb(n_free, threat.n_blinded) > 10**12


def enumerate_by_values(task: AttackTask) -> Stop:
    """Find the worst attack of a plan by trying all.

    If links can be cut it relies on a non-decreasing objective: then some worst attack uses its whole budgets.
    Otherwise all smaller sets of robots are blinded too. A robot blinded in one group leaves the others as they are, so
    each set of robots is valued once; many are valued in one batch.

    Raises
    ------
    OutOfBudget : the time is up, or no node is left; the bracket keeps the worst attack tried.
    """
    threat, worth = task.problem.threat, dict[frozenset[int], float]()
    f, plan = unmetered(task.problem.objective), task.values.plan
    free = sorted(set(range(task.problem.n_robots)) - threat.protected_robots)
    sizes = [threat.n_blinded] if threat.n_cut else range(threat.n_blinded, -1, -1)
    if threat.n_cut == 0 and len(task.problem.communication.groups()) == 1:
        return _enumerate_blinded(task, free, sizes)
    for cut, groups in partitions_by_few_cuts(threat, task.budget):
        blinded = chain.from_iterable(combinations(free, size) for size in sizes)
        while some := list(map(frozenset, islice(blinded, task.params.branching.at_once))):
            task.budget.check()
            left = [[group - blind for group in groups] for blind in some]
            new = list({group: None for parts in left for group in parts if group not in worth})
            worth.update(zip(new, task.values.values_of(new).tolist(), strict=True))
            for blind, parts in zip(some, left, strict=True):
                if max(worth[group] for group in parts) < task.bracket.upper:
                    task.budget.evaluate(len(parts))  # valued alone: batches may round otherwise
                    task.bracket.offer(Attack(blind, cut), max(f(plan[sorted(group)]) for group in parts))
    task.bracket.raise_lower(task.bracket.upper)
    return Stop.CLOSED


def _enumerate_blinded(task: AttackTask, free: list[int], sizes: Iterable[int]) -> Stop:
    """Find the worst attack if no link is cut: the team stays one group, valued in batches of its sets of robots."""
    f, plan, n = unmetered(task.problem.objective), task.values.plan, task.values.n
    for size in sizes:
        blinded = combinations(free, size)
        while some := list(islice(blinded, task.params.branching.at_once)):
            task.budget.check()
            sees = np.ones((len(some), n), dtype=np.bool_)
            sees[np.arange(len(some))[:, None], np.array(some, dtype=np.int64).reshape(len(some), size)] = False
            values = task.values.evaluate(sees)
            worst = int(values.argmin())
            if values[worst] < task.bracket.upper:
                task.budget.evaluate(1)  # valued alone: batches may round otherwise
                task.bracket.offer(Attack(frozenset(some[worst]), frozenset()), f(plan[sees[worst]].tolist()))
    task.bracket.raise_lower(task.bracket.upper)
    return Stop.CLOSED
