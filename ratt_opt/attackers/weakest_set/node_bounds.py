"""What no set of a family falls below, and which of its sets may come near that."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.weakest_set.minorant import Minorant, affine_minorant
from ratt_opt.attackers.weakest_set.weakest_axis import weakest_axis

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.attackers.weakest_set.planar_team import SetFamily

__all__ = ["FamilyBound", "bound_family"]

HEAVY_ROBOTS = ((50, 4), (10**9, 5))
"""(Undecided robots up to, robots per target whose patterns the minorant enumerates): few nodes are afforded above."""


@dataclass(frozen=True, slots=True)
class FamilyBound:
    """No set is worth less than ``bound``; ``suggested`` (size,) are positions of robots that may come near it.

    ``minorant`` : where the bound comes from one
    """

    bound: float
    suggested: IntArray | None = None
    minorant: Minorant | None = None


def bound_family(family: SetFamily, goal: float, parent: Minorant | None) -> FamilyBound:
    """Bound a family by its worst axis where that decides, and else by an affine minorant.

    Parameters
    ----------
    goal : no better bound is needed
    parent : a minorant of a larger family
    """
    if family.team.objective.states("planar_levels"):
        axis = weakest_axis(family)
        return FamilyBound(axis.bound, axis.chosen)
    n_free = len(family.information)
    if not 0 < family.size < n_free:
        return FamilyBound(-np.inf)
    heavy = next(heavy for most, heavy in HEAVY_ROBOTS if n_free <= most)
    minorant = affine_minorant(family, heavy, goal, parent)
    weakest = np.lexsort((minorant.scores, -minorant.fraction))[: family.size]
    return FamilyBound(minorant.bound(family.size), weakest, minorant)
