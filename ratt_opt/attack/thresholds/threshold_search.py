"""The exact attacker of larger teams on any graph: annealed attacks from above, refuted thresholds from below."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from enum import Enum
from functools import partial
from math import inf, isinf
from typing import TYPE_CHECKING

from ratt_opt.attack.annealing import Starts
from ratt_opt.budget import OutOfBudget, Stop

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt.attack.annealing import Partition
    from ratt_opt.attack.task import AttackTask
    from ratt_opt.attack.thresholds.pricing import DualPrices, PricingProblem
    from ratt_opt.budget import Budget

__all__ = ["Answer", "Decision", "Threshold", "ThresholdSearch"]


class Threshold(Enum):
    """Verdict on a threshold."""

    REFUTED = "refuted"
    REACHED = "reached"
    OPEN = "open"


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """Answer of a decision: the verdict and what proves it.

    ``partition`` : an attack below the threshold, if it is reached; ``prices`` : if they refuted it, dual prices at
    which no group below it has a negative reduced cost, and that claim more links than the budget
    """

    verdict: Threshold
    partition: Partition | None = None
    prices: DualPrices | None = None


class Decision(ABC):
    """Decision of thresholds for one plan."""

    @property
    def least(self) -> float:
        """No attack leaves less, whatever became of thresholds."""
        return -inf

    @abstractmethod
    def decide(self, threshold: float, budget: Budget, nodes: int) -> Answer:
        """Decide one threshold; ``OPEN`` after that many nodes.

        Raises
        ------
        OutOfBudget : the time is up.
        """

    def learn(self, partition: Partition) -> None:  # noqa: B027  (not all decisions learn)
        """Take note of the groups of an attack."""


class ThresholdSearch:
    """Search by thresholds that closes the task's bracket; relies on compiled code and a non-decreasing objective.

    A node is a node of an enumeration.

    ``decision`` : of thresholds; ``efforts`` : nodes of a threshold at first, and the most,
    after which the search ends, by default without end; ``anneals`` : whether attacks are annealed between thresholds
    """

    def __init__(
        self,
        task: AttackTask,
        plan: PricingProblem,
        decision: Decision,
        efforts: tuple[int, float] | None = None,
        *,
        anneals: bool = True,
    ) -> None:
        self.task, self.plan = task, plan
        self._starts = Starts(plan.team, plan.links, plan.threat, plan.team.params.annealing)
        self._decision = decision
        self._params, self._share, self._anneals = plan.team.params.threshold, 0.5, anneals
        self._effort, self._last_effort = (self._params.effort, inf) if efforts is None else efforts
        self._took = 0.0
        """Seconds of the last refutation."""
        self._unknown: float | None = None
        """The lowest threshold left open with this effort, if any."""

    def anneal(self, starts: int) -> None:
        """Offer the first annealed attacks, one of them from the attack in hand."""
        part = self._annealing_part()
        self._take(partial(self._starts.near, self.task.bracket.attack), part)
        self._anneal(starts, part)

    def run(self) -> Stop:
        """Refute or reach thresholds; the bracket is valid whenever this stops, and from there it can go on."""
        bracket, budget = self.task.bracket, self.task.budget
        while not bracket.is_closed:
            threshold = self._threshold(self._unknown)
            if threshold is None:
                if self._effort > self._last_effort:
                    return Stop.HEURISTIC
                self._effort, self._unknown = self._params.harder * self._effort, None
                self._anneal(self._params.starts, self._annealing_part())
                continue
            before, began, starts, answer = budget.nodes, budget.elapsed, 0, Answer(verdict=Threshold.OPEN)
            with budget.stage(self._patience()) as part:
                answer = self._decision.decide(threshold, part, part.nodes_left(self._effort))
                if answer.verdict is Threshold.REFUTED:
                    bracket.raise_lower(threshold)
            bracket.raise_lower(self._decision.least)
            spent = budget.nodes - before
            if answer.verdict is Threshold.REFUTED:
                self._took = budget.elapsed - began
                self._share = 0.5 if spent < self._params.long else self._params.quarter
            elif answer.partition is None or not self._offer(answer.partition):
                self._unknown, starts = threshold, self._params.starts
            else:
                self._unknown = None
            if not bracket.is_closed:
                self._anneal(starts + spent // self._params.nodes_of_start, self._annealing_part())
        return Stop.CLOSED

    def _patience(self) -> float:
        """Share of the seconds left for one threshold: little while the bracket is wide."""
        bracket, left, params = self.task.bracket, self.task.budget.seconds_left, self._params
        if bracket.upper - bracket.lower <= params.near * abs(bracket.upper) or isinf(left):
            return 1.0
        return min(max(params.for_one, max(params.as_last * self._took, params.least) / left), 1.0) if left > 0 else 1.0

    def _threshold(self, unknown: float | None) -> float | None:
        """The next threshold to decide; ``None`` if those below the unknown one are too close to it."""
        bracket, params = self.task.bracket, self._params
        width, near = bracket.upper - bracket.lower, params.near * abs(bracket.upper)
        if unknown is None or unknown > bracket.upper:
            share = self._share if width > near else 0.5
            within_reach = params.reach * self.task.budget.seconds_left / self._took if self._took > 0 else 1.0
            if width <= near and within_reach >= share:
                return bracket.goal
            return bracket.lower + min(share, within_reach) * width
        below = unknown - bracket.lower
        return (
            None
            if below <= max(params.resolution * width, params.bisected * abs(bracket.upper))
            else bracket.lower + below / 2
        )

    def _anneal(self, starts: int, part: Budget) -> None:
        """Run ``starts`` annealed starts, and more until ``PATIENCE`` times as many as the best attack took."""
        bracket, done = self.task.bracket, 0
        while self._anneals and done < starts and not part.is_over:
            before = bracket.upper
            self._take(self._starts.next, part)
            done += 1
            if bracket.upper < before:
                starts = max(starts, self._params.patience * done)
        self.task.budget.check()

    def _annealing_part(self) -> Budget:
        """Return the part of the budget for annealed starts."""
        budget, params = self.task.budget, self._params
        return budget.part(params.annealing_share, at_least=min(params.short_share * budget.seconds_left, params.short))

    def _take(self, start: Callable[[Budget], Partition | None], part: Budget) -> None:
        """Offer the outcome of a start; where its part of the budget ends first, the best one so far."""
        try:
            partition = start(part)
        except OutOfBudget:
            partition = self._starts.best
        if partition is not None:
            self._offer(partition)

    def _offer(self, partition: Partition) -> bool:
        """Offer an attack and teach its groups to the prices."""
        self._decision.learn(partition)
        return self.task.offer(partition.attack(self.task.problem.threat))
