"""Verify, in integers, that groups of a size need links of at least some weight to be cut.

It states prices ``q >= 0`` of robots. Let every group S of at most ``size`` that links of weight > 0 connect have

    unit * (weight of the links inside S)  <=  q(S).

Then a partition into groups of at most ``size`` has links of weight at most ``sum(q) / unit`` inside, and cuts all
others. (A group that is not connected has no more inside than its parts, and no lower prices.) Robots that protected
links join count as one robot: links between two such robots add up, and links inside one are never cut. Numbers of
robots and links below are those of that network, robots by their lowest member, links by their ends. The tree shows the
condition for all S: a split decides whether one robot is in S, and a leaf closes its case. Some robots are inside, with
links of weight ``base / unit`` less prices, and ``room`` is left. Free robots are those not decided that fit, and that
robots inside reach through free ones. For any division of links between free robots among their ends, and any
``multiplier >= 0``,

    unit * w(S) - q(S)  <=  base + multiplier * room + sum over free robots of max(0, given - q - multiplier * size),

where a link to a robot inside gives the free one all its weight: what S has beyond ``base`` is given to its free
robots, and their sizes add up to at most ``room``. A leaf must bring the right side to at most 0. It lists the parts of
links, as the link's first end gets them, that changed since the last leaf.

If prices prove less than the claim, the tree may list groups: those that a partition which cuts less can have. Then the
right side of a leaf is so far below 0 that none of its groups is one, or the leaf has a single group, which is listed.
``cut_proofs.py`` has what follows from a list, and the other proofs: by elimination, and by counting links.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ratt_opt.certificates.verifier.cut_proofs import cannot_cut_less, check_levels, most_links_inside
from ratt_opt.certificates.verifier.limits import SECONDS, VerifierLimits, within
from ratt_opt.certificates.verifier.limits import limits as current
from ratt_opt.certificates.verifier.reading import (
    CUTS_FORMAT,
    array,
    check_size,
    document_hash,
    fields,
    index,
    need,
    walk,
)
from ratt_opt.certificates.verifier.work import limited, tick

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["CUTS_FORMAT", "VerifiedCuts", "verify_cuts"]

STATED = "format version network size claim"
PROOFS = {
    "prices": "unit prices tree",
    "listed groups": "unit prices tree levels",
    "elimination": "order",
    "counting": "links_inside",
}
"""Fields of each kind of proof."""
GroupCase = tuple[frozenset[int], frozenset[int]]


@dataclass(frozen=True, slots=True, kw_only=True)
class VerifiedCuts:
    """Proved: links of weight at least ``lower / scale`` must be cut for groups of at most ``size / size_scale``."""

    lower: int
    scale: int
    size: int
    size_scale: int
    n_robots: int
    n_links: int
    n_protected: int
    proof: str
    leaves: int
    network_hash: str

    def lines(self) -> list[str]:
        """Say in plain text what was proved, and for which network."""
        weight = f"{self.lower}" if self.scale == 1 else f"{self.lower}/{self.scale}"
        size = f"{self.size}" if self.size_scale == 1 else f"{self.size}/{self.size_scale}"
        return [
            f"network: {self.n_robots} robots, {self.n_links} links, {self.n_protected} of them protected; "
            f"SHA-256 of its data {self.network_hash}",
            f"proved in integers: links of weight at least {weight} must be cut so that no group has more than {size} "
            f"(by {self.proof}{f', {self.leaves} leaves' if self.leaves else ''})",
            "not covered: whether the data describe the real network",
        ]


def verify_cuts(
    document: dict[str, Any], *, time_limit: float = SECONDS, limits: VerifierLimits | None = None
) -> VerifiedCuts:
    """Decide a certificate of cuts that is loaded already.

    Raises
    ------
    FileFormatError : a field is missing or is not what it must be.
    ProofError : the proof has a fault; the text names the first one found.
    UndecidedError : neither, within the time.
    """
    with within(limits), limited(time_limit):
        return _decide(document)


def _decide(document: dict[str, Any]) -> VerifiedCuts:
    proof = next((name for name, own in PROOFS.items() if set(document) == {*STATED.split(), *own.split()}), "prices")
    _, _, network, size, claim, *own = fields("", document, f"{STATED} {PROOFS[proof]}")
    lower = index("claim", claim, current().cut_numbers)
    about = _Network(network, index("size", size, current().cut_numbers))
    leaves = about.check(proof, lower, own)
    return VerifiedCuts(
        lower=lower,
        scale=about.scale,
        size=about.size,
        size_scale=about.size_scale,
        n_robots=about.stated_robots,
        n_links=about.stated_links,
        n_protected=about.protected_links,
        proof=proof,
        leaves=leaves,
        network_hash=document_hash(network),
    )


def _pairs(where: str, stated: object, robots: int) -> list[tuple[int, int]]:
    """Different pairs of robots, each in ascending order."""
    found = []
    for pair in array(where, stated):
        i, j = (index("link end", end, robots) for end in array("link", pair, 2))
        need(i < j, f"{where}: a link's ends are not in ascending order")
        found.append((i, j))
    need(len(set(found)) == len(found), f"{where}: a link is given twice")
    return found


def _joined(robots: int, links: list[tuple[int, int]]) -> list[int]:
    """(robots,) the number of each robot's group by these links, groups by their lowest robot."""
    lowest = list(range(robots))
    for i, j in links:
        tick()
        low, high = sorted((lowest[i], lowest[j]))
        lowest = [low if one == high else one for one in lowest]
    number = {low: k for k, low in enumerate(sorted(set(lowest)))}
    return [number[low] for low in lowest]


class _Network:
    """The network as stated, and the parts of links as the leaves so far left them."""

    def __init__(self, stated: object, size: int) -> None:
        count, links, weights, sizes, protected, scale, size_scale = fields(
            "network", stated, "robots links weights sizes protected scale size_scale"
        )
        self.stated_robots, self.size = index("network robots", count, current().cut_numbers), size
        given = _pairs("network links", links, self.stated_robots)
        each = [index("weight", one, current().cut_numbers) for one in array("weights", weights, len(given))]
        own = [index("robot's size", one, current().cut_numbers) for one in array("sizes", sizes, self.stated_robots)]
        need(all(own), "network: a robot has no size")
        joined = _pairs("protected links", protected, self.stated_robots)
        need(set(joined) <= set(given), "network: a protected link is no link")
        self.stated_links, self.protected_links = len(given), len(joined)
        self.stated_weights, self.least_size = each, min(own, default=1)
        node = _joined(self.stated_robots, joined)
        self.robots = 1 + max(node, default=-1)
        self.sizes = [0] * self.robots
        for robot, size_of_robot in enumerate(own):
            self.sizes[node[robot]] += size_of_robot
        between: dict[tuple[int, int], int] = {}
        for (i, j), weight in zip(given, each, strict=True):
            ends = min(node[i], node[j]), max(node[i], node[j])
            if ends[0] != ends[1] and weight:
                between[ends] = between.get(ends, 0) + weight
        self.links = sorted(between)
        self.weights = [between[ends] for ends in self.links]
        self.scale = 1 + index("scale less 1", scale - 1 if type(scale) is int else scale, current().cut_numbers)
        self.size_scale = 1 + index(
            "size scale less 1", size_scale - 1 if type(size_scale) is int else size_scale, current().cut_numbers
        )
        self.near: list[list[int]] = [[] for _ in range(self.robots)]
        for i, j in self.links:
            self.near[i].append(j)
            self.near[j].append(i)
        self.parts = [0] * len(self.links)
        self.unit, self.prices = 1, [0] * self.robots
        self.weight_of = between
        self.gap = -1  # room for the slack of groups that are listed; -1: none are
        self.needed: int | None = None
        self.listed: list[frozenset[int]] = []

    def check(self, proof: str, claim: int, own: list[Any]) -> int:
        """Check a proof of one kind by its own fields; return the leaves of its tree."""
        if proof == "prices":
            return self._check_prices(claim, *own)
        if proof == "listed groups":
            return self._check_list(claim, *own)
        return self._check_elimination(claim, *own) if proof == "elimination" else self._check_counting(claim, *own)

    def _check_prices(self, claim: int, unit: object, prices: object, tree: object) -> int:
        """Check a proof by prices; return the leaves of its tree."""
        leaves = self._walk(unit, prices, tree)
        need(sum(self.weights) - sum(self.prices) // self.unit >= claim, "claim: prices prove less")
        return leaves

    def _check_list(self, claim: int, unit: object, prices: object, tree: object, levels: object) -> int:
        """Check that the tree lists all groups of a partition which cuts less than the claim, and that none is left."""
        need(claim > 0, "claim: less than nothing cannot be cut")
        self.needed = sum(self.weights) - claim + 1
        leaves = self._walk(unit, prices, tree)
        check_levels(self.listed, levels, self.unit * self.needed, self._kept, self.robots)
        return leaves

    def _check_elimination(self, claim: int, order: object) -> int:
        """Check a proof by elimination of robots in an order; it has no leaves."""
        places = [index("robot in order", one, self.robots) for one in array("order", order, self.robots)]
        need(len(set(places)) == self.robots, "order: a robot is named twice")
        proved = cannot_cut_less(places, self.sizes, self.links, self.weights, self.size, claim)
        need(proved, "elimination: less weight is enough")
        return 0

    def _check_counting(self, claim: int, inside: object) -> int:
        """Check a proof by the number of links that groups of so few robots can have; it has no leaves."""
        most = most_links_inside(self.stated_robots, self.size // self.least_size)
        need(
            index("links inside", inside, current().cut_numbers) == most,
            "links inside: not the most that groups can have",
        )
        lightest = sorted(self.stated_weights)[: max(len(self.stated_weights) - most, 0)]
        need(sum(lightest) >= claim, "claim: counting proves less")
        return 0

    def _walk(self, unit: object, prices: object, tree: object) -> int:
        self.unit = 1 + index("unit less 1", unit - 1 if type(unit) is int else unit, current().cut_numbers)
        self.prices = [index("price", price, current().cut_numbers) for price in array("prices", prices, self.robots)]
        if self.needed is not None:
            self.gap = max(sum(self.prices) - self.unit * self.needed, -1)
        return walk("cuts", tree, (frozenset[int](), frozenset[int]()), self.expand)

    def expand(self, node: object, case: GroupCase) -> Iterator[GroupCase]:
        """The cases of a split, the robot inside first; none of a leaf that closes its case."""
        inside, outside = case
        if isinstance(node, dict) and set(node) == {"split"}:
            robot = index("split", node["split"], self.robots)
            need(robot not in inside and robot not in outside, "cuts proof: a robot is split twice")
            yield inside | {robot}, outside
            yield inside, outside | {robot}
            return
        multiplier, changed = fields("leaf", node, "multiplier parts")
        self._change(array("parts", changed))
        self._close(index("multiplier", multiplier, current().cut_numbers), inside, outside)

    def _change(self, changed: list[Any]) -> None:
        need(len(changed) % 2 == 0, "cuts proof: a part of a link is missing")
        for link, part in zip(changed[::2], changed[1::2], strict=True):
            place = index("link of a part", link, len(self.links))
            self.parts[place] = index("part", part, self.unit * self.weights[place] + 1)

    def _close(self, multiplier: int, inside: frozenset[int], outside: frozenset[int]) -> None:
        """Check that a case has no group that fits, or none beyond the bound, or a single one to list."""
        room = self.size - sum(self.sizes[i] for i in inside)
        free = self._free(inside, outside, room) if room >= 0 else set[int]()
        if room < 0 or not (inside or free):
            return
        bound = self._bound(multiplier, room, inside, free)
        if not free and self.gap >= 0 and -self.gap <= bound <= 0:
            self.listed.append(inside)
            check_size("list of groups", len(self.listed), current().cut_groups)
            return
        need(bound <= -1 - self.gap, "cuts proof: a leaf is open")

    def _kept(self, group: frozenset[int]) -> int:
        """Weight of the links inside a group, in units of prices."""
        near = sum(self.weight_of[min(i, j), max(i, j)] for i in group for j in self.near[i] if j in group)
        return near // 2 * self.unit

    def _bound(self, multiplier: int, room: int, inside: frozenset[int], free: set[int]) -> int:
        """The right side above."""
        bound = multiplier * room - sum(self.prices[i] for i in inside)
        given = dict.fromkeys(free, 0)
        for place, (i, j) in enumerate(self.links):
            tick()
            whole = self.unit * self.weights[place]
            if i in free and j in free:
                given[i] += self.parts[place]
                given[j] += whole - self.parts[place]
            elif i in inside and j in inside:
                bound += whole
            elif i in free and j in inside:
                given[i] += whole
            elif j in free and i in inside:
                given[j] += whole
        return bound + sum(max(0, given[i] - self.prices[i] - multiplier * self.sizes[i]) for i in free)

    def _free(self, inside: frozenset[int], outside: frozenset[int], room: int) -> set[int]:
        """Undecided robots that fit and that robots inside reach through such ones; all that fit if none is inside."""
        fit = {i for i in range(self.robots) if i not in inside and i not in outside and self.sizes[i] <= room}
        if not inside:
            return fit
        seen, open_ = set[int](), list(inside)
        while open_:
            for j in self.near[open_.pop()]:
                if j in fit and j not in seen:
                    seen.add(j)
                    open_.append(j)
        return seen
