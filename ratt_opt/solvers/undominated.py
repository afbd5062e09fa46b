"""A problem without elements that no plan needs: equal ones merged, dominated ones dropped."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt._validation import BoolArray, FloatArray, IntArray, readonly
from ratt_opt.problem import Problem, check_problem
from ratt_opt.setfunctions.criteria.two_by_two import eigenvalues

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = ["UndominatedProblem", "dominators", "undominated", "undominated_elements"]

ROUNDING = 1e-12
"""A negative eigenvalue of a difference counts as 0 up to this share of the two matrices' traces."""


@dataclass(frozen=True, eq=False, init=False, repr=False)
class UndominatedProblem(Problem):
    """A problem over some elements of another: ``kept`` (K,) are their indices there, ascending.

    A plan ``elements`` of this problem is the plan ``kept[elements]`` of the other one, with the same values. The other
    fields are those of a :class:`Problem`.
    """

    kept: IntArray = field(kw_only=True)

    def __init__(self, *, kept: ArrayLike, **fields: Any) -> None:
        super().__init__(**fields)
        object.__setattr__(self, "kept", readonly(np.asarray(kept, dtype=np.int64)))


def undominated(problem: Problem) -> UndominatedProblem:
    """Drop every element that another element of the same robot dominates; of equal ones keep the first.

    An element dominates another if it tells at least as much about every target in the Loewner order: the difference of
    their information matrices is positive semidefinite, up to rounding. The best worst case stays the same: exchange a
    dominated element of a plan for the one that dominates it. Every group's information grows or stays, so does its
    value, which is non-decreasing in the information, and so does the best group's under every attack. Dominance is
    transitive, so a chain of exchanges ends at an element that is kept. Idle elements are kept if few may be busy.

    Parameters
    ----------
    problem : E elements, whose objective is a criterion of information matrices

    Raises
    ------
    InputError : ``problem`` is no Problem, or its objective is another set function.
    """
    information = check_problem(problem, knows_at_most=True).information_objective.information
    kept = undominated_elements(information, problem.robot)
    kept = kept if problem.at_most is None else np.union1d(kept, problem.idle)
    return UndominatedProblem(
        objective=problem.information_objective.restricted_to(kept),
        robot=problem.robot[kept],
        graph=problem.graph,
        alpha_s=problem.alpha_s,
        alpha_c=problem.alpha_c,
        protected_robots=problem.protected_robots,
        protected_links=problem.protected_links,
        at_most=problem.at_most,
        kept=kept,
    )


def undominated_elements(information: FloatArray, owner: IntArray) -> IntArray:
    """Ascending elements that no other one of the same robot dominates; of equal ones the first.

    ``information`` : (E, M, d, d); ``owner`` : (E,)
    """
    choices = (np.flatnonzero(owner == robot) for robot in np.unique(owner))
    return np.sort(np.concatenate([choice[_kept(information[choice])] for choice in choices]))


def dominators(problem: Problem, kept: IntArray) -> IntArray:
    """(E,) for each element the number, among ``kept`` (K,), of one of the same robot that equals or dominates it."""
    information = problem.information_objective.information
    traces = np.trace(information, axis1=-2, axis2=-1)
    found = np.empty(len(information), dtype=np.int64)
    for choice in problem.choices:
        own = np.flatnonzero(np.isin(kept, choice))
        for e in choice.tolist():
            lowest = _lowest_eigenvalues(information[kept[own]] - information[e])
            missing = (lowest + ROUNDING * (traces[kept[own]] + traces[e])).min(axis=1)
            found[e] = own[missing.argmax()]
    found[kept] = np.arange(len(kept))
    return found


def _lowest_eigenvalues(matrices: FloatArray) -> FloatArray:
    """(...) of symmetric matrices (..., d, d); a formula has those of two coordinates, many times faster."""
    if matrices.shape[-1] == 2:
        return np.asarray(eigenvalues(matrices[..., 0, 0], matrices[..., 0, 1], matrices[..., 1, 1])[0])
    return np.asarray(np.linalg.eigvalsh(matrices)[..., 0])


def _kept(information: FloatArray) -> BoolArray:
    """(K,) which elements of one robot (K, M, d, d) no other one dominates; of equal ones the first."""
    traces = np.trace(information, axis1=-2, axis2=-1)
    slack = ROUNDING * traces
    stays = np.ones(len(information), dtype=np.bool_)
    for e in reversed(range(len(information))):
        others = np.flatnonzero(stays & (traces >= traces[e] - slack[e]).all(axis=1))
        others = others[others != e]
        if not len(others):
            continue
        lowest = _lowest_eigenvalues(information[others] - information[e])
        stays[e] = not (lowest >= -ROUNDING * (traces[others] + traces[e])).all(axis=1).any()
    return stays
