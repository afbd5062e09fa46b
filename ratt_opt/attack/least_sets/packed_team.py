"""A plan as arrays for the compiled loops, symmetric matrices packed as their lower triangles."""

from __future__ import annotations

from ctypes import POINTER, c_double, c_void_p
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.team import Team, TeamRecord, has_loops
from ratt_opt.native.library import address, function
from ratt_opt.setfunctions.information import InformationObjective, triangles

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.setfunctions.base import SetFunction

__all__ = ["PackedTeam", "SetFamily"]

PLANE = 2
"""Dimension of states for which criteria are in closed form."""


@dataclass(frozen=True, slots=True)
class PackedTeam:
    """Information of a plan, for a criterion that has compiled loops; T = d (d + 1) / 2 entries, of the plane 3.

    ``prior`` : (M, T) prior information; ``information`` : (N, M, T) of each robot's chosen element;
    ``single`` : (N,) individual values; ``weights`` : (M,) a copy of the criterion's, writable as compiled code has it
    """

    objective: InformationObjective
    weights: FloatArray
    prior: FloatArray
    information: FloatArray
    single: FloatArray

    @classmethod
    def of(cls, objective: SetFunction, plan: IntArray) -> PackedTeam | None:
        """The packed form, or ``None`` if the objective has no compiled loops."""
        if not has_loops(objective):
            return None
        prior, information = objective.prior_information, objective.information[plan]
        before, after = (objective.combine(objective.criterion(sums)) for sums in (prior, prior + information))
        return cls(objective, np.array(objective.weights), triangles(prior), triangles(information), before - after)

    @classmethod
    def planar(cls, objective: SetFunction, plan: IntArray) -> PackedTeam | None:
        """The packed form where targets are in the plane, else ``None``, as without compiled loops."""
        team = cls.of(objective, plan)
        return team if team is not None and team.is_planar else None

    def native(self, robots: IntArray | None = None) -> Team:
        """Some of the robots, in this order, or all of them, as the loops in C read them."""
        information = self.information if robots is None else np.ascontiguousarray(self.information[robots])
        return Team(self.code, self.objective.dimension, self.weights, self.prior, information)

    @property
    def is_planar(self) -> bool:
        """Whether targets have states of two dimensions, for which there are sharper bounds."""
        return self.objective.dimension == PLANE

    @property
    def is_by_axis(self) -> bool:
        """Whether a set is weak along one axis of one target, in the plane."""
        return self.is_planar and self.objective.states("planar_levels")

    @property
    def traces(self) -> FloatArray:
        """(N, M) traces of the robots' information."""
        d = self.objective.dimension
        return np.asarray(self.information[..., [i * (i + 3) // 2 for i in range(d)]].sum(axis=-1))

    @property
    def code(self) -> int:
        """The criterion's number in the compiled loops."""
        return _code(self.objective)

    @property
    def baseline(self) -> float:
        """The criterion before any measurement."""
        if self.is_planar:
            return float(_planar_criterion(self.objective, self.prior))
        return float(self.objective.combine(self.objective.criterion(self.objective.prior_information)))

    def sums(self, robots: Iterable[int]) -> FloatArray:
        """(M, T) posterior information of a set of robots."""
        return np.asarray(self.prior + self.information[sorted(robots)].sum(axis=0))

    def values(self, sums: FloatArray) -> FloatArray:
        """Values of posterior information: (..., M, T) -> (...)."""
        if self.is_planar:
            return np.asarray(self.baseline - _planar_criterion(self.objective, sums))
        native, call = self.native(), function("set_value", c_double, POINTER(TeamRecord), c_void_p)
        flat = np.ascontiguousarray(sums).reshape(-1, *sums.shape[-2:])
        return np.array([call(native.reference, address(row)) for row in flat]).reshape(sums.shape[:-2])

    def value(self, robots: Iterable[int]) -> float:
        """Value of one set of robots."""
        return float(self.values(self.sums(robots)))

    def family(self, robots: IntArray, size: int, chosen: Iterable[int] = ()) -> SetFamily:
        """The sets of ``size`` of the ``robots`` (F,) beside those ``chosen`` already."""
        return SetFamily(self, self.sums(chosen), self.information[robots], size)


@dataclass(frozen=True, slots=True)
class SetFamily:
    """All sets of ``size`` of F free robots, beside those already chosen.

    ``start`` : (M, T) prior plus the chosen robots' information; ``information`` : (F, M, T)
    """

    team: PackedTeam
    start: FloatArray
    information: FloatArray
    size: int


def _planar_criterion(objective: InformationObjective, sums: FloatArray) -> FloatArray:
    return objective.combine(objective.planar_criterion(sums[..., 0], sums[..., 1], sums[..., 2]))


def _code(objective: InformationObjective) -> int:
    assert objective.compiled_code is not None, "a packed team's criterion has compiled loops"
    return objective.compiled_code
