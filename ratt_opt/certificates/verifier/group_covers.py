"""The plan keeps a value under every attack on any graph: no groups that an attack may leave cover the team.

An attack that leaves only groups worth less than the claim partitions the team into connected groups g, blinding b_g
robots in each. In units of which ``half_link`` are half a link, robot i has a price p_i of any sign, a group q >= 0, a
blinded robot costs u >= 0, and three robots T have a penalty s_T >= 0 in a group that holds two of them: one at most
does. With need(g) <= b_g and at least ``fewest`` groups, the costs

    half_link * (links between g and the others) + u need(g) + sum of s_T over |g and T| >= 2 - sum of p_i over g - q

of the attack's groups add up to at most

    slack = 2 half_link alpha_c + u min(alpha_s, robots that may be blinded) + sum of s_T - sum of all p_i - q fewest.

Given are sets X of which any room(X) + 1 robots are worth the claim. So need(g) = max over X of |g and X| - room(X),
and each group holds at most room(X) of those |X| - min(alpha_s, ...) of X at least that see. A tree over who is inside
a group shows that none costs less than nothing and which cost no more than half the slack; these are listed. An attack
leaves one other group at most: a search of disjoint listed groups finds none that are, with all other robots as one
group or none, within the budgets.

Flows bound what a case's groups cost: a flow of at most half_link on each link (of any size on one that is protected)
carries out of a group at most half_link a lost link. Links and triples with decided robots count as they are.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ratt_opt.certificates.verifier.reading import array, fields, index, indices, need, walk
from ratt_opt.certificates.verifier.size_tree import check_size_tree
from ratt_opt.certificates.verifier.work import tick
from ratt_opt.errors import UndecidedError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from ratt_opt.certificates.verifier.statement import Statement
    from ratt_opt.certificates.verifier.worth import Worth

__all__ = ["Covers", "Group", "check_group_covers"]

LARGEST = 2**53
"""Of prices, penalties and flows, in size."""

MOST_COVERS = 1_000_000
"""Steps of the search of partitions: up to a minute."""

Case = tuple[int, int]
"""Who is inside a group and who is outside, as bit masks; the others are open."""


@dataclass(frozen=True, slots=True)
class Group:
    """A group that an attack may leave, as a bit mask, with its cost, blinded robots at least, and links lost."""

    robots: int
    cost: int
    need: int
    links: int


def check_group_covers(about: Statement, part: Any, worth: Worth) -> int:
    """Check the proof; returns its leaves.

    Cases in preorder, i >= 0: robot i is inside the group; or outside. -1: no further robot can be in the group, which
    is listed unless it costs more than half the slack. -2: no group of the case is part of an attack. -3 - k: all of
    them cost more, by the flow and the set of the number k = flow * sets + set.
    """
    names = "kind half_link robots blinded group sets triples flows tree"
    _, half, robots, blinded, group, sets, triples, flows, tree = fields("lower proof", part, names)
    groups, leaves = _Groups(about, half, robots, blinded), 0
    for given in array("sets", sets):
        members, room, proof = fields("set", given, "robots room tree")
        inside, most = indices("set robots", members, about.n), index("set room", room, about.n)
        others = frozenset(range(about.n)).difference(inside)
        leaves += check_size_tree(about.n, most + 1, proof, worth, others)
        groups.sets.append((_mask(inside), most))
    groups.add(group, triples)
    groups.flows = [groups.carried(flow) for flow in array("flows", flows)]
    listed: list[Group] = []

    def expand(node: Any, case: Case) -> Iterator[Case]:
        inside, outside = groups.settled(case)
        open_ = groups.everyone & ~inside & ~outside
        if node == -1:
            need(not open_, "lower proof: a leaf's group is not complete")
            group = groups.group_of(inside)
            need(group is None or group.cost >= 0, "lower proof: a group costs less than nothing")
            listed.extend([group] if group and group.cost <= groups.limit else [])
        elif node == -2:
            need(groups.impossible(inside, outside), "lower proof: a leaf's group may be part of an attack")
        elif type(node) is int and node < 0:
            number = index("lower tree bound", -3 - node, len(groups.flows) * len(groups.sets))
            least = groups.least(inside, outside, *divmod(number, len(groups.sets)))
            need(least > groups.limit, "lower proof: a group of a leaf may cost too little")
        else:
            i = index("lower tree", node, about.n)
            need(open_ >> i & 1, f"lower proof: robot {i} is decided twice")
            yield inside | 1 << i, outside
            yield inside, outside | 1 << i

    leaves += walk("lower", tree, (0, 0), expand)
    covers = Covers(listed, about.n, groups.group_of, groups.need)
    cover = covers.first((groups.slack, groups.most, 2 * about.alpha_c))
    need(cover is None, "lower proof: groups within the budgets cover the team")
    return leaves


class _Groups:
    """What groups cost at the prices given."""

    def __init__(self, about: Statement, half: object, robots: object, blinded: object) -> None:
        self.about, self.everyone = about, (1 << about.n) - 1
        self.half, self.blinded = index("half_link", half, LARGEST), index("blinded", blinded, LARGEST)
        self.robot = [_signed("robots", price) for price in array("robots", robots, about.n)]
        self.near = [_mask(others) for others in about.near]
        self.safe, self.tied = _mask(about.safe_robots), [0] * about.n
        for i, j in about.safe_links:
            self.tied[i] |= 1 << j
            self.tied[j] |= 1 << i
        self.most = min(about.alpha_s, about.n - len(about.safe_robots))
        self.slack = 2 * self.half * about.alpha_c + self.blinded * self.most - sum(self.robot)
        self.sets: list[tuple[int, int]] = []
        self.triples: list[tuple[int, int]] = []
        self.flows: list[list[dict[int, int]]] = []
        self.group = 0

    def add(self, group: object, triples: object) -> None:
        """Read the price of a group, and the triples."""
        self.group, seeing = (
            index("group", group, LARGEST),
            [(r.bit_count() - self.most, room) for r, room in self.sets],
        )
        self.slack -= self.group * max([1, *(-(-number // room) for number, room in seeing if room)])
        for given in array("triples", triples):
            robots, half_penalty = fields("triple", given, "robots half_penalty")
            three = indices("triple robots", array("triple robots", robots, 3), self.about.n)
            self.triples.append((_mask(three), 2 * index("half_penalty", half_penalty, LARGEST)))
            self.slack += self.triples[-1][1]

    @property
    def limit(self) -> int:
        """One group of an attack at most costs more."""
        return max(self.slack // 2, -1)

    def carried(self, flow: object) -> list[dict[int, int]]:
        """By robot and neighbour, what a flow carries there, after checking it."""
        out: list[dict[int, int]] = [{} for _ in range(self.about.n)]
        pairs = sorted(self.about.links)
        for (i, j), given in zip(pairs, array("flow", flow, len(pairs)), strict=True):
            out[i][j] = amount = _signed("flow", given)
            out[j][i] = -amount
            fits = abs(amount) <= self.half or (i, j) in self.about.safe_links
            need(fits, "lower proof: a flow exceeds half a link")
        return out

    def settled(self, case: Case) -> Case:
        """The case with who cannot be in a connected group outside; a robot inside that cannot be stays inside."""
        inside, outside = case
        if not inside:
            return case
        reached = front = inside & -inside
        while front:
            i = front.bit_length() - 1
            new = self.near[i] & ~outside & ~reached
            reached, front = reached | new, front ^ 1 << i | new
        return inside, self.everyone & ~reached

    def impossible(self, inside: int, outside: int) -> bool:
        """Whether no group with these robots, and without those, is left by an attack within the budgets."""
        if inside & outside or self.need(inside) > self.most:
            return True
        if any((inside & robots & self.safe).bit_count() > room for robots, room in self.sets):
            return True
        lost = sum((self.near[i] & outside).bit_count() for i in _robots(inside))
        return lost > self.about.alpha_c or any(self.tied[i] & outside for i in _robots(inside))

    def group_of(self, inside: int) -> Group | None:
        """The group of these robots, if an attack may leave it."""
        if not inside or self.settled((inside, self.everyone & ~inside)) != (inside, self.everyone & ~inside):
            return None
        if self.impossible(inside, self.everyone & ~inside):
            return None
        links = sum((self.near[i] & ~inside).bit_count() for i in _robots(inside))
        blinded = self.need(inside)
        cost = self.half * links + self.blinded * blinded - self.group - sum(self.robot[i] for i in _robots(inside))
        cost += sum(penalty for triple, penalty in self.triples if (triple & inside).bit_count() >= 2)
        return Group(inside, cost, blinded, links)

    def need(self, inside: int) -> int:
        """Robots blinded at least in a group with these."""
        return max((max((inside & robots).bit_count() - room, 0) for robots, room in self.sets), default=0)

    def least(self, inside: int, outside: int, flow: int, chosen: int) -> int:
        """No group of the case costs less, of which at most so many robots of the chosen set see."""
        robots, room = self.sets[chosen]
        seeing = room - (inside & robots).bit_count()
        paid, few, others = self.blinded * max(-seeing, 0) - self.group, [], 0
        paid += self.half * sum((self.near[i] & ~inside).bit_count() for i in _robots(inside))
        paid -= sum(self.robot[i] for i in _robots(inside))
        paid_for_triples, extra = self._penalties(inside, outside)
        open_ = self.everyone & ~inside & ~outside
        for i in _robots(open_):
            cost = extra.get(i, 0) - self.robot[i]
            cost += self.half * ((self.near[i] & outside).bit_count() - (self.near[i] & inside).bit_count())
            cost += sum(amount for j, amount in self.flows[flow][i].items() if open_ >> j & 1)
            if cost < 0 and robots >> i & 1:
                few.append(cost)
            else:
                others += min(cost, 0)
        few.sort()
        seen, blind = few[: max(seeing, 0)], few[max(seeing, 0) :]
        blind = blind[: max(self.most - max(-seeing, 0), 0)]
        return paid + paid_for_triples + others + sum(seen) + sum(min(c + self.blinded, 0) for c in blind)

    def _penalties(self, inside: int, outside: int) -> tuple[int, dict[int, int]]:
        """Of triples with two robots inside, and by open robot its part of those with one: half, or all if alone."""
        paid, extra = 0, dict[int, int]()
        for triple, penalty in self.triples:
            within = (triple & inside).bit_count()
            rest = list(_robots(triple & ~inside & ~outside))
            paid += penalty if within >= 2 else 0
            for i in rest if within == 1 else ():
                extra[i] = extra.get(i, 0) + penalty // len(rest)
        return paid, extra


class Covers:
    """Partitions of n robots into groups, and one more or none, within budgets of costs, needs and links.

    ``last`` : the group of these robots, if they can be one; ``need`` : what any group with them needs. Groups are bits
    of masks: of those that hold a robot, and of those within what is left of each budget.
    """

    def __init__(
        self, groups: list[Group], n: int, last: Callable[[int], Group | None], need: Callable[[int], int]
    ) -> None:
        self.groups, self.n, self.last, self.need = sorted(groups, key=lambda group: group.cost), n, last, need
        self.costs, self.nodes = [group.cost for group in self.groups], 0
        self.holds = [_mask(k for k, group in enumerate(self.groups) if group.robots >> i & 1) for i in range(n)]

    def first(self, budgets: tuple[int, int, int], most: int = MOST_COVERS) -> list[Group] | None:
        """The first partition found; ``None`` without one.

        Raises
        ------
        UndecidedError : neither after so many steps.
        """
        blinded, cut = (range(budget + 1) for budget in budgets[1:])
        self._needs = [_mask(k for k, group in enumerate(self.groups) if group.need <= x) for x in blinded]
        self._links = [_mask(k for k, group in enumerate(self.groups) if group.links <= x) for x in cut]
        self.nodes, self._most = 0, most
        return None if budgets[0] < 0 else self._search((1 << len(self.groups)) - 1, (1 << self.n) - 1, 0, budgets)

    def _search(self, usable: int, left: int, together: int, budgets: tuple[int, int, int]) -> list[Group] | None:
        """Cover ``left`` by usable groups and one with all robots ``together``, if there are any."""
        tick()
        self.nodes += 1
        if self.nodes > self._most:
            raise UndecidedError(f"not decided within {self._most} partitions into groups")
        cost, blinded, cut = budgets
        usable &= self._needs[blinded] & self._links[cut] & (1 << bisect_right(self.costs, cost)) - 1
        together |= _mask(i for i in _robots(left) if not usable & self.holds[i])
        if self.need(together) > blinded:
            return None
        if left == together:
            rest = self.last(left) if left else None
            fits = rest is not None and rest.cost <= cost and rest.need <= blinded and rest.links <= cut
            return [rest] if rest is not None and fits else None if left else []
        i = min(_robots(left & ~together), key=lambda i: (usable & self.holds[i]).bit_count())
        for k in _robots(usable & self.holds[i]):
            group, disjoint = self.groups[k], usable
            for j in _robots(group.robots):
                disjoint &= ~self.holds[j]
            spent = cost - group.cost, blinded - group.need, cut - group.links
            cover = self._search(disjoint, left & ~group.robots, together, spent)
            if cover is not None:
                return [group, *cover]
        return self._search(usable & ~self.holds[i], left, together | 1 << i, budgets)


def _robots(mask: int) -> Iterator[int]:
    """The bits of a mask, ascending."""
    while mask:
        yield (mask & -mask).bit_length() - 1
        mask &= mask - 1


def _mask(bits: Iterable[int]) -> int:
    return sum(1 << i for i in bits)


def _signed(where: str, value: Any) -> int:
    return index(where, value, LARGEST) if type(value) is not int or value >= 0 else -index(where, -value, LARGEST)
