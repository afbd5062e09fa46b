"""The main job as one call: plan, attack, bound, guarantee."""

from __future__ import annotations

import time
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np

from ratt_opt.attackers.exact import worst_case_attack
from ratt_opt.bounds.guarantees import all_guarantees
from ratt_opt.bounds.instance import instance_bound
from ratt_opt.certificates.write import certify, why_not_certifiable
from ratt_opt.curvatures.curvature import curvature, total_curvature
from ratt_opt.curvatures.domains import LARGEST_ENUMERATION
from ratt_opt.errors import InputError
from ratt_opt.problem import Plan, Problem
from ratt_opt.scenario.threat_fields import OBJECTIVES
from ratt_opt.setfunctions.base import LARGEST_TABLE
from ratt_opt.setfunctions.criteria.logdet import LogDetObjective
from ratt_opt.setfunctions.information import InformationObjective
from ratt_opt.solvers.baselines import greedy, myopic, nonrobust_search, random_plan
from ratt_opt.solvers.maxmin.solve import check_limits, solve_maxmin
from ratt_opt.solvers.ratt import equivalent_sensing_attacks, ratt
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from pathlib import Path

    from ratt_opt._validation import IntArray
    from ratt_opt.attackers.result import AttackResult
    from ratt_opt.bounds.guarantees import Guarantee
    from ratt_opt.certificates.write import Certificate
    from ratt_opt.curvatures.curvature import Curvature
    from ratt_opt.solvers.result import MaxMinResult

__all__ = ["BoundReport", "PlanAssessment", "bound"]

ATTACK_SHARE, NONROBUST_SHARE, OPTIMUM_SHARE, CURVATURE_SHARE = 0.08, 0.1, 0.75, 0.5
"""Share of the time left that each attack, and each of the later searches, may take. The non-robust
optimum is a baseline where it is proved in its share."""
LEAST_SECONDS = 1e-3
CURVATURE_GAP = 0.1
"""A curvature is bracketed until ``(1 - lower) / (1 - upper)`` is at most one plus this."""
SECONDS_BETWEEN_LINES = 1.0
RANDOM_SEED = 0
"""Seed of the random baseline, so that a report is reproducible."""


@runtime_checkable
class HasProblem(Protocol):
    """Anything that becomes a problem: a scenario, or the contents of a model-free file."""

    def problem(self, objective: str = "trace") -> Problem:
        """Return the max-min problem for one objective."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanAssessment:
    """One planner's plan and its worst case.

    ``elements`` : (N,) flat element indices; ``controls`` : their positions among each robot's
    own elements; ``bait`` : RATT's bait robots, empty for other planners.
    """

    name: str
    elements: IntArray
    controls: tuple[int, ...]
    bait: tuple[int, ...]
    worst_case: AttackResult
    evaluations: int


@dataclass(frozen=True, slots=True, kw_only=True)
class BoundReport:
    """What to do now, the worst that can follow, and how far that is from the best possible.

    Claims, all in floating point unless a certificate says more: each plan's worst case lies in
    its bracket; ``optimum.lower <= Phi* <= optimum.upper``; RATT's plan keeps at least
    ``certified_ratio`` of ``Phi*``. ``best`` is the plan the search for the optimum found.
    ``curvature`` is given for log-det (submodular), ``total_curvature`` for the other criteria.
    ``certificate`` : the verified proof file of ``optimum``, or why there is none.
    ``seconds`` : wall time of each step.
    """

    problem: Problem
    objective: str
    n_targets: int | None
    alpha_cs: int
    ratt: PlanAssessment
    baselines: tuple[PlanAssessment, ...]
    optimum: MaxMinResult
    best: PlanAssessment
    curvature: Curvature | None
    total_curvature: Curvature | None
    guarantees: Mapping[str, Guarantee]
    certificate: Certificate | str
    seconds: Mapping[str, float]

    @property
    def n_max(self) -> int:
        """Size of the largest group that link attacks are taken to leave: ``N - alpha_cs``."""
        return self.problem.n_robots - self.alpha_cs

    @property
    def plans(self) -> tuple[PlanAssessment, ...]:
        """RATT's, the best one found, and the baselines'."""
        return (self.ratt, self.best, *self.baselines)

    @property
    def recommended(self) -> PlanAssessment:
        """The plan with the best proved worst case; RATT's among equals."""
        return max(self.plans, key=lambda plan: plan.worst_case.lower)

    @property
    def upper(self) -> float:
        """Proved upper bound on what any plan can keep."""
        return max(self.optimum.upper, *(plan.worst_case.lower for plan in self.plans))

    def share(self, plan: PlanAssessment) -> float:
        """What a plan keeps at least, as a share of the best possible; 1 when both are 0."""
        return plan.worst_case.lower / self.upper if self.upper > 0 else 1.0

    @property
    def certified_ratio(self) -> float:
        """RATT's proved worst-case value over the optimum's upper bound; 1 when both are 0."""
        return self.share(self.ratt)


def bound(
    scenario_or_problem: HasProblem | Problem,
    *,
    objective: str | None = None,
    gap: float = 1e-9,
    time_limit: float | None = 60.0,
    certificate: str | Path | None = None,
    progress: Callable[[str], None] | None = None,
) -> BoundReport:
    """Plan, find the worst attack, bracket the optimum, prove it and list the guarantees of one scenario.

    Parameters
    ----------
    scenario_or_problem : a scenario (its ``problem(objective)`` is used), or a problem
    objective : ``"trace"`` (the default), ``"logdet"`` or ``"maxeig"``; not with a problem, which has its own
    gap : relative gap at which the search for the optimum stops
    time_limit : seconds for all searches together, of which that for the optimum may take three quarters of what
        the attacks on the baselines leave; ``None`` for no limit. Writing and verifying the certificate comes on top.
    certificate : file for the proof of the bracket, verified before it is named so; none where ``None``
    progress : called with one line of text whenever there is something to tell

    Raises
    ------
    InputError : an argument breaks its rule, or the certificate cannot be written.
    ProofError : the verifier finds a fault in the search's own proof.
    """
    check_limits(gap, time_limit)
    problem, name = _problem_of(scenario_or_problem, objective)
    tell = progress or _silent
    clock = _Clock(tell, time_limit)
    with clock("RATT and the baselines"):
        robust = assess(problem, "ratt", ratt(problem), clock.share(ATTACK_SHARE))
        baselines = tuple(
            assess(problem, label, plan, clock.share(ATTACK_SHARE)) for label, plan in _baselines(problem, clock)
        )
    with clock("the best possible plan"):
        limit = clock.share(OPTIMUM_SHARE)
        optimum = solve_maxmin(problem, gap=gap, time_limit=limit, progress=_search_lines(tell))
        best = _assess_optimum(problem, optimum, clock.share(ATTACK_SHARE))
    with clock("curvature and guarantees"):
        k, c = _curvatures(problem, clock.share(CURVATURE_SHARE))
        alpha_cs = equivalent_sensing_attacks(problem)
        guarantees = _guarantees(problem, robust.elements, clock.share(CURVATURE_SHARE), k=k, c=c)
    with clock("certificate"):
        proof = _certificate(problem, optimum, certificate)
    return BoundReport(
        problem=problem,
        objective=name,
        n_targets=_targets(problem),
        alpha_cs=alpha_cs,
        ratt=robust,
        baselines=baselines,
        optimum=optimum,
        best=best,
        curvature=k,
        total_curvature=c,
        guarantees=guarantees,
        certificate=proof,
        seconds=clock.seconds,
    )


def _guarantees(
    problem: Problem, plan: IntArray, time_limit: float | None, *, k: Curvature | None, c: Curvature | None
) -> dict[str, Guarantee]:
    """All that apply to RATT's plan, with the one from this instance's own numbers, strongest first."""
    found = all_guarantees(problem, equivalent_sensing_attacks(problem), k=k, c=c)
    if k or c:
        found["this instance"] = instance_bound(problem, plan, k=k, c=c, time_limit=time_limit)
    return dict(sorted(found.items(), key=lambda item: -item[1]))


def assess(
    problem: Problem, name: str, plan: Plan, time_limit: float | None = None, known: AttackResult | None = None
) -> PlanAssessment:
    """Attack one plan in the worst way, unless that is ``known``, and return both."""
    return PlanAssessment(
        name=name,
        elements=plan.elements,
        controls=controls_of(problem, plan.elements),
        bait=plan.bait,
        worst_case=known or worst_case_attack(problem, plan.elements, time_limit=time_limit),
        evaluations=plan.evaluations,
    )


def controls_of(problem: Problem, elements: IntArray) -> tuple[int, ...]:
    """Positions of the chosen elements among each robot's own."""
    return tuple(int(np.searchsorted(own, e)) for own, e in zip(problem.choices, elements, strict=True))


def _problem_of(given: HasProblem | Problem, objective: str | None) -> tuple[Problem, str]:
    if isinstance(given, Problem):
        if objective is not None:
            raise InputError("objective", "must be absent where a problem is given (it has its own)", objective)
        names = {kind: name for name, kind in OBJECTIVES.items()}
        return given, names.get(type(given.objective), type(given.objective).__name__)  # type: ignore[arg-type]
    if not isinstance(given, HasProblem):
        raise InputError("scenario_or_problem", "must be a scenario or a Problem", type(given).__name__)
    name = objective or "trace"
    return given.problem(name), name


def _baselines(problem: Problem, clock: _Clock) -> Iterator[tuple[str, Plan]]:
    yield "greedy", greedy(problem)
    yield "myopic", myopic(problem)
    yield "random", random_plan(problem, seed=RANDOM_SEED)
    if isinstance(problem.objective, InformationObjective) or problem.objective.n <= LARGEST_TABLE:
        unattacked = nonrobust_search(problem, time_limit=clock.share(NONROBUST_SHARE))
        if unattacked.stop in {Stop.CLOSED, Stop.EXHAUSTED, Stop.GAP}:
            yield "nonrobust", Plan(elements=unattacked.elements, evaluations=unattacked.evaluations)


def _assess_optimum(problem: Problem, optimum: MaxMinResult, time_limit: float | None) -> PlanAssessment:
    plan = Plan(elements=optimum.elements, evaluations=optimum.evaluations)
    return assess(problem, "maxmin", plan, time_limit, known=optimum.worst_case)


def _certificate(problem: Problem, optimum: MaxMinResult, path: str | Path | None) -> Certificate | str:
    if path is None:
        return "not asked for"
    return why_not_certifiable(problem, optimum) or certify(problem, optimum, path)


def _targets(problem: Problem) -> int | None:
    return problem.objective.n_targets if isinstance(problem.objective, InformationObjective) else None


def _search_lines(tell: Callable[[str], None]) -> Callable[[int, float, float], None]:
    last = [-np.inf]

    def line(nodes: int, lower: float, upper: float) -> None:
        if time.monotonic() - last[0] >= SECONDS_BETWEEN_LINES:
            last[0] = time.monotonic()
            tell(f"  {nodes} nodes: between {lower:.8g} and {upper:.8g}")

    return line


def _silent(_: str) -> None:
    pass


class _Clock:
    """Tells when a step begins, keeps how long it took, and shares out the time left."""

    def __init__(self, tell: Callable[[str], None], time_limit: float | None) -> None:
        self.seconds: dict[str, float] = {}
        self._tell = tell
        self._deadline = None if time_limit is None else time.monotonic() + time_limit

    def share(self, part: float) -> float | None:
        """Seconds that are ``part`` of the time left, never none; ``None`` where there is no limit."""
        return None if self._deadline is None else part * max(self._deadline - time.monotonic(), LEAST_SECONDS)

    @contextmanager
    def __call__(self, step: str) -> Iterator[None]:
        self._tell(step)
        began = time.monotonic()
        yield
        self.seconds[step] = time.monotonic() - began


def _curvatures(problem: Problem, time_limit: float | None) -> tuple[Curvature | None, Curvature | None]:
    """Curvature (log-det, which is submodular) and total curvature over feasible sets, where they can be bracketed."""
    f, owners = problem.objective, problem.robot
    submodular = isinstance(f, LogDetObjective)
    feasible = np.prod([len(choice) + 1.0 for choice in problem.choices])
    if not isinstance(f, InformationObjective) and feasible > LARGEST_ENUMERATION:
        return None, None
    if submodular:
        return curvature(f, owners, gap=CURVATURE_GAP, time_limit=time_limit), None
    return None, total_curvature(f, owners, gap=CURVATURE_GAP, time_limit=time_limit)
