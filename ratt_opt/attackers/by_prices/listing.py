"""Groups that cost little more than the prices pay, listed, and the partitions of a team into them."""

from __future__ import annotations

from dataclasses import dataclass
from time import monotonic
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.by_prices.groups.columns import FINISHED, FULL, Prices, Question, Stack, enumerate_groups
from ratt_opt.attackers.by_prices.groups.cover import FOUND, PAUSED, next_cover

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.attack.links import Links
    from ratt_opt.attackers.by_prices.team import PricedTeam
    from ratt_opt.budget import Budget
    from ratt_opt.graph.threat import Threat

__all__ = ["ListedGroups", "list_groups", "partitions_into"]

FIRST_CHUNK, GLANCE, COVERS = 50, 0.05, 100_000
"""Nodes before the first look at the clock; seconds between two looks that chunks of nodes are cut for; groups tried in
covers between them."""

MOST_UNDECIDED = 2_000
"""Groups of unknown need that end a listing: partitions into them prove nothing. At hubs of 30 robots and 99.5 % of the
attack every third node listed one, for 22 seconds."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ListedGroups:
    """Groups of small reduced cost.

    ``robots`` and ``blinded`` ones: (C, N); ``need`` : (C, 2) blinded robots, at least and as found; ``cost`` : (C,);
    ``is_complete`` : no other has so little; ``is_full`` : there was no room for more
    """

    robots: BoolArray
    blinded: BoolArray
    need: IntArray
    cost: FloatArray
    is_complete: bool
    is_full: bool


def list_groups(
    team: PricedTeam, links: Links, asked: tuple[Prices, Question], budget: Budget, most: tuple[int, int]
) -> ListedGroups:
    """Groups of ``asked`` = (prices, question), within ``most`` = (nodes, groups); nodes are counted in ``budget``.

    Raises
    ------
    OutOfBudget : the time is up.
    """
    n_robots, (nodes, room), (prices, question) = len(team.single), most, asked
    stack = Stack.of(n_robots, len(links.robot), (len(prices.shares), len(prices.forms.constant)))
    shape = (room, n_robots)
    listed = (np.zeros(shape, np.bool_), np.zeros(shape, np.bool_), np.zeros((room, 2), np.int64), np.zeros(room))
    code, chunk = PAUSED, FIRST_CHUNK
    nodes = budget.nodes_left(nodes)
    while code == PAUSED and (before := int(stack.position[2])) < nodes:
        budget.check()
        began = monotonic()
        code = enumerate_groups(team, links, prices, question, stack, min(chunk, nodes - before), listed)
        budget.nodes += int(stack.position[2]) - before
        chunk = 2 * chunk if monotonic() - began < GLANCE else max(chunk // 2, 1)
        count = int(stack.position[3])
        if np.count_nonzero(listed[2][:count, 0] < listed[2][:count, 1]) > MOST_UNDECIDED:
            break
    count = int(stack.position[3])
    robots, blinded, need, cost = listed
    return ListedGroups(
        robots=robots[:count],
        blinded=blinded[:count],
        need=need[:count],
        cost=cost[:count],
        is_complete=code == FINISHED,
        is_full=code == FULL,
    )


def partitions_into(
    listed: ListedGroups, threat: Threat, half_cuts: FloatArray, gap: float, budget: Budget
) -> Iterator[list[int]]:
    """Groups (their places in the list) of each partition within both of the adversary's budgets.

    ``half_cuts`` : (C,) half the links that separate each group from the others; ``gap`` : links that the groups of one
    partition may cost beyond what the prices pay

    Raises
    ------
    OutOfBudget : the time is up.
    """
    n_robots = threat.graph.n_robots
    busy = np.argsort(-listed.robots.sum(axis=0), kind="stable")
    robots = np.ascontiguousarray(listed.robots[:, busy])
    lowest = robots.argmax(axis=1)
    order = np.argsort(lowest, kind="stable")
    robots = np.ascontiguousarray(robots[order])
    costs = np.stack([np.maximum(listed.cost[order], 0.0), listed.need[order, 0], half_cuts[order]], axis=1)
    first = np.searchsorted(lowest[order], np.arange(n_robots + 1))
    position, depth = np.full(n_robots + 2, -1, dtype=np.int64), np.zeros(1, dtype=np.int64)
    covered, spent = np.zeros((n_robots + 2, n_robots), dtype=np.bool_), np.zeros((n_robots + 2, 3))
    state = (position, covered, spent, depth, first)
    budgets = np.array([gap, threat.n_blinded, threat.alpha_c], dtype=np.float64)
    while True:
        budget.check()
        code = next_cover(robots, costs, budgets, state, COVERS)
        if code == FOUND:
            yield order[position[: int(depth[0]) + 1]].tolist()
        elif code != PAUSED:
            return
