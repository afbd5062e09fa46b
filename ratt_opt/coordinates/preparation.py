"""One door of every search: the problem in the coordinates in which it is searched.

The entry, :func:`prepared`, leaves out what no sensor measures (``measured.py``) and takes the prior as unit if digits
would be lost otherwise (``unit_prior.py``). Elements, plans, attacks and values stay the same, so at the exit two
things are left to do: ends are widened by what the change and the values rounded
(:meth:`Problem.widen_by_rounding` of the prepared problem), and a proof becomes one in all coordinates
(:func:`restored`). Searches that call others hand on the prepared problem.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar
from weakref import WeakKeyDictionary

import numpy as np

from ratt_opt.coordinates.changed import ChangedProblem, WithProof, keeps_digits
from ratt_opt.coordinates.measured import measured_coordinates
from ratt_opt.coordinates.unit_prior import with_unit_prior
from ratt_opt.setfunctions.information import InformationObjective

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.problem import Problem

__all__ = ["precise", "prepared", "restored"]

Proved = TypeVar("Proved", bound=WithProof)


def prepared(problem: Problem) -> Problem:
    """Return the problem in the coordinates in which it is searched; itself if these are its own.

    The same object whenever the same problem is given. A set function of one's own has no coordinates.
    """
    objective = problem.objective
    is_prepared = isinstance(problem, ChangedProblem) and problem.is_prepared
    if is_prepared or not isinstance(objective, InformationObjective):
        return problem
    known = _PREPARED.get(problem)
    if known is None:
        change = _CHANGES.get(objective)
        if change is None or not change.is_for(problem):
            change = _CHANGES[objective] = _Change.found(problem)
        known = change.of(problem)
        if known is not problem:
            _PREPARED[problem] = known
    return known


def precise(problem: Problem) -> Problem:
    """Return the prepared problem if values in the given coordinates lose digits, to value one attack; else itself."""
    objective = problem.objective
    is_precise = not isinstance(objective, InformationObjective) or keeps_digits(problem, objective)
    return problem if is_precise else prepared(problem)


def restored(searched: Problem, result: Proved) -> Proved:
    """Return a result of a prepared problem with its proof as one in the coordinates that were given."""
    return searched.lifted(result) if isinstance(searched, ChangedProblem) else result


@dataclass(frozen=True, slots=True, kw_only=True)
class _Change:
    """A criterion in other coordinates ``basis[j]' x`` of targets; the same for all problems with these owners.

    ``before`` : by how much exact values had changed before, ``error`` : by how much they have after this change
    ``objective`` : ``None`` if the coordinates stay
    """

    robot: IntArray
    before: float
    objective: InformationObjective | None = None
    basis: FloatArray | None = None
    error: float = 0.0

    @classmethod
    def found(cls, problem: Problem) -> _Change:
        """The change for a problem: to measured coordinates, unless all of them keep many more digits."""
        stay = cls(robot=problem.robot, before=getattr(problem, "change_error", 0.0))
        best = with_unit_prior(measured_coordinates(problem))
        objective = problem.information_objective
        if not keeps_digits(best, objective):
            best = min(best, with_unit_prior(problem), key=lambda made: made.evaluation_error)
        if best.objective is objective or not isinstance(best, ChangedProblem):
            return stay
        return replace(stay, objective=best.information_objective, basis=best.basis, error=best.change_error)

    def is_for(self, problem: Problem) -> bool:
        """Tell whether the change is the one of a problem with the same criterion."""
        return self.before == getattr(problem, "change_error", 0.0) and np.array_equal(self.robot, problem.robot)

    def of(self, problem: Problem) -> Problem:
        """The problem in these coordinates."""
        if self.objective is None or self.basis is None:
            return problem
        return ChangedProblem.beside(problem, self.objective, self.basis, self.error, is_prepared=True)


_CHANGES: WeakKeyDictionary[InformationObjective, _Change] = WeakKeyDictionary()
"""Problems that differ in their threats share a change of coordinates: one of many elements takes a second."""
_PREPARED: WeakKeyDictionary[Problem, Problem] = WeakKeyDictionary()
"""Prepared problems. None refers to the problem that was given, so both are freed."""
