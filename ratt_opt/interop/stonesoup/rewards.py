"""This package's criteria as a reward for Stone Soup's own managers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from stonesoup.base import Property
from stonesoup.sensormanager.reward import RewardFunction
from stonesoup.types.prediction import GaussianStatePrediction
from stonesoup.types.track import Track

from ratt_opt.attackers.exact import worst_case_attack
from ratt_opt.interop.stonesoup.forecast import Forecast
from ratt_opt.interop.stonesoup.network import Network
from ratt_opt.interop.stonesoup.nodes import nodes_of
from ratt_opt.interop.stonesoup.problem import Step, make_step

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from datetime import datetime

__all__ = ["CriterionReward"]


class CriterionReward(RewardFunction):
    """What a configuration tells about the tracks: of the whole team, or of what the worst attack leaves.

    Stone Soup's own rewards look at the sensors of a configuration; here a platform's sensors count too, so that moving
    alone has a value. With ``alpha_s`` or ``alpha_c`` the reward is the worst case.
    """

    predictor: Any = Property(default=None, doc="Predicts tracks to the time of the actions; None: states as they are.")
    updater: Any = Property(
        default=None, doc="Unscented and cubature updaters linearise by points, others by Jacobian."
    )
    criterion: str = Property(default="trace", doc="'trace', 'logdet' or 'maxeig' of the measured coordinates.")
    coordinates: Any = Property(default=None, doc="Those of the states that count, as (0, 2); None: all measured ones.")
    graph: Any = Property(default=None, doc="networkx graph, or edges of Stone Soup's networks; None: all are linked.")
    alpha_s: int = Property(default=0, doc="Number of platforms, or sensors alone, that may be blinded at once.")
    alpha_c: int = Property(default=0, doc="Number of links that may be cut at once.")
    return_tracks: bool = Property(default=False, doc="Return (reward, tracks), as Stone Soup's tree search needs.")

    def __call__(
        self, config: Mapping[Any, Sequence[Any]], tracks: Iterable[Any], metric_time: datetime, *_: Any, **__: Any
    ) -> Any:
        """The reward; 0 if there is no track."""
        platforms = [actionable for actionable in config if hasattr(actionable, "sensors")]
        carried = [sensor for platform in platforms for sensor in platform.sensors]
        alone = [actionable for actionable in config if not hasattr(actionable, "sensors")]
        tracks = list(tracks) if isinstance(tracks, (list, tuple)) else set(tracks)
        if not tracks or not carried + alone:
            return (0.0, tracks) if self.return_tracks else 0.0
        nodes = nodes_of(platforms, list(dict.fromkeys([*carried, *alone])))
        choices = tuple(tuple((_option(config, a),) for a in node.actionables) for node in nodes)
        forecast = Forecast.of(tracks, self.predictor, metric_time)
        step = make_step(
            nodes,
            choices,
            forecast,
            metric_time,
            network=Network.of(self.graph, nodes),
            alpha_s=self.alpha_s,
            alpha_c=self.alpha_c,
            criterion=self.criterion,
            updater=self.updater,
            coordinates=self.coordinates,
        )
        value = self._value(step)
        return (value, _updated(step, forecast)) if self.return_tracks else value

    def _value(self, step: Step) -> float:
        everyone = range(step.problem.n_robots)
        if self.alpha_s == self.alpha_c == 0:
            return float(step.problem.objective(everyone))
        return float(worst_case_attack(step.problem, everyone).upper)


def _option(config: Mapping[Any, Sequence[Any]], actionable: Any) -> Any:
    return tuple(config[actionable]) if actionable in config else None


def _updated(step: Step, forecast: Forecast) -> set[Any]:
    """The tracks after measurements as predicted: the means stay, the covariances shrink."""
    told = step.problem.information_objective.information.sum(axis=0)
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
