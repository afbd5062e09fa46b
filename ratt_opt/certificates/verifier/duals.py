"""Costs of an attack's groups at dual prices, and proof that no groups within the budgets partition the team.

A group C of which b robots are blinded costs

    link * (links between C and the others) + blinded * b - sum of the duals of its robots.

The groups of an attack partition the team, and a cut link leaves two of them, so they cost

    slack = 2 link alpha_c + blinded min(alpha_s, robots that may be blinded) - sum of all duals

at most, together. If no group that is worth less than the claim costs less than 0, and the slack is negative, every
attack leaves a group that is worth it. If the slack is not negative, groups that cost no more are listed, and a tree
shows that they do not partition the team.

Source: Johnson, Mehrotra and Nemhauser, Mathematical Programming 62 (1993).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ratt_opt.certificates.verifier.cases import robots_of
from ratt_opt.certificates.verifier.limits import limits
from ratt_opt.certificates.verifier.reading import array, fields, index, need, signed, walk
from ratt_opt.certificates.verifier.work import tick
from ratt_opt.errors import UndecidedError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.certificates.verifier.cases import Cases, Close, GroupCase

__all__ = ["Duals", "ListedGroup", "check_duals", "check_partition"]


@dataclass(frozen=True, slots=True)
class ListedGroup:
    """A group within the budgets, as a bit mask: what it costs, robots blinded in it at least, links that leave it."""

    robots: int
    cost: int
    need: int
    links: int


@dataclass(frozen=True, slots=True)
class _Bound:
    """Prices of blinded robots and of cuts beside the duals; ``flow[i]`` : by neighbour, what is carried out of i."""

    blinding: int
    cut: int
    flow: list[dict[int, int]]


class Duals:
    """Duals, the bounds that go with them, and the groups that are listed."""

    def __init__(self, cases: Cases, given: object) -> None:
        link, robots, blinded = fields("duals", given, "link robots blinded")
        self.cases, self.about, self._largest = cases, cases.about, limits().dual_numbers
        self.link, self.blinded = (
            index("duals link", link, self._largest),
            index("duals blinded", blinded, self._largest),
        )
        self.robot = [
            signed("duals robots", dual, self._largest) for dual in array("duals robots", robots, self.about.n)
        ]
        self.slack = 2 * self.link * self.about.alpha_c + self.blinded * cases.blinded - sum(self.robot)
        self.bounds: list[_Bound] = []
        self._listed: dict[int, ListedGroup] = {}

    @property
    def listed(self) -> list[ListedGroup]:
        """Groups in the order in which leaves list them."""
        return list(self._listed.values())

    def read_bounds(self, given: object) -> None:
        """Read flows and their prices, after checking that no link carries more than it may."""
        pairs = sorted(self.about.links)
        for bound in array("bounds", given):
            tick()
            blinding, cut, carried = fields("bound", bound, "blinding cut flow")
            extra = index("bound cut", cut, self._largest)
            flow: list[dict[int, int]] = [{} for _ in range(self.about.n)]
            for (i, j), value in zip(pairs, array("bound flow", carried, len(pairs)), strict=True):
                amount = signed("bound flow", value, self._largest)
                fits = abs(amount) <= self.link + extra or (i, j) in self.about.safe_links
                need(fits, "lower proof: a flow exceeds what a link may carry")
                flow[i][j], flow[j][i] = amount, -amount
            self.bounds.append(_Bound(index("bound blinding", blinding, self._largest), extra, flow))

    def close_by_flow(self, case: GroupCase, number: object) -> None:
        """Leaf ``flow``: every group of the case costs more than the slack, or than nothing if that is negative."""
        bound = self.bounds[index("lower tree flow", number, len(self.bounds))]
        limit = max(self.slack, -1)
        need(self.least(case, bound) > limit, "lower proof: a group of a leaf may cost too little")

    def least(self, case: GroupCase, bound: _Bound) -> int:
        """Return a cost below which no group of the case is.

        Of the links that leave it those between decided robots count, those from an open robot to decided ones, and
        from open robots to others what the flow carries. Who of the robots that may sense is blinded does not matter
        to the cost: say that they are inside, as far as ``low`` of the group's robots must be, except those that are
        not inside and cannot sense.
        """
        near, link, price = self.cases.near, self.link + bound.cut, self.blinded + bound.blinding
        inside, outside = case.inside, case.outside
        open_ = case.everyone & ~inside & ~outside
        total = -bound.cut * self.about.alpha_c - bound.blinding * case.high
        inner: list[int] = []
        gains: list[int] = []
        for i in robots_of(inside):
            cost = -self.robot[i]
            total += link * (near[i] & outside).bit_count()
            if case.sensing >> i & 1:
                total += cost
            else:
                total += cost + price
                inner += [price] if case.may_sense >> i & 1 else []
        for i in robots_of(open_):
            flow = bound.flow[i]
            joins = link * (near[i] & outside).bit_count() - self.robot[i]
            joins += sum(flow[j] for j in robots_of(near[i] & open_))
            stays = link * (near[i] & inside).bit_count()
            best = min(stays, joins + price) if case.may_blind >> i & 1 else stays
            total += best
            if case.may_sense >> i & 1 and joins < best:
                gains.append(best - joins)
        elsewhere = (open_ & case.may_blind & ~case.may_sense).bit_count()
        within = inside.bit_count() - case.sensing.bit_count() - max(case.low - elsewhere, 0)
        gains += inner[: max(within, 0)]
        return total - sum(sorted(gains, reverse=True)[: max(case.more, 0)])

    def list_group(self, case: GroupCase, _: object) -> None:
        """Leaf ``listed``: each robot is inside or out."""
        inside, near = case.inside, self.cases.near
        need(inside | case.outside == case.everyone, "lower proof: a listed group is not decided")
        links = sum((near[i] & ~inside).bit_count() for i in robots_of(inside))
        blinded = max(case.need, 0)
        is_torn = any(self.cases.tied[i] & ~inside for i in robots_of(inside))
        if not inside or is_torn or links > self.about.alpha_c or blinded > self.cases.blinded:
            return
        cost = self.link * links + self.blinded * blinded - sum(self.robot[i] for i in robots_of(inside))
        need(cost >= 0, "lower proof: a listed group costs less than nothing")
        known = self._listed.get(inside)
        if cost <= self.slack and (known is None or known.need > blinded):
            self._listed[inside] = ListedGroup(inside, cost, blinded, links)
            if len(self._listed) > (most := limits().listed):
                raise UndecidedError(f"not decided: more than {most} groups are listed")


def check_duals(cases: Cases, size: int, *given: object) -> int:
    """Check the proof: its limits, duals, bounds and tree, and the partition if groups are listed; returns its leaves.

    ``size`` : any set of that many robots is worth the claim
    """
    limits, dual_values, bounds, tree, *partition = given
    leaves = cases.check_limits(limits)
    duals = Duals(cases, dual_values)
    duals.read_bounds(bounds)
    closing: dict[str, Close] = {"flow": duals.close_by_flow}
    if partition:
        closing["listed"] = duals.list_group
    need(bool(partition) == (duals.slack >= 0), "lower proof: whether duals claim more than the budgets is wrong")
    leaves += cases.check(tree, cases.groups(min(size - 1, cases.about.n)), closing)
    for groups in partition:
        check_partition(duals, groups)
    return leaves


def check_partition(duals: Duals, tree: object) -> None:
    """Check that the listed groups do not partition the team within the budgets.

    ``tree`` : in preorder the robot whose group is chosen; there is one child for each listed group that has it and
    fits.
    """
    listed, n = duals.listed, duals.about.n
    having = [[group for group in listed if group.robots >> i & 1] for i in range(n)]

    def expand(robot: object, case: tuple[int, int, int, int]) -> Iterator[tuple[int, int, int, int]]:
        left, cost, blinded, links = case
        i = index("partition", robot, n)
        need(left >> i & 1, "lower proof: a robot of the tree of partitions has its group already")
        for group in having[i]:
            tick()
            fits = group.robots & ~left == 0 and group.cost <= cost and group.need <= blinded
            if fits and group.links <= links:
                rest = left & ~group.robots
                need(rest, "lower proof: listed groups partition the team within the budgets")
                yield rest, cost - group.cost, blinded - group.need, links - group.links

    walk("partition", tree, (duals.cases.everyone, duals.slack, duals.cases.blinded, 2 * duals.about.alpha_c), expand)
