"""The exact attacker of larger teams on any graph: annealed attacks from above, refuted thresholds from below."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.attackers.by_prices.decision import Decision, Verdict
from ratt_opt.attackers.by_prices.starts import Starts
from ratt_opt.attackers.by_prices.team import Links
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from ratt_opt.attackers.by_prices.starts import Split
    from ratt_opt.attackers.by_prices.team import Team
    from ratt_opt.attackers.task import AttackTask

__all__ = ["PriceSearch"]

FIRST_STARTS, FURTHER_STARTS = 12, 4
"""Annealed attacks before the first threshold, and whenever the thresholds get harder: about every fourth start finds
the best attack of 24 robots where it is hardest to find (small worlds and hubs, a third of the robots blinded)."""

ANNEALING_SHARE = 0.3
"""Of the seconds left that the first starts may take, where the limit is short."""

FIRST_REACH = 0.1
"""How far below the attack in hand thresholds are asked first, relative to it; doubled where they stay open."""

FIRST_EFFORT, HARDER = 50_000, 4
"""Nodes of one enumeration before a threshold is left open, and their growth when the lower ones are exhausted."""

BISECTED = 2e-3
"""Relative width below which the attack in hand is tested instead of the middle."""

RESOLUTION = 0.05
"""Share of the bracket below an open threshold that is not worth another bisection: more effort is."""


class PriceSearch:
    """Closes the task's bracket for criteria with compiled code; relies on a non-decreasing objective.

    A node is a node of an enumeration.
    """

    def __init__(self, task: AttackTask, team: Team) -> None:
        self.task = task
        threat = task.problem.threat
        links = Links.of(threat)
        self._starts = Starts(team, links, threat)
        self._decision = Decision(team, links, threat)
        self._reach = FIRST_REACH

    def anneal(self) -> None:
        """Offer the first annealed attacks."""
        self._anneal(FIRST_STARTS, ANNEALING_SHARE)

    def run(self) -> Stop:
        """Refute or reach thresholds; the bracket is valid whenever this stops."""
        bracket, budget = self.task.bracket, self.task.budget
        effort, unknown = FIRST_EFFORT, None
        while not bracket.is_closed:
            threshold = self._threshold(unknown)
            if threshold is None:
                effort, unknown = HARDER * effort, None
                self._anneal(FURTHER_STARTS, ANNEALING_SHARE)
                continue
            answer = self._decision.decide(threshold, budget, budget.nodes_left(effort))
            if answer.verdict is Verdict.REFUTED:
                bracket.raise_lower(threshold)
            elif answer.split is None or not self._offer(answer.split):
                unknown = threshold
            else:
                unknown = None
        return Stop.CLOSED

    def _threshold(self, unknown: float | None) -> float | None:
        """The next threshold to decide; ``None`` where those below the unknown one are too close to it."""
        bracket = self.task.bracket
        near = BISECTED * abs(bracket.upper)
        if unknown is None or unknown > bracket.upper:
            return bracket.goal if bracket.upper - self._floor() <= near else (self._floor() + bracket.upper) / 2
        while unknown - self._floor() <= max(RESOLUTION * (bracket.upper - self._floor()), near):
            if self._floor() <= bracket.lower:
                return None
            self._reach *= 2
        return (self._floor() + unknown) / 2

    def _floor(self) -> float:
        """Thresholds below this are not asked: those close to the attack in hand are refuted as fast."""
        return max(self.task.bracket.lower, (1 - self._reach) * self.task.bracket.upper)

    def _anneal(self, starts: int, share: float) -> None:
        part = self.task.budget.part(share)
        for count in range(starts):
            self.task.budget.check()
            if count and part.stop() is not None:
                return
            split = self._starts.next()
            if split is not None:
                self._offer(split)

    def _offer(self, split: Split) -> bool:
        """Offer an attack and teach its groups to the prices."""
        self._decision.learn(split)
        return self.task.offer(split.attack(self.task.problem.threat))
