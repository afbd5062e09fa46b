"""Groups that pay the prices, or the proof that there is none: searches of compiled code, within a budget."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from time import monotonic
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.by_prices.groups.member_sets import MemberStack, search_member_sets
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
    from ratt_opt._validation import BoolArray, FloatArray
    from ratt_opt.attackers.by_prices.convex_forms import ConvexForms
    from ratt_opt.attackers.by_prices.falling_prices import FallingPrices
    from ratt_opt.attackers.by_prices.groups.columns import Prices, Question
    from ratt_opt.attackers.by_prices.team import Links, PricedTeam
    from ratt_opt.budget import Budget

__all__ = ["PayingGroups", "PayingSearch"]

FITTED = 2_000
"""Nodes after which forms are fitted to the prices: a tenth of a second at 30 robots at first, then less."""

AGAIN = 4
"""How many times as long as the last search made every way another must be to be made every way."""

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


class Way(Enum):
    """What a search asks first, and whether forms bound its nodes."""

    SEEING_WITH_FORMS = "who sees, with forms"
    SEEING = "who sees"
    INSIDE = "who is inside"


NODES = {Way.SEEING_WITH_FORMS: 2, Way.SEEING: 1, Way.INSIDE: 4}
"""Nodes of the search for who sees, without forms, that one of each way counts for: 1.3 to 3 with forms and 3 to 7 of
the search for who is inside at 30 to 100 robots."""

LARGE = 60
"""Robots beyond which it is first asked who is inside: at 100 robots that is mostly the shortest way, at 50 seldom."""


@dataclass(slots=True)
class PayingSearch:
    """Searches for groups of one team that pay; ``forms`` : what groups of each size cut, learned while it searches.

    Which way is short depends on the graph, the threshold and the prices: hubs of 30 robots take half to a tenth of
    the nodes with forms, a small world of 100 three times as many, and hubs of 100 a tenth where it is asked first who
    is inside. So a search long enough is made every way, and the shortest way is gone on with.
    """

    team: PricedTeam
    links: Links
    forms: ConvexForms
    _way: Way = field(init=False)
    _compared: int = field(default=FITTED, init=False)

    def __post_init__(self) -> None:
        """The way that is mostly short for so many robots."""
        self._way = Way.INSIDE if len(self.team.single) > LARGE else Way.SEEING_WITH_FORMS

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
        before, first = budget.nodes, self._way
        found = self._search((first, nodes, room), prices, question, budget, falling)
        spent = (budget.nodes - before) * NODES[first]
        if found.groups or spent < AGAIN * self._compared or budget.stop() is not None:
            return found
        self._compared = spent
        for way in Way:
            if way is first:
                continue
            if falling is not None:
                prices = prices._replace(robot=falling.prices.robot)
            before, fall = budget.nodes, None if found.is_complete else falling
            try:
                other = self._search((way, max(spent // NODES[way], 1), room), prices, question, budget, fall)
            except OutOfBudget:
                if found.is_complete:
                    return found
                raise
            if other.is_complete or other.groups:
                self._way, spent = way, (budget.nodes - before) * NODES[way]
                found = found if found.is_complete else other
                if found.groups:
                    break
        return found

    def _search(
        self,
        how: tuple[Way, int, int],
        prices: Prices,
        question: Question,
        budget: Budget,
        falling: FallingPrices | None,
    ) -> PayingGroups:
        """The same for ``how`` = (way, nodes, groups at most)."""
        way, nodes, room = how
        with_forms = way is Way.SEEING_WITH_FORMS
        prices = prices._replace(robot=prices.robot.copy(), forms=self.forms.known if with_forms else self.forms.none)
        asked = _ByMembers if way is Way.INSIDE else _BySeers
        search = asked(self.team, self.links, prices, question, self.forms.n_forms)
        found = (np.zeros(len(prices.robot), dtype=np.bool_), np.zeros(len(prices.robot), dtype=np.bool_))
        code, chunk, nodes, is_fitted = PAUSED, FIRST_CHUNK, budget.nodes_left(nodes), not with_forms
        below, groups = float(np.nextafter(question.threshold, -np.inf)), list[KnownGroup]()
        while code != FINISHED and len(groups) < room and (before := search.nodes) < nodes:
            budget.check()
            if before >= FITTED and not is_fitted:
                self.forms.fit(prices.robot, int(prices.capacity) + question.budget, budget)
                search.prices, is_fitted = search.prices._replace(forms=self.forms.known), True
            began = monotonic()
            code = search.go_on(min(chunk, nodes - before), found)
            budget.nodes += search.nodes - before
            if code == FOUND:
                group = KnownGroup(robots=found[0].copy(), need=int(found[1].sum()), value=below)
                if falling is not None and not groups and falling.fall(group, budget):
                    search.lower(falling.prices.robot)
                else:
                    groups.append(group)
                    leave_node(search.stack)
            elif monotonic() - began < GLANCE:
                chunk *= 2
            else:
                chunk = max(chunk // 2, 1)
        return PayingGroups(groups=groups, is_complete=code == FINISHED)


class _Begun:
    """A search that pauses; its prices of robots are its own."""

    stack: SeeingStack | MemberStack

    def __init__(self, team: PricedTeam, links: Links, prices: Prices, question: Question) -> None:
        self.team, self.links, self.prices, self.question = team, links, prices, question

    @property
    def nodes(self) -> int:
        return int(self.stack.position[1])


class _BySeers(_Begun):
    """Who sees is asked first."""

    def __init__(self, team: PricedTeam, links: Links, prices: Prices, question: Question, n_forms: int) -> None:
        super().__init__(team, links, prices, question)
        self._flows = _flows(prices, question.budget)
        bounds = len(self._flows.share), n_forms
        self.stack: SeeingStack = SeeingStack.of(len(links.robot), bounds, team.prior, len(prices.robot))

    def go_on(self, nodes: int, found: tuple[BoolArray, BoolArray]) -> int:
        asked = self.team, self.links, self.prices, self._flows, self.question, self.stack
        return int(search_seeing_sets(*asked, nodes, found))

    def lower(self, robot: FloatArray) -> None:
        lower_prices(self.stack, self.prices.robot, robot)


class _ByMembers(_Begun):
    """Who is inside is asked first."""

    def __init__(self, team: PricedTeam, links: Links, prices: Prices, question: Question, _: int) -> None:
        super().__init__(team, links, prices, question)
        self.stack: MemberStack = MemberStack.of(team.prior, len(prices.robot))

    def go_on(self, nodes: int, found: tuple[BoolArray, BoolArray]) -> int:
        asked = self.team, self.links, self.prices, self.question, self.stack
        return int(search_member_sets(*asked, nodes, found))

    def lower(self, robot: FloatArray) -> None:
        np.minimum(self.prices.robot, robot, out=self.prices.robot)


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
