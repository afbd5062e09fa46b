"""Plans for any set function, known by its values alone: a bracket of any size, within any number of values.

First RATT's, the greedy and the myopic plan, each attacked and improved by exchanges of one element: no search returns
less, so these go on for a moment (0.4 s) if a limit is shorter. Exchanges judged by exact worst cases are a floor, too,
if they end in that moment. On an idle core they took at most 0.1 s for twelve robots (two lost, or one lost and three
links cut), and for twenty robots of which two are lost; 0.2 to 0.9 s if four are lost, 1 to 10 s if links are cut.

Small problems are enumerated (``exhaustive.py``). Beyond: bounds by rows (``row_tree.py``) if the function is a sum or
submodular. Then walks from the best plan and branch and bound over all other plans take turns, by these rows or by
monotonicity (``plan_tree.py``). It ends with exact attacks on plans that nothing else rules out.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.budget import Budget, OutOfBudget, Stop
from ratt_opt.errors import InputError
from ratt_opt.graph.outcomes import count_outcomes
from ratt_opt.solvers.by_values.plan_search import PlanSearch
from ratt_opt.solvers.by_values.reliance import check_small
from ratt_opt.solvers.exhaustive import exhaustive_optimum
from ratt_opt.solvers.maxmin.params import or_default

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt.problem import Problem
    from ratt_opt.solvers.maxmin.params import MaxMinParams, ValueTurnParams
    from ratt_opt.solvers.result import MaxMinResult

__all__ = ["solve_by_values"]

DONE = {Stop.EXHAUSTED, Stop.CLOSED}


def solve_by_values(  # noqa: PLR0917  (as solve_maxmin has them)
    problem: Problem,
    budget: Budget,
    gap: float = 1e-9,
    alpha_cs: int | None = None,
    otherwise: Callable[[], MaxMinResult | None] | None = None,
    params: MaxMinParams | None = None,
) -> MaxMinResult:
    """Bracket the optimum of any non-decreasing function; ``alpha_cs`` : what RATT was asked before, if it was.

    ``otherwise`` : a bracket of the same optimum by another search, used if plans are too many to enumerate
    Relies on that (checked if it is small). A spent budget or an interrupt returns the bracket.

    Raises
    ------
    InputError : the function falls, if that is checked, or a value is no finite number.
    """
    search, params = None, or_default(params)
    try:
        check_small(problem, budget, params.value_checks)
        search = PlanSearch(problem, budget, params)
        search.start(alpha_cs)
        found = None if budget.is_over else _enumerated(problem, budget, params.value_turns)
        if found is not None and found.stop in DONE:
            return found
        search.learn(found)
        if not budget.is_over:
            search.bound_first()
        if otherwise is not None and not budget.is_over:
            search.learn(otherwise())
        closed = search.climb_first(gap)
        if not closed:
            budget.check()
        stop = Stop.CLOSED if closed else search.run(gap)
    except OutOfBudget as out:
        stop = out.stop
    except KeyboardInterrupt:
        stop = budget.interrupt()
    return (search or PlanSearch(problem, budget, params)).result(stop)


def _enumerated(problem: Problem, budget: Budget, params: ValueTurnParams) -> MaxMinResult | None:
    """Enumerate plans and outcomes within a share of the budget; ``None`` if there are too many. Plans are nodes."""
    plans = float(np.prod([float(len(choice)) for choice in problem.choices]))
    if budget.max_nodes is not None and plans > budget.max_nodes - budget.nodes:
        return None
    if problem.threat.links_alike and count_outcomes(problem.threat, enough=params.outcomes) > params.outcomes:
        return None
    try:
        return exhaustive_optimum(problem, budget=budget.part(params.enumerated))
    except InputError as error:
        if error.argument in {"problem", "graph"}:
            return None
        raise
