"""A sensor manager that plans for the worst attack on the team."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from stonesoup.base import Property

from ratt_opt.certificates.write import certify
from ratt_opt.errors import InputError
from ratt_opt.interop.stonesoup.nodes import TeamManager, default_option, options
from ratt_opt.interop.stonesoup.problem import PlanningStep, TeamProblem
from ratt_opt.solvers.maxmin.solve import solve_maxmin
from ratt_opt.solvers.ratt import ratt
from ratt_opt.solvers.refined import refined

if TYPE_CHECKING:
    from collections.abc import Collection
    from datetime import datetime

    from ratt_opt.certificates.certification import Certificate
    from ratt_opt.problem import Plan, Problem
    from ratt_opt.solvers.result import MaxMinResult

__all__ = ["METHODS", "RobustSensorManager"]

METHODS = ("ratt", "refined", "maxmin")


class RobustSensorManager(TeamManager, TeamProblem):
    """Choose actions that keep the most information after the worst blinding of sensors and cutting of links.

    At most ``alpha_s`` platforms (or sensors that stand alone) are blinded and ``alpha_c`` links cut; what counts is
    the best group that can still talk. Platforms and sensors given as lists keep their order, sets are ordered by
    their attributes, so that the same team gets the same actions on every run.

    After :meth:`choose_actions`, ``last_problem`` holds the step's :class:`ratt_opt.Problem`, ``last_result`` what the
    planner returned, and ``last_certificate`` the proof, if asked for (``None`` if there were no tracks).
    """

    alpha_s: int = Property(default=1, doc="Number of platforms, or sensors that stand alone, blinded at once.")
    method: str = Property(default="refined", doc="'ratt' (at once), 'refined' (better) or 'maxmin' (the best).")
    time_limit: float = Property(default=None, doc="Seconds for a plan; with it, plans may differ from run to run.")
    max_kicks: int = Property(default=40, doc="Random exchanges of 'refined': more find better plans and take longer.")
    proof: Any = Property(default=None, doc="File for the proof of each 'maxmin' plan; {step} in its name is numbered.")
    seed: int = Property(default=0, doc="Of the random exchanges of 'refined'.")

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        if self.method not in METHODS:
            raise InputError("method", f"must be {', '.join(METHODS[:-1])} or {METHODS[-1]}", self.method)
        if self.proof is not None and self.method != "maxmin":
            raise InputError("proof", "needs method='maxmin'", self.method)
        self.last_step: PlanningStep | None = None
        self.last_result: Plan | MaxMinResult | None = None
        self.last_certificate: Certificate | None = None
        self._steps = 0

    @property
    def last_problem(self) -> Problem | None:
        """The problem of the last step; ``last_step`` knows what its elements stand for."""
        return None if self.last_step is None else self.last_step.problem

    def choose_actions(
        self, tracks: Collection[Any], timestamp: datetime, nchoose: int = 1, **_: Any
    ) -> list[dict[Any, tuple[Any, ...]]]:
        """Return ``[{actionable: actions}]``: for each platform and sensor what to do until ``timestamp``.

        Without tracks everyone does what it does by default.

        Raises
        ------
        InputError : nobody has a choice, a budget is larger than the team, or sensors do not fit the tracks.
        """
        if nchoose != 1:
            raise InputError("nchoose", "must be 1: the best plan is one", nchoose)
        nodes = self.nodes
        self.last_step = self.last_result = self.last_certificate = None
        if not tracks:
            return [{a: default_option(a, timestamp) for node in nodes for a in node.actionables}]
        choices = tuple(tuple(options(a, timestamp) for a in node.actionables) for node in nodes)
        if all(own == [()] for node in choices for own in node):
            rule = "must have actions: use a sensor that turns (RadarRotatingBearingRange) or a platform that moves"
            raise InputError("sensors and platforms", rule, "none")
        self.last_step, self._steps = self.step(nodes, choices, tracks, timestamp), self._steps + 1
        self.last_result = self._planned(self.last_step.problem)
        return [self.last_step.configuration(self.last_result.elements)]

    def _planned(self, problem: Problem) -> Plan | MaxMinResult:
        if self.method == "ratt":
            return ratt(problem)
        if self.method == "refined":
            return refined(problem, time_limit=self.time_limit, seed=self.seed, max_kicks=self.max_kicks)
        result = solve_maxmin(problem, time_limit=self.time_limit)
        if self.proof is not None:
            path = str(self.proof).replace("{step}", str(self._steps))
            self.last_certificate = certify(problem, result, path)
        return result
