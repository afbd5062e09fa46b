"""Verification of a worst-case value on any graph, by the sizes of the groups that an attack can leave.

Blinding more robots makes no group better: say that an attack blinds as many as it may, and leaves groups that are all
worth less than the claim. Take the group with the most sensing robots, a of them, and with b blinded ones. By duals (as
in ``duals.py``, and blinded robots cost nothing) the groups cost no more than the slack together. Forms bound from
below the cost of groups of each size, and so the least cost of the others by their sizes alone, as none has more than
a sensing robots. The rest of the slack is the most that the largest one may cost. That decides which a and b are
possible. As any ``size`` robots are worth the claim, a is less. For each that is left, a tree shows that such a group
is worth the claim, or costs more.

A *form* bounds costs from below: let robots I be in the group, and ``count`` of some others, x_i = 1 for these. For any
diagonal u, as x_i^2 = x_i and sum of x = ``count``, the group costs more than a limit if

    cost(x) - limit + sum of u_i (x_i^2 - x_i) > 0      for all real x with sum of x = count,

a quadratic form in (1, x) once one x_i is written by the others; so if that form is positive definite.

Source: for the relaxation, Poljak, Rendl and Wolkowicz, Journal of Global Optimization 7 (1995).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import gcd, inf
from typing import TYPE_CHECKING

from flint import fmpz_mat

from ratt_opt.certificates.verifier.cases import Cases, robots_of
from ratt_opt.certificates.verifier.exact_matrices import is_positive
from ratt_opt.certificates.verifier.limits import limits
from ratt_opt.certificates.verifier.reading import array, fields, index, need, signed
from ratt_opt.certificates.verifier.work import tick
from ratt_opt.errors import UndecidedError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.certificates.verifier.cases import GroupCase

__all__ = ["UNIT", "GroupComposition", "LinkCosts", "check_sizes", "largest_groups", "possible_groups"]

UNIT = 2**10
"""Unit of diagonals."""


def check_sizes(cases: Cases, size: int, *given: object) -> int:
    """Check the proof: its duals, forms, bounds and trees; returns its leaves."""
    duals, forms, bounds, trees = given
    costs, groups = possible_groups(cases, size, duals, forms)
    known: list[tuple[int, list[int]]] = []
    for bound in array("bounds", bounds):
        number, diagonal = fields("bound", bound, "duals diagonal")
        known.append((index("bound duals", number, len(costs)), _integers("bound diagonal", diagonal, cases.about.n)))
    leaves = 0
    for group, tree in zip(groups, array("trees", trees, len(groups)), strict=True):

        def close_by_form(case: GroupCase, number: object, group: GroupComposition = group) -> None:
            vector, diagonal = known[index("lower tree form", number, len(known))]
            missing = group.robots - case.inside.bit_count()
            open_ = case.everyone & ~case.inside & ~case.outside
            more = costs[vector].are_above(group.limits[vector], diagonal, (case.inside, open_), missing)
            need(more, "lower proof: a group of a leaf may cost too little")

        root = cases.groups(group.sensing, group.sensing, group.blinded)
        leaves += cases.check(tree, root, {"form": close_by_form})
    return leaves


def possible_groups(
    cases: Cases, size: int, duals: object, forms: object
) -> tuple[list[LinkCosts], list[GroupComposition]]:
    """Read the costs and their forms; return them and the sizes of a largest group that they leave."""
    about = cases.about
    if about.n > (most := limits().sized_robots):
        raise UndecidedError(f"not decided: sizes of groups are for at most {most} robots")
    costs: list[LinkCosts] = []
    for own in array("duals", duals):
        link, robots = fields("duals", own, "link robots")
        price = index("duals link", link, limits().size_numbers)
        costs.append(LinkCosts(cases.near, about.alpha_c, price, _integers("duals robots", robots, about.n)))
    need(costs, "lower proof: there are no duals")
    for form in array("forms", forms):
        number, robots, least, diagonal = fields("form", form, "duals robots least diagonal")
        one, count = costs[index("form duals", number, len(costs))], index("form robots", robots, about.n + 1)
        one.raise_least(
            count, signed("form least", least, limits().size_numbers), _integers("form diagonal", diagonal, about.n)
        )
    return costs, largest_groups(costs, cases.blinded, size)


def _integers(where: str, given: object, n: int) -> list[int]:
    return [signed(where, value, limits().size_numbers) for value in array(where, given, n)]


class LinkCosts:
    """Costs by one vector of duals.

    ``slack`` : the groups of an attack cost no more together; ``most`` : each of them no more; ``least`` : (N + 1,)
    those of s robots at least ``least[s]``, infinite where an attack leaves none
    """

    def __init__(self, near: list[int], alpha_c: int, link: int, duals: list[int]) -> None:
        self.near, self.link, n = near, link, len(near)
        degrees = [others.bit_count() for others in near]
        self.price = [link * degree - dual for degree, dual in zip(degrees, duals, strict=True)]
        """Cost of each robot if all its links leave the group; each link inside saves twice ``link``."""
        self.step = gcd(2 * link, *self.price) or 1
        self.slack = 2 * link * alpha_c - sum(duals)
        self.most: float = inf if any(duals) else link * alpha_c
        cheap, links = sorted(self.price), sum(degrees) // 2
        saved = [2 * link * min(s * (s - 1) // 2, links) for s in range(n + 1)]
        self.least = [self._left(sum(cheap[:s]) - saved[s]) for s in range(n + 1)]

    def _left(self, cost: int) -> float:
        return cost if cost <= self.most else inf

    def raise_least(self, size: int, least: int, diagonal: list[int]) -> None:
        """Check that groups of ``size`` robots cost at least ``least``, and use it from then on."""
        shown = self.are_above(least - 1, diagonal, (0, (1 << len(self.near)) - 1), size)
        need(shown, "lower proof: groups of a size may cost less")
        self.least[size] = max(self.least[size], self._left(-(-least // self.step) * self.step))

    def are_above(self, limit: float, diagonal: list[int], case: tuple[int, int], count: int) -> bool:
        """Prove that the robots inside and any ``count`` of the others of a case (two masks) cost more than a limit.

        ``diagonal`` : (N,), in units
        """
        tick()
        inside, others = case
        if limit == inf:
            return False
        if count == others.bit_count():
            inside, count = inside | others, 0
        room = sum(self.price[i] - self.link * (self.near[i] & inside).bit_count() for i in robots_of(inside))
        room -= int(limit)
        if not 0 < count < others.bit_count():
            return count != 0 or room > 0
        form = self._form(room, diagonal, inside, list(robots_of(others)))
        size = form.nrows() - 1
        rows = [[int(r == c) for c in range(size)] for r in range(size)] + [[count] + [-1] * (size - 1)]
        written = fmpz_mat(rows)
        return is_positive(written.transpose() * form * written)

    def _form(self, room: int, diagonal: list[int], inside: int, others: list[int]) -> fmpz_mat:
        """Build twice the form, in units."""
        form = fmpz_mat(len(others) + 1, len(others) + 1)
        form[0, 0] = 2 * UNIT * room
        for a, i in enumerate(others, 1):
            charge = self.price[i] - 2 * self.link * (self.near[i] & inside).bit_count()
            form[0, a] = form[a, 0] = UNIT * charge - diagonal[i]
            form[a, a] = 2 * diagonal[i]
            for b, j in enumerate(others[: a - 1], 1):
                form[a, b] = form[b, a] = -2 * self.link * UNIT * (self.near[i] >> j & 1)
        return form


@dataclass(frozen=True, slots=True)
class GroupComposition:
    """Robots that sense and that are blinded in the group, and what it may cost by each vector of duals."""

    sensing: int
    blinded: int
    limits: tuple[float, ...]

    @property
    def robots(self) -> int:
        """All of them."""
        return self.sensing + self.blinded


def largest_groups(costs: list[LinkCosts], n_blinded: int, size: int) -> list[GroupComposition]:
    """List the groups of fewer than ``size`` sensing robots that can be largest if ``n_blinded`` robots are blinded."""
    n_sensing = len(costs[0].near) - n_blinded
    size = min(size, n_sensing + 1)
    tables, found = [list(_others(one.least, n_sensing, n_blinded, size)) for one in costs], []
    for sensing in range(size):
        for blinded in range(n_blinded + 1):
            others = [table[sensing][n_blinded - blinded] for table in tables]
            limits = [min(one.slack - other, one.most) for one, other in zip(costs, others, strict=True)]
            if all(one.least[sensing + blinded] <= limit for one, limit in zip(costs, limits, strict=True)):
                found.append(GroupComposition(sensing, blinded, tuple(limits)))
    return found


def _others(least: list[float], n_sensing: int, n_blinded: int, size: int) -> Iterator[list[float]]:
    """Yield the least costs of the other groups, for a largest group of 0, 1, ... sensing robots.

    Each is a list by the number of blinded robots among the others. The table over c and x has the least cost of groups
    of at most a number of sensing robots each, c together, with x blinded ones together; groups of one size more are
    added one by one.
    """
    best = [[inf] * (n_blinded + 1) for _ in range(n_sensing + 1)]
    best[0][0] = 0.0
    for largest in range(size):
        for count in range(largest, n_sensing + 1):
            tick()
            fewer = best[count - largest]
            for x in range(n_blinded + 1):
                joined = (fewer[x - y] + least[largest + y] for y in range(not largest, x + 1))
                best[count][x] = min(best[count][x], *joined, inf)
        yield list(best[n_sensing - largest])
