"""The plan keeps a value under every attack on any graph, by prices of robots that no group worth less pays.

In units of which ``half_link`` are half a link, robot i has a price p_i, of any sign, and a blinded robot costs
u >= 0. Say a group g of which the robots b are blinded *pays* if

    sum of p_i over g  >  half_link * (links between g and the others) + u |b|.

If no group of robots that is worth less than the claim pays, every attack leaves one that is worth it: otherwise add up
what the groups of the attack do not pay. Each cut link lies between two groups, so

    sum of all p_i  <=  2 half_link alpha_c + u min(alpha_s, robots that may be blinded),

which is checked to be false. That no group pays is a tree over who sees in it, and flows: a flow f of at most
half_link on each link (of any size on one that is protected, which no group loses) carries out of a group at most
half_link a lost link. So with c_i = (flow out of i) - p_i the group costs at least

    sum of c_i over g + (u + s) |b| - s min(alpha_s, ...)        for any surcharge s >= 0,

whose least over what is open in a case is a sum over robots, each by itself but for the number of those that see.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from ratt_opt.certificates.verifier.reading import array, fields, index, need, signed, walk
from ratt_opt.certificates.verifier.version1.size_tree import check_size_tree

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.certificates.verifier.statement import Statement
    from ratt_opt.certificates.verifier.worth import Worth

__all__ = ["check_group_prices"]

LARGEST = 2**53
"""Of prices and flows, in size."""


@dataclass(frozen=True, slots=True)
class _Case:
    """Groups in which ``seeing`` see, ``others`` do not, of these ``blind`` are blinded and ``outside`` outside;
    at most ``room`` further robots see. ``known`` : the seeing ones, as ``Worth`` has them."""

    known: Any
    seeing: frozenset[int] = frozenset()
    others: frozenset[int] = frozenset()
    blind: frozenset[int] = frozenset()
    outside: frozenset[int] = frozenset()
    room: int = 0


def check_group_prices(about: Statement, part: Any, worth: Worth) -> int:
    """Check the proof; returns its leaves.

    Cases in preorder, 2i: robot i sees in the group; or does not. 2i + 1: robot i, which does not see, is blinded in
    the group; or outside. -1: the robots that see are worth the claim. -2 - 2r: at most r further robots see, as any
    r + 1 of the open ones bring the group to the claim; one case follows. -3 - 2k: no group of the case pays, by flow
    k.
    """
    names = "kind half_link robots blinded size sizes flows tree"
    _, half, robots, blinded, size, sizes, flows, tree = fields("lower proof", part, names)
    prices = _Prices(about, half, robots, blinded)
    bounds = [prices.bound(flow) for flow in array("flows", flows)]
    room = index("size", size, about.n + 1)
    leaves = check_size_tree(about.n, room + 1, sizes, worth)

    def expand(node: Any, case: _Case) -> Iterator[_Case]:
        decided = case.seeing | case.others
        if node == -1:
            worth.require(case.known)
        elif type(node) is int and node < 0:
            number, is_bound = divmod(-2 - node, 2)
            if is_bound:
                surcharge, costs = bounds[index("lower tree flow", number, len(bounds))]
                need(prices.least(case, surcharge, costs) >= 0, "lower proof: a group of a leaf may pay")
                return
            more = index("lower tree room", number, case.room)
            worth.require(case.known, [i for i in range(about.n) if i not in decided], more + 1)
            yield replace(case, room=more)
        else:
            i, asks_place = divmod(index("lower tree", node, 2 * about.n), 2)
            if asks_place:
                placed = i in case.seeing | case.blind | case.outside | about.safe_robots
                cannot_see = i in case.others or not case.room
                need(cannot_see and not placed, f"lower proof: robot {i} cannot be placed")
                yield replace(case, blind=case.blind | {i})
                yield replace(case, outside=case.outside | {i})
                return
            need(i not in decided and case.room, f"lower proof: robot {i} is decided twice, or too many see")
            known = worth.plus(case.known, i)
            yield replace(case, known=known, seeing=case.seeing | {i}, room=case.room - 1)
            yield replace(case, others=case.others | {i})

    return leaves + walk("lower", tree, _Case(worth.nobody, room=room), expand)


class _Prices:
    """The prices, checked to claim more than the budgets."""

    def __init__(self, about: Statement, half: object, robots: object, blinded: object) -> None:
        self.about = about
        self.half, self.blinded = index("half_link", half, LARGEST), index("blinded", blinded, LARGEST)
        self.robot = [signed("robots", price, LARGEST) for price in array("robots", robots, about.n)]
        self.most = min(about.alpha_s, about.n - len(about.safe_robots))
        claimed, budget = sum(self.robot), 2 * self.half * about.alpha_c + self.blinded * self.most
        need(claimed > budget, "lower proof: the prices claim no more than the budgets")

    def bound(self, flow: object) -> tuple[int, list[int]]:
        """Return the surcharge and the costs c of a flow, after checking it."""
        extra, carried = fields("flow", flow, "surcharge links")
        surcharge, costs = index("surcharge", extra, LARGEST), [-price for price in self.robot]
        pairs = sorted(self.about.links)
        for (i, j), given in zip(pairs, array("flow links", carried, len(pairs)), strict=True):
            amount = signed("flow links", given, LARGEST)
            fits = abs(amount) <= self.half or (i, j) in self.about.safe_links
            need(fits, "lower proof: a flow exceeds half a link")
            costs[i] += amount
            costs[j] -= amount
        return surcharge, costs

    def least(self, case: _Case, surcharge: int, costs: list[int]) -> int:
        """No group of the case costs less than its prices by more than this says."""
        dear, paid, gains = self.blinded + surcharge, -surcharge * self.most, []
        for i, cost in enumerate(costs):
            blind = min(cost + dear, 0) if i not in self.about.safe_robots else 0
            if i in case.seeing:
                paid += cost
            elif i in case.blind:
                paid += cost + dear
            elif i not in case.outside:
                paid += blind
                gains += [] if i in case.others else [min(cost - blind, 0)]
        return paid + sum(sorted(gains)[: case.room])
