"""Groups that pay the prices, or the proof that there is none: the search over seeing robots, within a budget."""

from __future__ import annotations

from dataclasses import dataclass, field
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
from ratt_opt.budget import OutOfBudget

if TYPE_CHECKING:
    from ratt_opt.attackers.by_prices.convex_forms import ConvexForms
    from ratt_opt.attackers.by_prices.falling_prices import FallingPrices
    from ratt_opt.attackers.by_prices.groups.columns import Prices, Question
    from ratt_opt.attackers.by_prices.team import Links, PricedTeam
    from ratt_opt.budget import Budget

__all__ = ["PayingGroups", "PayingSearch"]

FITTED = 2_000
"""Nodes after which forms are fitted to the prices: a tenth of a second at 30 robots at first, then less."""

FORM_NODES, AGAIN = 2, 4
"""Nodes without forms that one with forms counts for: 1.3 to 3 at 30 to 100 robots; and how many times as long as the
last search made both ways another must be to be made both ways."""

FIRST_CHUNK, GLANCE = 50, 0.05
"""Nodes before the first look at the clock, and seconds between two looks that chunks are cut for."""

SURCHARGE = 0.25
"""Of a blinded robot [links], beyond what the whole team needs not to pay. Without one, groups with more blinded robots
than there may be pay the prices; twice as much takes up to three times the nodes at 30 robots on hubs."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PayingGroups:
    """``groups`` that pay, though prices fell for others; ``is_complete`` : with none, that there is none."""

    groups: list[KnownGroup]
    is_complete: bool


@dataclass(slots=True)
class PayingSearch:
    """Searches for groups of one team that pay; ``forms`` : what groups of each size cut, learned while it searches.

    Forms shorten proofs or only slow them down, which depends on the graph and on the prices: hubs of 30 robots take
    half to a tenth of the nodes with them, a small world of 100 three times as many. So a search long enough is made
    both ways, and the shorter way is gone on with.
    """

    team: PricedTeam
    links: Links
    forms: ConvexForms
    _with_forms: bool = field(default=True, init=False)
    _compared: int = field(default=FITTED, init=False)

    def find(
        self,
        prices: Prices,
        question: Question,
        budget: Budget,
        falling: FallingPrices | None = None,
        *,
        nodes: int,
        room: int,
    ) -> PayingGroups:
        """Search for so many nodes, until ``room`` groups are found; counts its nodes in ``budget``.

        ``falling`` : the same prices, if they may fall for groups that pay, as far as they can; the search goes on for
        the groups left over.

        Raises
        ------
        OutOfBudget : the time is up.
        """
        before = budget.nodes
        found = self._search(prices, question, budget, falling, (nodes, room))
        spent = (budget.nodes - before) * (FORM_NODES if self._with_forms else 1)
        if found.groups or spent < AGAIN * self._compared or budget.stop() is not None:
            return found
        self._compared, self._with_forms = spent, not self._with_forms
        most = spent // (FORM_NODES if self._with_forms else 1)
        if falling is not None:
            prices = prices._replace(robot=falling.prices.robot)
        try:
            other = self._search(prices, question, budget, None if found.is_complete else falling, (most, room))
        except OutOfBudget:
            if found.is_complete:
                return found
            raise
        if not (other.is_complete or other.groups):
            self._with_forms = not self._with_forms
        return found if found.is_complete else other

    def _search(
        self, prices: Prices, question: Question, budget: Budget, falling: FallingPrices | None, most: tuple[int, int]
    ) -> PayingGroups:
        """The same one way, for ``most`` = (nodes, groups)."""
        known = self.forms.known if self._with_forms else self.forms.none
        prices = prices._replace(robot=prices.robot.copy(), forms=known)
        n_robots, flows, room = len(prices.robot), _flows(prices, question.budget), most[1]
        n_bounds = len(flows.share), self.forms.n_forms
        stack = SeeingStack.of(len(self.links.robot), n_bounds, self.team.prior, n_robots)
        found = (np.zeros(n_robots, dtype=np.bool_), np.zeros(n_robots, dtype=np.bool_))
        code, chunk, nodes, is_fitted = PAUSED, FIRST_CHUNK, budget.nodes_left(most[0]), not self._with_forms
        below, groups = float(np.nextafter(question.threshold, -np.inf)), list[KnownGroup]()
        while code != FINISHED and len(groups) < room and (before := int(stack.position[1])) < nodes:
            budget.check()
            if before >= FITTED and not is_fitted:
                self.forms.fit(prices.robot, int(prices.capacity) + question.budget, budget)
                prices, is_fitted = prices._replace(forms=self.forms.known), True
            began, asked = monotonic(), (self.team, self.links, prices, flows, question, stack)
            code = search_seeing_sets(*asked, min(chunk, nodes - before), found)
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
    """All of the robots' share, and none; without forms also half, and both ends with the surcharge."""
    mu = prices.blinded
    if len(prices.forms.constant):
        return Flows(np.array([1.0, 0.0]), np.array([mu, mu]))
    n_robots = len(prices.robot)
    least = n_robots - int(prices.capacity)  # the whole team as one group blinds so many at least
    excess = float(prices.robot.sum()) - mu * least
    dear = mu + SURCHARGE + max(excess / max(least - n_blinded, 1), 0.0)
    return Flows(np.array([1.0, 0.5, 1.0, 0.0, 0.0]), np.array([mu, mu, dear, dear, mu]))
