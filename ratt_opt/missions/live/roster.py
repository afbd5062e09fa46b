"""Robots that are lost, targets that appear or vanish, attacks that were seen."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import check_integer, readonly
from ratt_opt.errors import InputError
from ratt_opt.missions.belief import Belief
from ratt_opt.missions.world import Threatened, World
from ratt_opt.problem import Attack
from ratt_opt.scenario.model import Target

if TYPE_CHECKING:
    from ratt_opt.missions.live.state import Moment, TrackerState

__all__ = ["threat", "with_attack", "with_target", "without_robot", "without_target"]


def threat(world: World, state: TrackerState) -> Threatened:
    """Return the known failures and the remaining budgets: an attack that was seen has spent its share."""
    seen, team = state.attack, world.scenario
    return Threatened(seen, max(team.alpha_s - len(seen.sensing), 0), max(team.alpha_c - len(seen.links), 0))


def without_robot(world: World, state: TrackerState, robot: int) -> TrackerState:
    """The state once a robot is lost. InputError : there is none of that number, or it is lost already."""
    number = check_integer("robot", robot, low=0, high=world.scenario.n_robots - 1)
    if number in dict(state.lost):
        raise InputError("robot", "must not be lost already", number)
    return replace(state, lost=(*state.lost, (number, state.time)))


def with_attack(world: World, state: TrackerState, attack: Attack) -> TrackerState:
    """The state once an attack is seen. InputError : it is none, or names robots that do not exist."""
    if not isinstance(attack, Attack):
        raise InputError("attack", "must be an Attack", type(attack).__name__)
    for robot in {*attack.sensing, *(i for link in attack.links for i in link)}:
        check_integer("attack robot", robot, low=0, high=world.scenario.n_robots - 1)
    since = dict(state.blinded)
    blinded = tuple((robot, since.get(robot, state.time)) for robot in sorted(attack.sensing))
    return replace(state, attack=attack, blinded=blinded, attacks=(*state.attacks, (state.steps, attack)))


def with_target(world: World, state: TrackerState, target: Target) -> tuple[World, TrackerState]:
    """World and state once a target appears, known as it says. InputError : it is none, or its motion is not known."""
    if not isinstance(target, Target):
        raise InputError("target", "must be a Target", type(target).__name__)
    others = world.scenario.targets if state.targets else ()
    known = _world(world, (*others, target)).motion.initial(world.scenario.replace(targets=(*others, target)))
    # A known velocity's heading is that of time 0, when the target was not there yet.
    began = target.replace(heading=target.heading - target.turn_rate * state.time)
    fresh = Belief(known.mean[-1:], known.covariance[-1:])
    return _world(world, (*others, began)), replace(
        state,
        moments=tuple(
            replace(moment, belief=_joined(moment.belief, fresh), refused=(*moment.refused, 0))
            for moment in state.moments
        ),
        targets=(*state.targets, state.next_target),
        born=(*state.born, state.time),
        next_target=state.next_target + 1,
    )


def without_target(world: World, state: TrackerState, target: int) -> tuple[World, TrackerState]:
    """World and state once a target has vanished. InputError : there is none of that number.

    A scenario has a target at least: after the last one its place is kept, and no belief is about it.
    """
    if target not in state.targets or isinstance(target, bool):
        raise InputError("target", f"must be one of the targets {list(state.targets)}", target)
    row = state.targets.index(target)
    rest = tuple(t for k, t in enumerate(world.scenario.targets) if k != row)
    return _world(world, rest) if rest else world, replace(
        state,
        moments=tuple(_without_row(moment, row, target) for moment in state.moments),
        targets=tuple(j for j in state.targets if j != target),
        born=tuple(time for k, time in enumerate(state.born) if k != row),
    )


def _world(world: World, targets: tuple[Target, ...]) -> World:
    changed = World(world.scenario.replace(targets=targets), world.model, world.horizon)
    if len(changed.motion.noise(changed.period)) != len(targets):
        rule = f"must move any number of targets (name a motion): there are {len(targets)} now"
        raise InputError("motion", rule, type(changed.motion).__name__)
    return changed


def _joined(belief: Belief, more: Belief) -> Belief:
    mean = np.concatenate([belief.mean, more.mean])
    return Belief(readonly(mean), readonly(np.concatenate([belief.covariance, more.covariance])))


def _without_row(moment: Moment, row: int, target: int) -> Moment:
    mean, covariance = (np.delete(part, row, axis=0) for part in (moment.belief.mean, moment.belief.covariance))
    kept = tuple(m for m in moment.measurements if m.target != target)
    refused = tuple(count for k, count in enumerate(moment.refused) if k != row)
    return replace(moment, belief=Belief(readonly(mean), readonly(covariance)), refused=refused, measurements=kept)
