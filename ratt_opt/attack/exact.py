"""The exact worst-case attack on a plan, with a bracket at any time."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ratt_opt.attack import params as parameters
from ratt_opt.attack.heuristics import bounded_rational_attack
from ratt_opt.attack.stages.attack_state import AttackState, can_enumerate_subsets
from ratt_opt.attack.stages.branch_and_bound import AttackTree
from ratt_opt.attack.stages.schedule import CRITERION_STAGES, VALUE_STAGES
from ratt_opt.attack.staging import go_on, recorded, run_stages
from ratt_opt.attack.task import (
    AttackBracket,
    AttackMemory,
    AttackOptions,
    AttackResult,
    AttackTask,
    CutoffReached,
    PlanValues,
    StageRecord,
    metered_problem,
    widened_result,
)
from ratt_opt.budget import Budget, OutOfBudget, Stop, interruptible
from ratt_opt.coordinates.preparation import prepared
from ratt_opt.problem import Attack, check_problem
from ratt_opt.running.progress import Step
from ratt_opt.setfunctions.information import InformationObjective
from ratt_opt.setfunctions.metered import unmetered

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ratt_opt._validation import IntArray
    from ratt_opt.attack.params import AttackParams
    from ratt_opt.problem import Problem

__all__ = ["worst_case_attack", "worst_case_attack_unrounded"]


UNDONE = {Stop.TIME, Stop.NODES, Stop.EVALUATIONS, Stop.HEURISTIC}


@interruptible
@Step("the worst attack")
def worst_case_attack(
    problem: Problem,
    elements: ArrayLike,
    *,
    max_nodes: int | None = None,
    time_limit: float | None = None,
    max_evaluations: int | None = None,
    budget: Budget | None = None,
    aim: float = -math.inf,
    known: Attack | None = None,
    memory: AttackMemory | None = None,
    params: AttackParams | None = None,
    brief: bool = False,
) -> AttackResult:
    """Find the attack that hurts one plan most.

    Stages run one after the other until the bracket is closed or the budget is spent. The page
    ``docs/contributors/engine.md`` lists them, their conditions and shares of the budget; ``stages`` of the result
    says which ran. What a node is depends on the stage: a threshold, a branch, a set of robots.

    - Up to 24 robots (20 for functions of your own, and where targets are not in the plane) all sets of robots are
      looked at. That closes any network within seconds. For a function of your own it relies on nothing, once all
      sets are valued.
    - Larger teams rely on a non-decreasing objective. The three criteria are; functions of your own are not checked.
    - Give a limit for more than 24 robots (20 for functions of your own): some attacks take hours to close. With
      ``brief`` and no limit, dual prices stop after half a million nodes.
    - ``HEURISTIC`` says that no stage is left that could close the bracket. That happens on complete graphs with very
      many vectors of group sizes, and with ``brief``.

    A keyboard interrupt or a spent budget returns the bracket reached. If the user interrupts before any attack is
    known, the result is the team without an attack and, as lower end, the value of no measurement.

    Parameters
    ----------
    problem : N robots, E elements
    elements : (N,) element chosen for each robot
    max_nodes, time_limit : nodes that may be explored, and seconds, checked between nodes; unlimited by default.
        Listing the groups of a network is no node: without a limit of time give ``brief``, too, to be quick
    max_evaluations : values of an objective that is no information criterion (a few are computed whatever the limit)
    budget : an outer search's budget: its seconds and interrupts count too
    aim : stop, with ``GAP``, at an attack that leaves the team no more than this, whether or not there are worse ones
    known : an attack to begin with; the one found is no better for the team
    memory : of earlier attacks on this plan that a budget ended: both ends are taken from there, and prices, or
        partitions, are gone on with; what this one finds out is left there
    params : of the stages and their algorithms: they decide how soon the bracket closes, not whether it holds
    brief : one attack of many: short stages if there is no limit of time, and a branch and bound is left to a later
        call with the same memory. A budget alone changes no stage.

    Raises
    ------
    InputError : an element is not its robot's, ``elements`` has the wrong shape, a budget is not a number >= 0, ``aim``
        is no number, ``known`` is not within the budgets, or ``memory`` is of another plan.

    Source: ratt.tex, inner problem of eqn:resi_target_prob.
    """
    options = AttackOptions(
        max_nodes=max_nodes,
        time_limit=time_limit,
        max_evaluations=max_evaluations,
        budget=budget,
        aim=aim,
        known=known,
        memory=AttackMemory() if memory is None else memory,
        params=parameters.DEFAULT if params is None else params,
        brief=brief,
    )
    searched = prepared(check_problem(problem, knows_at_most=True))
    found = worst_case_attack_unrounded(searched, elements, options)
    return widened_result(searched, searched.check_plan(elements), found)


def worst_case_attack_unrounded(problem: Problem, elements: ArrayLike, options: AttackOptions) -> AttackResult:
    """:func:`worst_case_attack` for other searches, of a prepared problem: both ends as they were computed."""
    own = Budget.inside(options.budget, options.time_limit, options.max_nodes, options.max_evaluations)
    memory = options.memory
    values = PlanValues(problem, elements)
    memory.check(problem, values.plan)
    is_metered = not isinstance(problem.objective, InformationObjective)
    asked = metered_problem(problem, own) if is_metered else problem
    values.objective = asked.objective
    records: list[StageRecord] = []
    try:
        _begin(memory, problem, asked, values, options)
        assert memory.bracket is not None
        task = AttackTask(asked, values, memory.bracket, own, memory, records, options.params)
        stop = _search(task, is_inner=options.brief)
    except OutOfBudget as out:
        stop = out.stop
    except CutoffReached:
        stop = Stop.GAP
    except KeyboardInterrupt:
        stop = own.interrupt()
    bracket = memory.bracket or _unattacked(problem, values.plan)
    if not is_metered:  # other functions may fall, unless they are said not to
        bracket.check(bracket.lower)
    if memory.bracket is not None and bracket.is_closed and stop in UNDONE:
        stop = Stop.CLOSED  # by what was known before the budget ended
    return AttackResult(
        attack=bracket.attack,
        lower=min(bracket.lower, bracket.upper),
        upper=bracket.upper,
        stop=stop,
        evaluations=values.evaluations,
        nodes=own.nodes,
        stages=tuple(records),
        relies_on=("non-decreasing", *["submodular"] * bracket.is_submodular) if is_metered else (),
    )


def _begin(memory: AttackMemory, problem: Problem, asked: Problem, values: PlanValues, options: AttackOptions) -> None:
    """Give the memory a bracket by a first attack, unless it has one; offer the known attack.

    Raises ``CutoffReached`` : the attack in hand is what was aimed at.
    """
    if memory.bracket is None:
        first = bounded_rational_attack(asked, values.plan)
        is_exact = problem.evaluation_error == 0.0  # then the end was not moved
        upper = first.upper if is_exact else asked.team_value(values.plan, first.attack)
        memory.bracket = AttackBracket(first.attack, upper, first.lower, problem.objective.rounding)
        values.evaluations = first.evaluations
    memory.bracket.aim = options.aim
    if options.known is not None:
        value = asked.team_value(values.plan, problem.check_attack(options.known))
        memory.bracket.offer(options.known, value)
    memory.bracket.check_aim()


def _unattacked(problem: Problem, plan: IntArray) -> AttackBracket:
    """Bracket that needs no attack: the team as it is, and the value of no measurement."""
    values = PlanValues(problem, plan)
    values.objective = unmetered(problem.objective)
    upper = max(values(group) for group in problem.communication.groups())
    return AttackBracket(Attack(), upper, values(()))


def _search(task: AttackTask, *, is_inner: bool) -> Stop:
    is_criterion = isinstance(task.problem.objective, InformationObjective)
    begun = task.memory.search
    if isinstance(begun, AttackTree):
        goes_on = is_criterion or not can_enumerate_subsets(task)
    else:
        goes_on = task.budget.seconds_left <= task.params.stages.renewed * task.memory.seconds
    if begun is not None and goes_on:
        with recorded(task, "earlier search, resumed"):
            return go_on(task, begun)
    task.memory.seconds = task.budget.seconds_left
    stages = CRITERION_STAGES if is_criterion else VALUE_STAGES
    return run_stages(stages, AttackState(task, is_inner=is_inner)) or Stop.HEURISTIC
