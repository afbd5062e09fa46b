"""Stage: exact attacks on the best plan, between the turns of the upper end."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.budget import Stop
from ratt_opt.solvers.maxmin.incumbent import PROVED
from ratt_opt.solvers.maxmin.plan_stage import PlanPhase, PlanStage

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt._validation import IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.solvers.maxmin.incumbent import Incumbent
    from ratt_opt.solvers.maxmin.plan_stage import LowerEnd

__all__ = ["ProofStage"]


class ProofStage(PlanStage):
    """Stage that proves the best plan's value; what it learns instead lets the upper end go on."""

    name = "proof"
    phase = PlanPhase.BETWEEN

    def applies(self, state: LowerEnd) -> bool:
        """The best plan's value is not proved, and time is left."""
        return not state.incumbent.is_proved and state.incumbent.budget.stop() in {None, Stop.NODES}

    def run(self, state: LowerEnd, budget: Budget) -> bool:  # noqa: ARG002  (attacks have shares of the whole)
        """Attack the best plan exactly, before it one of which more is proved; on networks both in a race.

        True if another plan may be the best now, with which the search goes on.
        """
        incumbent = state.incumbent
        level, best = incumbent.candidates.level, incumbent.candidates.best
        for plan, share in _contenders(incumbent):
            aim = _aim(incumbent) if plan is best else -np.inf
            incumbent.proved.attack(plan, incumbent.budget.part(share), aim)
            # Where several plans are worth the same, the level stays as the first of them falls.
            if incumbent.is_proved or incumbent.candidates.level < level or incumbent.candidates.best is not best:
                return True
        return False


def _contenders(incumbent: Incumbent) -> Iterator[tuple[IntArray, float]]:
    """Plans to attack one after the other, the best one last, and the shares of the time left for them.

    On networks the first plan and the best one have a while each, then the one of which more is proved.
    """
    shares, best, rival = incumbent.params.incumbent, incumbent.candidates.best, _rival(incumbent)
    if rival is not None:
        incumbent.rivals.add(rival.tobytes())
        if incumbent.adversary.on_network:
            yield rival, shares.race
            yield best, shares.race
            if np.array_equal(incumbent.proved.elements, rival):
                yield rival, 1.0
        else:
            yield rival, shares.rival
    yield best, 1.0


def _aim(incumbent: Incumbent) -> float:
    """Return the value of the best plan under attack at which a search for other plans comes before its proof."""
    limit, level, shares = incumbent.budget.time_limit, incumbent.candidates.level, incumbent.params.incumbent
    if not incumbent.adversary.on_network or limit is None or incumbent.budget.elapsed > shares.early * limit:
        return -np.inf
    return level - shares.left_early * (level - incumbent.proved.lower)


def _rival(incumbent: Incumbent) -> IntArray | None:
    """The plan of which most is proved, unless it is the best one, was a rival, or no more is to be proved of it.

    On networks the first plan. None without a time limit: then the proof of the best one comes to its end.
    """
    on_network, is_limited = incumbent.adversary.on_network, np.isfinite(incumbent.budget.seconds_left)
    plan = incumbent.candidates.first if on_network else incumbent.proved.elements
    was_rival = plan.tobytes() in incumbent.rivals and not on_network
    if was_rival or not is_limited or np.array_equal(plan, incumbent.candidates.best):
        return None
    lower, rounding = incumbent.proved.lower, incumbent.problem.objective.rounding
    return plan if incumbent.pool.plan_value(plan) > lower * (1 + PROVED) + rounding else None
