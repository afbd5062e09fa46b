"""Weak families from prices: of the relaxed attack that keeps most links, group after group is chosen. No claim.

After each choice the program of the other groups is solved again with sets that pay its prices (column generation and
diving: Sadykov, Vanderbeck, Pessoa, Tahiri and Uchoa, INFORMS Journal on Computing 31 (2019)). Where the relaxed attack
ends short of links, the weakest robots left make one more group. Annealing from there finds attacks that it does
not find from random families.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.by_size.family_prices.family_program import Choice, FamilyProgram

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt._validation import BoolArray
    from ratt_opt.attackers.by_size.family_prices.family_program import FamilyPrices
    from ratt_opt.attackers.by_size.family_prices.set_finder import SetFinder
    from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
    from ratt_opt.budget import Budget
    from ratt_opt.graph.threat import Threat

__all__ = ["FamilyDive"]

ROUNDS, SPARE = 10, 0.02
"""Times that sets are added before a choice, at most, and the share of the links to keep that a relaxed attack has to
spare by then: more sets would hardly change it."""
RISE, RISES = 0.01, 5
"""By how much the threshold rises where there is no relaxed attack, and how often before the rest is one group."""
PAID, NODES = 1e-3, 5_000
"""What a robot costs less when sets are asked for that pay, in links, and nodes of a search for sets of a size."""
SEED = 0


class FamilyDive:
    """Makes one family after the other; deterministic."""

    def __init__(self, team: PackedTeam, threat: Threat, finder: SetFinder) -> None:
        self._team, self._threat, self._finder = team, threat, finder
        self._rng = np.random.default_rng(SEED)
        self._known: dict[bytes, tuple[BoolArray, float]] = {}
        for robot in np.eye(len(team.single), dtype=np.bool_):
            self._learn(robot)

    def family(self, threshold: float, budget: Budget) -> tuple[frozenset[int], ...]:
        """Groups that an attack can leave, worth not much more than the threshold if it can; empty where none is met.

        Raises
        ------
        OutOfBudget : the time is up.
        """
        program, rises = FamilyProgram(self._threat, is_scaled=True), 0
        for members, value in self._known.values():
            program.add(members, value)
        while program.kept > 0:
            choice = self._choose(program, threshold, budget) if rises <= RISES else self._last(program)
            if choice is not None:
                program = program.with_choice(choice)
            elif rises > RISES:
                return ()
            else:
                threshold, rises = (1 + RISE) * threshold, rises + 1
        return self._groups(program)

    def sets(self) -> Iterator[frozenset[int]]:
        """All sets met so far."""
        return (frozenset(np.flatnonzero(members).tolist()) for members, _ in self._known.values())

    def _groups(self, program: FamilyProgram) -> tuple[frozenset[int], ...]:
        """The groups chosen, and each of the other robots alone once the strongest are blinded."""
        left = np.flatnonzero(program.free)
        protected = np.isin(left, list(self._threat.protected_robots))
        order = left[np.lexsort((-self._team.single[left], protected))]
        blinded, alone = order[: self._threat.n_blinded], order[self._threat.n_blinded :]
        if not self._threat.protected_robots.isdisjoint(blinded.tolist()):
            return ()
        groups = [frozenset(np.flatnonzero(choice.members).tolist()) for choice in program.chosen]
        return (*groups, *(frozenset([i]) for i in alone.tolist()))

    def _choose(self, program: FamilyProgram, threshold: float, budget: Budget) -> Choice | None:
        """A group that the relaxed attack has, by shares and sizes; ``None`` where there is none."""
        if not self._converge(program, threshold, budget):
            return None
        shares = program.shares(threshold, budget.seconds_left)
        possible = [one for one in shares if _is_possible(program.with_choice(one[1]))]
        if not possible:
            return None
        weights = np.array([share * float(choice.members.sum()) ** 2 for share, choice in possible])
        return possible[int(self._rng.choice(len(possible), p=weights / weights.sum()))][1]

    def _converge(self, program: FamilyProgram, threshold: float, budget: Budget) -> bool:
        """Add sets that pay until a relaxed attack keeps links enough (true) or none are found."""
        has_attack = False
        for _ in range(ROUNDS):
            budget.check()
            prices = program.solve(threshold, budget.seconds_left)
            if prices is None or program.n_seeing <= 0:
                return False
            has_attack = prices.claim <= 0
            if prices.claim <= -SPARE * program.kept or not self._add(program, threshold, prices, budget):
                break
        return has_attack

    def _last(self, program: FamilyProgram) -> Choice | None:
        """The weakest robots left that keep the links still to be kept; ``None`` where all together do not."""
        left = np.flatnonzero(program.free)
        rising = left[np.argsort(self._team.single[left], kind="stable")]
        for size in range(1, program.n_seeing + 1):
            members = np.isin(np.arange(len(program.free)), rising[:size])
            choice = Choice(members, is_largest=program.may_have_blinded)
            if program.links(choice) >= program.kept:
                return choice
        return None

    def _add(self, program: FamilyProgram, threshold: float, prices: FamilyPrices, budget: Budget) -> int:
        """Add sets that pay to the program: how many are new."""
        asked = prices.lowered(prices.claim - PAID * prices.n_seeing)
        found = self._finder.searched(threshold, asked, NODES, budget).found
        return sum(program.add(members, self._learn(members)) for members in found)

    def _learn(self, members: BoolArray) -> float:
        value = self._team.value(np.flatnonzero(members))
        self._known[members.tobytes()] = members, value
        return value


def _is_possible(program: FamilyProgram) -> bool:
    """Whether all robots left, in one group, keep the links that are left to keep."""
    return program.n_seeing >= 0 and program.most_links >= program.kept
