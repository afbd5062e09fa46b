"""What conic programs and certificates need of a criterion; a criterion that lacks a part is refused by its name."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ratt_opt.errors import InputError
from ratt_opt.setfunctions.base import SetFunction

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import FloatArray

__all__ = ["ProofParts", "lacking"]


def lacking(criterion: object, part: str, what: str) -> InputError:
    """The refusal of a criterion that leaves a part out which is asked for."""
    return InputError("objective", f"must define {part}, the {what}", type(criterion).__name__)


class ProofParts(SetFunction):
    """Parts that the library's own criteria have; another may, where it is to be relaxed or certified."""

    __slots__ = ()

    def conic_value(self, posterior: Sequence[Any]) -> Any:  # noqa: ARG002
        """The value as a concave cvxpy expression of each target's information: M expressions of shape (d, d)."""
        raise lacking(self, "conic_value(posterior)", "value as a concave cvxpy expression")

    def fenchel_point(self, point: FloatArray, target: int | None) -> list[Any]:  # noqa: ARG002
        """What a certificate states of the tangent at ``point`` (M, d, d): the verifier derives its bound from it."""
        raise lacking(self, "fenchel_point(point, target)", "tangent as the verifier knows it")

    @property
    def prior_eigenvalue(self) -> float | None:
        """An irrational number of the prior that a certificate states as a narrow range, where it needs one."""
        return None

    @property
    def verifier_averages(self) -> bool:
        """Whether the verifier bounds values, and so averages of them; else it compares each with a level."""
        return True
