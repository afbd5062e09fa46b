"""Result of a mission: every step as it happened, and figures over all steps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.special import gammaincinv

from ratt_opt._validation import BoolArray, FloatArray, IntArray, check_number, readonly
from ratt_opt._values import ByValue
from ratt_opt.errors import InputError
from ratt_opt.scenario.remarks import scenario_remarks

if TYPE_CHECKING:
    from ratt_opt.missions.belief import Belief, Innovation
    from ratt_opt.problem import Attack
    from ratt_opt.scenario.model import Scenario

__all__ = ["FlownMission", "GroupTrack", "MissionStep"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class GroupTrack(ByValue):
    """A group after a step: its ``robots``, those that ``see``, what it believes, and its measurements' surprise."""

    robots: frozenset[int]
    see: frozenset[int]
    belief: Belief
    innovation: Innovation


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class MissionStep(ByValue):
    """One step: ``poses`` (N, 3) after it, ``controls`` (N, 2) that led there, the ``attack`` in force.

    ``truth`` : (M, d) states; ``links`` : those that were not cut; ``groups`` : by the lowest robot. ``best`` : which
    of them is the team's, the one with the smallest trace of position covariances (sharing the best group's belief
    only: the group that the criterion values most); ``value`` : the criterion of its unblinded robots. ``links_short``
    : by how many links the network was smaller than the attacker's budget, which was capped at the network's.
    """

    poses: FloatArray
    controls: FloatArray
    attack: Attack
    links: frozenset[tuple[int, int]]
    truth: FloatArray
    groups: tuple[GroupTrack, ...]
    best: int
    value: float
    links_short: int = 0

    @property
    def team(self) -> GroupTrack:
        """The team's group."""
        return self.groups[self.best]

    def role(self, robot: int) -> str:
        """``blinded``, ``best group`` or ``cut off``."""
        if robot in self.attack.sensing:
            return "blinded"
        return "best group" if robot in self.team.robots else "cut off"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FlownMission(ByValue):
    """A finished mission; equal missions are equal to the bit.

    ``start`` : the poses (N, 3) it began at; ``settings`` : its arguments by name, for people; ``decisions`` : the
    elements and attack of every step, from which it can be replayed.
    """

    scenario: Scenario
    settings: dict[str, str]
    start: FloatArray
    steps: tuple[MissionStep, ...]
    decisions: tuple[tuple[IntArray, Attack], ...]
    seconds: tuple[float, ...] = ()

    def __hash__(self) -> int:
        return hash((self.scenario, self.steps))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, FlownMission):
            return NotImplemented
        same = self.scenario == other.scenario and self.settings == other.settings
        return same and self.steps == other.steps

    def __repr__(self) -> str:
        if not self.steps:
            return "Mission(0 steps)"
        rmse = f"RMSE {self.rmse[-1]:.4g} m at the end, {self.rmse.mean():.4g} m on average"
        return f"Mission({len(self.steps)} steps, {rmse}, NEES {self.nees.mean():.3g} of {self.dimension})"

    @property
    def dimension(self) -> int:
        """Numbers d in a target's state."""
        return int(self.steps[0].truth.shape[1]) if self.steps else 2

    @property
    def remarks(self) -> tuple[str, ...]:
        """One line for each kind of number that can hardly be meant, and if nothing was ever measured."""
        unseen = self.steps and not any(step.team.innovation.count for step in self.steps)
        blind = "no measurement reached the team in any step: does a sensor see as far as the targets?"
        return (*scenario_remarks(self.scenario), *((blind,) if unseen else ()))

    def within(self, rms: float) -> BoolArray:
        """(T,) whether the error over the targets (RMS) was at most ``rms`` [m]."""
        return np.asarray(self.rmse <= check_number("rms", rms, low=0.0))

    @property
    def squared_errors(self) -> FloatArray:
        """(T, M) squared distances of the team's estimates from the truth [m^2]."""
        errors = [step.team.belief.mean[:, :2] - step.truth[:, :2] for step in self.steps]
        return readonly((np.array(errors).reshape(len(errors), -1, 2) ** 2).sum(axis=-1))

    @property
    def rmse(self) -> FloatArray:
        """(T,) root of the mean squared error over the targets [m]."""
        return readonly(np.sqrt(self.squared_errors.mean(axis=1)))

    @property
    def traces(self) -> FloatArray:
        """(T,) mean over the targets of the trace of the team's position covariances [m^2]."""
        return readonly(np.array([step.team.belief.trace / len(step.truth) for step in self.steps]))

    @property
    def nees(self) -> FloatArray:
        """(T,) normalised estimation error squared, mean over the targets; ``d`` if the filter is consistent."""
        return readonly(np.array([step.team.belief.nees(step.truth).mean() for step in self.steps]))

    @property
    def nis(self) -> FloatArray:
        """(T,) normalised innovation squared of the team's group per number measured; NaN if none was."""
        pairs = [(step.team.innovation.squared, step.team.innovation.count) for step in self.steps]
        return readonly(np.array([s / n if n else np.nan for s, n in pairs]))

    def nees_band(self, level: float = 0.95) -> tuple[float, float]:
        """Return the interval of :attr:`nees` with probability ``level`` for a consistent filter (chi-square)."""
        _check_level(level)
        freedom = self.dimension * self.scenario.n_targets
        low, high = (float(_chi_square(end, freedom)) for end in ((1 - level) / 2, (1 + level) / 2))
        return low / self.scenario.n_targets, high / self.scenario.n_targets

    def nis_band(self, level: float = 0.95) -> FloatArray:
        """(T, 2) what :attr:`nis` lies in with probability ``level`` when the filter is consistent; NaN if none."""
        _check_level(level)
        counts = np.array([step.team.innovation.count or np.nan for step in self.steps])
        ends = [(1 - level) / 2, (1 + level) / 2]
        return readonly(np.stack([_chi_square(end, counts) / counts for end in ends], axis=-1))

    def to_dict(self) -> dict[str, Any]:
        """Return the content of ``mission.json``: settings, and the figures of every step."""
        low, high = self.nees_band()
        return {
            "format": "ratt-opt mission",
            "version": 1,
            "settings": self.settings,
            "n_robots": self.scenario.n_robots,
            "n_targets": self.scenario.n_targets,
            "rmse": self.rmse.tolist(),
            "trace": self.traces.tolist(),
            "nees": self.nees.tolist(),
            "nees_expected": self.dimension,
            "nees_band": [low, high],
            "nis": [None if np.isnan(x) else float(x) for x in self.nis],
            "value": [step.value for step in self.steps],
            "remarks": list(self.remarks),
            "links_short": [step.links_short for step in self.steps],
            "attacks": [step.attack.to_dict() for step in self.steps],
            "groups": [[sorted(group.robots) for group in step.groups] for step in self.steps],
        }


def _chi_square(probability: float, freedom: FloatArray | int) -> FloatArray:
    """Quantile of the chi-square distribution; (...) like the degrees of freedom."""
    return np.asarray(2 * gammaincinv(np.asarray(freedom) / 2, probability), dtype=np.float64)


def _check_level(level: float) -> None:
    if not 0 < check_number("level", level) < 1:
        raise InputError("level", "must be between 0 and 1", level)
