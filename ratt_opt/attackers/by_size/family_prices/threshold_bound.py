"""Thresholds that no attack on a complete graph stays below, by prices that no weak set pays: lower ends, no attacks.

Thresholds between both ends are asked. For each, sets are added to the program of the prices, most of them annealed,
until a search finds no more; the threshold is refuted if the prices still claim something (a cutting-plane method for
a Lagrangian dual: Geoffrion, Mathematical Programming Study 2 (1974)). What claims nothing for the sets known is beyond
the reach of such prices, whatever else is found; where the relaxed attack then mixes vectors of sizes, some of them and
the others have prices of their own.
"""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.by_size.family_prices.family_program import FamilyProgram
from ratt_opt.attackers.by_size.family_prices.set_finder import SetFinder
from ratt_opt.attackers.by_size.family_prices.size_vectors import SizeVectors

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from ratt_opt._validation import BoolArray
    from ratt_opt.attackers.by_size.family_prices.family_program import FamilyPrices
    from ratt_opt.attackers.by_size.family_prices.paying_sets import Sets
    from ratt_opt.attackers.task import AttackBracket
    from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
    from ratt_opt.budget import Budget
    from ratt_opt.graph.survivor_sizes import Sizes
    from ratt_opt.graph.threat import Threat

__all__ = ["LARGEST", "ThresholdBound"]

LARGEST = 200
"""Robots up to which a bound on pairs of all of them takes some milliseconds."""
NEAR = 2e-4
"""Relative width between what is refuted and what is out of reach, or the attack, not worth another threshold."""
FIRST_EFFORT, QUICK_EFFORT, HARDER = 400_000, 300_000, 4
"""Nodes of a size before a threshold is left open, some milliseconds each or (quick ones) microseconds, and their
growth when the lower ones are refuted."""
OPEN_SHARE = 0.3
"""Share of what is between the lower end and an open threshold that is not worth another one with the same effort."""
STEP, LONG_STEP, WIDE = 2.0, 4.0, 0.0095
"""What is left to the lowest threshold not refuted is divided by it for the next one: by the second one where more than
such a share of the attack is left and searches take long. Those are of the sizes of which least is proved first, so
that one that does not end has proved most of what it could. Where 1 % is left, long steps left more at 60 robots,
(8, 999), trace."""
PROMISING = 30.0
"""Seconds left from which the first threshold is that share below the attack: then nothing is gained by lower ones
before, nor by higher ones that do not end (60 robots, (0, 1226), log-det, 60 s: 97.66 % and 99.42 % left 1.4 %, 99.05 %
at once 0.95 %). With a limit of 20 s it proved nothing in time."""
EASY = 0.95
"""Share of the time that a threshold refuted soon leaves of what it had."""
FIRST_MOVES, LONGER, MOST_MOVES = 3_000, 2, 24_000
"""Annealing moves around each robot, their growth where the search finds sets that they missed, and a limit."""
PULLED = 0.5
"""Share of the claim that prices keep while sets are annealed. Refuting 92 and 96 % of an attack (60 robots, log-det)
takes 8 and 6 s with the whole claim, 1 and 2 s with half of it, 1 and 2 s with none."""
AHEAD = 0.5
"""How far above a threshold, of what is between it and the lowest one out of reach, or the attack, the prices are for
which it is asked. Sets that pay such prices and are worth less than the threshold are further from being: at 60 robots,
(8, 999), log-det, minorants lack 5 instead of 10 of 260 for sets of 24, and 98 % of the attack is refuted in 5 s."""
MOST_PARTS = 30
"""Parts of the vectors of sizes with prices of their own, at most. Of 60 robots, (17, 1226), log-det, prices of all
vectors claim nothing from 98.8 % of the attack on, those of each vector 20 links and more at 99.2 %."""
NARROW = 3e-3
"""How far above the lower end, relative to the attack, prices are out of reach where vectors are divided: each part
takes as long as all. At 60 robots, (8, 1454), log-det, five parts from the second threshold on left 3.4 % after 40 s,
none until prices are so near 1.4 %."""
CLAIM = 1e-3
"""Links that prices have to claim: well above rounding in sums of prices and the program's tolerances."""


class _Verdict(Enum):
    """What is known of a threshold."""

    REFUTED, OPEN, OUT_OF_REACH = range(3)


class ThresholdBound:
    """Raises the lower end of a bracket; relies on a non-decreasing objective.

    ``vectors`` : of sizes that decide; without them, all that keep links enough
    ``known`` : sets of robots to begin with, such as the groups of attacks
    """

    def __init__(
        self,
        team: PackedTeam,
        threat: Threat,
        vectors: Sequence[Sizes] | None = None,
        known: Iterable[frozenset[int]] = (),
    ) -> None:
        self._team, self._n_robots = team, len(team.single)
        sizes = None if vectors is None else SizeVectors(self._n_robots, vectors)
        self._finder = SetFinder(team, self._n_robots - threat.n_blinded)
        self._programs = [FamilyProgram(threat, sizes)]
        """Each for a part of the vectors; a threshold is refuted if it is for each."""
        self._moves, self._effort = FIRST_MOVES, QUICK_EFFORT if self._finder.is_quick else FIRST_EFFORT
        self._beyond, self._unknown = np.inf, np.inf
        """The lowest thresholds out of reach, and left open with this effort."""
        self.has_left_open = False
        """Whether a search for sets that pay was given up."""
        self._easy = 0
        """Thresholds refuted soon, one after the other: the next is twice as near to what is not refuted."""
        self.learn(frozenset([i]) for i in range(self._n_robots))
        self.learn(known)

    def learn(self, groups: Iterable[frozenset[int]]) -> None:
        """Sets for the program to know."""
        self._learn_all([np.isin(np.arange(self._n_robots), list(group)) for group in groups])

    def run(self, bracket: AttackBracket, budget: Budget) -> None:
        """Ask thresholds until the bracket closes or prices reach no further.

        Raises
        ------
        OutOfBudget : the nodes are spent, the time is up, or the user interrupted; the bracket has what was proved.
        """
        while (threshold := self._threshold(bracket, budget.seconds_left)) is not None:
            left, aim = budget.seconds_left, self._aim(threshold, bracket)
            verdict = self._decide(threshold, aim, bracket, budget)
            is_easy = verdict is _Verdict.REFUTED and budget.seconds_left >= EASY * left
            self._easy = self._easy + 1 if is_easy else 0
            if verdict is _Verdict.REFUTED:
                bracket.raise_lower(threshold)
            elif verdict is _Verdict.OPEN:
                self._unknown, self.has_left_open = threshold, True
            else:
                self._beyond = aim

    def _aim(self, threshold: float, bracket: AttackBracket) -> float:
        """The threshold whose prices are asked; the same where searches end as soon as prices are found."""
        top = min(bracket.goal, self._beyond)
        return threshold if self._finder.is_quick else threshold + AHEAD * (top - threshold)

    def _threshold(self, bracket: AttackBracket, seconds: float) -> float | None:
        """The next threshold to ask with so many seconds left; ``None`` where none is worth it."""
        top, near = min(bracket.goal, self._beyond), NEAR * abs(bracket.upper)
        room = top - bracket.lower
        if bracket.is_closed or room <= 0 or (room <= near and self._beyond <= bracket.goal):
            return None
        if self._unknown - bracket.lower <= max(OPEN_SHARE * room, near):
            self._effort, self._unknown = HARDER * self._effort, np.inf
        if room <= near:
            return bracket.goal
        high = min(top, self._unknown)
        width = WIDE * abs(bracket.upper)
        is_long = not self._finder.is_quick and high - bracket.lower > width
        if is_long and high == bracket.goal and seconds >= PROMISING:
            return bracket.upper - width
        return float(high - (high - bracket.lower) / ((LONG_STEP if is_long else STEP) * 2**self._easy))

    def _decide(self, threshold: float, aim: float, bracket: AttackBracket, budget: Budget) -> _Verdict:
        """Refute a threshold for all vectors, in parts if one relaxed attack mixes them."""
        waiting, lower, upper = list(self._programs), bracket.lower, bracket.upper
        while waiting:
            program = waiting.pop()
            verdict = self._decide_part(program, threshold, aim, None if waiting else bracket, budget)
            is_near = aim - lower <= NARROW * abs(upper)
            if verdict is _Verdict.OUT_OF_REACH and is_near and len(self._programs) < MOST_PARTS:
                parts = program.divided(budget.seconds_left)
                if parts:
                    self._beyond = np.inf
                    self._programs = [one for one in self._programs if one is not program] + list(parts)
                    waiting.extend(parts)
                    continue
            if verdict is not _Verdict.REFUTED:
                return verdict
        return _Verdict.REFUTED

    def _decide_part(
        self, program: FamilyProgram, threshold: float, aim: float, bracket: AttackBracket | None, budget: Budget
    ) -> _Verdict:
        """Add sets that pay the prices of ``aim`` until there is none below the threshold, or they claim nothing.

        Of a threshold that is left open the bracket, if given, has what the sets are worth at least that may pay.
        They are annealed as long as that finds more of them in a second than the last search did.
        """
        rate, is_annealing = 0.0, True
        while True:
            budget.check()
            prices = program.solve(aim, budget.seconds_left)
            if prices is None:
                budget.check()
                return _Verdict.OPEN
            if prices.claim <= CLAIM:
                return _Verdict.OUT_OF_REACH
            if is_annealing and not self._finder.is_quick:
                began = budget.elapsed
                found = self._anneal(aim, prices.lowered(PULLED * prices.claim), budget)
                is_annealing = found > rate * (budget.elapsed - began)
                if found:
                    continue
            began = budget.elapsed
            sets = self._search(threshold, prices.lowered(CLAIM / 2), bracket, budget)
            if sets.is_complete:
                return _Verdict.REFUTED
            if not (found := self._learn_all(sets.found)):
                return _Verdict.OPEN
            rate, is_annealing = found / max(budget.elapsed - began, 1e-9), True
            self._moves = min(LONGER * self._moves, MOST_MOVES)

    def _search(self, threshold: float, prices: FamilyPrices, bracket: AttackBracket | None, budget: Budget) -> Sets:
        """Sets that pay; however that ends, the bracket, if given, has what all are worth at least that may."""
        if self._finder.is_quick:
            sets = self._finder.searched(threshold, prices, self._effort, budget)
            if not sets.found and bracket is not None:
                bracket.raise_lower(min(sets.lower, threshold))
            return sets
        try:
            return self._finder.decided(threshold, prices, self._effort, budget)
        finally:
            if bracket is not None:
                bracket.raise_lower(min(self._finder.proved, threshold))

    def _anneal(self, threshold: float, prices: FamilyPrices, budget: Budget) -> int:
        """Sets that pay, with each robot: how many are new."""
        return self._learn_all(self._finder.annealed(threshold, prices, CLAIM, self._moves, budget))

    def _learn_all(self, sets: list[BoolArray]) -> int:
        """How many of these are new."""
        return sum(self._learn(members) for members in sets)

    def _learn(self, members: BoolArray) -> bool:
        value = self._team.value(np.flatnonzero(members))
        return sum(program.add(members, value) for program in self._programs) > 0
