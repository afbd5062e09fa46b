"""Remarks on numbers of a scenario that can hardly be meant: degrees, geographic places, teams in pieces."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import networkx as nx
import numpy as np

from ratt_opt._values import counted

if TYPE_CHECKING:
    from ratt_opt.scenario.model import Scenario

__all__ = ["PlausibleNumbers", "scenario_remarks"]


@dataclass(frozen=True, slots=True)
class PlausibleNumbers:
    """Limits beyond which a number is remarked on; wider limits remark less, and miss more mistakes.

    ``angle`` : size of a heading [rad]; ``turn_rate`` [rad/s]; ``extent`` : of all places over a target's standard
    deviation; ``degrees`` : extent of places below which they may be degrees.
    """

    angle: float = 2 * math.pi
    turn_rate: float = 2 * math.pi
    extent: float = 0.1
    degrees: float = 1.0


def scenario_remarks(scenario: Scenario, limits: PlausibleNumbers | None = None) -> tuple[str, ...]:
    """One line for each kind of number that can hardly be meant; none if all can."""
    limits = limits or PlausibleNumbers()
    found = (_angles(scenario, limits), *_places(scenario, limits), _network(scenario), _noise(scenario))
    return tuple(line for line in found if line)


def _angles(scenario: Scenario, limits: PlausibleNumbers) -> str:
    headings = [robot.heading for robot in scenario.robots] + [target.heading for target in scenario.targets]
    turns = [target.turn_rate for target in scenario.targets]
    for robot in scenario.robots:
        turns += [control[1] for control in robot.controls] if robot.motion == "unicycle" else []
        turns += [control[2] for control in robot.controls if robot.motion == "holonomic" and len(control) > 2]
    turn, heading = max(map(abs, turns)), max(map(abs, headings))
    if turn > limits.turn_rate:
        return f"a turn rate is {turn:g} rad/s: should it be degrees? Angles are radians"
    return f"a heading is {heading:g} rad: should it be degrees? Angles are radians" if heading > limits.angle else ""


def _places(scenario: Scenario, limits: PlausibleNumbers) -> tuple[str, ...]:
    places = np.concatenate([scenario.poses[:, :2], [(target.x, target.y) for target in scenario.targets]])
    extent = float(np.ptp(places, axis=0).max())
    std = min(target.covariance[0][0] ** 0.5 for target in scenario.targets)
    if extent >= limits.extent * std:
        return ()
    words = f"all places lie within {extent:.3g} m, far less than the targets' standard deviations ({std:.3g} m)"
    low, high = np.abs(places).max(axis=0).tolist()
    if extent < limits.degrees and max(low, high) > 1 and low <= 180 and high <= 180:
        words += ": are they latitude and longitude? Places are metres"
    return (words,)


def _network(scenario: Scenario) -> str:
    graph = scenario.graph
    if graph is None or scenario.n_robots == 1:
        return ""
    parts = nx.number_connected_components(graph)
    if parts == 1:
        return ""
    reach = scenario.communication_range
    why = "" if reach is None else f" (communication_range is {reach:g} m)"
    if parts == scenario.n_robots:
        return f"no two robots are linked{why}: each is alone, and cutting links changes nothing"
    return f"the network is in {counted(parts, 'piece')}{why}: groups share nothing even without an attack"


def _noise(scenario: Scenario) -> str:
    period = scenario.sampling_period
    if period == 1 or all(t.process_noise is not None or t.process_std == 0 for t in scenario.targets):
        return ""
    return (
        f"process_std is per sampling period ({period:g} s), as in all files so far; process_noise is per root second"
    )
