"""Parts of a criterion, with a generic stand-in for each part that a criterion leaves out.

:class:`~ratt_opt.setfunctions.information.InformationObjective` adds the data. A search asks for a part by its name
and never which criterion it is.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ratt_opt.errors import InputError
from ratt_opt.setfunctions.base import SetFunction

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.setfunctions.planar_levels import PlanarLevels

__all__ = ["CriterionParts", "OtherElements", "SeparableMinorant", "Tangent", "TargetTangents"]

ROUNDING = 1e-12
"""Error of a marginal, relative to the criteria it is a difference of: thousands of units in the last place."""
VALUE_ROUNDING = 1e-14
"""Error of a value in the same sense: some dozens of units in the last place cover sums over a few hundred targets."""


@dataclass(frozen=True, slots=True, eq=False)
class Tangent:
    """``value(L) <= offset + sum_j <slope_j, L_j>`` for every positive definite ``L``; ``slope`` (M, d, d)."""

    slope: FloatArray
    offset: float


@dataclass(frozen=True, slots=True, eq=False)
class TargetTangents:
    """``value_j(L) <= offset_j + <slope_j, L>`` for each target ``j`` and every positive definite ``L``.

    ``slope`` : (M, d, d), up to rounding; ``size`` : (M, d, d) sizes of what each entry of it adds up
    ``offset`` : (M,), up to rounding; ``scale`` : (M,) sizes of what it adds up
    """

    slope: FloatArray
    size: FloatArray
    offset: FloatArray
    scale: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class OtherElements:
    """The elements of the owners other than ``x``'s: K elements of R owners about M targets, d by d.

    ``elements`` : (K,); ``owners`` : (K,) position of the owner; ``first`` : (R,) first position of each owner's
    elements.
    ``inverse`` : (K, M, d, d) of their ``information``, zero if it is not ``regular`` (K, M).
    """

    elements: IntArray
    owners: IntArray
    first: IntArray
    information: FloatArray
    inverse: FloatArray
    regular: BoolArray

    def mixed(self, share: FloatArray) -> FloatArray:
        """(M, d, d) information of a relaxed context: ``share`` (K,) sums to at most 1 over each owner's elements."""
        return np.asarray(np.tensordot(share, self.information, axes=1))

    def scores(self, slope: FloatArray) -> FloatArray:
        """(K,) inner products of each element's information with a slope (M, d, d)."""
        return np.asarray(self.information.reshape(len(self.information), -1) @ slope.ravel())


@dataclass(frozen=True, slots=True, eq=False)
class SeparableMinorant:
    """A lower bound ``constant - sum of scores`` on one element's marginal over every context.

    One score for each choice of each other owner, ``score`` (K,) of its elements or ``absent`` (R,) of none of them: it
    is smallest owner by owner, whatever the joint choice.
    """

    constant: float
    score: FloatArray
    absent: FloatArray


FORMULA = frozenset({"criterion", "value", "gradient"})
"""Parts that are the formula of a criterion; all others hold for that formula."""


def lacking(criterion: object, part: str, what: str) -> InputError:
    """The error for a criterion that lacks a part which is needed."""
    return InputError("objective", f"must define {part}, the {what}", type(criterion).__name__)


class CriterionParts(SetFunction):
    """The parts of a criterion of posterior information ``L`` (M, d, d): its value, and what theory knows of it.

    A subclass defines :meth:`criterion` (or :meth:`value`) and :meth:`gradient`; the rest has generic stand-ins.
    """

    __slots__ = ()

    prior_information: FloatArray
    information: FloatArray
    _baseline: FloatArray
    condition: FloatArray

    name: ClassVar[str] = ""
    """Name in files, tables and on the command line; empty for a criterion that is not registered."""
    unit: ClassVar[str] = ""
    native_kernel: ClassVar[int | None] = None
    """Number of the criterion in the compiled code (``native/src/team.h``), if it is there."""

    is_least_of_targets: ClassVar[bool] = False
    """True if the value is that of the target where it is least, as with the worst target's criterion."""

    states_again: ClassVar[type[CriterionParts] | None] = None
    """The criterion of the library whose formula a subclass states again, as one that counts its values does."""

    def __init_subclass__(cls) -> None:
        """Note a subclass of a criterion with parts of the formula of its own; they must be those of the criterion."""
        super().__init_subclass__()
        below: type[Any] | None = cls.__base__
        if FORMULA & set(vars(cls)) and below is not None and getattr(below, "name", None):
            cls.states_again = below.states_again or below

    def check_formula(self) -> None:
        """Check a subclass of a criterion against it: for no element, half of every element, and all elements.

        Tangents and all other parts are inherited and would be false for another formula.

        Raises ``InputError`` : the formula is another one.
        """
        below = self.states_again
        if below is None:
            return
        everything = self.information.sum(axis=0)
        points = np.stack([self.prior_information + share * everything for share in (0.0, 0.5, 1.0)])
        for part in sorted(FORMULA):
            own, inherited = getattr(self, part), getattr(below, part)
            if not all(np.array_equal(own(point), inherited(self, point)) for point in points):
                rule = "must subclass InformationObjective, as it has another formula than the class below it"
                raise InputError(type(self).__name__, rule, below.__name__)

    @classmethod
    def overrides(cls, part: str) -> bool:
        """Tell whether the criterion overrides a part instead of leaving it to the generic bounds."""
        return getattr(cls, part) is not getattr(CriterionParts, part)

    def criterion(self, posterior_information: FloatArray) -> FloatArray:  # noqa: ARG002
        """Weighted criterion per target, lower is better: (..., M, d, d) -> (..., M)."""
        raise lacking(self, "criterion(posterior_information)", "weighted criterion per target")

    def gradient(self, posterior_information: FloatArray) -> FloatArray:  # noqa: ARG002
        """A supergradient of the value with respect to ``Lambda``: (..., M, d, d), positive semidefinite.

        For every ``L'``: ``value(L') <= value(L) + sum_j <gradient_j, L'_j - L_j>`` (concavity).
        """
        raise lacking(self, "gradient(posterior_information)", "supergradient of its value")

    def combine(self, per_target: FloatArray) -> FloatArray:
        """The criterion of the team from that of each target: (..., M) -> (...); a sum."""
        return np.asarray(per_target.sum(axis=-1))

    def value(self, posterior_information: FloatArray) -> FloatArray:
        """Value as a concave function of the posterior information: (..., M, d, d) -> (...); a sum over targets."""
        return np.asarray((self._baseline - self.criterion(posterior_information)).sum(axis=-1))

    def target_criterion(self, matrices: FloatArray, target: int) -> FloatArray:
        """(K,) weighted criterion of one target for its posterior information (K, d, d)."""
        points = np.tile(self.prior_information, (len(matrices), 1, 1, 1))
        points[:, target] = matrices
        return self.criterion(points)[:, target]

    def largest_marginals(self) -> FloatArray:
        """(n, M) no element takes more off one target's criterion; alone if submodular, else all together."""
        slack = ROUNDING * self.prior_magnitude
        before = self.criterion(self.prior_information)
        if self.is_submodular:
            return np.asarray(
                (before - self.criterion(self.prior_information + self.information)) * (1 + ROUNDING) + slack
            )
        everything = before - self.criterion(self.prior_information + self.information.sum(axis=0))
        return np.tile(everything * (1 + ROUNDING) + slack, (self.n, 1))

    def target_values(self, posterior_information: FloatArray) -> FloatArray:
        """Each target's value, for a criterion that is the sum of them: (..., M, d, d) -> (..., M)."""
        return np.asarray(self._baseline - self.criterion(posterior_information))

    @property
    def prior_criterion(self) -> float | None:
        """The criterion before any measurement, if it is a size (trace, max-eigenvalue) and not a logarithm."""
        return None

    def planar_gradient(self, a: Any, b: Any, c: Any) -> FloatArray:  # noqa: ARG002
        """Derivative of one planar target's value, for weight 1, in the entries of ``[[a, b], [b, c]]``: (..., 3)."""
        raise lacking(self, "planar_gradient(a, b, c)", "derivative of one target's value")

    def tangent_targets(self, point: FloatArray, level: float, most: int) -> list[int | None]:  # noqa: ARG002
        """Targets to take tangents for at ``point`` (M, d, d), at most ``most``; ``None`` is all of them together.

        ``level`` : tangents that do not cut this value off are of no use.
        """
        return [None]

    def tangent(self, point: FloatArray, target: int | None) -> Tangent:  # noqa: ARG002
        """Bound the value of all information by the tangent at ``point`` (M, d, d), for one of its targets.

        Relies on :meth:`gradient` and :meth:`value` being exact at ``point`` up to rounding.
        """
        slope = self.gradient(point)
        return Tangent(slope, float(self.value(point)) - float(np.einsum("jkl,jkl->", slope, point)))

    def target_tangents(self, point: FloatArray) -> TargetTangents:  # noqa: ARG002
        """Tangents of each target's value at ``point`` (M, d, d), for a criterion that is the sum of them."""
        raise lacking(self, "target_tangents(point)", "tangents of each target's value")

    def marginals_beyond(self, base: FloatArray, information: FloatArray) -> FloatArray:  # noqa: ARG002
        """(K, E, M) no marginal of an element is larger at any information that is no less than ``base``.

        ``base`` : (K, M, d, d) positive definite; ``information`` : (E, M, d, d) of elements, positive semidefinite
        """
        raise lacking(self, "marginals_beyond(base, information)", "largest marginals beyond a set")

    def cut_values(self, points: FloatArray, targets: Sequence[int | None]) -> FloatArray:  # noqa: ARG002
        """Return values that tangents for these ``targets`` bound, up to a constant: (K, ..., M, d, d) -> (K, ...)."""
        return self.value(points)

    @property
    def prior_magnitude(self) -> float:
        """Sum of the targets' absolute criteria before any measurement: values are differences from it."""
        return float(np.abs(self._baseline).sum())

    @property
    def rounding(self) -> float:
        """Values are differences of sums of a few hundred numbers from :attr:`prior_magnitude`, whose own error is
        what rounding the information matrices does to their inverses."""
        return VALUE_ROUNDING * self.prior_magnitude + self.inverse_rounding(np.abs(self._baseline))

    def error_scale(self, size: FloatArray) -> FloatArray | None:  # noqa: ARG002
        """Largest change of each target's criterion per relative change of its information: (..., M).

        ``size`` : (..., M) norm of the target's covariance. ``None``: nothing is known of that. See
        ``evaluation_error.py``.
        """
        return None

    def inverse_rounding(self, scale: FloatArray) -> float:
        """Error of the sum of targets' criteria of these sizes (M,), by the condition of their matrices.

        Relative to its size and to the condition, an inverse is off by four units in the last place.
        """
        return 1e-15 * float(scale @ self.condition)

    def marginal_ends(self, owners: IntArray, budget: Budget) -> tuple[FloatArray, FloatArray]:  # noqa: ARG002
        """(n,) proved lower bounds on the smallest and upper bounds on the largest marginals of the elements.

        Over sets with at most one element per owner (``owners`` (n,): 0.. without gaps). Submodular: the marginal on
        top of all that the other owners have, and the value alone. Otherwise by monotonicity: 0, and the value of all.
        """
        slack = ROUNDING * self.prior_magnitude
        if not self.is_submodular:
            everything = float(self.evaluate(np.ones((1, self.n), dtype=np.bool_))[0])
            return np.zeros(self.n), np.full(self.n, everything * (1 + ROUNDING) + slack)
        by_owner = np.zeros((int(owners.max()) + 1, *self.prior_information.shape))
        np.add.at(by_owner, owners, self.information)
        others = self.prior_information + np.tensordot(1.0 - np.eye(len(by_owner)), by_owner, axes=1)
        below, above = self.value(others)[owners], self.value(others[owners] + self.information)
        floor = above - below - ROUNDING * (np.abs(above) + np.abs(below)) - 2 * slack
        return np.maximum(floor, 0.0), self.singletons() * (1 + 10 * ROUNDING)

    def marginal_minorant(self, added: FloatArray, others: OtherElements, share: FloatArray) -> SeparableMinorant:  # noqa: ARG002
        """Bound the marginal of information ``added`` (M, d, d) over all contexts, best at a relaxed one.

        Valid for any ``share`` (K,), which sums to at most 1 over each owner's elements. By default 0: none is less.
        """
        return SeparableMinorant(0.0, np.zeros(len(others.elements)), np.zeros(len(others.first)))

    def planar_levels(self) -> PlanarLevels | None:
        """The data as levels, if the value is one over their smallest (max-eigenvalue, at most two coordinates)."""
        return None

    # Parts for relaxations and certificates.

    def conic_value(self, posterior: Sequence[Any]) -> Any:  # noqa: ARG002
        """The value as a concave cvxpy expression of each target's information: M expressions of shape (d, d)."""
        raise lacking(self, "conic_value(posterior)", "value as a concave cvxpy expression")

    def fenchel_point(self, point: FloatArray, target: int | None) -> list[Any]:  # noqa: ARG002
        """Return the record of the tangent at ``point`` (M, d, d), from which the verifier derives its bound."""
        raise lacking(self, "fenchel_point(point, target)", "tangent as the verifier knows it")

    @property
    def stated(self) -> dict[str, Any]:
        """Further fields of the criterion in a certificate's problem record, by name, as plain data."""
        return {}

    @property
    def prior_eigenvalue(self) -> float | None:
        """An irrational number of the prior that a certificate states as a narrow range, if it needs one."""
        return None

    @property
    def verifier_averages(self) -> bool:
        """True if the verifier bounds values, and so averages of them; else it compares each value with a level."""
        return True
