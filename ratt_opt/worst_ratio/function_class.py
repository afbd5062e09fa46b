"""Classes of set functions, and their definitions tested on a table."""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.errors import ProofError

if TYPE_CHECKING:
    from fractions import Fraction

    from ratt_opt._validation import BoolArray, IntArray

__all__ = ["FunctionClass", "check_class"]


class FunctionClass(Enum):
    """Classes of normalised set functions."""

    NON_DECREASING = "non-decreasing"
    TOTAL_CURVATURE = "non-decreasing, total curvature at most c"
    SUBMODULAR = "non-decreasing and submodular"
    CURVATURE = "non-decreasing and submodular, curvature at most k"

    @property
    def symbol(self) -> str:
        """Letter of the curvature in texts."""
        return "c" if self is FunctionClass.TOTAL_CURVATURE else "k"

    @property
    def is_submodular(self) -> bool:
        """Tell whether marginals diminish."""
        return self in (FunctionClass.SUBMODULAR, FunctionClass.CURVATURE)

    @property
    def is_parametric(self) -> bool:
        """Tell whether the class depends on a curvature value."""
        return self in (FunctionClass.TOTAL_CURVATURE, FunctionClass.CURVATURE)


def check_class(
    function_class: FunctionClass, values: IntArray, curvature: Fraction | None, judged: BoolArray | None = None
) -> None:
    """Test the definitions of ``function_class`` on a full integer table; ``ProofError`` says what fails and where.

    ``judged`` : (2**n,) the sets that the curvature is over; all if it is not given
    """
    if values[0] != 0:
        raise ProofError("the function is not normalised")
    masks = np.arange(len(values))
    for x in range(len(values).bit_length() - 1):
        bases = masks[masks >> x & 1 == 0]
        marginals = values[bases | 1 << x] - values[bases]
        if marginals.min() < 0:
            raise ProofError(f"the function is not non-decreasing: element {x} has a negative marginal")
        for y in range(x) if function_class.is_submodular else ():
            without = bases >> y & 1 == 0
            after = values[bases[without] | 1 << x | 1 << y] - values[bases[without] | 1 << y]
            if (after > marginals[without]).any():
                raise ProofError(f"the function is not submodular: diminishing returns fail for elements {y} and {x}")
        if curvature is None or not function_class.is_parametric:
            continue
        kept = marginals if judged is None else marginals[judged[bases | 1 << x]]
        # Bases are ascending, so the first marginal is the value of the element alone.
        largest = int(kept[0] if function_class.is_submodular else kept.max())
        if int(kept.min()) < (1 - curvature) * largest:
            raise ProofError(f"the function's curvature exceeds {curvature} at element {x}")
