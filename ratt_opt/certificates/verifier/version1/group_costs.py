"""What groups cost at prices, and who may be in one that an attack leaves: the terms of ``group_covers.py``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from ratt_opt.certificates.verifier.reading import array, fields, index, indices, need, signed

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

__all__ = ["Case", "Group", "Groups", "Threatened", "mask_of", "robots_of"]

LARGEST = 2**53
"""Of prices, penalties and flows, in size."""

Case = tuple[int, int]
"""Who is inside a group and who is outside, as bit masks; the others are open."""


class Threatened(Protocol):
    """What of a :class:`Statement` says who is linked to whom, and what may be attacked."""

    n: int
    near: list[set[int]]
    safe_robots: frozenset[int]
    safe_links: frozenset[tuple[int, int]]
    links: frozenset[tuple[int, int]]
    alpha_s: int
    alpha_c: int


@dataclass(frozen=True, slots=True)
class Group:
    """A group that an attack may leave, as a bit mask, with its cost, blinded robots at least, and links lost."""

    robots: int
    cost: int
    need: int
    links: int


class Groups:
    """What groups cost at the prices given, and who may be in one."""

    def __init__(self, about: Threatened, half: object, robots: object, blinded: object) -> None:
        self.about, self.everyone = about, (1 << about.n) - 1
        self.half, self.blinded = index("half_link", half, LARGEST), index("blinded", blinded, LARGEST)
        self.robot = [signed("robots", price, LARGEST) for price in array("robots", robots, about.n)]
        self.near = [mask_of(others) for others in about.near]
        self.safe, self.tied = mask_of(about.safe_robots), [0] * about.n
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
            self.triples.append((mask_of(three), 2 * index("half_penalty", half_penalty, LARGEST)))
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
            out[i][j] = amount = signed("flow", given, LARGEST)
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
        lost = sum((self.near[i] & outside).bit_count() for i in robots_of(inside))
        return lost > self.about.alpha_c or any(self.tied[i] & outside for i in robots_of(inside))

    def group_of(self, inside: int) -> Group | None:
        """The group of these robots, if an attack may leave it."""
        if not inside or self.settled((inside, self.everyone & ~inside)) != (inside, self.everyone & ~inside):
            return None
        if self.impossible(inside, self.everyone & ~inside):
            return None
        links = sum((self.near[i] & ~inside).bit_count() for i in robots_of(inside))
        blinded = self.need(inside)
        cost = self.half * links + self.blinded * blinded - self.group - sum(self.robot[i] for i in robots_of(inside))
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
        paid += self.half * sum((self.near[i] & ~inside).bit_count() for i in robots_of(inside))
        paid -= sum(self.robot[i] for i in robots_of(inside))
        paid_for_triples, extra = self._penalties(inside, outside)
        open_ = self.everyone & ~inside & ~outside
        for i in robots_of(open_):
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
            rest = list(robots_of(triple & ~inside & ~outside))
            paid += penalty if within >= 2 else 0
            for i in rest if within == 1 else ():
                extra[i] = extra.get(i, 0) + penalty // len(rest)
        return paid, extra


def robots_of(mask: int) -> Iterator[int]:
    """The bits of a mask, ascending."""
    while mask:
        yield (mask & -mask).bit_length() - 1
        mask &= mask - 1


def mask_of(bits: Iterable[int]) -> int:
    """The mask with these bits."""
    return sum(1 << i for i in bits)
