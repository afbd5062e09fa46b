"""Plans that are looked for on the way have shares of the time: with a thousand robots one step takes half a second."""

import pytest

from ratt_opt import MaxMinParams, Problem, random_scenario, ratt, solve_maxmin, worst_case_attack
from ratt_opt.budget import Budget
from ratt_opt.solvers.maxmin.adversary import PlanIndependentAttacks
from ratt_opt.solvers.maxmin.incumbent import Incumbent
from ratt_opt.solvers.maxmin.outcome_pool import OutcomePool
from ratt_opt.solvers.maxmin.params import AdversaryParams, FirstPlanParams, IncumbentParams
from tests.attack.engine import exchanges_near, first_attack
from tests.brackets import attains

SECONDS = 1000.0


@pytest.fixture
def search() -> Incumbent:
    problem: Problem = random_scenario(20, 6, alpha_s=3, alpha_c=60, seed=0).problem("maxeig")
    return Incumbent(problem, OutcomePool(problem), ratt(problem).elements, Budget(time_limit=SECONDS))


def test_exchanges_next_to_known_outcomes_have_a_share(search: Incumbent, monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of one outcome took all of 50 seconds."""
    limits = []

    def near(_: object, __: object, budget: Budget) -> None:
        assert budget.time_limit is not None
        limits.append(budget.time_limit)
        budget.time_limit = 0.0

    search.adversary.learn(search.candidates.first)
    for seed in range(5):
        search.adversary.learn(ratt(random_scenario(20, 6, alpha_s=3, alpha_c=60, seed=seed).problem()).elements)
    assert len(search.pool) > 1
    exchanges_near(monkeypatch, near)
    search.adversary.learn(search.candidates.first)
    assert len(limits) == 1
    assert limits[0] <= AdversaryParams().quick * SECONDS


def test_attacks_on_one_offered_plan_have_a_share(search: Incumbent, monkeypatch: pytest.MonkeyPatch) -> None:
    shares, calls = [], iter(range(1, 100))

    def part(_: Budget, share: float = 1.0) -> Budget:
        shares.append(share)
        return Budget(time_limit=0.0)

    def learns(_: object) -> bool:
        assert next(calls) == 1
        return True

    monkeypatch.setattr(Budget, "part", part)
    monkeypatch.setattr(search.adversary, "learn", learns)
    monkeypatch.setattr(search.candidates, "is_better", lambda _: True)
    search.offer(search.candidates.first)
    assert shares == [IncumbentParams().improved]
    assert next(calls) == 2


def test_no_plan_is_attacked_once_the_time_is_up(search: Incumbent, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of three planners' plans each took a second or two after the end."""
    search.budget.time_limit = 0.0
    monkeypatch.setattr(search.adversary, "learn", lambda _: pytest.fail("attacked"))
    assert not search.offer(search.candidates.first)
    search.improve(search.candidates.first)


@pytest.mark.parametrize("criterion", ["trace", "logdet", "maxeig"])
def test_what_is_known_at_once_takes_one_attack(criterion: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each planner's plan had one of its own: half a second where a thousand robots lose 300,000 links.

    So it is without an overrun; with one, attacks are begun as long as some of it is left.
    """
    attacked = []
    first_attack(monkeypatch, lambda attack: lambda problem, plan: (attacked.append(plan), attack(problem, plan))[1])
    problem = random_scenario(40, 6, alpha_s=2, alpha_c=500, seed=0).problem(criterion)
    no_overrun = MaxMinParams(first_plans=FirstPlanParams(beyond=0.0))
    found = solve_maxmin(problem, time_limit=0, params=no_overrun)
    assert len(attacked) == 1
    assert found.worst_case is not None
    assert 0 < found.lower <= found.worst_case.upper
    assert attains(problem, found.elements, found.worst_case)


def test_attacks_that_last_are_left_out_where_they_take_long(
    search: Incumbent, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The 368 groups of one attack took all of ten seconds."""
    problem, plan = search.problem, search.candidates.first
    attack = worst_case_attack(problem, plan).attack
    lasting = PlanIndependentAttacks(problem, search.budget, 0.05)
    monkeypatch.setattr(Budget, "part", lambda *_: Budget(time_limit=0.0))
    assert lasting.of(attack) is attack
    monkeypatch.undo()
    assert lasting.of(attack) is not attack
