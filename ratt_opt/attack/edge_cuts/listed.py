"""Partitions into listed groups that keep enough: prices of robots and of triples, then exact covers.

If a partition keeps ``need``, the slacks ``q(S) - kept(S)`` of its groups add up to at most ``q(V) - need``: only
groups with so little slack can be in it. They are listed. Of three robots, at most one group holds two or more. Triples
get prices too, which close much of the gap that prices of robots leave:

    q(S) + sum of t over triples of which S holds two or more  >=  kept(S)   for every listed S
    ==>  a partition into listed groups keeps at most  sum of q + sum of t,

checked in integers. What is left are a few hundred groups, whose exact covers are searched.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.edge_cuts.program import chosen_labels
from ratt_opt.attack.thresholds.exact_cover import ExactCover, packed
from ratt_opt.highs import LinearProgram, rows_of

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.attack.edge_cuts.network import CutNetwork
    from ratt_opt.budget import Budget

__all__ = ["Level", "ListedAnswer", "partition_that_keeps"]

Triple = tuple[int, int, int]


@dataclass(frozen=True, slots=True, eq=False)
class Level:
    """``prices`` (n,) of robots and of ``triples``, in units, that hold for the groups which earlier levels leave."""

    prices: IntArray
    triples: tuple[tuple[Triple, int], ...]


@dataclass(frozen=True, slots=True, eq=False)
class ListedAnswer:
    """``label`` (n,) of a partition that keeps enough; or ``None``, and the ``levels`` that rule groups out."""

    label: IntArray | None
    levels: tuple[Level, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class TripleParams:
    """``few`` : groups whose covers are searched; ``at_once`` : triples added to a program; ``violation`` : least.

    More triples make fewer rounds of larger programs.
    """

    few: int = 300
    at_once: int = 60
    violation: float = 1e-4


PARAMS = TripleParams()


@dataclass(frozen=True, slots=True, eq=False)
class _Left:
    """``groups`` (k, n) that may be chosen, their ``slack`` (k,) in units, and the ``room`` for the sum of these."""

    groups: BoolArray
    slack: IntArray
    room: int


def partition_that_keeps(
    network: CutNetwork, groups: BoolArray, prices: IntArray, need: int, budget: Budget
) -> ListedAnswer:
    """Look for a partition into some of ``groups`` (k, n) that holds at least ``need``.

    ``prices`` : (n,) in units, at least what each group keeps

    Raises
    ------
    OutOfBudget : the time is up, or the user interrupted.
    """
    kept = network.kept(groups) * network.unit
    room = int(prices.sum()) - need * network.unit
    left, triples = _Left(groups, groups @ prices - kept, room), list[Triple]()
    levels = [Level(prices, ())]
    while len(left.groups) > PARAMS.few and left.room >= 0:
        budget.check()
        program = _TripleProgram(network, left.groups, triples)
        shares = program.solve(budget.seconds_left)
        if shares is None:
            break  # HiGHS has nothing to say; what is known stays true
        before, left = left, _fewer(left, program, need)
        if left.room < before.room or len(left.groups) < len(before.groups):
            levels.append(program.level())
        fresh = [t for t in _violated(program.groups, shares) if t not in set(triples)][: PARAMS.at_once]
        if not fresh:
            break
        triples += fresh
    return ListedAnswer(_cover(network, left, need, budget), tuple(levels))


class _TripleProgram:
    """Prices of robots and triples over some groups, as integers once it is solved."""

    def __init__(self, network: CutNetwork, groups: BoolArray, triples: list[Triple]) -> None:
        self._unit, self.groups, self._triples = network.unit, groups, tuple(triples)
        held = [groups[:, list(triple)].sum(axis=1) >= 2 for triple in triples]
        self._paid = np.hstack([groups, np.array(held, dtype=np.bool_).reshape(len(triples), len(groups)).T])
        self.kept = network.kept(groups)
        self.prices = np.zeros(self._paid.shape[1], np.int64)

    def solve(self, seconds: float) -> FloatArray | None:
        """(k,) the share of each group in HiGHS's solution; ``None`` if it has none."""
        entries = [(np.flatnonzero(row).tolist(), [1.0] * int(row.sum())) for row in self._paid]
        program = LinearProgram(np.ones(self._paid.shape[1]), rows=rows_of(entries, self.kept.astype(np.float64)))
        claimed = program.solve(seconds, is_long=True)
        if len(claimed.x) != self._paid.shape[1] or len(claimed.duals) != len(self.groups):
            return None
        self.prices = np.ceil(np.maximum(claimed.x, 0.0) * self._unit).astype(np.int64)
        for row in np.flatnonzero(self.slack() < 0):  # by HiGHS's tolerance
            self.prices[self._paid[row].argmax()] += max(-int(self.slack()[row]), 0)
        return np.abs(claimed.duals)

    def level(self) -> Level:
        """The prices as a level of a proof."""
        n = len(self.prices) - len(self._triples)
        priced = zip(self._triples, self.prices[n:].tolist(), strict=True)
        return Level(self.prices[:n].copy(), tuple((triple, price) for triple, price in priced if price))

    def slack(self) -> IntArray:
        """(k,) what the prices of each group are above what it keeps, in units."""
        return np.asarray(self._paid @ self.prices - self.kept * self._unit)


def _fewer(left: _Left, program: _TripleProgram, need: int) -> _Left:
    """The groups that may still be chosen, by the prices that leave less room."""
    room, slack = int(program.prices.sum()) - need * program._unit, program.slack()
    fits = (slack <= room) if room < left.room else (left.slack <= left.room) & (slack <= room)
    own, most = (slack, room) if room < left.room else (left.slack, left.room)
    return _Left(left.groups[fits], own[fits], most)


def _violated(groups: BoolArray, shares: FloatArray) -> list[Triple]:
    """Triples of which groups hold two or more by a sum of shares above 1, the most violated first."""
    used = shares > 1e-7
    held, share = groups[used].astype(np.float64), shares[used]
    pair = held.T @ (share[:, None] * held)
    np.fill_diagonal(pair, 0.0)
    found = []
    for i in range(len(pair)):
        near = np.flatnonzero((pair[i] > 1e-6) & (pair[i] < 1 - 1e-6))
        near = near[near > i]
        three = (held[:, near] * (share * held[:, i])[:, None]).T @ held[:, near]
        total = pair[i, near][:, None] + pair[i, near] + pair[np.ix_(near, near)] - 2 * three
        for a, b in np.argwhere(np.triu(total > 1 + PARAMS.violation, 1)):
            found.append((-float(total[a, b]), (i, int(near[a]), int(near[b]))))
    return [triple for _, triple in sorted(found)]


def _cover(network: CutNetwork, left: _Left, need: int, budget: Budget) -> IntArray | None:
    """Labels of a cover by groups within the room that keeps enough, if there is one."""
    if left.room < 0 or not len(left.groups):
        return None
    order = np.argsort(left.slack, kind="stable")
    groups, costs = left.groups[order], np.zeros((len(order), 3), np.int64)
    costs[:, 0] = left.slack[order]
    covers = ExactCover(network.n_nodes, packed(groups), costs, (left.room, 0, 0))
    while chosen := covers.found(budget):
        label = chosen_labels(groups[chosen])
        if label is not None and network.total - network.cut_of(label) >= need:
            return label
    return None
