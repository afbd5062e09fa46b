"""The loop of a mission: predict, plan, move, be attacked, measure, update, and again.

Every random number of a step comes from the mission's seed and the step's number alone, one stream for each purpose: a
mission is the same to the bit on every run, targets move alike under every planner, and robots have the same luck.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._params import changed
from ratt_opt._validation import FloatArray, IntArray, check_integer, readonly
from ratt_opt.errors import InputError
from ratt_opt.missions.journal import Journal
from ratt_opt.missions.memory import Memory, Pieces
from ratt_opt.missions.mission import Mission
from ratt_opt.missions.planning import plan_team
from ratt_opt.missions.players.attack_models import AttackModel, attack_model
from ratt_opt.missions.players.attackers import attack_of, get_attacker
from ratt_opt.missions.players.named import name_of
from ratt_opt.missions.players.planners import DecentralisedPlanner, elements_of, get_planner, planned_with
from ratt_opt.missions.result import GroupTrack, MissionStep
from ratt_opt.missions.sensing import group_pieces, simulated_readings
from ratt_opt.missions.world import MissionModel, World
from ratt_opt.problem import Attack
from ratt_opt.scenario.planner_world import Now
from ratt_opt.vocabulary import current_name

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from ratt_opt.missions.belief import Innovation
    from ratt_opt.missions.planning import PlanningGroup, TeamPlan
    from ratt_opt.missions.players.attackers import Attacker, OwnAttacker
    from ratt_opt.missions.players.planners import Planner
    from ratt_opt.missions.sensing import Reading
    from ratt_opt.missions.world import Threatened
    from ratt_opt.scenario.model import Scenario

__all__ = ["SHARING", "Flight", "Players", "run_mission"]

SHARING = ("best group", "all surviving")
TRUTH, MOTION, LUCK, STRIKE, ATTACKER = range(5)
"""Streams of random numbers: the first states, motion noise, measurement noise, failures, the attacker's own."""


def run_mission(
    scenario: Scenario,
    *,
    steps: int,
    planner: str | Planner = "ratt",
    attacker: str | OwnAttacker = "worst",
    attacks: str | AttackModel = "renewed",
    sharing: str | None = None,
    horizon: int = 1,
    seed: int = 0,
    model: MissionModel | None = None,
    journal: str | Path | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> Mission:
    """Fly a mission in simulation.

    Parameters
    ----------
    scenario : where the robots are, what is believed of the targets, and the adversary's budgets
    steps : T, from 1 to a million: every step is kept, with four robots and targets in 4 kB, so a million take 4 GB
    planner : ``"ratt"``, ``"decentralised"``, ``"decentralised_refined"``, ``"refined"``, ``"maxmin"``, ``"greedy"``,
        ``"myopic"``, ``"nonrobust_optimum"``, ``"random"``, or ``f(problem)`` or ``f(problem, world)`` that returns a
        plan or its elements, such as :class:`MaxMinPlanner`; ``world`` is a :class:`PlannerWorld`
    attacker : ``"none"``, ``"worst"``, ``"bounded_rational"``, ``"greedy"``, ``"random"``, or ``f(problem, elements)``
        that returns an :class:`Attack`
    attacks : ``"renewed"`` in every step, ``"persistent"`` (held for 5 steps), ``"permanent"`` (failures add up), or
        an :class:`AttackModel`
    sharing : after a step the team goes on with ``"best group"``'s belief only (the paper's, and the default), or each
        group keeps its own and they are merged without double counting when links return (``"all surviving"``, the
        default for planners by messages: a robot knows what it measured and heard, as in :class:`TeamTrackers`). Then
        groups that standing failures keep apart plan for themselves, each against what of the budgets can hit it; and
        the attacker sees the belief of the group that knows most.
    horizon : steps H that a plan looks ahead; its first controls are executed
    seed : of everything random
    model : motions, sensors and filter; by default the paper's motions and the second-order EKF
    journal : a file that keeps every step's decisions; a mission that was killed is replayed from it and goes on
    progress : called as ``progress(step, steps)``

    If fewer links are left than may be cut, the attacker may cut all of them: ``MissionStep.links_short`` says so.

    Targets that nobody can reach stay as uncertain as their motion makes them; a robot that drives off is not stopped
    unless ``model.area`` says so.

    Raises
    ------
    InputError : an argument breaks its rule, a planner or attacker returns what it may not, or the journal is another
        mission's.
    """
    check_integer("steps", steps, low=1, high=1_000_000)
    check_integer("seed", seed, low=0)
    planner, attacker = current_name("planner", planner), current_name("attacker", attacker)
    if sharing is None:
        sharing = SHARING[isinstance(get_planner(planner), DecentralisedPlanner)]
    if sharing not in SHARING:
        raise InputError("sharing", f"must be {' or '.join(SHARING)}", sharing)
    world = World(scenario, model or MissionModel(), horizon)
    players = Players(get_planner(planner), get_attacker(attacker), attack_model(attacks))
    named = {"planner": planner, "attacker": attacker, "attacks": attacks, "sharing": sharing}
    settings = {name: _described(value) for name, value in named.items()}
    settings |= {"horizon": str(horizon), "seed": str(seed), "linearisation": world.model.linearisation}
    changes = changed(world.model.params)
    of_model = {"model": _described(world.model)} | ({"params": str(changes)} if changes else {})
    log = Journal.open(journal, scenario, settings | of_model)
    settings |= {name: _described(getattr(world.model, name)) for name in ("motion", "area")}
    flight = Flight(world, players, sharing, seed)
    for step in range(steps):
        flight.advance(step, log)
        if progress is not None:
            progress(step + 1, steps)
    return Mission(
        scenario=scenario,
        settings=settings,
        start=scenario.poses,
        steps=tuple(flight.steps),
        decisions=tuple(flight.decisions),
        seconds=tuple(flight.seconds),
    )


@dataclass(frozen=True, slots=True)
class Players:
    """Planner, attacker, and how long attacks last."""

    plan: Planner
    attack: Attacker
    model: AttackModel


class Flight:
    """The state of a mission under way."""

    def __init__(self, world: World, players: Players, sharing: str, seed: int) -> None:
        self.world, self.players, self.sharing, self.seed = world, players, sharing, seed
        scenario = world.scenario
        belief = world.motion.initial(scenario)
        self.memory = Memory.start(world.motion, world.period, belief, scenario.n_robots)
        self.poses = scenario.poses
        self.truth = belief.mean + _drawn(self._rng(0, TRUTH), belief.covariance)
        self.attack = Attack()
        self.attacks: list[tuple[int, Attack]] = []
        self.steps: list[MissionStep] = []
        self.decisions: list[tuple[IntArray, Attack]] = []
        self.seconds: list[float] = []

    def advance(self, step: int, log: Journal) -> None:
        """One step of everything."""
        began = perf_counter()
        threatened = self.threatened(step)
        team = self.prepare(step)
        recorded = log.recorded(step)
        if recorded is None:
            elements = team.chosen(self._planned)
            self.seconds.append(perf_counter() - began)
            self.attack = self.attacked(step, team, elements, threatened)
            log.append(step, elements, self.attack)
        else:
            elements, self.attack = recorded
            self.seconds.append(0.0)
            team.problem.check_plan(elements)
        self.fly(step, team, elements)

    def threatened(self, step: int) -> Threatened:
        """Return what stands failed, and what the adversary may still do in a step."""
        return self.players.model.threatened(step, self.attack, self.world.scenario)

    def prepare(self, step: int) -> TeamPlan:
        """Return the choices of the team in a step, after it has shared what it knows."""
        now = Now(step, step * self.world.period, self.poses, tuple(self.attacks))
        team = plan_team(self.world, self.memory, now, self.threatened(step))
        self.memory = team.memory
        return team

    def fly(self, step: int, team: TeamPlan, elements: IntArray) -> None:
        """Move robots and targets, measure under the attack in force, and keep the step."""
        self.decisions.append((elements, self.attack))
        if not self.attacks or self.attacks[-1][1] != self.attack:
            self.attacks.append((step, self.attack))
        self.poses = readonly(team.sequences.poses[elements, 0])
        self._move_targets(step)
        controls = readonly(team.sequences.controls[elements, 0])
        self._measure(step, team, elements, controls)

    def _planned(self, part: PlanningGroup) -> IntArray:
        return elements_of(planned_with(self.players.plan, part.problem, part.world), part.problem)

    def attacked(self, step: int, team: TeamPlan, elements: IntArray, threatened: Threatened) -> Attack:
        """Return the attack in force in this step: standing failures and the attacker's new ones."""
        standing = threatened.standing
        sensors, links = self.players.model.strikes(
            threatened, len(team.problem.communication.links), self._rng(step, STRIKE)
        )
        if sensors == 0 and links == 0:
            return standing
        problem = team.with_budgets(sensors, links)
        new = attack_of(self.players.attack(problem, elements, self._word(step, ATTACKER)), problem)
        return Attack(standing.sensing | new.sensing, standing.links | new.links)

    def _move_targets(self, step: int) -> None:
        motion, period = self.world.motion, self.world.period
        moved = motion.predict(self.truth, period, step * period)
        self.truth = readonly(moved + _drawn(self._rng(step, MOTION), motion.noise(period)))

    def _measure(self, step: int, team: TeamPlan, elements: IntArray, controls: FloatArray) -> None:
        """Every group updates what it believes; then what is to be shared is."""
        world, n_robots = self.world, self.world.scenario.n_robots
        size = max(sensor.size for sensor in world.sensors)
        luck = self._rng(step, LUCK).standard_normal((n_robots, len(self.truth), size))
        readings = dict(enumerate(simulated_readings(world, self.poses, self.truth, luck)))
        groups = team.groups_under(self.attack)
        whole = Pieces.none(n_robots, self.memory.base)
        made, innovations = np.zeros(n_robots, dtype=np.bool_), []
        best = None if self.sharing == "all surviving" else team.best_of(groups, elements, self.attack)
        for k, group in enumerate(groups):
            see = group - self.attack.sensing if best in {None, k} else frozenset()
            own, innovation = self._pieces(step, min(group), readings, see)
            members = sorted(see)
            whole.information[members], whole.vector[members] = own.information[members], own.vector[members]
            made[members] = True
            innovations.append(innovation)
        memory = self.memory.advanced(whole, made)
        self.memory = memory.shared([range(n_robots)] if best is not None else groups)
        beliefs = [self.memory.belief(min(group)) for group in groups]
        tracks = tuple(
            GroupTrack(robots=group, see=group - self.attack.sensing, belief=belief, innovation=innovation)
            for group, belief, innovation in zip(groups, beliefs, innovations, strict=True)
        )
        if best is None:
            best = int(np.argmin([belief.trace for belief in beliefs]))
        record = MissionStep(
            poses=self.poses,
            controls=controls,
            attack=self.attack,
            links=team.problem.communication.links - self.attack.links,
            truth=self.truth,
            groups=tracks,
            best=best,
            value=team.value(groups[best] - self.attack.sensing, elements),
            links_short=team.links_short,
        )
        self.steps.append(record)

    def _pieces(
        self, step: int, robot: int, readings: Mapping[int, Reading], see: frozenset[int]
    ) -> tuple[Pieces, Innovation]:
        """A group's new pieces, linearised at what its ``robot`` predicts."""
        predicted = self.memory.belief(robot).predicted(self.world.motion, self.world.period, step * self.world.period)
        return group_pieces(self.world, predicted, dict(enumerate(self.poses)), readings, see)

    def _rng(self, step: int, stream: int) -> np.random.Generator:
        return np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=(step, stream)))

    def _word(self, step: int, stream: int) -> int:
        return int(np.random.SeedSequence(self.seed, spawn_key=(step, stream)).generate_state(1)[0])


def _described(value: object) -> str:
    """A value as text, the same in every process: a function by its name, objects without their addresses."""
    return re.sub(r" at 0x[0-9a-f]+", "", name_of(value))


def _drawn(rng: np.random.Generator, covariance: FloatArray) -> FloatArray:
    """(M, d) numbers of the given covariances, which may be singular."""
    values, vectors = np.linalg.eigh(covariance)
    standard = rng.standard_normal(covariance.shape[:2]) * np.sqrt(np.clip(values, 0.0, None))
    return np.asarray((vectors @ standard[..., None])[..., 0])
