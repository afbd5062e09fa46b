"""The schedule of attacks: brackets stay true whichever stages are left out, and what ran is told as it was."""

import pickle

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from analysis.readme import refreshed
from analysis.schedule import TABLES
from tests.attack.engine import LARGE, WAYS, AttackMemory, size_vectors, without_stages
from tests.documents import ROOT
from tests.oracles import brute_force_worst_case
from tests.strategies import random_elements, random_problem
from tests.ways import go

NAMES = sorted({stage.name for table in TABLES.values() for stage in table})


def tree_like():
    return ro.graph_scenario(nx.path_graph(40), 5, alpha_s=1, alpha_c=1, seed=0).problem()


PROBLEMS = {
    "small": lambda: ro.random_scenario(8, 4, alpha_s=2, alpha_c=6, seed=0).problem(),
    "complete": lambda: ro.random_scenario(20, 6, alpha_s=6, alpha_c=47, seed=0).problem("logdet"),
    "dense": lambda: ro.network_scenario("dense", 24, 5, alpha_s=5, alpha_c=28, seed=1).problem(),
    "hubs": lambda: ro.network_scenario("hubs", 24, 5, alpha_s=2, alpha_c=8, seed=1).problem(),
    "small world": lambda: ro.network_scenario("small-world", 30, 5, alpha_s=6, alpha_c=13, seed=0).problem(),
    "tree": tree_like,
}


@pytest.mark.parametrize("name", PROBLEMS)
def test_each_stage_begins_where_the_one_before_ended(name):
    problem = PROBLEMS[name]()
    found = ro.worst_case_attack(problem, ro.ratt(problem).elements, time_limit=20)
    assert found.stages
    assert all(row.name in NAMES for row in found.stages)
    for before, after in zip(found.stages, found.stages[1:], strict=False):
        assert (before.lower, before.upper) == (after.lower_before, after.upper_before)
    for row in found.stages:
        assert row.lower_before <= row.lower
        assert row.upper <= row.upper_before
    last = found.stages[-1]
    assert found.lower <= min(last.lower, last.upper)
    assert found.upper >= last.upper
    assert found.upper == pytest.approx(last.upper, rel=1e-9)
    assert sum(row.nodes for row in found.stages) <= found.nodes
    assert pickle.loads(pickle.dumps(found)).stages == found.stages


def test_an_attack_that_goes_on_tells_of_what_is_new(monkeypatch):
    go(monkeypatch, WAYS["dual prices"])
    problem = PROBLEMS["small world"]()
    plan, memory = ro.ratt(problem).elements, AttackMemory()
    first = ro.worst_case_attack(problem, plan, max_nodes=1000, memory=memory, brief=True)
    later = ro.worst_case_attack(problem, plan, max_nodes=1000, memory=memory, brief=True)
    assert first.stop is ro.Stop.NODES
    assert [row.name for row in later.stages] == ["earlier search, resumed"]


@pytest.fixture(scope="module")
def small_teams():
    """Problems, plans and their worst cases by brute force, before small teams go the ways of large ones."""
    teams = []
    for seed in range(40):
        rng = np.random.default_rng([seed, 39])
        is_complete = seed % 3 > 0
        kind = None if seed % 3 == 2 else str(rng.choice(["trace", "logdet", "maxeig"]))
        problem = random_problem(rng, int(rng.integers(2, 6)), kind=kind, complete=is_complete, protect=not is_complete)
        plan = random_elements(rng, problem)
        teams.append((problem, plan, brute_force_worst_case(problem, plan)))
    return teams


@pytest.mark.parametrize("name", NAMES)
def test_brackets_are_true_without_a_stage(name, small_teams, monkeypatch):
    go(monkeypatch, LARGE)
    for seed, (problem, plan, worst) in enumerate(small_teams):
        go(monkeypatch, size_vectors(most=(1, 100)[seed % 2]))
        with without_stages(name):
            found = ro.worst_case_attack(problem, plan, time_limit=0.3)
        slack = 1e-9 * abs(worst) + 1e-10
        assert found.lower <= worst + slack
        assert found.upper >= worst - slack
        assert all(row.name != name for row in found.stages)


def test_the_page_of_the_engine_shows_the_schedules(tmp_path):
    text = (ROOT / "docs" / "contributors" / "engine.md").read_text(encoding="utf-8")
    assert refreshed(text, tmp_path) == text


def test_every_condition_says_when():
    for table in TABLES.values():
        for stage in table:
            assert stage.applies.__doc__, stage.name
            assert stage.run.__doc__, stage.name
