"""Groups that pay the prices, or the proof that there is none: the search over seeing robots, within a budget."""

from __future__ import annotations

from dataclasses import dataclass
from time import monotonic
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.by_prices.groups.seeing_sets import (
    FINISHED,
    FOUND,
    PAUSED,
    Flows,
    SeeingStack,
    leave_node,
    lower_prices,
    search_seeing_sets,
)
from ratt_opt.attackers.by_prices.prices import KnownGroup

if TYPE_CHECKING:
    from ratt_opt.attackers.by_prices.falling_prices import FallingPrices
    from ratt_opt.attackers.by_prices.groups.columns import Prices, Question
    from ratt_opt.attackers.by_prices.team import Links, PricedTeam
    from ratt_opt.budget import Budget

__all__ = ["PayingGroups", "find_paying_groups"]

FIRST_CHUNK, GLANCE = 500, 0.05
"""Nodes before the first look at the clock, and seconds between two looks that chunks are cut for."""

SURCHARGE = 0.25
"""Of a blinded robot [links], beyond what the whole team needs not to pay. Without one, groups with more blinded robots
than there may be pay the prices; twice as much takes up to three times the nodes at 30 robots on hubs."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PayingGroups:
    """``groups`` that pay, though prices fell for others; ``is_complete`` : with none, that there is none."""

    groups: list[KnownGroup]
    is_complete: bool


def find_paying_groups(  # noqa: PLR0917
    team: PricedTeam,
    links: Links,
    prices: Prices,
    question: Question,
    budget: Budget,
    falling: FallingPrices | None = None,
    *,
    nodes: int,
    room: int,
) -> PayingGroups:
    """Search for so many nodes, until ``room`` groups are found; counts its nodes in ``budget``.

    ``falling`` : the same prices, if they may fall for groups that pay, as far as they can; the search goes on for the
    groups left over.

    Raises
    ------
    OutOfBudget : the time is up.
    """
    prices = prices._replace(robot=prices.robot.copy())
    n_robots, flows = len(prices.robot), _flows(prices, question.budget)
    stack = SeeingStack.of(len(links.robot), len(flows.share), team.prior, n_robots)
    found = (np.zeros(n_robots, dtype=np.bool_), np.zeros(n_robots, dtype=np.bool_))
    code, chunk, nodes = PAUSED, FIRST_CHUNK, budget.nodes_left(nodes)
    below, groups = float(np.nextafter(question.threshold, -np.inf)), list[KnownGroup]()
    while code != FINISHED and len(groups) < room and (before := int(stack.position[1])) < nodes:
        budget.check()
        began = monotonic()
        code = search_seeing_sets(team, links, prices, flows, question, stack, min(chunk, nodes - before), found)
        budget.nodes += int(stack.position[1]) - before
        if code == FOUND:
            group = KnownGroup(robots=found[0].copy(), need=int(found[1].sum()), value=below)
            if falling is not None and not groups and falling.fall(group, budget):
                lower_prices(stack, prices.robot, falling.prices.robot)
            else:
                groups.append(group)
                leave_node(stack)
        elif monotonic() - began < GLANCE:
            chunk *= 2
        else:
            chunk = max(chunk // 2, 1)
    return PayingGroups(groups=groups, is_complete=code == FINISHED)


def _flows(prices: Prices, n_blinded: int) -> Flows:
    """Half of the robots' share and all of it, with the surcharge and without."""
    n_robots = len(prices.robot)
    least = n_robots - int(prices.capacity)  # the whole team as one group blinds so many at least
    excess = float(prices.robot.sum()) - prices.blinded * least
    dear = prices.blinded + SURCHARGE + max(excess / max(least - n_blinded, 1), 0.0)
    mu = prices.blinded
    return Flows(np.array([1.0, 0.5, 1.0, 0.0, 0.0]), np.array([mu, mu, dear, dear, mu]))
