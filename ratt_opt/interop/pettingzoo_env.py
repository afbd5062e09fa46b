"""A mission as a game: one agent for each robot, the exact attack as opponent, so that learned planners can enter.

PettingZoo's ``ParallelEnv`` [1]_: all agents choose a control at once. The adversary then makes the worst attack within
its budgets on these very choices. Targets move, the robots left measure, and all get the same reward.

.. [1] Terry and others, PettingZoo: Gym for multi-agent reinforcement learning, NeurIPS 2021.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium import spaces
from pettingzoo import ParallelEnv

from ratt_opt._validation import check_integer
from ratt_opt.errors import InputError
from ratt_opt.missions.players.attack_models import attack_model
from ratt_opt.missions.players.attackers import get_attacker
from ratt_opt.missions.run import Flight, Players
from ratt_opt.missions.world import MissionModel, World
from ratt_opt.scenario.model import Scenario
from ratt_opt.solvers.ratt import ratt

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from ratt_opt.missions.planning import TeamPlan
    from ratt_opt.missions.players.attackers import OwnAttacker
    from ratt_opt.problem import Problem

__all__ = ["TrackingEnv"]


class TrackingEnv(ParallelEnv):
    """A mission against an adversary, one agent a robot.

    An action is the number of one of the robot's controls. An observation holds the robot's own number as a unit
    vector (N,), all poses (N, 3) [m, m, rad], and of each target the predicted position (2,) [m] and the lower triangle
    of its covariance (3,) [m^2]: the same knowledge that planners of a mission have. The reward of every agent is the
    value of the team after the attack [unit of the criterion]; its mean over an episode is what planners are compared
    by. ``infos`` has ``attack`` and ``error`` (root mean squared error of the positions [m]).

    Parameters
    ----------
    scenario : the team, the targets, and the adversary's budgets
    steps : of an episode
    attacker : as in :func:`ratt_opt.run_mission`; the exact one by default
    model : motions, sensors and filter

    Raises
    ------
    InputError : an argument breaks its rule.
    """

    metadata = {"name": "ratt_opt_tracking_v0", "render_modes": []}  # noqa: RUF012  (PettingZoo asks for it)
    render_mode = None

    def __init__(
        self,
        scenario: Scenario,
        *,
        steps: int = 20,
        attacker: str | OwnAttacker = "worst",
        model: MissionModel | None = None,
    ) -> None:
        if not isinstance(scenario, Scenario):
            raise InputError("scenario", "must be a Scenario", type(scenario).__name__)
        self._world = World(scenario, model or MissionModel(), 1)
        self._attacker, self._steps = get_attacker(attacker), check_integer("steps", steps, low=1)
        self.possible_agents = [f"robot_{i}" for i in range(scenario.n_robots)]
        self.agents: list[str] = []
        self._flight: Flight | None = None
        self._team: TeamPlan = self._begin(0)
        self._counts = [len(choice) for choice in self._team.problem.choices]
        robots, targets = len(self.possible_agents), len(scenario.targets)
        size = (4 * robots + 5 * targets,)
        # One object for each agent as long as the game lasts: PettingZoo compares them by identity.
        self._seen = {agent: spaces.Box(-np.inf, np.inf, size, np.float64) for agent in self.possible_agents}
        self._acted = {a: spaces.Discrete(n) for a, n in zip(self.possible_agents, self._counts, strict=True)}

    def observation_space(self, agent: str) -> spaces.Box:
        """The space of an agent's observations: the same for all."""
        return self._seen[self.possible_agents[self._number(agent)]]

    def action_space(self, agent: str) -> spaces.Discrete:
        """The controls of an agent."""
        return self._acted[self.possible_agents[self._number(agent)]]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, NDArray[np.float64]], dict[str, dict[str, Any]]]:
        """Begin an episode; its random numbers follow from ``seed``, as those of a mission do."""
        del options
        self._team = self._begin(0 if seed is None else check_integer("seed", seed, low=0))
        self.agents = list(self.possible_agents)
        return self._observations(), {agent: {} for agent in self.agents}

    def step(self, actions: dict[str, int]) -> tuple[dict[str, Any], ...]:
        """Fly one step: observations, rewards, terminations, truncations, infos by agent.

        Raises
        ------
        InputError : an agent has no action, or one that is none.
        """
        if self._flight is None or not self.agents:
            raise InputError("actions", "must come after reset and before the episode's end", sorted(actions))
        elements = np.array([self._element(agent, actions) for agent in self.agents])
        flight, step = self._flight, len(self._flight.steps)
        flight.attack = flight.attacked(step, self._team, elements, flight.threatened(step))
        flight.fly(step, self._team, elements)
        last = flight.steps[-1]
        is_over = len(flight.steps) >= self._steps
        agents, self._team = self.agents, flight.prepare(step + 1)
        error = float(np.sqrt(((last.team.belief.positions - last.truth[:, :2]) ** 2).sum(axis=1).mean()))
        found = (
            self._observations(),
            dict.fromkeys(agents, float(last.value)),
            dict.fromkeys(agents, False),
            dict.fromkeys(agents, is_over),
            {agent: {"attack": last.attack, "error": error} for agent in agents},
        )
        if is_over:
            self.agents = []
        return found

    @property
    def problem(self) -> Problem:
        """Problem of the step to come, for planners ``f(problem)``."""
        return self._team.problem

    def actions_of(self, elements: Iterable[int]) -> dict[str, int]:
        """Return the actions that choose a plan's elements."""
        plan = self.problem.check_plan(list(elements))
        chosen = zip(self.possible_agents, self.problem.choices, plan, strict=True)
        return {agent: int(np.flatnonzero(choice == element)[0]) for agent, choice, element in chosen}

    def _begin(self, seed: int) -> TeamPlan:
        players = Players(ratt, self._attacker, attack_model("renewed"))
        self._flight = Flight(self._world, players, "best group", seed)
        return self._flight.prepare(0)

    def _element(self, agent: str, actions: dict[str, int]) -> int:
        i = self._number(agent)
        if agent not in actions:
            raise InputError("actions", "must have one for every agent", f"none for {agent}")
        action = check_integer(f"action of {agent}", actions[agent], low=0, high=self._counts[i] - 1)
        return int(self._team.problem.choices[i][action])

    def _number(self, agent: str) -> int:
        if agent not in self.possible_agents:
            raise InputError("agent", f"must be one of {', '.join(self.possible_agents)}", agent)
        return self.possible_agents.index(agent)

    def _observations(self) -> dict[str, NDArray[np.float64]]:
        assert self._flight is not None
        world, flight = self._world, self._flight
        at = len(flight.steps) * world.period
        ahead = self._team.memory.belief(0).predicted(world.motion, world.period, at)
        covariance = ahead.covariance[:, [0, 1, 1], [0, 0, 1]]
        seen = np.concatenate([flight.poses[:, :3].ravel(), ahead.positions.ravel(), covariance.ravel()])
        own = np.eye(len(self.possible_agents))
        return {agent: np.concatenate([own[self._number(agent)], seen]) for agent in self.agents}
