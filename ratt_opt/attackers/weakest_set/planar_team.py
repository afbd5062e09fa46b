"""A plan against targets with two-dimensional states, as arrays for the compiled loops."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.setfunctions.criteria.two_by_two import triples
from ratt_opt.setfunctions.information import InformationObjective

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.setfunctions.base import SetFunction

__all__ = ["PlanarTeam", "SetFamily"]


@dataclass(frozen=True, slots=True)
class PlanarTeam:
    """Information as ``(a, b, c)`` triples of ``[[a, b], [b, c]]``, for a criterion that has compiled loops.

    ``prior`` : (M, 3) prior information; ``information`` : (N, M, 3) of each robot's chosen element;
    ``single`` : (N,) individual values; ``weights`` : (M,) a copy of the criterion's, writable as compiled code has it
    """

    objective: InformationObjective
    weights: FloatArray
    prior: FloatArray
    information: FloatArray
    single: FloatArray

    @classmethod
    def of(cls, objective: SetFunction, plan: IntArray) -> PlanarTeam | None:
        """The planar form, or ``None`` where the objective has no compiled loops or targets are not planar."""
        if not isinstance(objective, InformationObjective) or objective.compiled_code is None:
            return None
        if objective.dimension != 2:
            return None
        prior, information = triples(objective.prior_information), triples(objective.information[plan])
        single = _criterion(objective, prior) - _criterion(objective, prior + information)
        return cls(objective, np.array(objective.weights), prior, information, single)

    @property
    def code(self) -> int:
        """The criterion's number in the compiled loops."""
        assert self.objective.compiled_code is not None, "a planar team's criterion has compiled loops"
        return self.objective.compiled_code

    @property
    def baseline(self) -> float:
        """The criterion before any measurement."""
        return float(_criterion(self.objective, self.prior))

    def sums(self, robots: Iterable[int]) -> FloatArray:
        """(M, 3) posterior information of a set of robots."""
        return np.asarray(self.prior + self.information[sorted(robots)].sum(axis=0))

    def values(self, sums: FloatArray) -> FloatArray:
        """Values of posterior information: (..., M, 3) -> (...)."""
        return np.asarray(_criterion(self.objective, self.prior) - _criterion(self.objective, sums))

    def value(self, robots: Iterable[int]) -> float:
        """Value of one set of robots."""
        return float(self.values(self.sums(robots)))

    def family(self, robots: IntArray, size: int, chosen: Iterable[int] = ()) -> SetFamily:
        """The sets of ``size`` of the ``robots`` (F,) beside those ``chosen`` already."""
        return SetFamily(self, self.sums(chosen), self.information[robots], size)


@dataclass(frozen=True, slots=True)
class SetFamily:
    """All sets of ``size`` of F free robots, beside those already chosen.

    ``start`` : (M, 3) prior plus the chosen robots' information; ``information`` : (F, M, 3)
    ``lacking`` : (F,) where given, only sets of which it adds up to less than 0 belong to the family
    """

    team: PlanarTeam
    start: FloatArray
    information: FloatArray
    size: int
    lacking: FloatArray | None = None


def _criterion(objective: InformationObjective, sums: FloatArray) -> FloatArray:
    return objective.combine(objective.planar_criterion(sums[..., 0], sums[..., 1], sums[..., 2]))
