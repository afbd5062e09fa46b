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

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray
    from ratt_opt.attack.links import Links
    from ratt_opt.attackers.by_prices.convex_forms import ConvexForms
    from ratt_opt.attackers.by_prices.falling_prices import FallingPrices
    from ratt_opt.attackers.by_prices.groups.columns import Prices, Question
    from ratt_opt.attackers.by_prices.team import PricedTeam
    from ratt_opt.budget import Budget

__all__ = ["PayingGroups", "PayingSearch"]

FITTED = 2_000
"""Nodes after which forms are fitted to the prices: a tenth of a second at 30 robots at first, then less."""

BEHIND = 3
"""Of the work of the way that ended last, what each other way has: a third."""

KEPT = 9
"""Searches that may be gone on with: of three vectors of prices, every way."""

NEARLY = 0.75
"""Of what was left of a search: if so much or less is left now it goes on for as many nodes again. Measured at hubs of
50 robots and 97 % of the attack: what is left falls from 0.63 to 0.51, 0.29, 0.20 and 0.02 with every doubling at the
slackest prices, with forms, and stays above 0.6 at the others."""

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
    is inside; for one threshold and its neighbour it is another. So every way is tried, the one that ended last first
    and furthest, and where all of it was in vain and the same prices are asked again, all go on where they were.
    """

    team: PricedTeam
    links: Links
    forms: ConvexForms
    _way: Way = field(init=False)
    _begun: dict[tuple[Way, float, float, float, bytes], _BySeers | _ByMembers] = field(
        default_factory=dict, init=False
    )

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
        for way in sorted(Way, key=lambda way: way is not self._way):
            work = NODES[Way.SEEING_WITH_FORMS] * (nodes if way is self._way else nodes // BEHIND)
            found = self._search((way, work // NODES[way], room), prices, question, budget, falling)
            if found.is_complete:
                self._way = way
            if found.is_complete or found.groups:
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
        prices = prices if falling is None else prices._replace(robot=falling.prices.robot)
        key = way, question.threshold, question.limit, prices.blinded, prices.robot.tobytes()
        search = self._begun.pop(key, None) or self._begin(way, prices, question)
        found = (np.zeros(len(prices.robot), dtype=np.bool_), np.zeros(len(prices.robot), dtype=np.bool_))
        code, chunk, fell = PAUSED, FIRST_CHUNK, False
        nodes, left = search.nodes + budget.nodes_left(max(nodes - search.nodes, 0)), search.left
        below, groups = float(np.nextafter(question.threshold, -np.inf)), list[KnownGroup]()
        while code != FINISHED and len(groups) < room and (before := search.nodes) < nodes:
            budget.check()
            if before >= FITTED and not search.is_fitted:
                self.forms.fit(prices.robot, int(prices.capacity) + question.budget, budget)
                search.prices, search.is_fitted = search.prices._replace(forms=self.forms.known), True
            began = monotonic()
            code = search.go_on(min(chunk, nodes - before), found)
            budget.nodes += search.nodes - before
            if code == FOUND:
                group = KnownGroup(robots=found[0].copy(), need=int(found[1].sum()), value=below)
                if falling is not None and not groups and falling.fall(group, budget):
                    search.lower(falling.prices.robot)
                    fell = True
                else:
                    groups.append(group)
                    leave_node(search.stack)
            elif monotonic() - began < GLANCE:
                chunk *= 2
            else:
                chunk = max(chunk // 2, 1)
            if code == PAUSED and search.nodes >= nodes and search.left <= NEARLY * left:
                nodes, left = nodes + budget.nodes_left(nodes), search.left
        if groups:
            self._begun.clear()
        elif code != FINISHED and not fell:
            self._begun[key] = search
            while len(self._begun) > KEPT:
                del self._begun[next(iter(self._begun))]
        return PayingGroups(groups=groups, is_complete=code == FINISHED)

    def _begin(self, way: Way, prices: Prices, question: Question) -> _BySeers | _ByMembers:
        """A search of one way; its prices are its own."""
        with_forms = way is Way.SEEING_WITH_FORMS
        prices = prices._replace(robot=prices.robot.copy(), forms=self.forms.known if with_forms else self.forms.none)
        asked = _ByMembers if way is Way.INSIDE else _BySeers
        search = asked(self.team, self.links, prices, question, self.forms.n_forms)
        search.is_fitted = not with_forms
        return search


class _Begun:
    """A search that pauses; its prices of robots are its own."""

    stack: SeeingStack | MemberStack
    is_fitted = True

    def __init__(self, team: PricedTeam, links: Links, prices: Prices, question: Question) -> None:
        self.team, self.links, self.prices, self.question = team, links, prices, question

    @property
    def nodes(self) -> int:
        return int(self.stack.position[1])

    @property
    def left(self) -> float:
        """Of the search, if both nodes of every decision take as long."""
        return float(self.stack.weight[: self.stack.position[0] + 1].sum()) if self.nodes else 1.0


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
