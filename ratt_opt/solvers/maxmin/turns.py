"""Time is shared between the search for plans and the proof of the best one's worst case."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from ratt_opt.budget import Budget
    from ratt_opt.solvers.maxmin.plans.incumbent import Incumbent

__all__ = ["Turns"]

SEARCH_SHARE = 0.25
"""Share of the time left that is searched before an unproved plan is attacked exactly."""


class Turns:
    """Says when it is time to stop searching: for good, or to prove the best plan's value."""

    def __init__(self, budget: Budget, incumbent: Incumbent) -> None:
        self.budget, self._incumbent = budget, incumbent
        self._turn = budget.part(SEARCH_SHARE)

    def stop(self) -> Stop | None:
        """Why to stop searching now, if at all."""
        if (stop := self.budget.stop()) not in {None, Stop.NODES}:
            return stop
        return Stop.TIME if self._turn.stop() is Stop.TIME and not self._incumbent.is_proved else None

    def prove(self) -> bool:
        """Attack the best plan exactly; return whether the search can go on, and begin its next turn."""
        goes_on = self._incumbent.prove()
        self._turn = self.budget.part(SEARCH_SHARE)
        return goes_on
