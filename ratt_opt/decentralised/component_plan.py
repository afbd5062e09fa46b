"""The plan that one robot makes with its component: bait, then choices, then exchanges, by items sent and taken.

It stands and falls with a view of the component: for another view the agent makes another plan. ``alpha`` is RATT's, of
the component. Items go along the view's tree, apart from menus and, with limited hops, choices.
"""

from __future__ import annotations

from collections import Counter
from enum import Enum
from math import inf
from typing import TYPE_CHECKING

from ratt_opt.budget import Budget
from ratt_opt.decentralised.exchanges import best_exchange
from ratt_opt.decentralised.knowledge import AwardedSum
from ratt_opt.decentralised.messages import Award, BaitChoice, BaitList, Bid, Menu

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from ratt_opt.decentralised.knowledge import OwnChoice
    from ratt_opt.decentralised.messages import Choice, Item
    from ratt_opt.decentralised.view import ComponentView

__all__ = ["ComponentPlan", "State"]


class State(Enum):
    """Stage of an agent, with a sentence about it."""

    FLOODING = "It collects the link records of its component."
    LISTING = "It collects its children's lists of valuable robots."
    LISTED = "It has sent its list and waits for the choice of bait."
    HEARING = "It waits for choices within its hops: of lower robots before its own one, then of the others."
    BIDDING = "It collects its children's bids of this round."
    OFFERED = "It has sent the best bid of its part of the tree and waits for the award."
    PROPOSING = "It collects its neighbours' menus, then its children's proposals of an exchange."
    PROPOSED = "It has sent the best exchange that its part of the tree proposes and waits for the decision."
    ENDED = "It knows all choices that it will hear of."


class ComponentPlan:
    """One robot's part in the plan of its component.

    ``name`` : digest of view and ``alpha``; ``stamp`` : sum of the numbers of the link records that the robot knows;
    ``send`` : takes a robot and an item for it. ``bait`` : ``None`` until it is known. ``chosen`` : choices that it
    heard of and its own, in their order; ``own_after`` : own element after RATT's plan and after each exchange.
    """

    def __init__(  # noqa: PLR0917
        self,
        view: ComponentView,
        name: bytes,
        alpha: int,
        own: OwnChoice,
        stamp: Callable[[], int],
        send: Callable[[int, Item], None],
    ) -> None:
        self.view, self.name, self.alpha, self.own = view, name, alpha, own
        self.robot, self.hops, self.params = own.knowledge.robot, own.knowledge.hops, own.knowledge.exchanges
        self.bait: tuple[int, ...] | None = None
        self.chosen: dict[int, Choice] = {}
        self.own_after: list[int] = []
        self._stamp, self._send = stamp, send
        self._branches = view.branches(self.robot)
        self._children = sorted(set(self._branches.values()))
        self._told = AwardedSum(own.objective)
        self._lists: dict[int, BaitList] = {}
        self._bids: dict[int, Bid] = {}
        self._menus: dict[int, tuple[Choice, ...]] = {}
        self._mine: Bid | None = None
        self._near: tuple[int, ...] = ()
        self._open_below: Counter[int] = Counter()
        self._has_sent = self._has_closed = False

    @property
    def exchanges(self) -> int:
        """Exchanges taken so far."""
        return max(len(self.own_after) - 1, 0)

    @property
    def is_over(self) -> bool:
        """True if it knows all choices that it will hear of."""
        if self.bait is None:
            return False
        if self.hops is not None:
            return not self._awaited
        return self._has_closed or (self.params is None and self._all_awarded)

    @property
    def state(self) -> State:
        """Stage that it is in."""
        if self.is_over:
            return State.ENDED
        if self.bait is None:
            return State.LISTED if self._has_sent else State.LISTING
        if self.hops is not None:
            return State.HEARING
        if self._may_exchange:
            return State.PROPOSED if self._has_sent else State.PROPOSING
        return State.OFFERED if self._has_sent else State.BIDDING

    @property
    def _all_awarded(self) -> bool:
        assert self.bait is not None
        return len(self.chosen) >= len(self.view.members) - len(self.bait)

    @property
    def _may_exchange(self) -> bool:
        return len(self.chosen) == len(self.view.members)

    def begin(self) -> None:
        """Choose bait by messages, unless all robots are bait or none."""
        if 0 < self.alpha < len(self.view.members):
            self._list()
        else:
            self._take_choice(self.view.members if self.alpha else ())

    def take(self, sender: int, item: Bid | BaitList | BaitChoice) -> None:
        """Take an item about this plan."""
        if isinstance(item, BaitList):
            self._lists[sender] = item
            self._list()
        elif isinstance(item, BaitChoice):
            self._to_children(item)
            self._take_choice(item.robots)
        elif isinstance(item, Award):
            (self._take_award if self.hops is None else self._hear)(item)
        elif isinstance(item, Menu):
            assert self.params is not None
            robot = item.choices[0].robot
            self._menus[robot] = item.choices
            self._tell(robot, item, self.params.reach)
        else:
            self._bids[sender] = item
        if self.bait is not None and self.hops is None:
            self._bid()

    # ------------------------------------------------------------------ bait

    def _list(self) -> None:
        """Send the best robots of this part of the tree once all children's lists are there; the root chooses."""
        if self._has_sent or len(self._lists) < len(self._children):
            return
        known = [(self.own.value_alone, self.robot)] + [one for told in self._lists.values() for one in told.best]
        best = tuple(sorted(known, key=lambda one: (-one[0], one[1]))[: self.alpha])
        if self.view.root == self.robot:
            bait = tuple(sorted(robot for _, robot in best))
            self._to_children(BaitChoice(self._stamp(), self.name, bait))
            self._take_choice(bait)
        else:
            self._has_sent = True
            self._to_parent(BaitList(self._stamp(), self.name, best))

    def _take_choice(self, bait: tuple[int, ...]) -> None:
        self.bait, self._has_sent = bait, False
        if self.robot in bait:
            self.own.choose_alone()
        self._count_open(set(self.view.members).difference(bait) or bait)
        if self.hops is None:
            self._bid()
        else:
            self._near = (self.robot, *self.view.within(self.robot, self.hops))
            self._choose()

    # ------------------------------------------------------------------ choices that are told some hops far

    @property
    def _awaited(self) -> list[int]:
        """Greedy robots within the hops, this one among them, whose choices are not known yet."""
        assert self.bait is not None
        return [i for i in self._near if i not in self.bait and i not in self.chosen]

    def _choose(self) -> None:
        """Choose beside what was heard once all lower robots within the hops have chosen."""
        if min(self._awaited, default=None) == self.robot:
            value, choice = self.own.best_beside(self._told.posterior())
            self.own.take(choice, [self.chosen[i] for i in sorted(self.chosen)])
            self._hear(Award(self._stamp(), self.name, len(self.chosen), value, (choice,)))

    def _hear(self, award: Award) -> None:
        """Keep a choice and tell it further, along the shortest ways from the robot that made it."""
        assert self.hops is not None
        (choice,) = award.choices
        self.chosen[choice.robot] = choice
        self._told.add(choice)
        self._tell(choice.robot, award, self.hops)
        if self.bait is not None:
            self._choose()

    def _tell(self, origin: int, item: Item, hops: int) -> None:
        """Pass on what a robot tells all within some hops."""
        for i, above in self.view.within(origin, hops).items():
            if above == self.robot:
                self._send(i, item)

    # ------------------------------------------------------------------ auctions, and exchanges after them

    def _bid(self) -> None:
        """Send the best bid of this part of the tree once it is known; the root awards it and goes on."""
        while not self.is_over and not self._has_sent:
            if self._mine is None:
                self._mine = self._own_bid()
            waits = (child not in self._bids for child in self._children if self._open_below[child])
            if any(waits) or (self._may_exchange and self._mine is None):
                return
            best = self._mine
            for bid in self._bids.values():
                best = bid if bid.beats(best) else best
            self._has_sent = True
            if best is None:
                return
            if self.view.root != self.robot:
                self._to_parent(best)
                return
            self._take_award(Award(self._stamp(), self.name, best.round, best.value, best.choices))

    def _own_bid(self) -> Bid | None:
        """Best own element beside those awarded, or best exchange; ``None`` if it has its element or lacks a menu."""
        assert self.bait is not None
        number = len(self.chosen) + self.exchanges
        if self._may_exchange:
            if len(self._menus) < len(self._near):
                return None
            return Bid(self._stamp(), self.name, number, *self._best_exchange())
        if self.robot in self.chosen or (self.robot in self.bait) is not self._all_awarded:
            return None
        posterior = self.own.objective.prior_information if self._all_awarded else self._told.posterior()
        value, choice = self.own.best_beside(posterior)
        return Bid(self._stamp(), self.name, number, value, (choice,))

    def _best_exchange(self) -> tuple[float, tuple[Choice, ...]]:
        assert self.params is not None
        if self.exchanges == self.params.most:
            return -inf, ()
        budget = Budget.inside(self.own.knowledge.budget, self.params.seconds)
        return best_exchange(self.view, self.own.objective, self.chosen, self._menus, self.params.kicks, budget)

    def _take_award(self, award: Award) -> None:
        assert self.bait is not None
        if self._may_exchange:
            self._has_closed = not award.choices
            self.chosen |= {choice.robot: choice for choice in award.choices}
            self.own.element = self.chosen[self.robot].element
            if award.choices:
                self.own_after.append(self.own.element)
        else:
            self._take_element(award.choices[0])
        self._bids.clear()
        self._mine, self._has_sent = None, False
        self._to_children(award)

    def _take_element(self, choice: Choice) -> None:
        """Note an awarded element; the last ones are those of bait, told only if the team exchanges."""
        assert self.bait is not None
        if choice.robot not in self.bait:
            if choice.robot == self.robot:
                self.own.take(choice, self.chosen.values())
            elif self.robot not in self.chosen:
                self._told.add(choice)
        self.chosen[choice.robot] = choice
        if choice.robot in self._branches:
            self._open_below[self._branches[choice.robot]] -= 1
        if self.params is not None and self._all_awarded and choice.robot not in self.bait:
            self._count_open(self.bait)
        if self._may_exchange and self.params is not None:
            self.own_after.append(self.own.element)
            self._count_open(self.view.members)
            self._near = (self.robot, *self.view.within(self.robot, self.params.reach))
            self._menus[self.robot] = self.own.menu()
            menu = Menu(self._stamp(), self.name, 0, 0.0, self._menus[self.robot])
            self._tell(self.robot, menu, self.params.reach)

    def _count_open(self, robots: Iterable[int]) -> None:
        """Count the robots below each child that have to bid."""
        self._open_below = Counter(self._branches[i] for i in robots if i in self._branches)

    def _to_parent(self, item: Item) -> None:
        self._send(self.view.parent[self.robot], item)

    def _to_children(self, item: Item) -> None:
        for child in self._children:
            self._send(child, item)
