"""Robust selection by buckets of equal size, each chosen greedily as if the others were lost."""

from __future__ import annotations

from math import ceil, log
from typing import TYPE_CHECKING

from ratt_opt._validation import check_integer
from ratt_opt.planners.greedy_sets import Selection
from ratt_opt.problem import Plan, Problem, check_problem

if TYPE_CHECKING:
    from ratt_opt.budget import Budget

__all__ = ["bucket_size", "uniform_buckets"]


def bucket_size(count: int, lost: int) -> int:
    """Size of a bucket if ``count`` elements are chosen and ``lost`` removed: ``lost * log(count)``, if that fits.

    The published size asks for ``lost`` far below the root of ``count``. Smaller teams would consist of buckets alone:
    here these take at most half of the elements (our choice), and have at least one each.
    """
    return max(1, min(ceil(lost * log(max(count, 2))), count // (2 * max(lost, 1))))


def uniform_buckets(problem: Problem, *, size: int | None = None, budget: Budget | None = None) -> Plan:
    """Plan against ``alpha_s`` lost robots by ``alpha_s`` greedy buckets, then greedy for the others.

    Each bucket is chosen greedily among the robots left, beginning from nothing; so is the rest. Links are ignored.

    Guarantee: 0.387 of the optimum, in the limit of ``alpha_s = o(sqrt(N))``, for a submodular non-decreasing function
    and at most N elements of a set, of which ``alpha_s`` are lost. For one element of each robot none is published.

    Parameters
    ----------
    size : elements of a bucket; by default :func:`bucket_size`

    Raises
    ------
    InputError : ``size`` is no integer of at least 1.

    Source: Orlin, Schulz, Udwani, Robust monotone submodular function maximization, IPCO 2016 and Mathematical
    Programming 172, 2018 (arXiv 1507.06616), the 0.387 algorithm, in the form of Bogunovic and others 2017, Section 2.
    Read here: the abstract (0.387 for ``alpha_s`` far below the root of N). Taken on trust: the size of a bucket.
    """
    lost = check_problem(problem, knows_at_most=True).alpha_s
    count = problem.n_robots if problem.at_most is None else problem.at_most
    given = bucket_size(count, lost) if size is None else check_integer("size", size, low=1)
    selection = Selection.of(problem, budget)
    for _ in range(lost):
        selection.grow(given)
    selection.grow(count)
    return selection.plan(problem)
