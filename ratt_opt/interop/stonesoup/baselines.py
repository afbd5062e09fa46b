"""Baselines: this package's criteria as a reward for Stone Soup's own managers, and a greedy one that is fair.

Stone Soup's greedy manager scores every platform and sensor alone; the one here scores what each adds to those before.
"""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from stonesoup.base import Property
from stonesoup.sensormanager.reward import RewardFunction
from stonesoup.types.prediction import GaussianStatePrediction
from stonesoup.types.track import Track

from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.errors import InputError
from ratt_opt.interop.stonesoup.nodes import TeamManager, nodes_of, options
from ratt_opt.interop.stonesoup.problem import PlanningStep, TeamProblem

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence
    from datetime import datetime

__all__ = ["CriterionReward", "SequentialGreedySensorManager"]


class CriterionReward(RewardFunction, TeamProblem):
    """Value of a configuration for the tracks: of the whole team, or of what the worst attack leaves.

    Stone Soup's own rewards look at the sensors of a configuration; here a platform's sensors count too, so that moving
    alone has a value. With ``alpha_s`` or ``alpha_c`` the reward is the worst case. With a ``graph``, configurations
    must be of everybody whom it names.
    """

    return_tracks: bool = Property(default=False, doc="Return (reward, tracks), as Stone Soup's tree search needs.")

    def __call__(
        self, config: Mapping[Any, Sequence[Any]], tracks: Collection[Any], metric_time: datetime, *_: Any, **__: Any
    ) -> Any:
        """The reward; 0 if there is no track."""
        platforms = [actionable for actionable in config if hasattr(actionable, "sensors")]
        carried = [sensor for platform in platforms for sensor in platform.sensors]
        alone = [actionable for actionable in config if not hasattr(actionable, "sensors")]
        if not tracks or not carried + alone:
            return (0.0, tracks) if self.return_tracks else 0.0
        nodes = nodes_of(platforms, list(dict.fromkeys([*carried, *alone])))
        choices = tuple(tuple((_option(config, a),) for a in node.actionables) for node in nodes)
        step = self.step(nodes, choices, tracks, metric_time)
        value = self._value(step)
        return (value, _updated(step)) if self.return_tracks else value

    def _value(self, step: PlanningStep) -> float:
        everyone = range(step.problem.n_robots)
        if self.alpha_s == self.alpha_c == 0:
            return float(step.problem.objective(everyone))
        return float(worst_case_attack(step.problem, everyone).upper)


def _option(config: Mapping[Any, Sequence[Any]], actionable: Any) -> Any:
    return tuple(config[actionable]) if actionable in config else None


def _updated(step: PlanningStep) -> set[Any]:
    """The tracks after measurements as predicted: the means stay, the covariances shrink."""
    forecast, told = step.forecast, step.problem.information_objective.information.sum(axis=0)
    found = set()
    for j, rows in enumerate(step.coordinates):
        n, k = forecast.sizes[j], len(rows)
        covariance = forecast.covariances[j, :n, :n]
        gain = covariance[:, rows] @ np.linalg.inv(np.eye(k) + told[j, :k, :k] @ covariance[np.ix_(rows, rows)])
        after = covariance - gain @ told[j, :k, :k] @ covariance[rows]
        state = GaussianStatePrediction(
            forecast.predictions[j].mean, (after + after.T) / 2, timestamp=forecast.predictions[j].timestamp
        )
        found.add(Track([*forecast.tracks[j].states, state]))
    return found


class SequentialGreedySensorManager(TeamManager):
    """Add the node and actions with which the ``reward_function`` of all chosen so far is largest; not robust.

    A node is a platform with its sensors, or a sensor that stands alone. Among equal rewards the first is taken.
    """

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        if self.reward_function is None:
            raise InputError("reward_function", "must be given, as CriterionReward(predictor)", None)

    def choose_actions(
        self, tracks: Collection[Any], timestamp: datetime, nchoose: int = 1, **_: Any
    ) -> list[dict[Any, tuple[Any, ...]]]:
        """Return ``[{actionable: actions}]``.

        Raises
        ------
        InputError : ``nchoose`` is not 1, or there is no sensor.
        """
        if nchoose != 1:
            raise InputError("nchoose", "must be 1: the greedy choice is one", nchoose)
        chosen: dict[Any, tuple[Any, ...]] = {}
        left = []
        for node in self.nodes:
            every = product(*(options(actionable, timestamp) for actionable in node.actionables))
            left.append([dict(zip(node.actionables, choice, strict=True)) for choice in every])
        while left:
            tried = [(k, chosen | choice) for k, choices in enumerate(left) for choice in choices]
            rewards = [self.reward_function(config, tracks, timestamp) for _, config in tried]
            best, chosen = tried[max(range(len(tried)), key=rewards.__getitem__)]
            del left[best]
        return [chosen]
