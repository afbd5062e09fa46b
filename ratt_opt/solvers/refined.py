"""A good plan at once: RATT's, improved against the attacks that hurt it, for as long as there is time.

Exchanges of single elements are judged by the attacks known: first by a mean of what the worst of them leave, then by
what the worst one leaves. A plan that seems better is attacked, and that attack is known from then on. If no exchange
is left, some robots take other elements at random, and the walk goes on from there (iterated local search, Lourenço,
Martin and Stützle 2003). In the end the best plan is attacked exactly. It is returned if it is proved to keep no less
than RATT's plan can; otherwise RATT's plan is. That proof has time of its own: on a cold or busy machine the walk may
use up all of the limit, and what it found would be lost.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._rounding import down, up
from ratt_opt._validation import check_integer, readonly
from ratt_opt._values import shown
from ratt_opt.attack.task import widened_result
from ratt_opt.budget import Budget, OutOfBudget, Stop, interruptible, undisturbed
from ratt_opt.coordinates.preparation import prepared
from ratt_opt.problem import Attack, Plan, Problem, check_problem
from ratt_opt.running.progress import Step
from ratt_opt.setfunctions.information import InformationObjective
from ratt_opt.solvers.by_values.plan_search import PlanSearch
from ratt_opt.solvers.maxmin.incumbent import Incumbent, ProvedPlan
from ratt_opt.solvers.maxmin.outcome_pool import OutcomePool
from ratt_opt.solvers.maxmin.params import MaxMinParams
from ratt_opt.solvers.maxmin.stages.ties import break_ties
from ratt_opt.solvers.maxmin.walk import Walk
from ratt_opt.solvers.maxmin.watchers import watched_plan
from ratt_opt.solvers.ratt import alpha_cs_in_share, greedy, myopic, ratt
from ratt_opt.solvers.undominated import UndominatedProblem, dominators, undominated

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

    from ratt_opt._validation import IntArray
    from ratt_opt.attack.task import AttackResult

__all__ = ["RefinedParams", "RefinedPlan", "refined"]


@dataclass(frozen=True, slots=True, kw_only=True)
class RefinedParams:
    """Times of the proof of a plan's worst case: more proves more of the plan, and searches fewer others.

    ``proof`` : share of the remaining time for proving the worst case of the best plan
    ``short_proof`` : the same if all attacks that matter are known, and for functions known by their values
    ``best`` : share of the proof's time for the best plan; the rest is for an attack on RATT's plan
    ``nodes`` : of one exact attack: nearly all on teams of up to 30 robots close in less
    ``patience`` : kicks in vain that end a search without a limit of time
    ``search`` : parameters of the best plan, its kicks and quick attacks

    For the last exact attacks, beyond the limit, which more of it overruns by more:

    ``last_share`` : of the limit [1]; ``last_seconds`` : at least [s]; ``least_share`` : but no more than this share
    of a short limit [1]; ``interrupted_seconds`` : after an interrupt instead [s]: a user waits for it
    """

    proof: float = 0.4
    short_proof: float = 0.05
    best: float = 0.7
    nodes: int = 500_000
    patience: int = 200
    search: MaxMinParams = field(default_factory=MaxMinParams)
    last_share: float = 0.08
    last_seconds: float = 0.4
    least_share: float = 0.5
    interrupted_seconds: float = 0.1

    def last(self, own: Budget) -> float:
        """Seconds for the last attacks of a search with this budget."""
        if own.is_interrupted:
            return self.interrupted_seconds
        if own.time_limit is None:
            return self.last_seconds
        return max(self.last_share * own.time_limit, min(self.last_seconds, self.least_share * own.time_limit))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class RefinedPlan(Plan):
    """A plan and its worst-case value: at least ``lower``, at most ``upper`` (by ``worst_case``).

    ``unattacked`` : its value when nobody attacks; ``kicks`` : perturbations of the best plan that were tried
    """

    lower: float
    upper: float
    unattacked: float
    stop: Stop
    kicks: int
    worst_case: AttackResult | None = None

    def __repr__(self) -> str:
        bracket = f"{down(self.lower, 9)} <= worst case <= {up(self.upper, 9)}"
        return f"RefinedPlan({bracket}, {self.kicks} kicks, {self.stop.name}, elements={shown(self.elements)})"


@interruptible
@Step("refining a plan")
def refined(
    problem: Problem,
    *,
    time_limit: float | None = 1.0,
    start: ArrayLike | Plan | None = None,
    seed: int = 0,
    max_kicks: int | None = None,
    budget: Budget | None = None,
    on_improvement: Callable[[IntArray], object] | None = None,
    params: RefinedParams | None = None,
) -> RefinedPlan:
    """Improve RATT's plan against the attacks that hurt it; never return a plan that is worse.

    Anytime: with ten robots most of the gain comes within a tenth of a second. The bracket of the plan's worst case is
    valid whenever it stops; no claim is made about other plans (:func:`solve_maxmin`).

    Parameters
    ----------
    problem : criteria of information matrices, or any non-decreasing set function (relied on): its exchanges are valued
        in batches, from the greedy and the myopic plan, too
    time_limit : seconds, attacks included; ``None`` ends after 200 kicks in vain, or ``max_kicks``. If nothing is left
        for the last exact attacks they take up to 0.4 s more (half of a shorter limit)
    start : a plan (N,) to begin with beside RATT's
    seed : integer >= 0, of the kicks
    max_kicks : with it, and no limit of time, the plan is the same on every run
    budget : an outer search's budget: its seconds and interrupts count too
    on_improvement : called with RATT's plan (N,), and then with each one that the attacks known rate above all before
    params : shares of the time and limits; they decide what is found and proved, not whether the bracket holds

    Raises
    ------
    InputError : a limit is negative, or ``start`` is no plan.
    """
    params = RefinedParams() if params is None else params
    if not isinstance(check_problem(problem, knows_at_most=True).objective, InformationObjective):
        own, kicked = Budget.inside(budget, time_limit), (seed, max_kicks)
        return _refined_by_values(problem, own, start, kicked, on_improvement, params=params)
    asked, problem = problem, prepared(problem)
    kicks_left = None if max_kicks is None else check_integer("max_kicks", max_kicks, low=0)
    rng = np.random.default_rng(check_integer("seed", seed, low=0))
    given = [] if start is None else [problem.check_plan(start.elements if isinstance(start, Plan) else start)]
    own = Budget.inside(budget, time_limit)
    first = ratt(asked, alpha_cs=alpha_cs_in_share(problem, own), budget=own)
    few = undominated(problem)
    if on_improvement is not None:
        on_improvement(first.elements)
    among = dominators(problem, few.kept)
    incumbent = Incumbent(few, OutcomePool(few), among[first.elements], own, params.search)
    kicks, stop = 0, Stop.HEURISTIC
    try:
        if on_improvement is not None:
            incumbent.on_improvement = lambda plan: on_improvement(few.kept[plan])
        incumbent.pool.list_all(incumbent.params.outcomes)
        others = [planner(problem, budget=own).elements for planner in (greedy, myopic)]
        watched = watched_plan(few, own, incumbent.params.watchers)
        plans = [among[plan] for plan in (first.elements, *given, *others)]
        incumbent.meet(plans if watched is None else [*plans, watched])
        kicks = _walked(incumbent, rng, own, kicks_left, params)
        _prove(incumbent, own, params)
        break_ties(incumbent, own.part(incumbent.params.ties.share))
    except OutOfBudget as out:
        stop = out.stop
    except KeyboardInterrupt:
        stop = own.interrupt()
    stop = own.stop() or stop
    starts = [among[plan] for plan in (first.elements, *given)]
    _prove_last(incumbent, starts, own, params)
    return undisturbed(own, lambda: _best(problem, few, incumbent, starts, first, kicks, stop))


def _prove_last(incumbent: Incumbent, starts: list[IntArray], own: Budget, params: RefinedParams) -> None:
    """Attack the best plan known, then those it began with, in a time of their own if the limit left none for it."""
    if incumbent.is_proved and not _can_be_worse(incumbent, starts):
        return
    with suppress(OutOfBudget):
        last = Budget.apart(params.last(own))
        if not incumbent.is_proved:
            incumbent.proved.attack(incumbent.candidates.best, last.part(params.best))
        for plan in starts:
            if _can_be_worse(incumbent, [plan]):
                incumbent.proved.attack(plan, last)


def _can_be_worse(incumbent: Incumbent, starts: list[IntArray]) -> bool:
    """Test whether less is proved of the plan in hand than one of its starts may be worth."""
    most = max(incumbent.pool.plan_value(plan) for plan in starts)
    return incumbent.proved.lower < most - incumbent.problem.objective.rounding


def _refined_by_values(
    problem: Problem,
    budget: Budget,
    start: ArrayLike | Plan | None,
    kicks: tuple[int, int | None],
    on_improvement: Callable[[IntArray], object] | None,
    *,
    params: RefinedParams,
) -> RefinedPlan:
    """Improve RATT's, the greedy and the myopic plan of any non-decreasing function, known by its values."""
    seed, max_kicks = kicks
    most = np.inf if max_kicks is None else check_integer("max_kicks", max_kicks, low=0)
    given = [] if start is None else [problem.check_plan(start.elements if isinstance(start, Plan) else start)]
    seed = check_integer("seed", seed, low=0)
    search = PlanSearch(problem, budget, params.search, seed=seed, on_improvement=on_improvement)
    is_patient = max_kicks is None and np.isinf(budget.seconds_left)
    stop = Stop.HEURISTIC
    try:
        search.start(None)
        search.refine(given, 1 - params.short_proof, most, params.patience if is_patient else np.inf)
    except OutOfBudget as out:
        stop = out.stop
    except KeyboardInterrupt:
        stop = budget.interrupt()
    found, ratts = search.result(budget.stop() or stop), search.ratts
    is_ratts = ratts is not None and np.array_equal(found.elements, ratts.elements)
    unattacked = problem.team_value(found.elements, Attack())
    upper = unattacked if found.worst_case is None else found.worst_case.upper
    return RefinedPlan(
        elements=found.elements,
        evaluations=found.evaluations,
        bait=ratts.bait if ratts is not None and is_ratts else (),
        alpha_cs=ratts.alpha_cs if ratts is not None and is_ratts else None,
        lower=found.lower,
        upper=max(upper, found.lower),
        unattacked=unattacked,
        stop=found.stop,
        kicks=search.kicks,
        worst_case=found.worst_case,
    )


def _prove(incumbent: Incumbent, budget: Budget, params: RefinedParams) -> None:
    """Attack the best plan exactly, and the next best if that one falls; then RATT's, until it is known to be worse."""
    first, proved, part = incumbent.candidates.first, incumbent.proved, budget.part(params.best)
    while not incumbent.is_proved and not part.is_over:
        known = len(incumbent.pool)
        proved.attack(incumbent.candidates.best, part.part(max_nodes=params.nodes))
        if len(incumbent.pool) == known:
            break
    if proved.lower < incumbent.pool.plan_value(first) and not budget.is_over:
        incumbent.adversary.attack(first, budget.part(max_nodes=params.nodes), proved.lower)


def _walked(
    incumbent: Incumbent, rng: np.random.Generator, budget: Budget, most: int | None, params: RefinedParams
) -> int:
    """Walk for as long as there is time, that for the proof left aside; how many kicks that were."""
    until = budget.part(1 - (params.short_proof if incumbent.pool.complete else params.proof))
    patience = params.patience if most is None and np.isinf(budget.seconds_left) else None
    return Walk(incumbent, rng).run(until, most, patience)


def _best(  # noqa: PLR0917
    problem: Problem,
    few: UndominatedProblem,
    incumbent: Incumbent,
    starts: list[IntArray],
    ratts: Plan,
    kicks: int,
    stop: Stop,
) -> RefinedPlan:
    """The plan with the best proved worst case, if that is no less than those of RATT's plan and of the one given.

    Otherwise the one of these two of which more is proved.

    Elements of RATT's plan that are dominated were exchanged before.
    """
    proved, pool = incumbent.proved, incumbent.pool
    if _can_be_worse(incumbent, starts) and not any(np.array_equal(proved.elements, plan) for plan in starts):
        proved = ProvedPlan(incumbent.adversary, starts[-1])
        for plan in starts:
            with suppress(OutOfBudget):  # it knows what the attacks so far proved
                proved.evaluate_quickly(plan, incumbent.budget)
    unattacked = few.team_value(proved.elements, Attack())
    upper = min(unattacked, pool.plan_value(proved.elements))
    if proved.worst_case is not None:
        upper = min(upper, proved.worst_case.upper)
    elements, (lower, upper) = few.kept[proved.elements], problem.widen_by_rounding(min(proved.lower, upper), upper)
    is_ratts = np.array_equal(elements, ratts.elements)
    return RefinedPlan(
        elements=readonly(elements),
        evaluations=ratts.evaluations + incumbent.proved.evaluations,
        bait=ratts.bait if is_ratts else (),
        alpha_cs=ratts.alpha_cs if is_ratts else None,
        lower=float(lower),
        upper=float(upper),
        unattacked=float(unattacked),
        stop=stop,
        kicks=kicks,
        worst_case=None if proved.worst_case is None else widened_result(problem, elements, proved.worst_case),
    )
