"""Robust active target tracking: bait for the attacked robots, greedy for the others; and what it is compared with."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import inf, isinf
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._params import check_at_least_one
from ratt_opt._validation import FloatArray, IntArray, check_integer, readonly
from ratt_opt.attack.edge_cuts.smallest import bound_soon
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.graph.connected_partitions import LARGEST_LATTICE
from ratt_opt.graph.survivor_sizes import caa
from ratt_opt.problem import Plan, Problem, check_problem
from ratt_opt.running.progress import Step
from ratt_opt.setfunctions.information import InformationObjective
from ratt_opt.solvers.lazy_greedy import LazyGreedy, LazyGreedyParams

if TYPE_CHECKING:
    from ratt_opt.graph.largest_group.counting import LargestGroup
    from ratt_opt.graph.threat import Threat

__all__ = [
    "RattParams",
    "alpha_cs_in_share",
    "bait_and_greedy",
    "equivalent_sensing_attacks",
    "greedy",
    "largest_group_in_share",
    "links_worth",
    "myopic",
    "random_plan",
    "ratt",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class RattParams:
    """Time for ``n_max`` if there is a limit: more of it finds fewer baits, and leaves less for what comes after.

    ``share`` : of the remaining seconds [1]; ``quick`` : not less, up to the share ``half`` of them [s]: what takes no
    longer is the same within any limit of twice as many; ``at_once`` : not less within any limit [s]: RATT's plan
    then does not depend on it
    ``first`` : share if the plan is but a search's first one [1]. On networks of 30 robots a tenth of 120 seconds went
    there, and no plan was better for it; ``short`` : at most, if that is less than ``quick``: of one second nothing
    was left [1]
    ``greedy`` : how greedy choices are evaluated
    """

    share: float = 0.1
    quick: float = 2.0
    half: float = 0.5
    at_once: float = 0.3
    first: float = 0.02
    short: float = 0.1
    greedy: LazyGreedyParams = field(default_factory=LazyGreedyParams)

    def __post_init__(self) -> None:
        check_at_least_one(self, ("greedy.first",))

    def seconds_of(self, left: float) -> float | None:
        """Seconds for ``n_max`` of those that are left."""
        return None if isinf(left) else max(self.share * left, min(self.quick, self.half * left), self.at_once)

    def first_share(self, left: float) -> float:
        """Share of the seconds left for the ``n_max`` of a search's first plan."""
        return min(max(self.first, self.quick / max(left, self.quick)), self.short)


DEFAULT = RattParams()


@Step("the smallest largest group")
def equivalent_sensing_attacks(problem: Problem, budget: Budget | None = None, params: RattParams = DEFAULT) -> int:
    """Return ``alpha_cs``, the sensing attacks that the link attacks are worth: ``N - n_max``, or a bound above it.

    Complete graphs without protected links: CAA. Other graphs: the exact ``n_max`` up to 14 robots and, if an
    attack can split off few groups, up to 60; else a proved lower bound on it, by tree inequalities and counting,
    within a fixed amount of work (an integer program takes minutes from 20 robots on). If both were asked, at 20 to
    36 robots, they mostly agree and differ by one at most. RATT then prepares for more attacks than the links are
    worth; its guarantees hold for any number of baits. ``smallest_largest_group`` takes the time that the exact one
    needs, and :func:`ratt` an ``alpha_cs`` from there.

    ``budget`` : an outer search's: if it is short and robots are more than 14, a weaker bound is returned

    Source: ratt.tex, Algorithm 2 (CAA), for complete graphs.
    """
    if check_problem(problem, knows_at_most=True).threat.links_alike:
        return caa(problem.n_robots, problem.alpha_c).alpha_cs
    return problem.n_robots - largest_group_in_share(problem, budget, params).lower


def largest_group_in_share(problem: Problem, budget: Budget | None, params: RattParams = DEFAULT) -> LargestGroup:
    """Bracket the smallest largest group that link attacks leave, as :func:`equivalent_sensing_attacks` needs it."""
    is_small = problem.n_robots <= LARGEST_LATTICE  # a tenth of a second: the same however busy the machine is
    left = inf if budget is None or is_small else budget.seconds_left
    return bound_soon(replace(problem.threat, alpha_s=0), Budget(params.seconds_of(left)))


def links_worth(threat: Threat, budget: Budget | None = None) -> int:
    """Sensing attacks that the link attacks of a threat are worth: the same number for the same links, without time."""
    if threat.links_alike:
        return caa(threat.graph.n_robots, threat.alpha_c).alpha_cs
    return threat.graph.n_robots - bound_soon(replace(threat, alpha_s=0), budget or Budget()).lower


def ratt(
    problem: Problem, *, alpha_cs: int | None = None, budget: Budget | None = None, params: RattParams = DEFAULT
) -> Plan:
    """Plan against ``alpha = alpha_s + alpha_cs`` sensing attacks.

    The ``alpha`` robots with the largest individual values get their individually best
    element (bait); the others are chosen greedily, ignoring the bait. With
    ``alpha >= N`` every robot is bait. Ties go to the lowest element, then the lowest robot.

    Parameters
    ----------
    alpha_cs : sensing attacks that the link attacks are worth, if known; else asked for
    budget : an outer search's budget: if ``alpha_cs`` takes long it is a bound found in a part of its seconds, and
        once it is spent, the robots left get their individually best element too
    params : which part of its seconds, and how greedy choices are evaluated

    Returns
    -------
    Plan : with ``bait`` and ``alpha_cs``; ``evaluations`` counts the set-function values of Algorithm 1.

    Source: ratt.tex, Algorithm 1 (RATT); guarantee in Theorem 1, evaluations in Theorem 2.
    """
    known = equivalent_sensing_attacks(problem, budget, params) if alpha_cs is None else alpha_cs
    planned = bait_and_greedy(problem, problem.alpha_s + known, budget, params=params.greedy)
    return replace(planned, alpha_cs=known)


def alpha_cs_in_share(problem: Problem, budget: Budget, params: RattParams = DEFAULT) -> int:
    """``alpha_cs`` as far as it is found in a share of a search's time: RATT's plan is but its first one."""
    return links_worth(problem.threat, budget.part(params.first_share(budget.seconds_left)))


@Step("planning")
def bait_and_greedy(
    problem: Problem,
    alpha: int,
    budget: Budget | None = None,
    single: FloatArray | None = None,
    params: LazyGreedyParams = DEFAULT.greedy,
) -> Plan:
    """Algorithm 1 for a given number ``alpha >= 0`` of sensing attacks (lines 3 to 18), as far as the budget lasts.

    ``single`` : (E,) individual values, if known; else asked for. They count as evaluations either way
    """
    check_problem(problem, knows_at_most=True)
    single = problem.objective.singletons() if single is None else single
    if problem.at_most is not None:
        return _choose_few(problem, alpha, budget or Budget(), single)
    best = np.array([choice[np.argmax(single[choice])] for choice in problem.choices])
    # A stable sort of the negated values keeps the lowest robot first among equals.
    order = np.argsort(-single[best], kind="stable")
    bait = np.sort(order[:alpha])
    elements = best.copy()
    greedy_robots = np.setdiff1d(np.arange(problem.n_robots), bait)
    budget = budget or Budget()
    evaluations = problem.objective.n + _greedy(problem, greedy_robots, single, elements, budget, params)
    return Plan(elements=readonly(elements), evaluations=evaluations, bait=tuple(int(i) for i in bait))


def _choose_few(problem: Problem, alpha: int, budget: Budget, single: FloatArray) -> Plan:
    """Algorithm 1 if the number of robots that choose is limited: first bait, then greedy ones; the others rest.

    Elements are taken in the same order, with the same ties. A spent budget leaves robots idle.
    """
    most, elements = problem.at_most or 0, problem.idle.copy()
    best = np.array([choice[np.argmax(single[choice])] for choice in problem.choices])
    bait = np.sort(np.argsort(-single[best], kind="stable")[: min(alpha, most)])
    elements[bait] = best[bait]
    useful = np.ones(problem.objective.n, dtype=np.bool_)
    useful[problem.idle] = False
    candidates = np.flatnonzero(useful & ~np.isin(problem.robot, bait))
    chosen, evaluations = np.array([], dtype=np.int64), problem.objective.n
    while len(candidates) and len(bait) + len(chosen) < most and not budget.is_over:
        try:
            values = problem.objective.extensions(chosen, candidates) if len(chosen) else single[candidates]
        except OutOfBudget:  # of the values of the function
            break
        evaluations += len(candidates) if len(chosen) else 0
        pick = candidates[np.argmax(values)]
        elements[problem.robot[pick]] = pick
        chosen = np.append(chosen, pick)
        candidates = candidates[problem.robot[candidates] != problem.robot[pick]]
    return Plan(elements=readonly(elements), evaluations=evaluations, bait=tuple(int(i) for i in bait))


def _greedy(  # noqa: PLR0917
    problem: Problem, robots: IntArray, single: FloatArray, elements: IntArray, budget: Budget, params: LazyGreedyParams
) -> int:
    """Fill ``elements`` of ``robots`` by the standard greedy algorithm; return the evaluations it took.

    The first round needs no evaluation: its values are the individual ones.
    """
    candidates = np.flatnonzero(np.isin(problem.robot, robots))
    objective = problem.objective
    if isinstance(objective, InformationObjective) and objective.compiled_code is not None and objective.dimension == 2:
        rounds = len(robots) - 1
        if not budget.is_over and rounds * len(candidates) / 2 * objective.n_targets > params.plain:
            greedy = LazyGreedy(objective, np.isin(np.arange(objective.n), candidates), params)
            return _lazy_greedy(problem, greedy, elements, budget)
    chosen = np.array([], dtype=np.int64)
    evaluations = 0
    while len(candidates) and not budget.is_over:
        if len(chosen):
            try:
                values = objective.extensions(chosen, candidates)
            except OutOfBudget:  # of the values of the function
                break
            evaluations += len(candidates)
        else:
            values = single[candidates]
        pick = candidates[np.argmax(values)]
        elements[problem.robot[pick]] = pick
        chosen = np.append(chosen, pick)
        candidates = candidates[problem.robot[candidates] != problem.robot[pick]]
    return evaluations


def _lazy_greedy(problem: Problem, greedy: LazyGreedy, elements: IntArray, budget: Budget) -> int:
    """Make the greedy choices with few evaluations; the returned number is that of the plain algorithm."""
    is_open, evaluations = greedy.is_open, -int(greedy.is_open.sum())
    while (left := int(is_open.sum())) > 0 and not budget.is_over:
        pick = greedy.choose(budget)
        if pick is None:
            break
        evaluations += left
        elements[problem.robot[pick]] = pick
        is_open[problem.choices[int(problem.robot[pick])]] = False
    return evaluations


def greedy(problem: Problem, *, budget: Budget | None = None) -> Plan:
    """Standard greedy plan that ignores attacks: RATT with ``alpha = 0`` (``budget`` : as for :func:`ratt`).

    Source: Fisher, Nemhauser, Wolsey 1978; the algorithm Greedy of ratt.tex, Section VI.
    """
    return bait_and_greedy(problem, 0, budget)


def myopic(problem: Problem, *, budget: Budget | None = None) -> Plan:
    """Individually best element of every robot: RATT with ``alpha = N``. Source: ratt.tex, Remark 1."""
    return bait_and_greedy(problem, check_problem(problem, knows_at_most=True).n_robots, budget)


def random_plan(problem: Problem, *, seed: int) -> Plan:
    """Uniformly random element of every robot. Source: the algorithm Random of ratt.tex, Section VI."""
    rng = np.random.default_rng(check_integer("seed", seed, low=0))
    choices = check_problem(problem, knows_at_most=True).choices
    elements = np.array([choice[rng.integers(len(choice))] for choice in choices])
    if problem.at_most is not None:
        resting = rng.permutation(problem.n_robots)[problem.at_most :]
        elements[resting] = problem.idle[resting]
    return Plan(elements=readonly(elements), evaluations=0)
