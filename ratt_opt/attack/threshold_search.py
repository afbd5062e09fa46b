"""The exact attacker of larger teams on any graph: annealed attacks from above, refuted thresholds from below."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from functools import partial
from math import inf, isinf
from typing import TYPE_CHECKING, Protocol

from ratt_opt.attack.annealing import Starts
from ratt_opt.budget import OutOfBudget, Stop

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt.attack.annealing import Partition
    from ratt_opt.attack.pricing import DualPrices, PricingProblem
    from ratt_opt.attack.task import AttackTask
    from ratt_opt.budget import Budget

__all__ = ["Answer", "Threshold", "ThresholdSearch"]

FURTHER_STARTS, NODES_A_START = 4, 50_000
"""Annealed attacks whenever a threshold is left open, and whenever the thresholds get harder: a tenth of a second each
at 30 robots, against seconds; and nodes of a proof for which there is one more, about a twentieth of the time."""

PATIENCE = 3
"""Times the starts that the best attack took. On hubs of 30 robots, (10, 31), the best of 60 was the 33rd, 36th
and 4th with three seeds, and the ones before it the 19th, 34th and 3rd."""

ANNEALING_SHARE, SHORT_SHARE, SHORT = 0.1, 0.3, 3.0
"""Share of the remaining seconds for annealed starts; in a short search another share, up to that many seconds.
At 50 robots of hubs patience took 34 s of 120 at first, the last 27 of them in vain."""

FIRST_EFFORT, HARDER = 500_000, 4
"""Nodes of one enumeration before a threshold is left open, and their growth when the lower ones are exhausted."""

NEAR, BISECTED = 2e-2, 2e-3
"""Relative widths below which the attack in hand is tested instead of the middle, and below which an open threshold
is not bisected. Measured on a disk graph of 24 robots: the test takes 10 s, thresholds from a tenth below a minute."""

LONG, QUARTER = 50_000, 0.25
"""Nodes of a refutation after which the next threshold is no more than a quarter up while the bracket is wider than
``NEAR``. Measured on a small world of 100 robots: 4 % more take ten times the nodes; half-way up, 65 s went for
nothing."""

FOR_ONE, AS_LAST, LEAST = 0.35, 2.0, 10.0
"""Limits of seconds for one threshold while the bracket is wider than ``NEAR``: a share of the remaining seconds,
but at least a multiple of what the last refutation took, and at least a number."""

REACH = 0.25
"""Share of the bracket for the next step if the remaining seconds equal the last refutation's; less with less."""

RESOLUTION = 0.05
"""Share of the bracket below an open threshold that is not worth another bisection: more effort is."""


class Threshold(Enum):
    """Verdict on a threshold."""

    REFUTED = "refuted"
    REACHED = "reached"
    OPEN = "open"


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """``partition`` : an attack below the threshold, if it is reached.

    ``prices`` : that no weak group pays and that claim more links than the budget, if these refuted it
    """

    verdict: Threshold
    partition: Partition | None = None
    prices: DualPrices | None = None


class Decision(Protocol):
    """Decides thresholds for one plan."""

    @property
    def least(self) -> float:
        """No attack leaves less, whatever became of thresholds."""
        ...

    def decide(self, threshold: float, budget: Budget, nodes: int) -> Answer:
        """Decide one threshold; ``OPEN`` after that many nodes."""
        ...

    def learn(self, partition: Partition) -> None:
        """Take note of the groups of an attack."""
        ...


class ThresholdSearch:
    """Closes the task's bracket for criteria with compiled code; relies on a non-decreasing objective.

    A node is a node of an enumeration.

    ``decision`` : of thresholds; ``efforts`` : nodes of a threshold at first, and the most,
    after which the search ends; ``anneals`` : whether attacks are annealed between thresholds
    """

    def __init__(
        self,
        task: AttackTask,
        plan: PricingProblem,
        decision: Decision,
        efforts: tuple[int, float] = (FIRST_EFFORT, inf),
        *,
        anneals: bool = True,
    ) -> None:
        self.task, self.plan = task, plan
        self._starts = Starts(plan.team, plan.links, plan.threat)
        self._decision = decision
        (self._effort, self._last_effort), self._share, self._anneals = efforts, 0.5, anneals
        self._took = 0.0
        """Seconds of the last refutation."""
        self._unknown: float | None = None
        """The lowest threshold left open with this effort, if any."""

    def anneal(self, starts: int) -> None:
        """Offer the first annealed attacks, one of them from the attack in hand."""
        part = _annealing_part(self.task.budget)
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
                self._effort, self._unknown = HARDER * self._effort, None
                self._anneal(FURTHER_STARTS, _annealing_part(budget))
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
                self._share = 0.5 if spent < LONG else QUARTER
            elif answer.partition is None or not self._offer(answer.partition):
                self._unknown, starts = threshold, FURTHER_STARTS
            else:
                self._unknown = None
            if not bracket.is_closed:
                self._anneal(starts + spent // NODES_A_START, _annealing_part(budget))
        return Stop.CLOSED

    def _patience(self) -> float:
        """Share of the seconds left for one threshold: little while the bracket is wide."""
        bracket, left = self.task.bracket, self.task.budget.seconds_left
        if bracket.upper - bracket.lower <= NEAR * abs(bracket.upper) or isinf(left):
            return 1.0
        return min(max(FOR_ONE, max(AS_LAST * self._took, LEAST) / left), 1.0) if left > 0 else 1.0

    def _threshold(self, unknown: float | None) -> float | None:
        """The next threshold to decide; ``None`` if those below the unknown one are too close to it."""
        bracket = self.task.bracket
        width, near = bracket.upper - bracket.lower, NEAR * abs(bracket.upper)
        if unknown is None or unknown > bracket.upper:
            share = self._share if width > near else 0.5
            within_reach = REACH * self.task.budget.seconds_left / self._took if self._took > 0 else 1.0
            if width <= near and within_reach >= share:
                return bracket.goal
            return bracket.lower + min(share, within_reach) * width
        below = unknown - bracket.lower
        return None if below <= max(RESOLUTION * width, BISECTED * abs(bracket.upper)) else bracket.lower + below / 2

    def _anneal(self, starts: int, part: Budget) -> None:
        """Run ``starts`` annealed starts, and more until ``PATIENCE`` times as many as the best attack took."""
        bracket, done = self.task.bracket, 0
        while self._anneals and done < starts and not part.is_over:
            before = bracket.upper
            self._take(self._starts.next, part)
            done += 1
            if bracket.upper < before:
                starts = max(starts, PATIENCE * done)
        self.task.budget.check()

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


def _annealing_part(budget: Budget) -> Budget:
    """Return the part of a budget for annealed starts."""
    return budget.part(ANNEALING_SHARE, at_least=min(SHORT_SHARE * budget.seconds_left, SHORT))
