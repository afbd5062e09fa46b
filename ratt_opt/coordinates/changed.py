"""A problem in other coordinates, and how far its values are from the exact ones of the problem as it was given.

In coordinates ``y = U'x`` with ``V U = 1`` a target has the prior ``Q = U'PU`` and the information ``Y = V X V'``;
``X = U Y U'``. Both are rounded. With ``S = |Q| |Y|``,

- ``tr C (Q^{-1} + Y)^{-1} C'`` moves by at most ``(1 + sqrt S)^2 |C|^2`` times what ``Q`` moves, as
  ``(1 + QY)^{-1} = 1 - Q Y^{1/2} (1 + Y^{1/2} Q Y^{1/2})^{-1} Y^{1/2}``;
- and by at most ``|C|^2 |Q|^2`` times what ``Y`` moves, as no posterior exceeds the prior.

The largest eigenvalue moves by no more. ``logdet(1 + QY)`` moves by at most ``d`` times what ``|Q| |Y|`` moves.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, TypeVar

import numpy as np

from ratt_opt._validation import FloatArray, IntArray, readonly
from ratt_opt.problem import Problem, idle_elements
from ratt_opt.setfunctions.evaluation_error import evaluation_error, largest_fall
from ratt_opt.setfunctions.rounding_errors import UNIT, largest_sizes

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["ChangedProblem", "change_error", "keeps_digits", "product_error", "selects", "sizes_of"]


class WithProof(Protocol):
    """A dataclass with a proof: a result of :func:`ratt_opt.solve_maxmin`."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def proof(self) -> Any:
        """The proof of its upper end, or ``None``."""


Proved = TypeVar("Proved", bound=WithProof)


@dataclass(frozen=True, eq=False, init=False, repr=False)
class ChangedProblem(Problem):
    """A problem in coordinates ``basis[j]' x`` of each target: the same elements, plans, attacks and values.

    ``basis`` : (M, d, r), the identity if nothing was changed; ``given`` : the criterion as it was given
    ``change_error`` : no exact value differs by more from the exact one of ``given``
    ``is_prepared`` : searches take it as it is
    The other fields are those of a :class:`Problem`.
    """

    basis: FloatArray = field(kw_only=True)
    given: InformationObjective = field(kw_only=True)
    change_error: float = field(kw_only=True, default=0.0)
    is_prepared: bool = field(kw_only=True, default=False)

    def __init__(
        self,
        *,
        basis: ArrayLike,
        given: InformationObjective,
        change_error: float = 0.0,
        is_prepared: bool = False,
        **fields: Any,
    ) -> None:
        object.__setattr__(self, "given", given)
        super().__init__(**fields)
        object.__setattr__(self, "basis", readonly(np.asarray(basis, dtype=np.float64)))
        object.__setattr__(self, "change_error", change_error)
        object.__setattr__(self, "is_prepared", is_prepared)

    @classmethod
    def of(
        cls, problem: Problem, objective: InformationObjective, basis: FloatArray, change_error: float = 0.0
    ) -> ChangedProblem:
        """``problem`` with the objective in coordinates ``basis[j]' x`` of those it has."""
        if isinstance(problem, ChangedProblem):
            basis, change_error = problem.basis @ basis, problem.change_error + change_error
        return cls.beside(problem, objective, basis, change_error)

    @classmethod
    def beside(
        cls, problem: Problem, objective: InformationObjective, basis: FloatArray, change_error: float, **more: bool
    ) -> ChangedProblem:
        """``problem`` with the objective in coordinates ``basis[j]' x`` of those given; all else is shared."""
        given = problem.given if isinstance(problem, ChangedProblem) else problem.information_objective
        changed = {"objective": objective, "given": given, "basis": readonly(basis), "change_error": change_error}
        shared = {name: getattr(problem, name) for name in ("robot", "graph", "threat", "choices", "at_most")}
        made = object.__new__(cls)
        for name, value in {**shared, **changed, "is_prepared": False, **more}.items():
            object.__setattr__(made, name, value)
        return made

    @cached_property
    def idle(self) -> IntArray:
        """(N,) idle elements as given: others of little information may have none in these coordinates."""
        return idle_elements(self.given, self.choices)

    @property
    def is_smaller(self) -> bool:
        """Tell whether coordinates were left out."""
        return bool(self.basis.shape[2] < self.basis.shape[1])

    @property
    def is_changed(self) -> bool:
        """Tell whether the coordinates are others."""
        return self.objective is not self.given

    @cached_property
    def evaluation_error(self) -> float:
        """Evaluation error as of any problem, against the exact values of ``given``."""
        return evaluation_error(self.information_objective, self.choices) + self.change_error

    @property
    def least_value(self) -> float:
        """Least value as of any problem, of the exact values of ``given``."""
        return -min(largest_fall(self.given, self.choices), self.largest_fall + self.change_error)

    def lifted(self, result: Proved) -> Proved:
        """A result of this problem with the proof as one of ``given``: it touches at the same information."""
        if not self.is_changed:
            return result
        proof = result.proof
        return result if proof is None else replace(result, proof=proof.moved(self._lifted))

    def _lifted(self, point: FloatArray) -> FloatArray:
        added = self.basis @ (point - self.information_objective.prior_information) @ np.swapaxes(self.basis, -1, -2)
        lifted = self.given.prior_information + added
        return np.asarray((lifted + np.swapaxes(lifted, -1, -2)) / 2)


def sizes_of(matrices: FloatArray) -> FloatArray:
    """Frobenius' norms."""
    return np.asarray(np.linalg.norm(matrices, axis=(-2, -1)))


def product_error(left: FloatArray, matrices: FloatArray, right: FloatArray) -> FloatArray:
    """(..., r, r) entries no smaller than the errors of computed products ``left @ matrices @ right``.

    Products that select entries of the matrices are exact.
    """
    if selects(left) and selects(np.swapaxes(right, -1, -2)):
        return np.zeros((*np.broadcast_shapes(left.shape[:-2], matrices.shape[:-2]), left.shape[-2], right.shape[-1]))
    terms = 2 * matrices.shape[-1] + 4
    return np.asarray(terms * UNIT * (np.abs(left) @ np.abs(matrices) @ np.abs(right)))


def change_error(
    problem: Problem, objective: InformationObjective, prior: FloatArray, information: FloatArray, share: FloatArray
) -> float:
    """Bound the difference between values of ``objective`` and of ``problem``, the same in other coordinates.

    ``prior`` : (M,) how far the prior in these coordinates is from the exact one; ``information`` : (M,) the same of
    the information of a whole plan; ``share`` : (M,) of the criterion's size, whatever else was neglected
    """
    size, whole = sizes_of(objective.prior), largest_sizes(objective.information, problem.choices)
    scale = objective.error_scale(size)
    assert scale is not None
    worst = 1 + np.sqrt(size * whole)
    return float(objective.combine(2 * scale * (worst**2 * prior / size + size * information + share)))


def keeps_digits(problem: Problem, objective: InformationObjective) -> bool:
    """Tell whether values lose few digits; ``objective`` : as it was given, or in other coordinates.

    Few are lost if nine digits of the criterion before any measurement are certain: a bracket needs no more of them.
    """
    scale = objective.error_scale(sizes_of(objective.prior))
    return scale is None or problem.evaluation_error <= 1e-9 * float(objective.combine(scale))


def selects(rows: FloatArray) -> bool:
    """Tell whether each row has one 1 and else zeros."""
    return bool((((rows == 0) | (rows == 1)).all(axis=-1) & (rows.sum(axis=-1) == 1)).all())
