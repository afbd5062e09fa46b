"""Partitioned robust maximization (PRo): many small greedy buckets and few large ones, then greedy."""

from __future__ import annotations

from math import ceil, log2
from typing import TYPE_CHECKING

from ratt_opt._validation import check_integer
from ratt_opt.planners.greedy_sets import Selection
from ratt_opt.problem import Plan, Problem, check_problem

if TYPE_CHECKING:
    from ratt_opt.budget import Budget

__all__ = ["partition_sizes", "partitioned_robust"]


def partition_sizes(lost: int, eta: int = 1) -> list[int]:
    """Sizes of the buckets in their order: for i = 0 to ceil(log2 lost), ceil(lost / 2^i) of size ``2^i eta``.

    They add up to at most ``3 eta lost (log2(lost) + 2)`` (Proposition 4.1).
    """
    if lost < 1:
        return []
    return [2**i * eta for i in range(ceil(log2(lost)) + 1) for _ in range(ceil(lost / 2**i))]


def partitioned_robust(problem: Problem, *, eta: int = 1, budget: Budget | None = None) -> Plan:
    """Plan against ``alpha_s`` lost robots by greedy buckets of exponentially growing size, then greedy.

    Each bucket is chosen greedily among the robots left, beginning from nothing; so is the rest. If the team is smaller
    than the buckets together, the last ones are cut short. Links are ignored.

    Guarantee: 0.387 of the optimum, in the limit of ``alpha_s = o(N / (eta polylog N))`` and ``eta`` of at least
    ``log^2 N``, for a submodular non-decreasing function and at most N elements of a set, of which ``alpha_s`` are
    lost. For one element of each robot none is published.

    Parameters
    ----------
    eta : size of the smallest buckets; the published experiments take small ones

    Raises
    ------
    InputError : ``eta`` is no integer of at least 1.

    Source: Bogunovic, Mitrovic, Scarlett, Cevher, Robust submodular maximization: a non-uniform partitioning approach,
    ICML 2017 (arXiv 1706.04918), Algorithm 1. Read here: the abstract (buckets of exponentially growing size, the share
    of Orlin and others for ``alpha_s = o(N)``). Taken on trust: the numbers of buckets and the limits of ``eta``.
    """
    check_integer("eta", eta, low=1)
    selection = Selection.of(check_problem(problem, knows_at_most=True), budget)
    for size in partition_sizes(problem.alpha_s, eta):
        selection.grow(size)
    selection.grow(selection.most)
    return selection.plan(problem)
