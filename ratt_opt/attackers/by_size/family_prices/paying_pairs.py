"""Sets of one size that are weak and pay more than a limit, by bounds on pairs of robots: ruled out, or found.

A depth-first search in compiled code. A node has some robots inside its sets and some outside. Sets that are worth less
than the threshold and pay more than the limit have

    value(S) - multiplier (price(S) - limit) < threshold

whatever the multiplier >= 0, so a node is closed where a bound on the left side (``pair_bound.py``) reaches the
threshold. Robots with which the bound reaches it leave, those without which it does join, and a node is divided by the
robot that lowers it most: 40 instead of 2,200 nodes where the least clear robot is taken (60 robots, sets of 12).

Imported only where a large team is attacked: compiling takes seconds, once per machine (cached).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ratt_opt.attackers.weakest_set.pair_bound import fill_pairs, mean_of_least, worth
from ratt_opt.running.compiling import numba

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attackers.weakest_set.pair_bound import View

    Decided = tuple[IntArray, IntArray]

__all__ = ["FINISHED", "FOUND", "PAUSED", "PairNodes", "Question", "search_pairs", "slack_of_pairs"]

OPEN, INSIDE, OUTSIDE = 0, 1, 2
FINISHED, PAUSED, FOUND = 0, 1, 2
STEPS, FACTOR = 5, 1.4
"""Multipliers tried at a node, and how far apart the first ones are."""


class Question(NamedTuple):
    """Is there a set worth less than ``threshold`` whose ``prices`` (N,) add up to more than ``limit``?"""

    threshold: float
    prices: FloatArray
    limit: float


class PairNodes(NamedTuple):
    """Open nodes, one at each depth: ``side`` (D, N) of each robot, ``sums`` (D, M, 3) of those inside, what these
    have ``paid`` (D,), how many are ``left`` (D,) to choose, the ``multiplier`` (D,) that closes most; ``position``
    (2,) : depth, below 0 at the end, and nodes looked at.
    """

    side: Any
    sums: Any
    paid: Any
    left: Any
    multiplier: Any
    position: Any

    @classmethod
    def of(cls, view: View, question: Question, size: int, decided: Decided, multiplier: float) -> PairNodes:
        """The root, with ``size`` robots to choose beside those ``decided``: some inside, some outside.

        ``multiplier`` : to begin with
        """
        inside, outside = decided
        depth, n_robots = size + 2, len(view.information)
        nodes = cls(
            side=np.zeros((depth, n_robots), dtype=np.int8),
            sums=np.zeros((depth, *view.prior.shape)),
            paid=np.zeros(depth),
            left=np.zeros(depth, dtype=np.int64),
            multiplier=np.full(depth, multiplier),
            position=np.zeros(2, dtype=np.int64),
        )
        nodes.side[0, inside], nodes.side[0, outside] = INSIDE, OUTSIDE
        nodes.sums[0] = view.prior + view.information[inside].sum(axis=0)
        nodes.paid[0], nodes.left[0] = question.prices[inside].sum(), size
        return nodes


class _Work(NamedTuple):
    """Arrays of a node: open ``robots`` (N,), values of ``pairs`` (N, N), ``least`` (2, N), ``prices`` (N,)."""

    robots: Any
    pairs: Any
    least: Any
    prices: Any


@numba.njit(cache=True)
def _fill_open(view: Any, question: Any, nodes: Any, work: Any) -> int:
    """List the open robots of the last node; those that reach the threshold with the ones inside are closed."""
    node, count, one = nodes.position[0], 0, np.empty_like(nodes.sums[0])
    side, sums = nodes.side[node], nodes.sums[node]
    for i in range(len(side)):
        if side[i] != OPEN:
            continue
        for j in range(len(one)):
            for t in range(3):
                one[j, t] = sums[j, t] + view.information[i, j, t]
        if worth(view, one) >= question.threshold:
            side[i] = OUTSIDE
        else:
            work.robots[count] = i
            count += 1
    return count


@numba.njit(cache=True)
def _most_paid(question: Any, nodes: Any, work: Any, count: int) -> float:
    """What the sets of the last node pay at most."""
    node = nodes.position[0]
    left = nodes.left[node]
    prices = np.sort(question.prices[work.robots[:count]])
    return float(nodes.paid[node] + prices[count - left :].sum())


@numba.njit(cache=True)
def _find_last(question: Any, nodes: Any, work: Any, count: int, members: Any) -> bool:
    """Whether one robot, or two (their values are ``work.pairs``), make a set that pays; ``members`` is the last."""
    node = nodes.position[0]
    left, paid, found = nodes.left[node], nodes.paid[node], False
    for x in range(count):
        i = work.robots[x]
        for y in range(x if left == 2 else 1):
            k = work.robots[y] if left == 2 else i
            price = paid + question.prices[i] + (question.prices[k] if left == 2 else 0.0)
            if price > question.limit and (left == 1 or work.pairs[x, y] < question.threshold):
                members[:] = nodes.side[node] == INSIDE
                members[i] = members[k] = found = True
    return found


@numba.njit(cache=True)
def _slack(question: Any, nodes: Any, work: Any, count: int, multiplier: float, least: Any) -> float:  # noqa: PLR0917
    """By how much the bound exceeds the threshold with this multiplier."""
    node = nodes.position[0]
    for x in range(count):
        work.prices[x] = multiplier * question.prices[work.robots[x]]
    bound = mean_of_least(work.pairs, work.prices, count, nodes.left[node], least)
    return float(bound - multiplier * (nodes.paid[node] - question.limit) - question.threshold)


@numba.njit(cache=True)
def _best_slack(question: Any, nodes: Any, work: Any, count: int) -> float:
    """The same with the best multiplier of a few tried, which the node keeps; the bound is concave in it."""
    node, factor = nodes.position[0], FACTOR
    best, trial = work.least[0], work.least[1]
    multiplier = nodes.multiplier[node]
    slack = _slack(question, nodes, work, count, multiplier, best)
    for _ in range(STEPS):
        if slack >= 0:
            break
        other = _slack(question, nodes, work, count, multiplier * factor, trial)
        if other > slack:
            slack, multiplier = other, multiplier * factor
            best[:count] = trial[:count]
        else:
            factor = 1 / factor if factor > 1 else factor**-0.5
    nodes.multiplier[node] = multiplier
    return float(slack)


@numba.njit(cache=True)
def _close_robots(nodes: Any, work: Any, count: int, slack: float) -> Any:
    """Leave out robots without which the bound stays below; the next robot, and whether no set is without it."""
    node, least = nodes.position[0], work.least[0]
    left, forced, chosen = nodes.left[node], -1, 0
    rising = np.sort(least[:count])
    last, following = rising[left - 1], rising[left] if left < count else np.inf
    room = -slack * left
    for x in range(count):
        if least[x] > last:
            if least[x] - last >= room:
                nodes.side[node, work.robots[x]] = OUTSIDE
        elif following - least[x] >= room:
            forced = x
        if least[x] < least[chosen]:
            chosen = x
    return (work.robots[forced], True) if forced >= 0 else (work.robots[chosen], False)


@numba.njit(cache=True)
def _take(view: Any, question: Any, nodes: Any, target: int, robot: int) -> None:
    """Make the node at depth ``target`` the last one with the robot inside."""
    node = nodes.position[0]
    nodes.side[target] = nodes.side[node]
    nodes.side[target, robot] = INSIDE
    nodes.sums[target] = nodes.sums[node] + view.information[robot]
    nodes.paid[target] = nodes.paid[node] + question.prices[robot]
    nodes.left[target] = nodes.left[node] - 1
    nodes.multiplier[target] = nodes.multiplier[node]


@numba.njit(cache=True)
def _work(n_robots: int) -> Any:
    pairs, robots = np.empty((n_robots, n_robots)), np.empty(n_robots, dtype=np.int64)
    return _Work(robots, pairs, np.empty((2, n_robots)), np.empty(n_robots))


@numba.njit(cache=True)
def slack_of_pairs(view: Any, question: Any, nodes: Any) -> float:
    """By how much the bound on the last node's sets exceeds the threshold, for more than two robots to choose."""
    work = _work(len(question.prices))
    count, left = _fill_open(view, question, nodes, work), nodes.left[nodes.position[0]]
    if count < left:
        return np.inf
    fill_pairs(view, nodes.sums[nodes.position[0]], work.robots[:count], left, work.pairs)
    return _best_slack(question, nodes, work, count)


@numba.njit(cache=True)
def search_pairs(view: Any, question: Any, nodes: Any, most: int, members: Any) -> int:
    """Continue for at most so many nodes: FINISHED, PAUSED, or FOUND with a set in ``members`` (N,).

    The node in which a set is found is left, though there may be others in it.
    """
    position, work = nodes.position, _work(len(question.prices))
    for _ in range(most):
        node = position[0]
        if node < 0:
            return FINISHED
        position[1] += 1
        count, left = _fill_open(view, question, nodes, work), nodes.left[node]
        if count < left or _most_paid(question, nodes, work, count) <= question.limit:
            position[0] -= 1
            continue
        if left > 1:
            fill_pairs(view, nodes.sums[node], work.robots[:count], left, work.pairs)
        slack = _best_slack(question, nodes, work, count) if left > 2 else 0.0
        found = left <= 2 and _find_last(question, nodes, work, count, members)
        if slack >= 0:
            position[0] -= 1
            if found:
                return FOUND
            continue
        robot, is_forced = _close_robots(nodes, work, count, slack)
        if is_forced:
            _take(view, question, nodes, node, robot)
        else:
            _take(view, question, nodes, node + 1, robot)
            nodes.side[node, robot] = OUTSIDE
            position[0] += 1
    return FINISHED if position[0] < 0 else PAUSED
