"""Results of the planners that bound the optimum."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from ratt_opt._rounding import down, up
from ratt_opt._values import ByValue, ReprMixin, plain, shown
from ratt_opt.attack.task import widened_result
from ratt_opt.problem import Plan

if TYPE_CHECKING:
    from numpy.typing import DTypeLike, NDArray

    from ratt_opt._validation import IntArray
    from ratt_opt.attack.task import AttackResult
    from ratt_opt.budget import Stop
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.maxmin.proof import UpperProof

__all__ = ["MaxMinResult", "NonrobustPlan", "posterior_gap"]


def posterior_gap(problem: Problem, lower: float, upper: float) -> float | None:
    """``upper - lower`` as a share of the posterior criterion that ``lower`` leaves, if the criterion is a size."""
    before = problem.information_objective.prior_criterion
    return None if before is None or before <= lower else float((upper - lower) / (before - lower))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class NonrobustPlan(Plan):
    """A plan for a team that nobody attacks; ``lower <= best value <= upper``, and why the search stopped."""

    lower: float
    upper: float
    stop: Stop


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class MaxMinResult(ByValue, ReprMixin):
    """Claim: ``lower <= Phi* <= upper``, and the plan ``elements`` is worth at least ``lower`` under any attack.

    ``Phi*`` is the largest worst-case value of any plan [unit of the objective]. Two results are equal when all
    their fields are.
    """

    elements: IntArray
    lower: float
    upper: float
    stop: Stop
    evaluations: int
    nodes: int = 0
    posterior_gap: float | None = None
    """``upper - lower`` as a share of the posterior criterion (trace, max-eigenvalue) that ``lower`` leaves: a
    diffuse prior hides real differences in the relative gap. ``None`` for other objectives."""
    worst_case: AttackResult | None = None
    """The attack on ``elements`` that ``lower`` rests on; ``None`` if it was enumerated."""
    proof: UpperProof | None = None
    """Derivation of ``upper``; ``None`` if it was enumerated."""
    relies_on: tuple[str, ...] = ()
    """Properties of a set function of your own that the claim takes from its word, such as ``"submodular"``."""
    unattacked: float | None = None
    """Value of the plan without attack: among plans of equal worst case, one with a higher value is preferred.
    ``None`` if plans were enumerated, and for set functions that are no information criterion."""

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        """Return the elements of the plan: functions that take elements take a result, too."""
        return np.array(self.elements, dtype=dtype, copy=copy)

    def widen_by_rounding(self, problem: Problem) -> Self:
        """The result, its ends moved apart by what computing them for ``problem`` may have rounded."""
        worst = None if self.worst_case is None else widened_result(problem, self.elements, self.worst_case)
        return replace(self.within(problem, *problem.widen_by_rounding(self.lower, self.upper)), worst_case=worst)

    def within(self, problem: Problem, lower: float, upper: float) -> Self:
        """The result, its ends moved apart as far as these."""
        lower, upper = min(self.lower, lower), max(self.upper, upper)
        gap = None if self.posterior_gap is None else posterior_gap(problem, lower, upper)
        return replace(self, lower=lower, upper=upper, posterior_gap=gap)

    def to_dict(self) -> dict[str, Any]:
        """The result as plain data, without its proof: unknown numbers are ``None``."""
        names = (
            "elements",
            "lower",
            "upper",
            "stop",
            "evaluations",
            "nodes",
            "posterior_gap",
            "worst_case",
            "unattacked",
            "relies_on",
        )
        return {name: plain(getattr(self, name)) for name in names}

    def __repr__(self) -> str:
        bracket = f"{down(self.lower, 9)} <= Phi* <= {up(self.upper, 9)}"
        return f"MaxMinResult({bracket}, {self.stop.name}, {self.nodes} nodes, elements={shown(self.elements)})"
