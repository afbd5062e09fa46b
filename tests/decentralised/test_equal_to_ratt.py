"""Plans by messages are RATT's, element by element, whatever goes wrong."""

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt import Faults, Stop, decentralised_ratt
from tests.decentralised.teams import breaking_faults, expected, radio_faults, team
from tests.strategies import range_bearing


def check_connected(seed):
    rng = np.random.default_rng(seed)
    problem = team(rng)
    plan, known = decentralised_ratt(problem, faults=radio_faults(rng), seed=seed), ro.ratt(problem)
    assert list(plan) == list(known)
    assert plan.bait == known.bait
    assert plan.components == (tuple(range(problem.n_robots)),)


def check_broken(seed):
    rng = np.random.default_rng([1, seed])
    problem = team(rng)
    plan = decentralised_ratt(problem, faults=breaking_faults(rng, problem), seed=seed)
    elements, bait = expected(problem, plan)
    alone = {i for i, element in enumerate(elements) if element is None}
    assert [e for i, e in enumerate(plan) if i not in alone] == [e for e in elements if e is not None]
    assert plan.bait == bait
    assert plan.stop is Stop.EXHAUSTED
    assert not plan.disagreements
    problem.check_plan(plan.elements)
    return bool(plan.faults_met), len(plan.components) > 1


def test_connected_teams():
    for seed in range(150):
        check_connected(seed)


def test_cuts_crashes_and_blindings_in_any_round():
    met, split = np.array([check_broken(seed) for seed in range(200)]).sum(axis=0)
    assert met > 100
    assert split > 50


@pytest.mark.slow
def test_ten_thousand_teams():
    for seed in range(5_000):
        check_connected(10_000 + seed)
        check_broken(10_000 + seed)


def test_every_round_of_one_team_may_be_the_one_of_a_crash():
    problem = team(np.random.default_rng(3), 6, objective="trace")
    last = decentralised_ratt(problem).rounds
    for robot in range(6):
        for at in range(last + 1):
            plan = decentralised_ratt(problem, faults=Faults(crashed=((at, robot),)))
            wanted, _ = expected(problem, plan)
            assert [e for e, w in zip(plan, wanted, strict=True) if w is not None] == [
                e for e in wanted if e is not None
            ]


def test_the_same_seed_gives_the_same_run():
    rng = np.random.default_rng(5)
    problem, faults = team(rng, 6), radio_faults(rng)
    one, again = (decentralised_ratt(problem, faults=faults, seed=7) for _ in range(2))
    assert one == again
    assert one.messages != decentralised_ratt(problem, faults=Faults(loss=0.5), seed=8).messages


def test_robots_without_links_choose_for_themselves():
    problem = team(np.random.default_rng(2), 4)
    isolated = ro.Problem(problem.objective, problem.robot, nx.empty_graph(4), 1, 0)
    plan = decentralised_ratt(isolated)
    assert list(plan) == list(ro.myopic(isolated))
    assert plan.components == ((0,), (1,), (2,), (3,))
    assert (plan.rounds, plan.messages, plan.bytes, plan.decision_time) == (0, 0, 0, 0.0)


def test_a_large_team_with_the_lazy_planner_s_ties():
    rng = np.random.default_rng(1)
    prior, information = range_bearing(rng, 60, 10, 12)
    graph = nx.random_regular_graph(8, 60, seed=1)
    problem = ro.Problem(ro.TraceObjective(prior, information), np.repeat(np.arange(60), 12), graph, 5, 10)
    assert list(decentralised_ratt(problem)) == list(ro.ratt(problem))


def test_faults_after_the_end_are_not_counted():
    problem = team(np.random.default_rng(9), 5)
    calm = decentralised_ratt(problem)
    late = decentralised_ratt(problem, faults=Faults(crashed=((calm.rounds + 1, 0),), blinded=((10**6, 1),)))
    assert late == calm
    assert not late.faults_met


def test_an_early_end_leaves_a_plan():
    problem = team(np.random.default_rng(4), 7)
    plan = decentralised_ratt(problem, faults=Faults(loss=0.9), time_limit=0.0)
    problem.check_plan(plan.elements)
    assert plan.stop in {Stop.TIME, Stop.EXHAUSTED}


@pytest.mark.parametrize(
    ("faults", "named"),
    [
        ({"loss": 1.0}, "loss"),
        ({"duplicates": -0.1}, "duplicates"),
        ({"cuts": ((0, 1),)}, "cuts"),
        ({"crashed": ((-1, 0),)}, "crashed"),
        ({"blinded": ((0, 99),)}, "blinded"),
        ({"cuts": ((0, 0, 99),)}, "cuts"),
    ],
)
def test_faults_that_cannot_be_are_refused(faults, named):
    with pytest.raises(ro.InputError, match=named):
        decentralised_ratt(team(np.random.default_rng(0), 4), faults=Faults(**faults))


def test_other_set_functions_are_refused():
    problem = ro.Problem(ro.TableFunction(np.arange(4.0)), [0, 1], None, 0, 0)
    with pytest.raises(ro.InputError, match="information matrices"):
        decentralised_ratt(problem)
