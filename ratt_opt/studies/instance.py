"""One scenario of a trial, and what its planners and attackers share."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import networkx as nx

from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.attack.heuristics import bounded_rational_attack, greedy_attack, random_attack
from ratt_opt.budget import Stop
from ratt_opt.errors import InputError
from ratt_opt.missions.players.attackers import attack_of
from ratt_opt.missions.players.named import get_player
from ratt_opt.missions.players.planners import RefinedPlanner, elements_of, planned_with
from ratt_opt.planners.registry import PUBLISHED, Published
from ratt_opt.problem import Attack, Problem
from ratt_opt.scenario.generator import random_scenario
from ratt_opt.scenario.model import Scenario
from ratt_opt.scenario.planner_world import scenario_world
from ratt_opt.scenario.sensor import Sensor
from ratt_opt.scenario.simulation import simulate_tracking
from ratt_opt.setfunctions.criteria.trace import TraceObjective
from ratt_opt.setfunctions.information import InformationObjective
from ratt_opt.solvers.exhaustive import exhaustive_optimum
from ratt_opt.solvers.maxmin.solve import nonrobust_optimum, solve_maxmin
from ratt_opt.solvers.ratt import greedy, myopic, random_plan, ratt

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import IntArray
    from ratt_opt.attack.task import AttackResult
    from ratt_opt.missions.players.attackers import OwnAttacker
    from ratt_opt.missions.players.planners import Planner
    from ratt_opt.scenario.simulation import Tracking
    from ratt_opt.solvers.result import MaxMinResult
    from ratt_opt.studies.cases import Case, Seeds

__all__ = ["ATTACKERS", "GRAPHS", "METRICS", "PLANNERS", "Instance"]

METRICS = ("value", "proved", "trace", "mse")
"""Metrics of a planner under an attacker; the last two need a physical scenario."""
SENSOR = "sensor."
"""Prefix of the options that are fields of the sensor, not arguments of ``random_scenario``."""
LARGEST_EXHAUSTIVE = 5
"""Robots up to which the optimum is found by evaluating every plan; beyond it is bracketed by ``solve_maxmin``."""
EFFORT: dict[str, Any] = {"gap": 5e-4, "max_nodes": 30}
"""Limits of the bracket of a large optimum; counted in nodes, not seconds, so that rows are reproducible."""


@dataclass(slots=True)
class Instance:
    """A problem, its seeds, and the scenario it comes from, if any.

    The optimum is computed when first asked for, and each plan attacked once.
    """

    problem: Problem
    seeds: Seeds
    drawn: Scenario | None = None
    _optimum: MaxMinResult | None = None
    _attacked: dict[bytes, AttackResult] = field(default_factory=dict)

    @classmethod
    def of(cls, case: Case, seeds: Seeds, *, made: Problem | Scenario | None = None) -> Instance:
        """Draw the scenario of one trial, or take the problem or scenario that a study makes itself."""
        if isinstance(made, Scenario):
            return cls(made.problem(case.objective), seeds, made)
        if made is not None:
            return cls(made, seeds)
        options: dict[str, Any] = {name: value for name, value in case.options if not name.startswith(SENSOR)}
        noise: dict[str, Any] = {name.removeprefix(SENSOR): v for name, v in case.options if name.startswith(SENSOR)}
        scenario = random_scenario(
            case.n_robots,
            case.n_targets,
            alpha_s=0,  # the budgets belong to the problem: its graph may have fewer links than the scenario's
            alpha_c=0,
            seed=seeds.scenario,
            sensor=Sensor(**noise),
            **options,
        )
        objective = scenario.problem(case.objective).objective
        graph = None if case.graph == "complete" else GRAPHS[case.graph](case.n_robots)
        return cls(Problem(objective, scenario.robot, graph, case.alpha_s, case.alpha_c), seeds, scenario)

    @property
    def objective(self) -> InformationObjective:
        """The criterion; what needs one is refused for other set functions."""
        if not isinstance(self.problem.objective, InformationObjective):
            raise InputError(
                "metrics", "must not need a criterion of information", type(self.problem.objective).__name__
            )
        return self.problem.objective

    @property
    def scenario(self) -> Scenario:
        """The random scenario; what needs one is refused for problems that a study makes itself."""
        if self.drawn is None:
            raise InputError("metrics", "must not need a scenario if the study makes its problems itself", "mse")
        return self.drawn

    @property
    def optimum(self) -> MaxMinResult:
        """The bracket of the optimum and the plan that attains its lower end."""
        if self._optimum is None:
            small = self.problem.n_robots <= LARGEST_EXHAUSTIVE
            self._optimum = exhaustive_optimum(self.problem) if small else solve_maxmin(self.problem, **EFFORT)
            if (attack := self._optimum.worst_case) is not None and attack.stop in {Stop.CLOSED, Stop.EXHAUSTED}:
                self._attacked.setdefault(self._optimum.elements.tobytes(), attack)
        return self._optimum

    def worst_case(self, plan: IntArray) -> AttackResult:
        """Return the exact worst case of a plan."""
        key = plan.tobytes()
        if key not in self._attacked:
            self._attacked[key] = worst_case_attack(self.problem, plan)
        return self._attacked[key]

    def plan(self, planner: str | Planner) -> IntArray:
        """(N,) the elements that a planner of :data:`PLANNERS`, or one of your own, chooses.

        Raises
        ------
        InputError : there is none of that name, or yours returns no plan.
        """
        if callable(planner):
            world = None if self.drawn is None else scenario_world(self.drawn, self.problem)
            return elements_of(planned_with(planner, self.problem, world), self.problem)
        return get_player("planner", planner, PLANNERS)(self)

    def strike(self, attacker: str | OwnAttacker, plan: IntArray) -> tuple[Attack, float | None]:
        """The attack of an attacker of :data:`ATTACKERS`, or of your own, and what no attack goes below.

        The second is ``None`` if nobody attacks, and 0, the value of no measurements, if your attacker does not say.

        Raises
        ------
        InputError : there is none of that name, or yours returns no attack within the budgets.
        """
        if callable(attacker):
            own = attacker(self.problem, plan)
            return attack_of(own, self.problem), getattr(own, "lower", 0.0)
        found = get_player("attacker", attacker, ATTACKERS)(self, plan)
        return attack_of(found, self.problem), getattr(found, "lower", None)

    @property
    def digest(self) -> str:
        """Hash of everything the planners see: equal for equal scenarios, budgets and objectives.

        Of a set function that is no criterion, the values of single elements stand for the whole.
        """
        problem, f = self.problem, self.problem.objective
        arrays = (f.prior, f.information) if isinstance(f, InformationObjective) else (f.singletons(),)
        parts = [array.tobytes() for array in (problem.robot, *arrays)]
        kind = f.name if isinstance(f, InformationObjective) else type(f).__name__
        threat = f"{problem.alpha_s} {problem.alpha_c} {sorted(problem.communication.links)} {kind}"
        return hashlib.sha256(b"".join([*parts, threat.encode()])).hexdigest()[:16]

    def trace(self, plan: IntArray, attack: Attack) -> float:
        """Trace of the posterior covariance per target [m^2], of the best group left by the attack."""
        group = sorted(self.problem.best_group(plan, attack))
        traces = TraceObjective(self.objective.prior, self.objective.information)
        return float(traces.criterion(self.objective.posterior_information(plan[group])).mean())

    def track(self, plan: IntArray, attack: Attack, *, draws: int) -> Tracking:
        """Simulate what the best group left by the attack measures and estimates."""
        group = self.problem.best_group(plan, attack)
        return simulate_tracking(self.scenario, plan, group, seed=self.seeds.simulation, draws=draws)


def _published(planner: Published) -> Callable[[Instance], IntArray]:
    return lambda instance: planner.plan(instance.problem).elements


PLANNERS: dict[str, Callable[[Instance], IntArray]] = {
    "maxmin": lambda instance: instance.optimum.elements,
    "ratt": lambda instance: ratt(instance.problem).elements,
    "nonrobust_optimum": lambda instance: nonrobust_optimum(instance.problem).elements,
    "greedy": lambda instance: greedy(instance.problem).elements,
    "myopic": lambda instance: myopic(instance.problem).elements,
    "refined": lambda instance: RefinedPlanner()(instance.problem).elements,
    "random": lambda instance: random_plan(instance.problem, seed=instance.seeds.planner).elements,
    **{name: _published(planner) for name, planner in PUBLISHED.items() if planner.takes_any},
}
"""The planners of studies by name. ``refined`` is limited by kicks, so that rows are reproducible."""

ATTACKERS: dict[str, Callable[[Instance, IntArray], Attack | AttackResult]] = {
    "none": lambda _instance, _plan: Attack(),
    "worst": lambda instance, plan: instance.worst_case(plan),
    "bounded_rational": lambda instance, plan: bounded_rational_attack(instance.problem, plan),
    "greedy": lambda instance, plan: greedy_attack(instance.problem, plan),
    "random": lambda instance, plan: random_attack(instance.problem, plan, seed=instance.seeds.attacker),
}
"""The attackers of studies by name."""

GRAPHS: dict[str, Callable[[int], nx.Graph]] = {
    "ring": nx.cycle_graph,
    "line": nx.path_graph,
    "star": lambda n: nx.star_graph(n - 1),
    "grid": lambda n: nx.convert_node_labels_to_integers(nx.grid_2d_graph(2, n // 2), ordering="sorted"),
    "ladder": lambda n: nx.circular_ladder_graph(n // 2),
}
