"""A plan within a limit of seconds: RATT's first, which takes milliseconds, then the planner's if it is in time.

A planner that is late or raises an error does not cost the step its plan. If it is late, RATT's is used; if it raised
an error, the better of RATT's and of the rest of the last plan, by the worst case of each.
"""

from __future__ import annotations

import logging
from concurrent.futures import Future
from concurrent.futures import TimeoutError as LateError
from dataclasses import dataclass, field
from functools import partial
from threading import Thread
from time import monotonic
from typing import TYPE_CHECKING

from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.budget import Budget
from ratt_opt.missions.players.planners import AnytimePlanner, elements_of, planned_with
from ratt_opt.solvers.ratt import ratt

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import IntArray
    from ratt_opt.missions.players.planners import Planner
    from ratt_opt.problem import Problem
    from ratt_opt.scenario.planner_world import PlannerWorld

__all__ = ["Planned", "TimedPlanner"]

LOG = logging.getLogger("ratt_opt.tracker")
LATE = "late"


@dataclass(frozen=True, slots=True, eq=False)
class Planned:
    """``elements`` (N,) of a plan; ``fallback`` : why they are not the planner's (``"late"``, its error), or ``""``."""

    elements: IntArray
    fallback: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class PlanRequest:
    """Request of a step: its ``problem``, the ``world`` it comes from, the rest of the last plan to ``start`` from."""

    problem: Problem
    world: PlannerWorld
    start: IntArray


@dataclass(slots=True)
class TimedPlanner:
    """Plans within ``time_limit`` [s] of a step's beginning, or whenever the planner is done if there is no limit.

    ``fallback_nodes`` : of each worst case by which known plans are compared if the planner fails; more prove more and
    take longer (a thousand: some milliseconds). ``search_share`` : of a step's remaining time, for a search: it looks
    at the clock between nodes, and a node takes a while.
    """

    planner: Planner
    time_limit: float | None
    fallback_nodes: int
    search_share: float
    _running: Future[IntArray] | None = field(default=None, init=False, repr=False)

    def __call__(self, asked: PlanRequest, began: float, *, strict: bool) -> Planned:
        """Plan one step. A search begins from the rest of the last plan, and from RATT's plan."""
        try:
            return self._asked(asked, began)
        except Exception as error:
            if strict:
                raise
            LOG.warning("the planner failed: %s: %s", type(error).__name__, error)
            return Planned(self._best_known(asked), f"{type(error).__name__}: {error}")

    def _asked(self, asked: PlanRequest, began: float) -> Planned:
        if self.time_limit is None:
            return Planned(self._whole(asked))
        known = ratt(asked.problem).elements
        left = self.time_limit - (monotonic() - began)
        if self.planner is ratt:
            return Planned(known, LATE if left < 0 else "")
        if left <= 0 or (self._running is not None and not self._running.done()):
            return Planned(known, LATE)  # out of time, or a thread is busy with a plan that nobody waits for
        budget = Budget(self.search_share * left)
        running = self._running = _in_thread(partial(self._within, asked, budget))
        try:
            return Planned(running.result(timeout=left))
        except LateError:
            if running.done():  # the planner itself raised it
                raise
            budget.interrupt()
            return Planned(known, LATE)

    def __getstate__(self) -> tuple[Planner, float | None, int, float]:
        return self.planner, self.time_limit, self.fallback_nodes, self.search_share

    def __setstate__(self, state: tuple[Planner, float | None, int, float]) -> None:
        (self.planner, self.time_limit, self.fallback_nodes, self.search_share), self._running = state, None

    def _best_known(self, asked: PlanRequest) -> IntArray:
        """RATT's plan, or the rest of the last plan if more of that is proved to be left by the worst attack."""
        problem = asked.problem
        plans = [ratt(problem).elements, asked.start]

        def worth(plan: IntArray) -> float:
            return worst_case_attack(problem, plan, max_nodes=self.fallback_nodes, brief=True).lower

        return max(plans, key=worth)

    def _whole(self, asked: PlanRequest) -> IntArray:
        plan, problem = self.planner, asked.problem
        if isinstance(plan, AnytimePlanner):
            return elements_of(plan(problem, start=asked.start), problem)
        return elements_of(planned_with(plan, problem, asked.world), problem)

    def _within(self, asked: PlanRequest, budget: Budget) -> IntArray:
        plan, problem = self.planner, asked.problem
        if isinstance(plan, AnytimePlanner):
            return elements_of(plan.within(problem, budget, asked.start), problem)
        return elements_of(planned_with(plan, problem, asked.world), problem)


def _in_thread(work: Callable[[], IntArray]) -> Future[IntArray]:
    """The result to come of work in a thread that does not keep the program from ending."""
    future: Future[IntArray] = Future()

    def run() -> None:
        try:
            future.set_result(work())
        except BaseException as error:  # noqa: BLE001  (it is raised where the result is asked for)
            future.set_exception(error)

    Thread(target=run, name="planner", daemon=True).start()
    return future
