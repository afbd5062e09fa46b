"""What is proved of the first plan of a large team, whatever becomes of the search for a better one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from ratt_opt import (
    Attack,
    AttackResult,
    MaxMinParams,
    Problem,
    Stop,
    TraceObjective,
    greedy,
    myopic,
    network_scenario,
    random_scenario,
    ratt,
    worst_case_attack,
)
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.solvers.maxmin.adversary import Adversary
from ratt_opt.solvers.maxmin.incumbent import Incumbent
from ratt_opt.solvers.maxmin.outcome_pool import OutcomePool
from ratt_opt.solvers.maxmin.params import IncumbentParams
from ratt_opt.solvers.maxmin.plan_stage import LowerEnd, PlanPhase, run_plan_stages
from ratt_opt.solvers.maxmin.stages.schedule import PLAN_STAGES

if TYPE_CHECKING:
    from collections.abc import Sequence

NODES = 40
"""Few: an attack on teams of this size takes thousands."""


def started(problem: Problem, plan: np.ndarray, **shares: float) -> Incumbent:
    params = MaxMinParams(incumbent=IncumbentParams(**shares))
    return Incumbent(problem, OutcomePool(problem), plan, Budget(time_limit=3600.0), params)


def run(search: Incumbent, phase: PlanPhase, plans: Sequence[np.ndarray] = ()) -> bool:
    """Run the stages of a phase."""
    return run_plan_stages(PLAN_STAGES, LowerEnd(incumbent=search, plans=plans), phase)


@pytest.mark.parametrize(("robots", "blinded", "cut"), [(40, 13, 195), (40, 1, 600), (60, 19, 442)])
def test_the_lower_end_is_what_an_attack_on_the_first_plan_proves_with_as_many_nodes(
    robots: int, blinded: int, cut: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The time is up as soon as a better plan is looked for."""
    problem = random_scenario(robots, 6, alpha_s=blinded, alpha_c=cut, seed=0).problem()
    first = ratt(problem).elements
    alone = worst_case_attack(problem, first, max_nodes=NODES, brief=True)
    at_once = worst_case_attack(problem, first, max_nodes=0, brief=True)
    search = started(problem, first, first_nodes=NODES)

    def no_time(*_: object) -> None:
        raise OutOfBudget(Stop.TIME)

    monkeypatch.setattr(search, "improve", no_time)
    with pytest.raises(OutOfBudget):
        run(search, PlanPhase.BEFORE, [first])
    assert search.proved.lower >= alone.lower > at_once.lower
    assert np.array_equal(search.proved.elements, first)


@pytest.mark.parametrize("criterion", ["trace", "logdet", "maxeig"])
@pytest.mark.parametrize("family", ["complete", "dense", "hubs"])
def test_the_lower_end_is_what_is_known_at_once_of_any_planners_plan(family: str, criterion: str) -> None:
    """At once more can be known of another plan than a brief attack on RATT's proves."""
    if family == "complete":
        scenario = random_scenario(60, 8, alpha_s=12, alpha_c=531, seed=1)
    else:
        scenario = network_scenario(family, 60, 8, alpha_s=0.2, alpha_c=0.15, seed=1)
    problem = scenario.problem(criterion)
    plans = [planner(problem).elements for planner in (ratt, greedy, myopic)]
    at_once = [worst_case_attack(problem, plan, time_limit=0).lower for plan in plans]
    search = started(problem, plans[0], first=0.0)
    search.budget.time_limit = 0.0
    run(search, PlanPhase.BEFORE, plans)
    best = int(np.argmax(at_once))
    assert problem.widen_by_rounding(search.proved.lower, 0.0)[0] == at_once[best] > 0
    assert np.array_equal(search.proved.elements, plans[best])
    assert search.proved.worst_case is not None
    assert search.proved.worst_case.upper == problem.team_value(plans[best], search.proved.worst_case.attack)


def contested(problem: Problem) -> tuple[Incumbent, np.ndarray, np.ndarray]:
    """A search, RATT's plan in it, and another one that seems better."""
    first = ratt(problem).elements
    search = started(problem, first)
    search.adversary.learn(first)
    known = search.pool.plan_value(first)
    rng, best = np.random.default_rng(0), first
    while not search.pool.plan_value(best) > known:
        drawn = np.array([rng.choice(choice) for choice in problem.choices])
        best = np.where(rng.random(len(first)) < 0.2, drawn, first)
    search.candidates.add(first)
    search.candidates.add(best)
    return search, first, best


@pytest.mark.parametrize("share_of_best", [0.5, 0.9])
def test_of_the_plan_that_more_is_proved_of_more_is_proved_in_the_end(
    share_of_best: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before the proof of the best plan, which may be in vain, the one of which most was proved is attacked again."""
    problem = random_scenario(40, 6, alpha_s=2, alpha_c=300, seed=0).problem()
    search, first, best = contested(problem)
    known = search.pool.plan_value(first)
    attacked = []

    def attack(_: Adversary, plan: np.ndarray, _budget: Budget, _aim: float) -> AttackResult:
        is_first = np.array_equal(plan, first)
        attacked.append(is_first)
        share = 0.95 + 0.01 * len(attacked) if is_first else share_of_best
        return AttackResult(attack=Attack(), lower=share * known, upper=known, stop=Stop.TIME, evaluations=1)

    monkeypatch.setattr(Adversary, "attack", attack)
    search.proved.attack(first, Budget())
    search.proved.attack(best, Budget())
    assert not run(search, PlanPhase.BETWEEN)
    assert attacked == [True, False, True, False]
    assert search.proved.lower == pytest.approx(0.98 * known)


class _Attacks:
    """Exact attacks of scripted ends, as shares of what is known of a plan; notes which plans were attacked."""

    def __init__(self, search: Incumbent, first: np.ndarray, ends: list[tuple[bool, float]]) -> None:
        self.search, self.first, self.ends = search, first, iter(ends)
        self.attacked: list[bool] = []
        self.aims: list[float] = []

    def __call__(self, plan: np.ndarray, _budget: Budget, aim: float) -> AttackResult:
        is_first, lower = next(self.ends)
        assert is_first == np.array_equal(plan, self.first)
        self.attacked.append(is_first)
        self.aims.append(aim)
        known = self.search.pool.plan_value(plan)
        return AttackResult(attack=Attack(), lower=lower * known, upper=known, stop=Stop.TIME, evaluations=1)


@pytest.mark.parametrize(
    "ends",
    [
        [(True, 0.90), (False, 0.80), (True, 0.95)],
        [(True, 0.80), (False, 0.90), (False, 0.95)],
    ],
)
def test_on_a_network_the_plan_that_more_is_proved_of_gets_the_rest(
    ends: list[tuple[bool, float]], monkeypatch: pytest.MonkeyPatch
) -> None:
    problem = network_scenario("hubs", 24, 4, alpha_s=5, alpha_c=12, seed=0).problem()
    search, first, _ = contested(problem)
    known = search.pool.plan_value(first)
    attacks = _Attacks(search, first, [*ends, (False, 0.5)])
    monkeypatch.setattr(Adversary, "attack", attacks)
    assert not run(search, PlanPhase.BETWEEN)
    assert attacks.attacked[:3] == [is_first for is_first, _ in ends]
    assert search.proved.lower >= 0.95 * known
    level = search.candidates.level
    lower = ends[0][1] * known
    assert attacks.aims[1] == pytest.approx(level - IncumbentParams().left_early * (level - lower))
    assert attacks.aims[0] == problem.objective([])


@pytest.mark.parametrize("seconds", [0.3, 0.6, 1.0, 3.0])
@pytest.mark.parametrize("family", ["dense", "disk-6", "small-world", "hubs"])
def test_of_a_short_search_on_a_network_the_first_attack_has_nearly_all(
    family: str, seconds: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With four fifths of a second 81 of 236 searches proved less of RATT's plan than an attack on it alone."""
    problem = network_scenario(family, 24, 4, alpha_s=0.2, alpha_c=0.15, seed=0).problem()
    parts = []

    def attack(_: Adversary, _plan: np.ndarray, part: Budget, _aim: float) -> AttackResult:
        assert part.time_limit is not None
        parts.append(part.time_limit)
        raise OutOfBudget(Stop.TIME)

    monkeypatch.setattr(Adversary, "attack", attack)
    first, budget = ratt(problem).elements, Budget(time_limit=seconds)
    monkeypatch.setattr("ratt_opt.budget.monotonic", lambda: budget.started)
    with pytest.raises(OutOfBudget):
        run(Incumbent(problem, OutcomePool(problem), first, budget), PlanPhase.BEFORE, [first])
    assert min(seconds, 1.0) >= parts[0] >= 0.9 * min(seconds, 1.0)


def test_a_search_goes_on_where_another_plan_seems_as_good_as_the_one_refuted() -> None:
    """The level did not fall, so a search of 24 robots ended after 7 of 60 seconds with 0.03 % open."""
    information = np.diag([1.0, 1.0]) * np.array([0.5, 7.0, 10.0, 6.0, 10.0, 6.0, 10.0])[:, None, None, None]
    problem = Problem(TraceObjective(np.eye(2)[None], information), [0, 0, 0, 1, 1, 2, 2], None, 1, 0)
    weak, proved, strong = np.array([0, 4, 6]), np.array([1, 3, 5]), np.array([2, 4, 6])
    search = started(problem, proved)
    search.proved.attack(proved, search.budget)
    for plan in weak, strong:
        search.candidates.meet(plan)
        search.candidates.add(plan)
    assert search.candidates.best.tolist() == weak.tolist()
    level = search.candidates.level
    assert run(search, PlanPhase.BETWEEN)
    assert search.candidates.level == level
    assert search.candidates.best.tolist() == strong.tolist()
    assert run(search, PlanPhase.BETWEEN)
    assert search.is_proved
