"""Stages: thresholds over all sets of robots, one after the other.

An attack leaves groups that cover the team. It leaves less than a threshold if in each group blinding some robots does,
no more of them in all than ``alpha_s``, and if the groups are cut off by no more links than ``alpha_c``.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.annealing import Starts
from ratt_opt.attack.bounds import first_bound
from ratt_opt.attack.params import DEFAULT
from ratt_opt.attack.stages.attack_state import AttackState
from ratt_opt.attack.staging import Stage, go_on
from ratt_opt.attack.team import Links, Team
from ratt_opt.attack.thresholds.columns import UNIT, Columns, best_duals
from ratt_opt.attack.thresholds.sets_below import SetsBelow
from ratt_opt.budget import OutOfBudget, Stop
from ratt_opt.graph.communication import robots_of
from ratt_opt.graph.group_list import groups_of
from ratt_opt.setfunctions.metered import Metered, unmetered

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.attack.params import AttackParams
    from ratt_opt.attack.task import AttackTask
    from ratt_opt.budget import Budget
    from ratt_opt.graph.group_list import GroupList
    from ratt_opt.graph.threat import Threat
    from ratt_opt.problem import Attack


__all__ = ["AllSets", "Reachability", "ThresholdsOfFewStage", "ThresholdsStage", "decide"]


class ThresholdsStage(Stage[AttackState]):
    """Stage that decides thresholds over all sets of robots."""

    name = "thresholds"

    def applies(self, attack: AttackState) -> bool:
        """Team of at most 20 robots, and values left for all sets; planar targets: at most 24 robots."""
        return attack.has_table

    def run(self, attack: AttackState) -> Stop:
        """All sets of robots, thresholds one after the other."""
        begun = attack.task.memory.search
        return go_on(attack.task, begun if isinstance(begun, AllSets) else AllSets(attack.task))


class ThresholdsOfFewStage(ThresholdsStage):
    """Stage for teams so small that nothing else need be tried."""

    def applies(self, attack: AttackState) -> bool:
        """Team of at most 12 robots."""
        return attack.n_robots <= attack.task.params.criterion.small

    def run(self, attack: AttackState) -> Stop:
        """Values of all sets, thresholds one after the other; without all values, what single robots prove."""
        try:
            return super().run(attack)
        except (OutOfBudget, KeyboardInterrupt):
            task = attack.task
            task.bracket.raise_lower(first_bound(attack.objective, task.values.plan, attack.threat))
            raise


class AllSets:
    """Resumable search that narrows the bracket by thresholds over all sets.

    The search looks for an attack below the best one known. If there is none, the bracket is closed; if that is left
    open, lower thresholds raise the lower end first.
    """

    def __init__(self, task: AttackTask) -> None:
        self.task = task
        self._threat = task.problem.threat
        self._team = Team.of(task.problem.objective, task.values.plan, task.params)
        self._graph = groups_of(self._threat)
        self._table, self._valued = np.empty(0 if self._team else 2**task.values.n), 0
        self._below: SetsBelow | None = None
        self._starts: Starts | None = None
        self._steps = task.params.all_sets.first_steps

    def run(self) -> Stop:
        """Narrow the task's bracket; raises ``OutOfBudget``."""
        self.task.budget.check()
        below, bracket = self._begun(), self.task.bracket
        threshold, levels = bracket.goal, self.task.params.all_sets.levels
        while not bracket.is_closed or (bracket.lower < bracket.upper and levels > 0):
            answer = decide(
                self._threat,
                below,
                self._graph,
                threshold,
                self.task.budget,
                steps=self._steps,
                params=self.task.params,
            )
            if answer.is_reachable:
                self._offer(answer.groups, answer.blinded)
                if self._starts is not None:  # from a mild attack the threshold would come down in many steps
                    self._anneal(self._starts, bracket.attack)
            elif answer.is_reachable is not None:
                bracket.raise_lower(min(self._value(answer.following), bracket.upper))
            if not bracket.is_closed:
                threshold = self._next(threshold, is_open=answer.is_reachable is None)
            elif answer.is_reachable is False:  # sets of about the same value are told apart if there are few
                threshold, levels = float(np.nextafter(answer.level, np.inf)), levels - 1
            else:
                break
        return Stop.EXHAUSTED

    def _next(self, threshold: float, *, is_open: bool) -> float:
        bracket = self.task.bracket
        width = threshold - bracket.lower
        if not is_open:
            return bracket.goal
        if width > self.task.params.all_sets.narrow * abs(bracket.upper):
            return bracket.lower + width / 2
        self._steps *= self.task.params.all_sets.more
        return bracket.goal

    def _begun(self) -> SetsBelow:
        if self._below is not None:
            return self._below
        if self._team is None:
            self._tabulate()
            self._drop_monotone_bounds()
        source: Team | FloatArray = self._table if self._team is None else self._team
        if self._team is not None and self._team.robots <= self.task.params.all_sets.few:
            source = self._team.all_values()
        if isinstance(source, Team):  # with a table the next threshold is decided sooner than an attack is annealed
            params = self.task.params
            moves = params.all_sets.moves * self._graph.robots
            self._starts = Starts(source, Links.of(self._threat), self._threat, params.annealing, moves=moves)
            self._anneal(self._starts)
        groups, _ = self._graph.all(self.task.budget)
        self._below = SetsBelow(source, self._threat.protected_robots, groups, self._threat.n_blinded)
        return self._below

    def _anneal(self, starts: Starts, near: Attack | None = None) -> None:
        """Offer the best of some annealed attacks, or of one that begins with a known attack."""
        budget = self.task.budget
        try:
            if near is not None:
                starts.near(near, budget)
            else:
                for _ in range(self.task.params.all_sets.starts):
                    starts.next(budget)
        finally:
            if starts.best is not None:
                self.task.offer(starts.best.attack(self._threat))

    def _value(self, robots: int | None) -> float:
        """Return the value of a set (bit mask), rounded as attacks' values are; infinite without a set."""
        if robots is None:
            return np.inf
        return float(self._table[robots]) if self._team is None else self.task.values(robots_of(robots))

    def _offer(self, groups: tuple[int, ...], blinded: int) -> None:
        """Offer an attack, by bit masks."""
        self.task.offer_split(map(robots_of, groups), robots_of(blinded))

    def _tabulate(self) -> None:
        """Value the sets that are not valued yet, by bit mask."""
        values, budget, table = self.task.values, self.task.budget, self._table
        if len(table) - self._valued > budget.evaluations_left:
            raise OutOfBudget(Stop.EVALUATIONS)
        asked = values if isinstance(values.objective, Metered) else Metered(values, budget)
        bits = np.arange(values.n)
        while self._valued < len(table):
            masks = np.arange(self._valued, min(self._valued + self.task.params.all_sets.block, len(table)))
            table[masks] = asked.evaluate((masks[:, None] >> bits & 1).astype(np.bool_))
            self._valued += len(masks)

    def _drop_monotone_bounds(self) -> None:
        """Drop lower bounds that rely on a non-decreasing function, unless the table confirms it.

        The least value of the table holds in any case.
        """
        bracket, table, params = self.task.bracket, self._table, self.task.params.all_sets
        largest = float(np.abs(table).max())
        is_ordered = unmetered(self.task.problem.objective).is_non_decreasing or not _falls(
            table, params.fall * largest
        )
        proved = bracket.lower - params.slack * largest - bracket.rounding if is_ordered else -np.inf
        bracket.lower = max(proved, float(table.min()))


def _falls(table: FloatArray, rounding: float) -> bool:
    """Test whether some set is worth less than one of its subsets, by more than rounding."""
    halves = (table.reshape(-1, 2, 1 << i) for i in range(len(table).bit_length() - 1))
    return any(bool((pairs[:, 1] < pairs[:, 0] - rounding).any()) for pairs in halves)


@dataclass(frozen=True, slots=True)
class Reachability:
    """Answer to a threshold question: ``is_reachable``, or ``None`` if undecided.

    ``level``, ``following`` : if it is not, what every attack leaves at least, and bit mask of the set that is worth it
    ``groups``, ``blinded`` : if it is, bit masks of the groups, and of the blinded robots
    """

    is_reachable: bool | None
    level: float = inf
    following: int | None = None
    groups: tuple[int, ...] = ()
    blinded: int = 0


def decide(
    threat: Threat,
    below: SetsBelow,
    graph: GroupList,
    threshold: float,
    budget: Budget,
    *,
    steps: int,
    params: AttackParams = DEFAULT,
) -> Reachability:
    """Ask ``below`` for the threshold, list columns, bound their master, and search covers within its gap.

    ``steps`` : of the search of covers, columns looked at

    Raises
    ------
    OutOfBudget : the time is up, nodes are spent, or the user interrupted.
    """
    budget.spend()
    groups, cuts = graph.all(budget)
    level, following = below.mark(threshold, budget)
    columns = Columns.of(groups, cuts, below, threat.n_blinded)
    most_cut = 2 * threat.alpha_c
    duals = best_duals(columns, threat.n_blinded, most_cut, budget, params.master).duals
    gap = most_cut * UNIT - duals.claim(threat.n_blinded)
    if gap < 0:
        return Reachability(is_reachable=False, level=level, following=following)
    chosen = columns.within(duals, gap, params.all_sets.most_columns)
    if chosen is None:
        return Reachability(is_reachable=None)
    few, costs = chosen
    places = few.covers(costs, (gap, threat.n_blinded, most_cut)).next(budget, steps)
    if not isinstance(places, list):
        return Reachability(is_reachable=places, level=level, following=following)
    covered = few.groups[places].tolist()
    blinded = sum(group ^ below.largest_inside(group) for group in covered)
    return Reachability(is_reachable=True, groups=tuple(covered), blinded=blinded)
