"""Stages of the search for the best plan's lower end: objects with a name, a phase, a condition, and a share."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

from ratt_opt.attack.staging import LEFT_OUT
from ratt_opt.solvers.maxmin.elements import Task
from ratt_opt.solvers.maxmin.incumbent import PROVED
from ratt_opt.solvers.maxmin.known import Known

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.solvers.maxmin.incumbent import Incumbent

__all__ = ["LowerEnd", "PlanPhase", "PlanShare", "PlanStage", "run_plan_stages"]


class PlanPhase(Enum):
    """Moment at which a stage runs, beside the stages of the upper end."""

    BEFORE = "before the upper end"
    BETWEEN = "between its turns"
    AFTER = "after the proof"


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanShare:
    """Part of the remaining budget that a stage may spend.

    ``part`` : of the seconds left; ``max_nodes`` : of its attacks, at most; ``at_least`` : seconds, whatever the part
    """

    part: float = 1.0
    max_nodes: int | None = None
    at_least: float = 0.0


@dataclass(kw_only=True, eq=False)
class LowerEnd:
    """State of the search for the best plan: ``incumbent``, and the ``plans`` that it begins with, RATT's first.

    ``gap``, ``by_rows`` : of the upper end (``known.py``)
    """

    incumbent: Incumbent
    plans: Sequence[IntArray] = ()
    gap: float = 0.0
    by_rows: bool = True

    @cached_property
    def known(self) -> Known:
        """State that the stages of the upper end share; it is built when the first plans are known.

        Both sides together stay within the gap: what the search leaves, and what counts as a proved plan.
        """
        task = Task.of(self.incumbent.problem, self.incumbent.params)
        return Known.of(task, self.incumbent, max(self.gap - PROVED, 0.0), by_rows=self.by_rows)


class PlanStage(ABC):
    """One row of the schedule. The docstrings of ``run`` and ``applies`` are what the table shows."""

    name: ClassVar[str]
    phase: ClassVar[PlanPhase] = PlanPhase.BEFORE

    def applies(self, state: LowerEnd) -> bool:
        """Time is left."""
        return not state.incumbent.budget.is_over

    def share(self, incumbent: Incumbent) -> PlanShare:  # noqa: ARG002  (the shape of a share)
        """Return all of the remaining budget by default."""
        return PlanShare()

    @abstractmethod
    def run(self, state: LowerEnd, budget: Budget) -> bool | None:
        """Improve the best plan, or prove more of it; true if the upper end can go on with what was learnt."""


def run_plan_stages(stages: Sequence[PlanStage], state: LowerEnd, phase: PlanPhase) -> bool:
    """Run the stages of a phase that apply; return whether one of them learnt something for the upper end.

    Raises
    ------
    OutOfBudget : the user interrupted an attack; what it had proved counts.
    """
    learnt = False
    for stage in stages:
        if stage.phase is phase and stage.name not in LEFT_OUT and stage.applies(state):
            share, budget = stage.share(state.incumbent), state.incumbent.budget
            part = budget.part(share.part, max_nodes=share.max_nodes, at_least=share.at_least)
            learnt = bool(stage.run(state, part)) or learnt
    return learnt
