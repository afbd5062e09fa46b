"""The main job as one call: plan, attack, bound, guarantee."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from functools import partial
from time import process_time
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias, runtime_checkable

from ratt_opt.bounds.applicable import all_guarantees, inapplicable_guarantees
from ratt_opt.bounds.instance import instance_bound
from ratt_opt.budget import Budget, Stop, undisturbed
from ratt_opt.certificates.certification import INTERRUPTED, NOT_ASKED_FOR, Certification
from ratt_opt.certificates.write import certify_if_possible
from ratt_opt.curvatures.curvature import curvature, total_curvature
from ratt_opt.errors import InputError, ProofError
from ratt_opt.graph.largest_group.counting import by_caa
from ratt_opt.main_job.assessment import assess, recommended, views_of
from ratt_opt.main_job.job_params import DEFAULT, JobParams
from ratt_opt.main_job.params import QUICK, SHARES
from ratt_opt.main_job.remarks import omitted_curvatures, omitted_parts, remarks_on_data, remarks_on_params
from ratt_opt.main_job.result import BoundReport, PlanAssessment
from ratt_opt.main_job.steps import Steps
from ratt_opt.missions.first_step import first_step, first_world
from ratt_opt.missions.players.planners import elements_of, planned_with
from ratt_opt.missions.world import MissionModel
from ratt_opt.problem import Plan, Problem, check_problem
from ratt_opt.scenario.model import Scenario
from ratt_opt.scenario.planner_world import scenario_world
from ratt_opt.scenario.remarks import scenario_remarks
from ratt_opt.setfunctions.information import InformationObjective
from ratt_opt.solvers.maxmin.solve import check_limits, nonrobust_search, solve_maxmin
from ratt_opt.solvers.ratt import bait_and_greedy, largest_group_in_share, random_plan

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from pathlib import Path

    from ratt_opt._validation import FloatArray
    from ratt_opt.bounds.guarantees import Guarantee
    from ratt_opt.bounds.params import BoundParams
    from ratt_opt.certificates.params import CertificateParams
    from ratt_opt.curvatures.curvature import Curvature
    from ratt_opt.curvatures.params import CurvatureParams
    from ratt_opt.missions.players.planners import Planner
    from ratt_opt.scenario.planner_world import PlannerWorld
    from ratt_opt.solvers.result import MaxMinResult

    Attacked: TypeAlias = Callable[..., PlanAssessment]

__all__ = ["bound"]

GUARANTEES = ("none", "quick", "full")
"""Modes of the guarantees."""


TAKEN = ("ratt", "maxmin", "greedy", "myopic", "random", "nonrobust_optimum")
"""Names of a report's own planners."""


@runtime_checkable
class HasProblem(Protocol):
    """Anything that becomes a problem: a scenario, or the contents of a model-free file."""

    def problem(self, objective: str = "trace") -> Problem:
        """Return the max-min problem for one objective."""


def bound(
    scenario_or_problem: HasProblem | Problem,
    *,
    objective: str | None = None,
    model: MissionModel | None = None,
    gap: float = 1e-9,
    time_limit: float | None = 60.0,
    certificate: str | Path | None = None,
    progress: Callable[[str], None] | None = None,
    guarantees: str = "quick",
    planners: Mapping[str, Planner] | None = None,
    params: JobParams = DEFAULT,
) -> BoundReport:
    """Plan, find the worst attack, bracket the optimum, prove it and list the guarantees of one scenario.

    An interrupt (Ctrl-C) once RATT has planned ends every search; the report holds what is proved so far.

    Parameters
    ----------
    scenario_or_problem : a scenario (its ``problem(objective)`` is used), or a problem
    objective : name of the criterion (the model's, or the trace, if ``None``); not with a problem, which has its own
    model : of a scenario: plan as the first step of a mission with this model does, with its sensors, motions and
        filter. The default filter of missions counts what linearisation leaves out, so values are below those of the
        scenario alone, which is the paper's linearised problem
    gap : relative gap at which the search for the optimum stops
    time_limit : seconds for all of it, of which the search for the optimum may take three quarters of what
        the attacks on the baselines leave, and a certificate has a quarter for itself; ``None`` for no limit. Of a set
        function of the user's own the value of each element is computed whatever the limit: RATT's plan needs them
    certificate : file for the proof of the bracket, verified before it is named so; none if ``None``
    progress : called with one line of text whenever there is something to tell
    guarantees : what was sure before planning, which rests on curvatures: ``"quick"`` spends two seconds of the
        processor at most, ``"full"`` up to three quarters of the time left, ``"none"`` leaves them out
    planners : planners of your own by name, ``f(problem)`` or ``f(problem, world)`` as in missions: their plans are
        attacked too, and stand beside the others in every table and figure. They take what time they take
    params : of searches, attacks, guarantees and certificates; a remark says which are not as by default

    Raises
    ------
    InputError : an argument breaks its rule. A certificate that cannot be written is a reason in the report.
    ProofError : the verifier finds a fault in the search's own proof; its ``report`` holds what was found.
    """
    check_limits(gap, time_limit)
    planners = planners or {}
    _check_asked(guarantees, planners, params)
    began, given = datetime.now(UTC), scenario_or_problem
    problem, source = _problem_of(given, objective, model)
    whole, steps, busy_since = Budget(time_limit), Steps(progress), process_time()
    budget = whole if certificate is None else whole.part(1 - SHARES.certificate)
    with steps("RATT and the baselines"):
        # Asked for once: of a slow function of the user's own these are most of what a short limit has time for.
        single = problem.objective.singletons()
        largest = by_caa(problem.threat) if problem.threat.links_alike else largest_group_in_share(problem, budget)
        alpha_cs = problem.n_robots - largest.lower
        attacked = partial(assess, problem, params=params.attack)
        robust = _planned(problem, alpha_cs, single, budget, attacked)
        baselines = undisturbed(budget, lambda: tuple(_baselines(problem, single, budget, attacked)))
        seen = _world_of(given, model, problem) if planners else None
        baselines += tuple(_own_plans(problem, planners, seen, budget, attacked))
    with steps("the best possible plan"):
        told: dict[str, Any] = {"gap": gap, "progress": steps.search_line, "alpha_cs": alpha_cs}
        optimum, best = _best(partial(solve_maxmin, problem, params=params.search, **told), budget, attacked)
    with steps("other attacks on the recommended plan"):
        shown, part = recommended((robust, best, *baselines)), budget.part(SHARES.attack)
        views = undisturbed(budget, lambda: views_of(problem, shown, part, params.attack))
    with steps("curvature and guarantees"):
        k = c = None
        sure: dict[str, Guarantee] = {}
        if guarantees != "none":
            rest = QUICK.within(budget, process_time() - busy_since) if guarantees == "quick" else budget
            k, c = undisturbed(budget, lambda: _curvatures(problem, rest.part(SHARES.curvature), params.curvatures))
            sure = undisturbed(budget, lambda: _guarantees(problem, robust, alpha_cs, rest, params.bounds, k=k, c=c))
    with steps("certificate"):
        proof, failure = _certified(problem, optimum, certificate, whole, source=source, params=params.certificate)
    report = BoundReport(
        problem=problem,
        alpha_cs=alpha_cs,
        n_max_upper=largest.upper,
        largest_group=largest,
        ratt=robust,
        baselines=baselines,
        optimum=optimum,
        best=best,
        curvature=k,
        total_curvature=c,
        guarantees=sure,
        inapplicable={} if guarantees == "none" else inapplicable_guarantees(problem, alpha_cs),
        omitted=omitted_parts(baselines, guarantees, planners) | omitted_curvatures(guarantees, k=k, c=c),
        certificate=NOT_ASKED_FOR,
        seconds=steps.seconds,
        created=began.isoformat(timespec="seconds"),
        source=source,
        views=views,
        seeds={"random": SHARES.seed},
        interrupted=whole.stop() is Stop.INTERRUPTED,
        remarks=_remarks(problem, params, given),
    )
    return _delivered(report.with_certificate(proof), failure)


def _remarks(problem: Problem, params: JobParams, given: HasProblem | Problem) -> tuple[str, ...]:
    of_scenario = scenario_remarks(given) if isinstance(given, Scenario) else ()
    return remarks_on_data(problem) + remarks_on_params(params) + of_scenario


def _delivered(report: BoundReport, failure: ProofError | None) -> BoundReport:
    """The report, or the fault of its proof with the report in it."""
    if failure is None:
        return report
    failure.report = report
    raise failure


def _planned(problem: Problem, alpha_cs: int, single: FloatArray, budget: Budget, attacked: Attacked) -> PlanAssessment:
    """RATT's plan under attack; ``alpha_cs`` : what the link attacks are worth; ``single`` (E,) individual values."""
    plan = replace(bait_and_greedy(problem, problem.alpha_s + alpha_cs, budget, single), alpha_cs=alpha_cs)
    return undisturbed(budget, lambda: attacked("ratt", plan, budget.part(SHARES.attack)))


def _best(
    search: Callable[..., MaxMinResult], budget: Budget, attacked: Attacked
) -> tuple[MaxMinResult, PlanAssessment]:
    """The search for the best plan, and that plan under attack."""
    optimum = undisturbed(budget, lambda: search(budget=budget.part(SHARES.optimum)))
    found = Plan(elements=optimum.elements, evaluations=optimum.evaluations)
    known = partial(attacked, "maxmin", found, known=optimum.worst_case)
    return optimum, undisturbed(budget, lambda: known(budget=budget.part(SHARES.attack)))


def _certified(
    problem: Problem,
    optimum: MaxMinResult,
    path: str | Path | None,
    budget: Budget,
    *,
    source: object,
    params: CertificateParams,
) -> tuple[Certification, ProofError | None]:
    """The certificate or why there is none, and the fault that the verifier found in our own proof."""
    if budget.stop() is Stop.INTERRUPTED:
        return INTERRUPTED, None
    try:
        return certify_if_possible(problem, optimum, path, budget, source=source, params=params), None
    except ProofError as failure:
        return Certification.faulty(failure), failure
    except KeyboardInterrupt:
        budget.interrupt()
        return INTERRUPTED, None


def _problem_of(
    given: HasProblem | Problem, objective: str | None, model: MissionModel | None = None
) -> tuple[Problem, HasProblem | None]:
    """The problem, and what it was made from where that is known."""
    if model is not None:
        if not isinstance(model, MissionModel):
            raise InputError("model", "must be a MissionModel", type(model).__name__)
        chosen = model if objective is None else replace(model, objective=objective)
        step = first_step(given, chosen)
        return step.problem(chosen.objective), step
    if isinstance(given, Problem):
        if objective is not None:
            raise InputError("objective", "must be absent if a problem is given (it has its own)", objective)
        return check_problem(given, knows_at_most=True), None
    if not isinstance(given, HasProblem):
        raise InputError("scenario_or_problem", "must be a scenario or a Problem", type(given).__name__)
    return check_problem(given.problem() if objective is None else given.problem(objective), knows_at_most=True), given


def _world_of(given: HasProblem | Problem, model: MissionModel | None, problem: Problem) -> PlannerWorld | None:
    """Return the world that planners may look at beside the problem, if it comes from a scenario."""
    if not isinstance(given, Scenario):
        return None
    return scenario_world(given, problem) if model is None else first_world(given, model)


def _baselines(problem: Problem, single: FloatArray, budget: Budget, attacked: Attacked) -> Iterator[PlanAssessment]:
    plans = {
        "greedy": bait_and_greedy(problem, 0, budget, single),
        "myopic": bait_and_greedy(problem, problem.n_robots, budget, single),
        "random": random_plan(problem, seed=SHARES.seed),
    }
    for name, plan in plans.items():
        yield attacked(name, plan, budget.part(SHARES.attack))
    if not budget.is_over:
        unattacked = nonrobust_search(problem, budget=budget.part(SHARES.nonrobust))
        if unattacked.stop in {Stop.CLOSED, Stop.EXHAUSTED, Stop.GAP}:
            plan = Plan(elements=unattacked.elements, evaluations=unattacked.evaluations)
            yield attacked("nonrobust_optimum", plan, budget.part(SHARES.attack))


def _own_plans(
    problem: Problem,
    planners: Mapping[str, Planner],
    world: PlannerWorld | None,
    budget: Budget,
    attacked: Attacked,
) -> Iterator[PlanAssessment]:
    """The plans of the user's planners under attack; an interrupt ends them. InputError : one returns no plan."""
    for name, planner in planners.items():
        try:
            found = planned_with(planner, problem, world)
            elements, cost = elements_of(found, problem), getattr(found, "evaluations", 0)
        except KeyboardInterrupt:
            budget.interrupt()
            return
        except InputError as error:
            raise InputError(f"planners[{name!r}]: {error.argument}", error.rule, error.value) from None
        plan = Plan(elements=elements, evaluations=cost)
        yield undisturbed(budget, partial(attacked, name, plan, budget.part(SHARES.attack)))


def _check_asked(guarantees: str, planners: Mapping[str, Planner], params: JobParams) -> None:
    if guarantees not in GUARANTEES:
        raise InputError("guarantees", f"must be {', '.join(GUARANTEES)}", guarantees)
    if not isinstance(params, JobParams):
        raise InputError("params", "must be JobParams, such as JobParams(search=...)", type(params).__name__)
    for name, planner in planners.items():
        if name in TAKEN or not (isinstance(name, str) and name.isprintable() and name):
            raise InputError("planners", f"must have names that are none of {', '.join(TAKEN)}", name)
        if not callable(planner):
            raise InputError(f"planners[{name!r}]", "must be a function of the problem", type(planner).__name__)


def _curvatures(problem: Problem, budget: Budget, params: CurvatureParams) -> tuple[Curvature | None, Curvature | None]:
    """Curvature (of a submodular criterion) or total curvature over feasible sets, if it can be bracketed."""
    f, owners = problem.objective, problem.robot
    asked: dict[str, Any] = {"gap": SHARES.curvature_gap, "time_limit": None, "budget": budget, "params": params}
    try:
        if f.is_submodular:
            return curvature(f, owners, **asked), None
        return None, total_curvature(f, owners, **asked)
    except InputError:
        if not isinstance(f, InformationObjective):
            raise
        return None, None  # a formula of one's own that breaks what it is relied upon for; the report says so


def _guarantees(
    problem: Problem,
    robust: PlanAssessment,
    alpha_cs: int,
    budget: Budget,
    params: BoundParams,
    *,
    k: Curvature | None,
    c: Curvature | None,
) -> dict[str, Guarantee]:
    """All that apply to RATT's plan, with the one from this instance's own numbers, strongest first."""
    budget = budget.part(SHARES.curvature)
    if problem.at_most is not None:
        return {}
    found = all_guarantees(problem, alpha_cs, k=k, c=c, budget=budget, params=params)
    if k or c:
        asked: dict[str, Any] = {"time_limit": None, "budget": budget, "params": params}
        found["this instance"] = instance_bound(problem, robust.elements, k=k, c=c, **asked)
    return dict(sorted(found.items(), key=lambda item: -item[1]))
