"""What groups of so many robots score at most, decided in integers: the terms of ``group_sizes.py``.

A group g scores, for prices p of robots, 4 (links inside) - sum of p over g. Let robots I be in it, and ``count`` of
some others, x_i = 1 for these. For any diagonal u, as x_i^2 = x_i and sum of x = ``count``, it scores less than a bound
if

    bound - score(x) + sum of u_i (x_i^2 - x_i) > 0      for all real x with sum of x = count,

a quadratic form in (1, x) once one x_i is written by the others; so if that form is positive definite.

Source: for the relaxation, Poljak, Rendl and Wolkowicz, Journal of Global Optimization 7 (1995).
"""

from __future__ import annotations

from math import gcd, inf
from typing import TYPE_CHECKING

from flint import fmpz_mat

from ratt_opt.certificates.verifier.exact_matrices import is_positive
from ratt_opt.certificates.verifier.reading import need
from ratt_opt.certificates.verifier.version1.group_costs import mask_of, robots_of
from ratt_opt.certificates.verifier.work import tick

if TYPE_CHECKING:
    from ratt_opt.certificates.verifier.version1.group_costs import Threatened

__all__ = ["NONE", "UNIT", "LinkScores"]

UNIT = 2**10
"""Of diagonals."""

NONE = -inf
"""The score of groups that an attack cannot leave."""


class LinkScores:
    """Scores by one vector of prices.

    ``need`` : the groups of an attack score so much together; ``least`` : each of them so much; ``most`` : those of s
    robots at most ``most[s]``, (N + 1,)
    """

    def __init__(self, about: Threatened, price: list[int]) -> None:
        self.n, self.price = about.n, price
        self.near = [mask_of(others) for others in about.near]
        self.step = gcd(4, *price)
        self.need = 4 * len(about.links) - 4 * about.alpha_c - sum(price)
        # For prices of twice the degrees a group scores minus two for each link that it loses.
        of_lost = all(p == 2 * len(others) for p, others in zip(price, about.near, strict=True))
        self.least: float = -2 * about.alpha_c if of_lost else NONE
        cheap, links = sorted(price), len(about.links)
        self.most = [self._left(4 * min(s * (s - 1) // 2, links) - sum(cheap[:s])) for s in range(about.n + 1)]

    def _left(self, score: int) -> float:
        return score if score >= self.least else NONE

    def lower(self, size: int, below: int, diagonal: list[int]) -> None:
        """Take over that groups of so many robots score less, after checking it."""
        shown = self.are_below(below, diagonal, (0, (1 << self.n) - 1), size)
        need(shown, "lower proof: groups of a size may score more")
        self.most[size] = min(self.most[size], self._left((below - 1) // self.step * self.step))

    def are_below(self, bound: int, diagonal: list[int], case: tuple[int, int], count: int) -> bool:
        """Whether the robots inside and any ``count`` of the others of a case (masks of both) are shown to score less.

        ``diagonal`` : (N,), in units
        """
        tick()
        inside, others = case
        if count == others.bit_count():
            inside, count = inside | others, 0
        room = bound + sum(self.price[i] - 2 * (self.near[i] & inside).bit_count() for i in robots_of(inside))
        if not 0 < count < others.bit_count():
            return count != 0 or room > 0
        form = self._form(room, diagonal, inside, list(robots_of(others)))
        size = form.nrows() - 1
        rows = [[int(r == c) for c in range(size)] for r in range(size)] + [[count] + [-1] * (size - 1)]
        written = fmpz_mat(rows)
        return is_positive(written.transpose() * form * written)

    def _form(self, room: int, diagonal: list[int], inside: int, others: list[int]) -> fmpz_mat:
        """Twice the form, in units."""
        form = fmpz_mat(len(others) + 1, len(others) + 1)
        form[0, 0] = 2 * UNIT * room
        for a, i in enumerate(others, 1):
            charge = self.price[i] - 4 * (self.near[i] & inside).bit_count()
            form[0, a] = form[a, 0] = UNIT * charge - diagonal[i]
            form[a, a] = 2 * diagonal[i]
            for b, j in enumerate(others[: a - 1], 1):
                form[a, b] = form[b, a] = -4 * UNIT * (self.near[i] >> j & 1)
        return form
