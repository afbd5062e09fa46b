"""Bound on better planners: one plan that RATT, the myopic planner and Greedy all return, and no exchange improves.

The best of several planners has at least RATT's worst ratio, and no more than the ratio of any instance on which all
of them return the same plan. The smallest such ratio is the optimum of RATT's own program with more comparisons; if
the two agree, the best of the planners is provably no better than RATT alone at these budgets. With several attacks
that are equally bad for the plan, an exchange of a few robots' elements leaves one of them as bad as it was.

Plans that no exchange of ``j`` elements improves, from any source, can be worth nothing once ``j`` robots may be
blinded: a plan of useless elements stays at 0, as the attack blinds the robots whose elements were exchanged.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING

from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.budget import Budget, OutOfBudget, uninterrupted
from ratt_opt.worst_ratio.ratio import class_rows
from ratt_opt.worst_ratio.ratio_search import RatioSearch, skeleton
from ratt_opt.worst_ratio.witness import PLANNERS, RatioWitness, replay

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from ratt_opt._validation import IntArray
    from ratt_opt.problem import Problem
    from ratt_opt.worst_ratio.ratio_search import Groups
    from ratt_opt.worst_ratio.witness import RatioQuestion

__all__ = ["SharedPlanRatio", "exchange_gain", "shared_plan_ratio"]


@dataclass(frozen=True, slots=True, kw_only=True)
class SharedPlanRatio:
    """Claim: the best of all planners has at most ``upper`` of the optimum on ``witness``, if any was found.

    ``lower`` : no instance on which the planners agree in this way has a smaller ratio.
    """

    lower: Fraction
    upper: Fraction
    witness: RatioWitness | None


def shared_plan_ratio(
    question: RatioQuestion,
    order: Sequence[int],
    *,
    attacks: Sequence[Groups] = (),
    time_limit: float | None = None,
) -> SharedPlanRatio:
    """Bracket the smallest ratio over instances on which RATT, the myopic planner and Greedy return one plan.

    Parameters
    ----------
    question : for RATT; its ``planner`` is not used
    order : the robots in the order in which Greedy picks them, RATT's bait first by index
    attacks : groups left, as bit masks of robots, that all must be as bad for the plan as its worst attack; one of all
        attacks if empty
    time_limit : seconds; the bracket stays valid
    """
    n = question.n_robots
    base = skeleton(n, question.alpha_s, question.alpha_c, question.n_bait)
    alone = [(1 << i, 1 << n + i) for i in range(n)]
    compared = tuple(dict.fromkeys([*base.comparisons, *alone, *_picks(n, order)]))
    together = tuple(sorted({group for groups in attacks for group in groups}))
    # Greedy's order tells bait robots apart, so attacks that bait permutes differ.
    parts = replace(base, comparisons=compared, attacks=(together,) if together else base.outcomes)
    agreed = replace(question, planner="ratt")

    def worst_of_all(values: IntArray) -> Fraction:
        return max(replay(replace(agreed.witness(values), planner=name)) for name in PLANNERS)

    search = RatioSearch(parts, class_rows(parts, agreed), worst_of_all, Fraction(0))
    with suppress(OutOfBudget):  # the bracket so far is valid
        search.run(Budget(time_limit))
    witness = None if search.table is None else agreed.witness(search.table)
    return SharedPlanRatio(lower=search.lower, upper=search.upper, witness=witness)


def _picks(n_robots: int, order: Sequence[int]) -> Iterator[tuple[int, int]]:
    """Greedy over all robots: each pick adds at least as much as any element of a robot that comes later."""
    chosen = 0
    for place, robot in enumerate(order):
        pick = chosen | 1 << robot
        for later in order[place:]:
            yield pick, chosen | 1 << n_robots + later
            if later != robot:
                yield pick, chosen | 1 << later
        chosen = pick


def exchange_gain(problem: Problem, elements: IntArray) -> float:
    """Return the gain in a plan's worst case from the best exchange of one robot's element; 0 if none gains."""
    here = uninterrupted(worst_case_attack(problem, elements)).upper
    best = here
    for robot, choice in enumerate(problem.choices):
        for element in choice:
            other = elements.copy()
            other[robot] = element
            best = max(best, uninterrupted(worst_case_attack(problem, other)).lower)
    return best - here
