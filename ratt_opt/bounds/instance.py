"""A guarantee for one plan of one instance: the theorems' steps with the instance's own numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.bounds.group_size import achievable_group_size, strongest_robots
from ratt_opt.bounds.guarantees import NON_DECREASING, SUBMODULAR, Guarantee
from ratt_opt.bounds.params import DEFAULT
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.curvatures.curvature import total_curvature
from ratt_opt.curvatures.domains import domain_of, over_subsets
from ratt_opt.curvatures.params import DEFAULT as CURVATURE
from ratt_opt.errors import InputError
from ratt_opt.problem import check_problem

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.bounds.params import BoundParams
    from ratt_opt.curvatures.curvature import Curvature
    from ratt_opt.problem import Problem

__all__ = ["instance_bound"]


def instance_bound(
    problem: Problem,
    elements: ArrayLike,
    *,
    k: Curvature | None = None,
    c: Curvature | None = None,
    time_limit: float | None = CURVATURE.seconds,
    budget: Budget | None = None,
    params: BoundParams = DEFAULT,
) -> Guarantee:
    """Share of the optimum that a plan is worth under the worst attack, from this plan's and this instance's numbers.

    Proof, of the larger of two. *By marginals.* Let ``u`` be the plan, ``o`` any plan, and put the robots in any
    order. For every set ``S`` of robots, ``u_S`` is built robot by robot in that order, each adding at least ``l_i``,
    the smallest marginal of ``u_i`` over sets of elements that the plan has before ``i`` (submodular: the marginal on
    top of all of them). And ``o_S`` is built from marginals of at most ``m_i``, the largest marginal of any element of
    robot ``i`` over feasible sets (submodular: its value alone). So ``phi(u_S) >= sum_S l_i >= min_i (l_i / m_i)
    phi(o_S)``, for every ``S``, hence for the best group of every outcome and after the worst attack. The order that
    makes the smallest ratio largest puts last, again and again, the robot with the largest ratio among those left:
    leaving robots out can only raise the others' ``l``.

    *By group size* (:func:`group_size_bound` with the numbers themselves). Some robot of the ``alpha_s + 1`` largest
    ``phi(u_i)`` sees after every attack, so the plan is worth at least the smallest of these. Take the attack that
    blinds the strongest robots and leaves at most ``g`` of the others in a group ``S``. It leaves any plan at most
    ``sum_S m_i``, less the largest ``m_i`` minus value of ``S``, as one of its elements can come first.

    Parameters
    ----------
    elements : (N,) any plan, RATT's or not
    k : curvature over feasible sets of a submodular objective (its word for submodularity, and its values alone)
    c : total curvature over feasible sets of a non-decreasing objective; give exactly one of the two
    time_limit : seconds; what is not known by then counts as nothing
    budget : an outer search's budget: its seconds and interrupts count too
    params : what is tabulated and annealed

    Raises
    ------
    InputError : neither or both curvatures, one over another domain, or ``elements`` is no plan.

    Source: this library. For RATT's plan never below the pattern-free bound: a greedy element's ``l`` in RATT's own
    order is its greedy marginal, at least ``(1-k) m_i``, respectively ``(1-c)^2 m_i``; a bait's likewise. If
    ``alpha_cs >= 1`` nor below the group-size bound.
    """
    check_problem(problem)
    if (k is None) == (c is None):
        raise InputError("k, c", "must be given one at a time", "neither" if k is None else "both")
    given = k or c
    assert given is not None
    if given.domain != "feasible":
        raise InputError("k" if k else "c", "must be over feasible sets (give the owners)", given.domain)
    plan = problem.check_plan(elements)
    largest = np.array([given.marginals.largest_upper[choice].max() for choice in problem.choices])
    own = Budget.inside(budget, time_limit)
    within = _on_top(problem, plan) if k else _smallest_within(problem, plan, own, params)
    try:
        value = _best_order(within, largest, own)
    except OutOfBudget:
        value = 0.0
    except KeyboardInterrupt:
        own.interrupt()
        value = 0.0
    if np.isfinite(largest).all():
        value = max(value, _by_group_size(problem, plan, largest, own, params))
    needs = (SUBMODULAR if k else NON_DECREASING, "this instance and this plan")
    return Guarantee(min(max(value, 0.0), 1.0), needs, "this instance's marginals and groups", "instance_bound")


def _by_group_size(problem: Problem, plan: IntArray, largest: FloatArray, budget: Budget, params: BoundParams) -> float:
    """Proved value of some robot after any attack over a bound on every plan; ``largest`` (N,) marginals."""
    single, free = problem.objective.singletons(), ~np.isin(np.arange(problem.n_robots), list(problem.protected_robots))
    kept = -np.sort(-np.append(single[plan[free]], 0.0))[problem.threat.n_blinded]
    safe = max([kept, *(single[plan[i]] for i in problem.protected_robots)])
    left = np.setdiff1d(np.arange(problem.n_robots), list(strongest_robots(problem)))
    size = min(achievable_group_size(problem, budget, params), len(left))
    if not size:
        return 1.0
    excess = np.maximum(largest[left] - [single[problem.choices[i]].max() for i in left], 0.0)
    # No group whose largest excess is e has more than the largest marginals with an excess up to e.
    most = max(np.sort(largest[left[excess <= e]])[-size:].sum() - e for e in np.unique(excess))
    return float(safe / most) if most > 0 else 1.0


def _best_order(within: Callable[[IntArray, int], float], largest: FloatArray, budget: Budget) -> float:
    """The smallest ratio under the best order; robots that can never add anything do not count.

    Raises ``OutOfBudget``.
    """
    left = np.flatnonzero(largest > 0)
    smallest = 1.0
    while len(left):
        ratios = np.empty(len(left))
        for position, i in enumerate(left):
            budget.check()
            ratios[position] = within(left[left != i], int(i)) / largest[i]
        smallest = min(smallest, float(ratios.max()))
        left = np.delete(left, int(ratios.argmax()))
    return smallest


def _on_top(problem: Problem, plan: IntArray) -> Callable[[IntArray, int], float]:
    """Marginals of a robot's element on top of some others'."""
    f = problem.objective

    def within(before: IntArray, robot: int) -> float:
        return f(plan[np.append(before, robot)]) - f(plan[before])

    return within


def _smallest_within(
    problem: Problem, plan: IntArray, budget: Budget, params: BoundParams
) -> Callable[[IntArray, int], float]:
    """Smallest marginals of a robot's element over subsets of some others'."""
    f, robots = problem.objective, len(plan)
    values = None
    domain = domain_of(f, None, plan) if robots <= params.table_robots else None
    if domain is not None:
        try:
            values = domain.values(budget.part(params.table_share))
        except OutOfBudget:
            pass
        except KeyboardInterrupt:
            budget.interrupt()
    if domain is None or values is None:
        # The domain's elements ascend; the plan's are in the order of the robots.
        order = np.argsort(np.argsort(plan, kind="stable"), kind="stable")
        lower = total_curvature(f, plan=plan, gap=0.1, time_limit=None, budget=budget).marginals.smallest_lower[order]
        return lambda _, robot: float(lower[robot])
    position = {int(name): axis for axis, name in enumerate(domain.names)}
    axes_of = [position[int(e)] for e in plan]
    tables = [over_subsets(np.minimum, np.diff(values, axis=axis).squeeze(axis)) for axis in axes_of]

    def within(before: IntArray, robot: int) -> float:
        own = position[int(plan[robot])]
        axes = {position[int(plan[i])] - (position[int(plan[i])] > own) for i in before}
        return float(tables[robot][tuple(int(axis in axes) for axis in range(robots - 1))])

    return within
