"""The exact worst-case attack on a plan, with a bracket at any time."""

from __future__ import annotations

import math
from dataclasses import replace
from numbers import Real
from typing import TYPE_CHECKING

from ratt_opt.attackers.annealed_values import anneal_for_a_share
from ratt_opt.attackers.any_function import any_bound, exchange_attack, metered_problem
from ratt_opt.attackers.any_graph import any_graph, last_stage
from ratt_opt.attackers.attack_tree import AttackTree
from ratt_opt.attackers.by_partition.threshold_search import LARGEST_PLAIN, threshold_search
from ratt_opt.attackers.by_size.relaxed_teams import unprotected_bound
from ratt_opt.attackers.few_attacks import try_every_attack
from ratt_opt.attackers.first_bound import first_bound
from ratt_opt.attackers.heuristics.bounded_rational import bounded_rational_attack
from ratt_opt.attackers.heuristics.greedy import greedy_attack
from ratt_opt.attackers.task import AttackBracket, AttackMemory, AttackResult, AttackTask, MeetsAim, PlanValues, outward
from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.errors import InputError
from ratt_opt.graph.few_cuts import attacks_are_few
from ratt_opt.graph.threshold import LARGEST_COMPILED
from ratt_opt.problem import Attack
from ratt_opt.progress import Step
from ratt_opt.setfunctions.information import InformationObjective
from ratt_opt.setfunctions.metered import unmetered
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ratt_opt.graph.separable_groups import SeparableGroups
    from ratt_opt.problem import Problem

__all__ = ["strongest_attack", "worst_case_attack"]

THRESHOLDS_FASTER = 15
"""Up to so many robots, thresholds are decided faster than partitions are searched, on any graph."""
FEW_GROUPS, MANY_GROUPS, LISTING_SHARE = 10_000, 300_000, 0.1
"""Groups that an attack may leave for partitions to be searched: where thresholds are the alternative, and else; and
of the seconds left, for listing them. It takes a second on sparse graphs of 50 robots, four on dense ones."""

RENEWED = 4
"""Times as many seconds as an earlier attack on the plan had, from which its first stages, which had shares of them,
are run again before its last one goes on."""

GREEDY_SHARE = 0.05
"""Of the time left for greedy steps on networks, which at 500 robots of disk-6 took 36 of 40 seconds; annealed attacks,
which come later, are worse for the team."""

SPATIAL_SHARE = 0.6
"""Of the time left for families by their sizes where targets are not in the plane, before prices."""

UNDONE = {Stop.TIME, Stop.NODES, Stop.EVALUATIONS, Stop.HEURISTIC}


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
) -> AttackResult:
    """Find the attack that hurts one plan most.

    - Up to 12 robots, and up to 20 where the next three lines do not apply, on any graph and for any
      objective, thresholds are decided one after the other (``graph/threshold.py``; a node is one
      threshold). The result relies on nothing.
    - Larger teams on graphs on which few links are cut and few robots blinded (up to 20,000 attacks, as with one cut on
      hundreds of robots): every attack (``few_attacks.py``; a node is a set of links). Relies on a non-decreasing
      objective.
    - Larger teams with two-dimensional targets on a complete graph without protected links: families
      of groups by their sizes (``by_size``; a node is a bound, a branch or a partial set), and where several groups are
      about equally good, prices of robots and links. Where there are too many vectors of sizes, it goes on with these
      and with annealed attacks until the time is up, and without a limit ends ``HEURISTIC`` where it did not close.
      Relies on a non-decreasing objective, which the three criteria are.
    - Two-dimensional targets on other graphs that an attack can split into few groups (up to 300,000), 16 to 60
      robots: partitions into groups and who is blinded in each (``by_partition``; a node is a group tried or a partial
      set), beyond 20 robots and where half of all links are there for a fifth of the budget, elsewhere with annealed
      attacks after about a second; where there are more than 10,000 groups, these first, and prices that leave few
      groups (``by_covers``). Before, on a complete graph, the bounds of the attacker that may cut protected links too
      (``unprotected_bound``). Relies on a non-decreasing objective, as above.
    - Teams of more than 20 robots on any graph, where the lines above do not apply or end: annealed attacks, tree
      inequalities (``tree_bound.py``), groups of sizes that are possible on the graph (``by_size/relaxed_teams.py``;
      where another search asks, on dense graphs and within a limit of time), and prices that no weak group pays
      (``by_prices``; a node is a branch on one robot), until closed or out of the budget: give one, as graphs of 50
      robots can take hours to close (of another search's budget that limits nothing, half a million nodes). Relies on
      a non-decreasing objective, as above; targets of any dimension. Compiling takes about a minute once per machine.
    - Set functions that are no information criteria, beyond the first line or where that would take too long: greedy
      steps and exchanges, and the bounds of ``any_function.py``; within a limit of time or values, annealing where no
      other search asks, and where none does or it asks again with a memory, all attacks by branch and bound
      (``attack_tree.py``).
    - Otherwise (criteria of one's own) an honest bracket (``forced_group.py``), within a limit of time then annealing
      and all attacks by branch and bound, without one ``HEURISTIC`` where it did not close. Relies on a non-decreasing
      objective (not checked).

    A keyboard interrupt or a spent budget returns the bracket reached; the lower bound of up to 12 robots
    then relies on a non-decreasing objective too. Interrupted before any attack is known, it evaluates the team
    without an attack and returns that, and the value of no measurement.

    Parameters
    ----------
    problem : N robots, E elements
    elements : (N,) element chosen for each robot
    max_nodes, time_limit : nodes that may be explored, and seconds, checked between nodes; unlimited by default
    max_evaluations : values of an objective that is no information criterion (a few are asked for whatever the limit)
    budget : an outer search's budget: its seconds and interrupts count too
    aim : stop, with ``GAP``, at an attack that leaves the team no more than this, whether or not there are worse ones
    known : an attack to begin with; the one found is no better for the team
    memory : of earlier attacks on this plan that a budget ended: both ends are taken from there, and prices, or
        partitions, are gone on with; what this one finds out is left there

    Raises
    ------
    InputError : an element is not its robot's, ``elements`` has the wrong shape, a budget is not a number >= 0, ``aim``
        is no number, ``known`` is not within the budgets, or ``memory`` is of another plan.

    Source: ratt.tex, inner problem of eqn:resi_target_prob.
    """
    memory = AttackMemory() if memory is None else memory
    found = strongest_attack(
        problem,
        elements,
        max_nodes=max_nodes,
        time_limit=time_limit,
        max_evaluations=max_evaluations,
        budget=budget,
        aim=aim,
        known=known,
        memory=memory,
    )
    return outward(memory.searched_of(problem), problem.check_plan(elements), found)


def strongest_attack(
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
) -> AttackResult:
    """:func:`worst_case_attack` for other searches: both ends as they were computed."""
    own = Budget.inside(budget, time_limit, max_nodes, max_evaluations)
    if isinstance(aim, bool) or not isinstance(aim, Real) or math.isnan(aim):
        raise InputError("aim", "must be a number", aim)
    values = PlanValues(problem, elements)
    memory = AttackMemory() if memory is None else memory
    memory.check(problem, values.plan)
    problem = memory.searched_of(problem)
    values.objective = problem.objective
    try:
        asked = problem
        if not isinstance(problem.objective, InformationObjective):
            asked = metered_problem(problem, own)
            values.objective = asked.objective
        if memory.bracket is None:
            first = bounded_rational_attack(asked, values.plan)
            is_exact = problem.evaluation_error == 0.0  # then the end was not moved
            upper = first.upper if is_exact else asked.team_value(values.plan, first.attack)
            memory.bracket = AttackBracket(first.attack, upper, first.lower, problem.objective.rounding)
            values.evaluations = first.evaluations
        memory.bracket.aim = aim
        if known is not None:
            memory.bracket.offer(known, asked.team_value(values.plan, problem.check_attack(known)))
        memory.bracket.check_aim()
        is_inner = budget is not None or max_nodes is not None
        task = AttackTask(asked, values, memory.bracket, own, memory)
        stop = _search(task, is_inner=is_inner)
    except OutOfBudget as out:
        stop = out.stop
    except MeetsAim:
        stop = Stop.GAP
    except KeyboardInterrupt:
        stop = own.interrupt()
    if memory.bracket is not None and memory.bracket.is_closed and stop in UNDONE:
        stop = Stop.CLOSED  # by what was known before the budget ended
    if (bracket := memory.bracket) is None:  # what no attack at all gives
        values.objective = unmetered(problem.objective)
        bracket = AttackBracket(Attack(), _unattacked(problem, values), values(()))
    attack, lower, upper = bracket.attack, min(bracket.lower, bracket.upper), bracket.upper
    return AttackResult(
        attack=attack, lower=lower, upper=upper, stop=stop, evaluations=values.evaluations, nodes=own.nodes
    )


def _unattacked(problem: Problem, values: PlanValues) -> float:
    return max(values(group) for group in problem.communication.groups())


def _search(task: AttackTask, *, is_inner: bool) -> Stop:
    problem, plan = task.problem, task.values.plan
    begun = task.memory.search
    if isinstance(begun, AttackTree):
        goes_on = isinstance(problem.objective, InformationObjective) or not _has_table(task)
    else:
        goes_on = task.budget.seconds_left <= RENEWED * task.memory.seconds
    if begun is not None and goes_on:
        return last_stage(task, begun)
    task.memory.seconds = task.budget.seconds_left
    if not isinstance(problem.objective, InformationObjective):
        return _any_function(task, is_inner=is_inner)
    if problem.n_robots <= LARGEST_PLAIN:
        try:
            return threshold_search(task)
        except (OutOfBudget, KeyboardInterrupt):
            task.bracket.raise_lower(first_bound(problem.objective, plan, problem.threat))
            raise
    task.bracket.raise_lower(first_bound(problem.objective, plan, problem.threat))
    if task.budget.is_interrupted:
        return Stop.INTERRUPTED
    return Stop.CLOSED if task.bracket.is_closed else _larger_team(task, is_inner=is_inner)


def _are_tried_one_by_one(problem: Problem) -> bool:
    """Whether attacks are few; where links are alike, sizes of groups are fewer still."""
    return not problem.threat.links_alike and attacks_are_few(problem.threat)


def _larger_team(task: AttackTask, *, is_inner: bool) -> Stop:
    """More robots than thresholds are decided for at once, under a criterion of information matrices."""
    problem, plan = task.problem, task.values.plan
    if _are_tried_one_by_one(problem):
        return try_every_attack(task)
    team = PackedTeam.of(problem.objective, plan)
    if team is not None and problem.threat.links_alike:
        from ratt_opt.attackers.by_size.size_vector_search import SizeVectorSearch  # compiles

        if team.is_planar:
            return SizeVectorSearch(task, team).run()
        with task.budget.stage(SPATIAL_SHARE) as part:
            SizeVectorSearch(replace(task, budget=part), team).run()
        if task.bracket.is_closed:
            return Stop.CLOSED
    with task.budget.stage(GREEDY_SHARE) as part:
        task.offer(greedy_attack(problem, plan, budget=part).attack)
    groups = _few_groups(task, team)
    if problem.n_robots <= LARGEST_COMPILED and groups is None:
        return threshold_search(task)
    if team is not None and problem.communication.is_complete:
        unprotected_bound(task, team)
    is_brief = is_inner and math.isinf(task.budget.seconds_left)
    return any_graph(task, team, groups, is_brief=is_brief)


def _any_function(task: AttackTask, *, is_inner: bool) -> Stop:
    """Thresholds where all sets of robots can be valued; where that is limited, and beyond, first what is quick."""
    n_robots, budget = task.problem.n_robots, task.budget
    if n_robots > LARGEST_COMPILED and _are_tried_one_by_one(task.problem):
        any_bound(task)
        return Stop.CLOSED if task.bracket.is_closed else try_every_attack(task)
    is_limited = min(budget.seconds_left, budget.evaluations_left) < math.inf
    has_table = _has_table(task)
    if n_robots > LARGEST_COMPILED or is_limited:
        any_bound(task)
        exchange_attack(task)
        if is_limited and not (task.bracket.is_closed or has_table or is_inner):
            anneal_for_a_share(task)
        if task.bracket.is_closed:
            return Stop.CLOSED
    if has_table:
        return threshold_search(task)
    if task.bracket.is_closed or not is_limited:
        return Stop.CLOSED if task.bracket.is_closed else Stop.HEURISTIC
    budget.check()
    tree = AttackTree(task)
    if is_inner:  # of many attacks: whoever asks again, with its memory, wants to know
        task.memory.search = tree
        return budget.stop() or Stop.HEURISTIC
    return last_stage(task, tree)


def _has_table(task: AttackTask) -> bool:
    """Whether all sets of robots can be valued."""
    return task.problem.n_robots <= LARGEST_COMPILED and 2**task.problem.n_robots <= task.budget.evaluations_left


def _few_groups(task: AttackTask, team: PackedTeam | None) -> SeparableGroups | None:
    """The groups an attack may leave, where they are few enough, and soon listed, to search partitions of the team."""
    problem = task.problem
    if team is None or problem.n_robots <= THRESHOLDS_FASTER:
        return None
    from ratt_opt.graph.separable_groups import separable_groups  # compiles

    few = FEW_GROUPS if problem.n_robots <= LARGEST_COMPILED else MANY_GROUPS
    return separable_groups(problem.threat, few, task.budget.part(LISTING_SHARE))
