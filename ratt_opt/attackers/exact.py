"""The exact worst-case attack on a plan, with a bracket at any time."""

from __future__ import annotations

import math
from dataclasses import replace
from numbers import Real
from typing import TYPE_CHECKING

from ratt_opt.attackers.any_function import any_bound, exchange_attack, metered_problem
from ratt_opt.attackers.by_partition.threshold_search import LARGEST_PLAIN, threshold_search
from ratt_opt.attackers.by_size.relaxed_teams import possible_sizes_bound, unprotected_bound
from ratt_opt.attackers.first_bound import first_bound
from ratt_opt.attackers.forced_group import forced_group_bound
from ratt_opt.attackers.heuristics.bounded_rational import bounded_rational_attack
from ratt_opt.attackers.heuristics.greedy import greedy_attack
from ratt_opt.attackers.task import AttackBracket, AttackMemory, AttackResult, AttackTask, MeetsAim, PlanValues
from ratt_opt.attackers.tree_bound import tree_bound
from ratt_opt.attackers.weakest_set.planar_team import PlanarTeam
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.errors import InputError
from ratt_opt.graph.largest_group.spreading import forced_size
from ratt_opt.graph.threshold import LARGEST_COMPILED
from ratt_opt.problem import Attack
from ratt_opt.progress import Step
from ratt_opt.setfunctions.information import InformationObjective
from ratt_opt.setfunctions.metered import unmetered
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ratt_opt.attackers.by_prices.price_search import PriceSearch
    from ratt_opt.attackers.task import Resumable
    from ratt_opt.graph.separable_groups import SeparableGroups
    from ratt_opt.problem import Problem

__all__ = ["worst_case_attack"]

THRESHOLDS_FASTER = 15
"""Up to so many robots, thresholds are decided faster than partitions are searched, on any graph."""
TREE_SHARE, BOUND_SHARE, BOUND_NODES = 0.2, 0.3, 500_000
"""Of what is left of the budget for tree inequalities; then, and at most so many nodes, for the weakest group of the
forced size; prices get the rest. Not measured."""

FIRST_STARTS, INNER_STARTS, STARTS_FOR = 12, 3, 24
"""Annealed attacks before the first threshold, and where only nodes limit or another search sets no time: about every
fourth start finds the best attack of 24 robots where it is hardest to find (small worlds and hubs, a third blinded).
The first grow with the square of the robots beyond these 24: at 50 (a disk of mean degree 12, 17 blinded, 90 links cut)
the fourteenth start is the first of 112 to find the best attack, 1.3 % worse for the team than what the others find."""

INNER_NODES = 500_000
"""Of the search by prices where another search asks and nothing is limited: some ten seconds. Rankings attack dozens of
teams, none of which need ever close."""

DENSE = 0.5
"""Share of all links from which groups of possible sizes are looked at before partitions, if time allows."""

FEW_GROUPS, MANY_GROUPS, LISTING_SHARE = 10_000, 300_000, 0.1
"""Groups that an attack may leave for partitions to be searched: where thresholds are the alternative, and else; and
of the seconds left, for listing them. It takes a second on sparse graphs of 50 robots, four on dense ones."""

RENEWED = 4
"""Times as many seconds as an earlier attack on the plan had, from which its first stages, which had shares of them,
are run again before its last one goes on."""


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

    - Up to 12 robots, and up to 20 where the next two lines do not apply, on any graph and for any
      objective, thresholds are decided one after the other (``graph/threshold.py``; a node is one
      threshold). The result relies on nothing.
    - Larger teams with two-dimensional targets on a complete graph without protected links: families
      of groups by their sizes (``by_size``; a node is a bound, a branch or a partial set). Relies on a non-decreasing
      objective, which the three criteria are.
    - Two-dimensional targets on other graphs that an attack can split in few ways, 16 to 60 robots, to 20 where half of
      all links are there: partitions into groups and who is blinded in each (``by_partition``; a node is a group tried
      or a partial set), after the bounds of the next line and, on a complete graph, of the attacker that may cut
      protected links too (``unprotected_bound``). Relies on a non-decreasing objective, as above.
    - Teams of more than 20 robots on any graph, where the lines above do not apply: annealed attacks, tree inequalities
      (``tree_bound.py``), groups of sizes that are possible on the graph (``by_size/relaxed_teams.py``; where another
      search asks, on dense graphs and within a limit of time), and prices that no weak group pays (``by_prices``; a
      node is a branch on one robot), until closed or out of the budget: give one, as graphs of 50 robots can take
      hours to close (of another search's budget that limits nothing, half a million nodes). Relies on a non-decreasing
      objective, as above; targets of any dimension. Compiling takes about a minute once per machine.
    - Set functions that are no information criteria, beyond the first line or where that would take too long: greedy
      steps and exchanges, and the bounds of ``any_function.py``.
    - Otherwise an honest bracket (``forced_group.py``), with ``stop`` ``HEURISTIC`` where it did not close. Relies on a
      non-decreasing objective (not checked).

    A keyboard interrupt or a spent budget returns the bracket reached. Interrupted before any attack
    is known, it evaluates the team without an attack and returns that; its lower bound, the value of no
    measurement, relies on a non-decreasing objective until the 2**N values of a small team are tabulated.

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
    own = Budget.inside(budget, time_limit, max_nodes, max_evaluations)
    if isinstance(aim, bool) or not isinstance(aim, Real) or math.isnan(aim):
        raise InputError("aim", "must be a number", aim)
    values = PlanValues(problem, elements)
    memory = AttackMemory() if memory is None else memory
    memory.check(problem, values.plan)
    try:
        asked = problem
        if not isinstance(problem.objective, InformationObjective):
            asked = metered_problem(problem, own)
            values.objective = asked.objective
        if memory.bracket is None:
            first = bounded_rational_attack(asked, values.plan)
            memory.bracket = AttackBracket(first.attack, first.upper, first.lower, problem.objective.rounding)
            values.evaluations = first.evaluations
        memory.bracket.aim = aim
        if known is not None:
            memory.bracket.offer(known, asked.team_value(values.plan, problem.check_attack(known)))
        memory.bracket.check_aim()
        is_inner = budget is not None or max_nodes is not None
        task = AttackTask(asked, values, memory.bracket, own, memory)
        stop = _search(task, is_brief=is_inner and math.isinf(own.seconds_left))
    except OutOfBudget as out:
        stop = out.stop
    except MeetsAim:
        stop = Stop.GAP
    except KeyboardInterrupt:
        stop = own.interrupt()
    if (bracket := memory.bracket) is None:  # what no attack at all gives
        values.objective = unmetered(problem.objective)
        bracket = AttackBracket(Attack(), _unattacked(problem, values), values(()))
    attack, lower, upper = bracket.attack, min(bracket.lower, bracket.upper), bracket.upper
    return AttackResult(
        attack=attack, lower=lower, upper=upper, stop=stop, evaluations=values.evaluations, nodes=own.nodes
    )


def _unattacked(problem: Problem, values: PlanValues) -> float:
    return max(values(group) for group in problem.communication.groups())


def _search(task: AttackTask, *, is_brief: bool) -> Stop:
    problem, plan = task.problem, task.values.plan
    if task.memory.search is not None and task.budget.seconds_left <= RENEWED * task.memory.seconds:
        return _last_stage(task, task.memory.search)
    task.memory.seconds = task.budget.seconds_left
    if not isinstance(problem.objective, InformationObjective):
        return _any_function(task)
    if problem.n_robots <= LARGEST_PLAIN:
        return threshold_search(task)
    task.bracket.raise_lower(first_bound(problem.objective, plan, problem.threat))
    team = PlanarTeam.of(problem.objective, plan)
    if team is not None and problem.threat.links_alike:
        from ratt_opt.attackers.by_size.size_vector_search import SizeVectorSearch  # compiles

        return SizeVectorSearch(task, team).run()
    better = greedy_attack(problem, plan, budget=task.budget)
    task.bracket.offer(better.attack, better.upper)
    task.budget.check()
    groups = _few_groups(task, team)
    if problem.n_robots <= LARGEST_COMPILED and groups is None:
        return threshold_search(task)
    if team is not None and problem.communication.is_complete:
        unprotected_bound(task, team)
    return _any_graph(task, team, groups, is_brief=is_brief)


def _any_function(task: AttackTask) -> Stop:
    """Thresholds where all sets of robots can be valued; where that is limited, and beyond, first what is quick."""
    n_robots, budget = task.problem.n_robots, task.budget
    is_limited = min(budget.seconds_left, budget.evaluations_left) < math.inf
    if n_robots > LARGEST_COMPILED or is_limited:
        any_bound(task)
        exchange_attack(task)
        if task.bracket.is_closed:
            return Stop.CLOSED
    if n_robots <= LARGEST_COMPILED and 2**n_robots <= budget.evaluations_left:
        return threshold_search(task)
    return Stop.CLOSED if task.bracket.is_closed else budget.stop() or Stop.HEURISTIC


def _any_graph(task: AttackTask, team: PlanarTeam | None, groups: SeparableGroups | None, *, is_brief: bool) -> Stop:
    """Groups of possible sizes on dense graphs; partitions where they are few; else annealing, bounds, prices."""
    is_dense = _is_dense(task.problem) and not is_brief
    if team is not None and groups is not None:
        from ratt_opt.attackers.by_partition.split_search import SplitSearch  # compiles

        if not is_dense or task.problem.n_robots <= LARGEST_COMPILED:
            stop = forced_group_bound(task, team)
            return stop if stop is Stop.CLOSED else _last_stage(task, SplitSearch(task, team, groups))
        if _closed_by_sizes(task, team, 0):
            return Stop.CLOSED
    if is_brief and task.budget.max_nodes is None:
        task.budget.max_nodes = task.budget.nodes + INNER_NODES
    least = _by_trees(task, is_brief=is_brief)
    prices = _price_search(task) if task.budget.stop() is None else None
    if prices is None:
        return forced_group_bound(task, team, least)
    starts = int(FIRST_STARTS * max(task.problem.n_robots / STARTS_FOR, 1.0) ** 2)
    prices.anneal(INNER_STARTS if is_brief else starts)
    if _closed_by_sizes(task, team, least, looks=not is_brief):
        return Stop.CLOSED
    return _last_stage(task, prices)


def _last_stage(task: AttackTask, search: Resumable) -> Stop:
    """Run a search, begun or new, that goes on where the memory finds it."""
    search.task, task.memory.search = task, search
    return search.run()


def _closed_by_sizes(task: AttackTask, team: PlanarTeam | None, least: int, *, looks: bool = True) -> bool:
    """Whether groups of possible sizes, where one ``looks`` at them, or the weakest of the forced size close it."""
    if looks:
        least = possible_sizes_bound(task, team, least)
    return task.bracket.is_closed or _forced_group_in_share(task, team, least) is Stop.CLOSED


def _is_dense(problem: Problem) -> bool:
    return 2 * len(problem.communication.links) >= DENSE * problem.n_robots * (problem.n_robots - 1)


def _by_trees(task: AttackTask, *, is_brief: bool) -> int:
    """Seeing robots that some group is forced to keep, by tree inequalities; the bracket knows what that is worth."""
    objective, threat, part = task.problem.objective, task.problem.threat, task.budget.part(TREE_SHARE)
    assert isinstance(objective, InformationObjective)
    size = forced_size(threat, part, threat.graph.n_robots)
    task.bracket.raise_lower(first_bound(objective, task.values.plan, threat, size))
    if not is_brief:
        task.bracket.raise_lower(tree_bound(objective, task.values.plan, threat, part, task.bracket.upper))
    task.budget.check()
    return size


def _price_search(task: AttackTask) -> PriceSearch | None:
    """The search by prices, new or begun, for criteria with compiled code."""
    from ratt_opt.attackers.by_prices.team import PricedTeam

    team = PricedTeam.of(task.problem.objective, task.values.plan)
    if team is None:
        return None
    from ratt_opt.attackers.by_prices.price_search import PriceSearch  # compiles

    begun = task.memory.search
    if isinstance(begun, PriceSearch):
        begun.task = task
        return begun
    return PriceSearch(task, team)


def _forced_group_in_share(task: AttackTask, team: PlanarTeam | None, least: int) -> Stop:
    """The bound of the forced size within its share of the seconds and nodes left; the bracket keeps what it proves."""
    budget = task.budget
    nodes = math.inf if budget.max_nodes is None else BOUND_SHARE * budget.nodes_left(budget.max_nodes)
    part = budget.part(BOUND_SHARE, max_nodes=int(min(nodes, BOUND_NODES)))
    try:
        return forced_group_bound(replace(task, budget=part), team, least)
    except OutOfBudget as out:
        if out.stop is Stop.INTERRUPTED:
            raise
        return out.stop
    finally:
        budget.nodes += part.nodes


def _few_groups(task: AttackTask, team: PlanarTeam | None) -> SeparableGroups | None:
    """The groups an attack may leave, where they are few enough, and soon listed, to search partitions of the team."""
    problem = task.problem
    if team is None or problem.n_robots <= THRESHOLDS_FASTER:
        return None
    from ratt_opt.graph.separable_groups import separable_groups  # compiles

    few = FEW_GROUPS if problem.n_robots <= LARGEST_COMPILED else MANY_GROUPS
    return separable_groups(problem.threat, few, task.budget.part(LISTING_SHARE))
