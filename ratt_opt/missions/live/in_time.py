"""A plan within a limit of seconds: RATT's first, which takes milliseconds, then the planner's if it is in time."""

from __future__ import annotations

from concurrent.futures import Future
from concurrent.futures import TimeoutError as LateError
from dataclasses import dataclass, field
from functools import partial
from threading import Thread
from time import monotonic
from typing import TYPE_CHECKING

from ratt_opt.budget import Budget
from ratt_opt.missions.players.planners import AnytimePlanner, elements_of
from ratt_opt.solvers.ratt import ratt

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import IntArray
    from ratt_opt.missions.players.planners import Planner
    from ratt_opt.problem import Problem

__all__ = ["InTime", "Planned"]

SEARCH_SHARE = 0.7
"""Share of a step's remaining time for a search. It looks at the clock between nodes, and a node takes a while."""


@dataclass(frozen=True, slots=True, eq=False)
class Planned:
    """``elements`` (N,) of a plan; ``late`` : whether they are RATT's because the planner was late."""

    elements: IntArray
    late: bool


@dataclass(slots=True)
class InTime:
    """Plans within ``time_limit`` [s] of a step's beginning, or whenever the planner is done if there is no limit."""

    planner: Planner
    time_limit: float | None
    _running: Future[IntArray] | None = field(default=None, init=False, repr=False)

    def __call__(self, problem: Problem, start: IntArray, began: float) -> Planned:
        """Plan one step. A search begins from ``start``, the rest of the last plan, and from RATT's plan."""
        if self.time_limit is None:
            return Planned(self._whole(problem, start), late=False)
        known = ratt(problem).elements
        left = self.time_limit - (monotonic() - began)
        if self.planner is ratt:
            return Planned(known, late=left < 0)
        if left <= 0 or (self._running is not None and not self._running.done()):
            return Planned(known, late=True)  # out of time, or a thread is busy with a plan that nobody waits for
        budget = Budget(SEARCH_SHARE * left)
        self._running = _in_thread(partial(self._within, problem, start, budget))
        try:
            return Planned(self._running.result(timeout=left), late=False)
        except LateError:
            budget.interrupt()
            return Planned(known, late=True)

    def __getstate__(self) -> tuple[Planner, float | None]:
        return self.planner, self.time_limit

    def __setstate__(self, state: tuple[Planner, float | None]) -> None:
        (self.planner, self.time_limit), self._running = state, None

    def _whole(self, problem: Problem, start: IntArray) -> IntArray:
        plan = self.planner
        found = plan(problem, start=start) if isinstance(plan, AnytimePlanner) else plan(problem)
        return elements_of(found, problem)

    def _within(self, problem: Problem, start: IntArray, budget: Budget) -> IntArray:
        plan = self.planner
        found = plan.within(problem, budget, start) if isinstance(plan, AnytimePlanner) else plan(problem)
        return elements_of(found, problem)


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
