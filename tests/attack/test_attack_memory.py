"""Attacks that go on where an earlier one on the same plan ended."""

from dataclasses import replace

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.budget import Budget
from tests.attack.engine import LARGE, WAYS, AttackMemory, Search
from tests.brackets import assert_closed
from tests.oracles import brute_force_worst_case
from tests.strategies import Opaque, random_elements, random_problem, team_problem
from tests.ways import go

PIECES = 20_000
"""Budgets after which a search that learns nothing from one to the next would still not have ended."""


@pytest.mark.parametrize("seed", range(1, 13))
@pytest.mark.parametrize(("name", "growth"), [("dual prices", 50), ("listed columns", PIECES)])
def test_a_search_is_gone_on_with_from_one_small_budget_to_the_next(name: str, growth: int, seed: int) -> None:
    problem, plan = team_problem(seed, 3 + seed % 4)
    search = Search(name, problem, plan)
    bracket = search.bracket
    truth, ends = brute_force_worst_case(problem, plan), (bracket.lower, bracket.upper)
    for piece in range(PIECES):
        if search.run(Budget(max_nodes=1 + piece % growth)) is ro.Stop.CLOSED:
            break
        assert ends[0] <= bracket.lower <= truth * (1 + 1e-9) + 1e-10
        assert truth <= bracket.upper * (1 + 1e-9) + 1e-10
        assert bracket.upper <= ends[1]
        ends = bracket.lower, bracket.upper
    assert_closed(problem, plan, bracket, truth)


def test_an_attack_in_pieces_proves_what_one_proves(monkeypatch: pytest.MonkeyPatch) -> None:
    go(monkeypatch, LARGE, WAYS["dual prices"])
    problem = ro.network_scenario("hubs", 24, 4, alpha_s=2, alpha_c=8, seed=1).problem()
    plan = ro.ratt(problem).elements
    whole, memory = ro.worst_case_attack(problem, plan), AttackMemory()
    assert whole.stop is ro.Stop.CLOSED
    parts = [ro.worst_case_attack(problem, plan, max_nodes=0, memory=memory, brief=True)]
    while parts[-1].stop is ro.Stop.NODES:
        parts.append(ro.worst_case_attack(problem, plan, max_nodes=100 * len(parts), memory=memory, brief=True))
        assert parts[-2].lower <= parts[-1].lower <= whole.upper * (1 + 1e-9)
        assert whole.lower * (1 - 1e-9) <= parts[-1].upper <= parts[-2].upper
    assert parts[-1].stop is ro.Stop.CLOSED
    assert parts[-1].upper == pytest.approx(whole.upper, rel=1e-9)
    begun = [row.name for part in parts for row in part.stages if row.name != "earlier search, resumed"]
    assert begun[-1] == "dual prices"
    assert len(parts) > 2


def test_more_time_runs_the_first_stages_again() -> None:
    """They had a share of next to nothing."""
    problem = ro.network_scenario("small-world", 60, 4, alpha_s=12, alpha_c=26, seed=0).problem()
    plan, memory = ro.ratt(problem).elements, AttackMemory()
    at_once = ro.worst_case_attack(problem, plan, time_limit=0, memory=memory)
    for seconds in (2, 8, 32):  # two are enough unless the machine is busy
        later = ro.worst_case_attack(problem, plan, time_limit=seconds, memory=memory)
        if later.lower > at_once.lower:
            break
    assert later.lower > at_once.lower
    assert later.upper < at_once.upper


def test_what_is_remembered_of_another_plan_is_refused() -> None:
    problem = ro.network_scenario("hubs", 14, 3, alpha_s=2, alpha_c=4, seed=0).problem()
    plan, memory = ro.ratt(problem).elements, AttackMemory()
    first = ro.worst_case_attack(problem, plan, memory=memory)
    other = np.array([choice[choice != e][0] for choice, e in zip(problem.choices, plan, strict=True)])
    with pytest.raises(ro.InputError, match="memory"):
        ro.worst_case_attack(problem, other, memory=memory)
    assert ro.worst_case_attack(problem, plan, memory=memory).upper == first.upper


@pytest.mark.parametrize("seed", range(8))
def test_thresholds_in_pieces_never_prove_less_than_before(seed: int) -> None:
    """A table of all sets must not drop what was proved without it, and is not made twice."""
    rng = np.random.default_rng(seed)
    problem = random_problem(rng, n_robots=5, kind=["trace", "logdet"][seed % 2])
    opaque = replace(problem, objective=Opaque(problem.objective))
    plan, memory = random_elements(rng, problem), AttackMemory()
    truth = brute_force_worst_case(problem, plan)
    parts = [ro.worst_case_attack(opaque, plan, max_evaluations=20, memory=memory)]
    while parts[-1].stop not in {ro.Stop.EXHAUSTED, ro.Stop.CLOSED}:
        parts.append(ro.worst_case_attack(opaque, plan, max_nodes=1, memory=memory, brief=True))
        assert parts[-2].lower * (1 - 1e-8) <= parts[-1].lower <= truth * (1 + 1e-9) + 1e-10
        assert truth * (1 - 1e-9) <= parts[-1].upper <= parts[-2].upper
    assert parts[-1].upper == pytest.approx(truth, rel=1e-9, abs=1e-10)
    assert opaque.objective.asked < 2 * 60


def test_a_bound_that_a_table_refutes_is_dropped() -> None:
    """Bounds found before rely on a function that never falls; one that does is answered from its table."""
    values = np.array([0.0, 3.0, 3.0, 1.0])
    problem = ro.Problem(Opaque(ro.TableFunction(values)), np.arange(2), None, 0, 0)
    memory = AttackMemory()
    first = ro.worst_case_attack(problem, [0, 1], max_evaluations=2, memory=memory)
    found = ro.worst_case_attack(problem, [0, 1], memory=memory)
    assert first.lower <= found.lower == found.upper == 1.0
