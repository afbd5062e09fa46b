"""Prices of robots, links and sizes that no weak set pays, by a linear program over the sets known so far.

An attack blinds ``b`` of N robots and leaves groups of the others, of sizes ``s_1 >= s_2 >= ...``; the blinded ones
stay with the largest. Let robots have prices ``w``, and groups prices ``h(s)`` of the largest and ``g(s)`` of the
others by their sizes, and let every set ``S`` worth less than a threshold have

    w(S) <= -g(|S|),    and    w(S) <= -h(|S|).

If all groups are worth less, then ``w(all groups) <= -theta``, where ``theta`` is the least ``h(s_1) + g(s_2) + ...``
over all vectors of sizes that the budgets allow. So there is no such attack where the ``N - b`` smallest prices add up
to more.

Of any vector the groups keep ``sum_k C(s_k, 2) + b s_1 + C(b, 2)`` links, and ``kept`` of all have to stay. Where the
vectors are too many to list, prices are those of links, ``g(s) = mu C(s, 2)`` and ``h(s) = mu (C(s, 2) + b s) - sigma``
with ``mu >= 0``, and ``theta = mu (kept - C(b, 2)) - sigma``. Else sizes have prices of their own beside: attacks mixed
of several vectors keep links enough without any one of them (60 robots, (8, 999), max-eigenvalue: prices of links
claim nothing from 98.0 % of the attack on, prices of sizes claim up to 99.9 % and more).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import comb
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.highs import LinearProgram, rows_of

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.attackers.by_size.family_prices.size_vectors import SizeVectors
    from ratt_opt.graph.threat import Threat

__all__ = ["Choice", "FamilyPrices", "FamilyProgram"]


TAKEN = 1e6
"""What a set pays less for a robot that has a group: more than any set may pay."""
WIDTH = 50.0
"""What a size may cost more or less than its links, in links: keeps prices of sizes of which no set is known yet near
those of links. With 5 links prices claim less as soon; without a bound those of unknown sizes are beyond all sense."""
ROUNDS, ADDED = 100, 20
"""Times that vectors of sizes are added before prices are taken as they are, and how many each time."""
MIXED = 1e-3
"""Share of a relaxed attack that a vector has to have to count."""
SLACK = 1e-7
"""Links by which a vector may cost less than the program says before it is added."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FamilyPrices:
    """``robots`` (N,) : w; ``limits`` (N + 1,) : what a weak set of each size must not exceed, infinite where no group
    has it; ``claim`` [links] : by how much the smallest prices exceed what the groups of an attack then pay: above 0,
    there is none.
    """

    robots: FloatArray
    limits: FloatArray
    claim: float
    n_seeing: int

    def lowered(self, claim: float) -> FamilyPrices:
        """Every robot cheaper, so that less is claimed."""
        return replace(self, robots=self.robots - (self.claim - claim) / self.n_seeing, claim=claim)


@dataclass(frozen=True, slots=True)
class Choice:
    """A group (N,) of an attack, perhaps the largest one, which the blinded robots stay with."""

    members: BoolArray
    is_largest: bool


class FamilyProgram:
    """The linear program for a complete graph; sets may be added, and the threshold changed, at any time.

    Columns: w (N,), a level, and how far each price is below it (N,): the sum of the smallest prices; theta, mu, sigma,
    and what g (N + 1,) and h (N + 1,) are beside prices of links.

    ``vectors`` : of sizes that attacks may have; without them, links are counted
    ``chosen`` : groups that an attack has already; the program, without vectors, is about its other groups
    ``is_scaled`` : links have a price of 1, so that minus the claim is how many links more than necessary a relaxed
    attack keeps; else the scale is free, and the claim 0 where there is such an attack
    """

    def __init__(
        self,
        threat: Threat,
        vectors: SizeVectors | None = None,
        chosen: tuple[Choice, ...] = (),
        *,
        is_scaled: bool = False,
    ) -> None:
        self._threat, self._vectors, self.chosen, self._is_scaled = threat, vectors, chosen, is_scaled
        self._n_robots, self._n_blinded = threat.graph.n_robots, threat.n_blinded
        self.free = np.ones(self._n_robots, dtype=np.bool_)
        self.kept = comb(self._n_robots, 2) - threat.alpha_c - comb(self._n_blinded, 2)
        """Links that the other groups have to keep."""
        for choice in chosen:
            self.free &= ~choice.members
            self.kept -= self.links(choice)
        self.n_seeing = int(self.free.sum()) - self._n_blinded
        self.may_have_blinded = self._n_blinded > 0 and not any(choice.is_largest for choice in chosen)
        self._sets: dict[bytes, tuple[BoolArray, float]] = {}
        self._program: LinearProgram | None = None
        self._threshold = -np.inf
        self._rows: list[Choice | None] = []
        """What each row after the first N says not to pay; ``None`` for a vector of sizes."""
        self._vector_rows: list[int] = []
        sizes = np.arange(self._n_robots + 1, dtype=np.float64)
        self._links = sizes * (sizes - 1) / 2
        self._links_of_largest = self._links + self._n_blinded * sizes

    @property
    def most_links(self) -> int:
        """Links that all robots left keep in one group."""
        size = max(self.n_seeing, 0)
        return comb(size, 2) + (self._n_blinded * size if self.may_have_blinded else 0)

    def with_choice(self, choice: Choice) -> FamilyProgram:
        """The program for an attack with one more group; it knows the same sets."""
        return self._taught(FamilyProgram(self._threat, None, (*self.chosen, choice), is_scaled=self._is_scaled))

    def divided(self, seconds: float = np.inf) -> tuple[FamilyProgram, ...]:
        """The program for some vectors, and for the others, where the last relaxed attack mixes both about equally.

        Empty where it mixes none: then it is of whole groups' shares.
        """
        if self._vectors is None or self._program is None:
            return ()
        duals = np.abs(self._program.solve(seconds).duals[self._n_robots :]).tolist()
        of_vectors = [dual for dual, choice in zip(duals, self._rows, strict=False) if choice is None]
        weights = dict(zip(self._vector_rows, of_vectors, strict=False))
        least = MIXED * sum(weights.values())
        mixed = sorted(which for which, weight in weights.items() if weight > least)
        if len(mixed) < 2:
            return ()
        rising = np.cumsum([weights[which] for which in mixed])
        cut = min(int(np.searchsorted(rising, rising[-1] / 2)), len(mixed) - 2)
        parts = self._vectors.divided(mixed[cut] + 1)
        return tuple(self._taught(FamilyProgram(self._threat, vectors)) for vectors in parts)

    def _taught(self, other: FamilyProgram) -> FamilyProgram:
        """Another program, once it knows the same sets."""
        for members, value in self._sets.values():
            other.add(members, value)
        return other

    def add(self, members: BoolArray, value: float) -> bool:
        """Add a set (N,) of that value; whether it is new, and may be a group beside those chosen."""
        key = members.tobytes()
        if key in self._sets or not self.free[members].all() or not self._roles(int(members.sum())):
            return False
        self._sets[key] = members.copy(), value
        if self._program is not None and value < self._threshold:
            self._append(self._program, [members])
        return True

    def solve(self, threshold: float, seconds: float = np.inf) -> FamilyPrices | None:
        """Prices that no known set worth less pays, and that claim most; ``None`` where the program says nothing."""
        self._set_threshold(threshold)
        assert self._program is not None
        prices = None
        for _ in range(ROUNDS):
            x = self._program.solve(seconds).x
            if len(x) != self._program.n_columns:
                return None
            prices, lacking = self._prices(x)
            if not len(lacking):
                break
            self._append_vectors(self._program, lacking)
        return prices

    def _prices(self, x: FloatArray) -> tuple[FamilyPrices, IntArray]:
        """What the columns say, their theta computed anew; and vectors that the program lacks."""
        n, vectors = self._n_robots, self._vectors
        robots, claimed, lacking = np.where(self.free, x[:n], -TAKEN), float(x[2 * n + 1]), np.empty(0, dtype=np.int64)
        link, bonus = max(float(x[2 * n + 2]), 0.0), float(x[2 * n + 3])
        other, largest = link * self._links, link * self._links_of_largest - bonus
        if vectors is None:
            theta = link * self.kept - bonus
            limits = np.minimum(-other, -largest) if self.may_have_blinded else -other
        else:
            other, largest = other + x[2 * n + 4 : 3 * n + 5], largest + x[3 * n + 5 :]
            costs = vectors.costs(largest, other)
            theta, cheapest = float(costs.min()), np.argsort(costs, kind="stable")[:ADDED]
            lacking = np.setdiff1d(cheapest[costs[cheapest] < claimed - SLACK], self._vector_rows)
            limits = np.minimum(
                np.where(vectors.is_other, -other, np.inf), np.where(vectors.is_largest, -largest, np.inf)
            )
        claim = float(np.sort(robots[self.free])[: self.n_seeing].sum()) + theta
        return FamilyPrices(robots=robots, limits=limits, claim=claim, n_seeing=self.n_seeing), lacking

    def shares(self, threshold: float, seconds: float = np.inf) -> list[tuple[float, Choice]]:
        """How much of each group has the relaxed attack, of known sets worth less, that keeps most links.

        Empty where the program says nothing; of a scaled program.
        """
        self._set_threshold(threshold)
        assert self._program is not None
        duals = np.abs(self._program.solve(seconds).duals[self._n_robots :])
        pairs = zip(duals, self._rows, strict=False)
        return [(float(share), choice) for share, choice in pairs if share > 0 and choice is not None]

    def _set_threshold(self, threshold: float) -> None:
        if self._program is None or threshold != self._threshold:
            self._program, self._threshold, self._rows, self._vector_rows = self._start(), threshold, [], []
            if self._vectors is None:
                self._rows.append(None)
                theta = 2 * self._n_robots + 1
                kept = [([theta, theta + 1, theta + 2], [1.0, -float(self.kept), 1.0])]
                self._program.add_rows(rows_of(kept, -np.inf, 0.0))
            else:
                self._append_vectors(self._program, self._vectors.some())
            self._append(self._program, [members for members, value in self._sets.values() if value < threshold])

    def links(self, choice: Choice) -> int:
        """Links that a group keeps."""
        size = int(choice.members.sum())
        return comb(size, 2) + (self._n_blinded * size if choice.is_largest else 0)

    def _start(self) -> LinearProgram:
        n, most = self._n_robots, float(self._n_robots)
        further = 0 if self._vectors is None else 2 * n + 2
        cost = np.concatenate([np.zeros(n), [self.n_seeing], -1.0 * self.free, [1.0, 0.0, 0.0], np.zeros(further)])
        # No set of the sizes of largest groups may be known.
        bonus = float(comb(n, 2)) if self._vectors is not None else np.inf if self.may_have_blinded else 0.0
        middle = [-np.inf, float(self._is_scaled), -bonus], [np.inf, 1.0, bonus]
        low = np.concatenate([np.full(n, -most), [-np.inf], np.zeros(n), middle[0], np.full(further, -WIDTH)])
        high = np.concatenate([np.full(n, most), np.full(n + 1, np.inf), middle[1], np.full(further, WIDTH)])
        below = [([i, n, n + 1 + i], [-1.0, 1.0, -1.0]) for i in range(n)]
        rows = rows_of(below, -np.inf, 0.0)
        return LinearProgram(cost, low, high, rows=rows, maximise=True)

    def _append(self, program: LinearProgram, sets: list[BoolArray]) -> None:
        """That these sets do not pay."""
        n, entries = self._n_robots, []
        for members in sets:
            robots, size = np.flatnonzero(members).tolist(), int(members.sum())
            for is_largest in self._roles(size):
                choice = Choice(members, is_largest)
                self._rows.append(choice)
                columns, values = [*robots, 2 * n + 2], [*[1.0] * size, float(self.links(choice))]
                if is_largest:
                    columns, values = [*columns, 2 * n + 3], [*values, -1.0]
                if self._vectors is not None:
                    columns = [*columns, (3 * n + 5 if is_largest else 2 * n + 4) + size]
                    values = [*values, 1.0]
                entries.append((columns, values))
        program.add_rows(rows_of(entries, np.full(len(entries), -np.inf), np.zeros(len(entries))))

    def _roles(self, size: int) -> tuple[bool, ...]:
        """Whether a set of that size may be the largest group (true), and another one (false)."""
        if self._vectors is not None:
            return self._vectors.roles(size)
        if size > self.n_seeing:
            return ()
        return (False, True) if self.may_have_blinded else (False,)

    def _append_vectors(self, program: LinearProgram, which: IntArray) -> None:
        """That theta is no more than these vectors cost."""
        assert self._vectors is not None
        n, entries = self._n_robots, []
        for first, others in map(self._vectors.vector, which.tolist()):
            sizes = np.flatnonzero(others)
            links = float(self._links_of_largest[first] + others @ self._links)
            columns = [2 * n + 1, 2 * n + 2, 2 * n + 3, 3 * n + 5 + first, *(2 * n + 4 + sizes).tolist()]
            entries.append((columns, [1.0, -links, 1.0, -1.0, *(-others[sizes]).tolist()]))
        self._rows.extend([None] * len(entries))
        self._vector_rows.extend(which.tolist())
        program.add_rows(rows_of(entries, np.full(len(entries), -np.inf), np.zeros(len(entries))))
