"""The guarantee for heard sets, by brute force over plans and robot sets, and at the instance that attains it."""

from itertools import combinations, product

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt import Faults, decentralised_ratt, heard_sets_bound
from tests.decentralised.teams import breaking_faults, connected_graph, parts, radio_faults, team


@pytest.mark.parametrize(("k", "value"), [(0.3, 0.595), (0.5, 0.375), (0.8, 0.12)])
def test_two_components_have_the_known_values(k, value):
    assert heard_sets_bound(2, k=k) == pytest.approx(value)


@pytest.mark.parametrize("k", [0.0, 0.25, 1.0])
def test_one_clique_is_no_better_than_the_pattern_free_bound(k):
    assert heard_sets_bound(1, k=k) == pytest.approx(float(ro.pattern_free_bound(k=k)))
    assert heard_sets_bound(3, c=k) == pytest.approx(float(ro.pattern_free_bound(c=k)))
    assert heard_sets_bound(10**6, k=k) == pytest.approx((1 - k) ** 2, abs=1e-5)


def test_any_group_of_a_broken_team_keeps_its_share():
    checked = 0
    for seed in range(60):
        rng = np.random.default_rng([7, seed])
        problem = team(rng, objective="logdet" if seed % 2 else "trace", most=4)
        f = problem.objective
        plan = decentralised_ratt(problem, faults=breaking_faults(rng, problem), seed=seed)
        blind = {who[0] for _, kind, who in plan.faults_met if kind == "blinded"}
        if blind:
            continue  # the function is another one then
        c = ro.total_curvature(f, problem.robot)
        bounds = [heard_sets_bound(plan.cliques, c=c)]
        if f.is_submodular:
            bounds.append(heard_sets_bound(plan.cliques, k=ro.curvature(f, problem.robot)))
        share = max(map(float, bounds))
        assert decentralised_ratt(problem, c=c).guarantee <= 1
        for size in range(1, problem.n_robots + 1):
            for robots in combinations(range(problem.n_robots), size):
                best = max(f(list(chosen)) for chosen in product(*(problem.choices[i] for i in robots)))
                assert f(plan.elements[list(robots)]) >= share * best - 1e-9
                checked += share > 0
    assert checked > 100


def heard_within(problem, plan, hops):
    """Robots that chose earlier within so many links of each robot, by the definition."""
    graph = nx.empty_graph(problem.n_robots)
    graph.add_edges_from(problem.communication.links)
    apart = dict(nx.all_pairs_shortest_path_length(graph))
    greedy = [i for i in range(problem.n_robots) if i not in plan.bait]
    return [
        tuple(j for j in greedy if j < i and apart[i].get(j, 99) <= hops) * (i in greedy) for i in range(len(apart))
    ]


def check_hops(seed):
    rng = np.random.default_rng([8, seed])
    drawn, hops = team(rng, 5, objective="logdet" if seed % 2 else "trace"), 1 + seed // 2 % 2
    problem = ro.Problem(drawn.objective, drawn.robot, connected_graph(rng, 5, 0.1), int(seed % 3 == 0), 0)
    plan = decentralised_ratt(problem, hops=hops, faults=radio_faults(rng), seed=seed)
    f, heard = problem.objective, heard_within(problem, plan, hops)
    assert list(plan.heard) == heard
    for i, choice in enumerate(problem.choices):
        beside = np.sort(plan.elements[list(heard[i])]) if heard[i] else np.zeros(0, dtype=int)
        assert plan.elements[i] == choice[np.argmax(f.extensions(beside, choice))]
    assert plan.bait == ro.ratt(problem).bait
    kinds = {"c": ro.total_curvature(f, problem.robot)}
    if f.is_submodular:
        kinds["k"] = ro.curvature(f, problem.robot)
    share = max(float(heard_sets_bound(plan.cliques, **{kind: value})) for kind, value in kinds.items())
    best = ro.exhaustive_optimum(problem).upper
    assert ro.worst_case_attack(problem, plan.elements).upper >= share * best - 1e-9
    for size in range(1, problem.n_robots + 1):
        for robots in combinations(range(problem.n_robots), size):
            most = max(f(list(chosen)) for chosen in product(*(problem.choices[i] for i in robots)))
            assert f(plan.elements[list(robots)]) >= share * most - 1e-9
    return plan.cliques > 1, share > 0.01


def test_choices_told_some_hops_far_keep_their_share():
    several, proved = np.array([check_hops(seed) for seed in range(16)]).sum(axis=0)
    assert several > 2
    assert proved > 5


@pytest.mark.slow
def test_choices_told_some_hops_far_keep_their_share_in_many_teams():
    for seed in range(100, 200):
        check_hops(seed)


def check_broken_hops(seed):
    rng = np.random.default_rng([11, seed])
    problem = team(rng)
    plan = decentralised_ratt(problem, hops=int(rng.integers(1, 4)), faults=breaking_faults(rng, problem), seed=seed)
    assert plan.stop is ro.Stop.EXHAUSTED
    assert not plan.disagreements
    for group, own, alone in parts(problem, plan):
        assert set(group) & set(plan.bait) == {group[k] for k in ro.ratt(alone).bait}
        for k, i in enumerate(group):
            assert set(plan.heard[i]) <= set(group)
            heard = [plan.elements[j] for j in plan.heard[i]]
            beside = np.sort(np.searchsorted(own, heard)).astype(int)
            values = alone.objective.extensions(beside, alone.choices[k])
            assert plan.elements[i] == own[alone.choices[k][np.argmax(values)]]


def test_choices_told_some_hops_far_are_best_beside_those_heard_whatever_goes_wrong():
    for seed in range(40):
        check_broken_hops(seed)


@pytest.mark.slow
def test_choices_told_some_hops_far_are_best_beside_those_heard_in_many_teams():
    for seed in range(100, 220):
        check_broken_hops(seed)


def test_all_hops_are_one_clique():
    drawn = team(np.random.default_rng(1), 6, objective="trace")
    problem = ro.Problem(drawn.objective, drawn.robot, nx.path_graph(6), 0, 0)
    plan = decentralised_ratt(problem, hops=6)
    assert plan.cliques == 1
    assert plan.heard[-1] == (0, 1, 2, 3, 4)
    assert plan.messages < decentralised_ratt(problem).messages


def test_who_changed_later_was_not_heard():
    for seed in range(200):
        rng = np.random.default_rng([9, seed])
        problem = team(rng, 5, objective="trace")
        problem = ro.Problem(problem.objective, problem.robot, problem.graph, 0, 0)
        faults = ro.Faults(crashed=((int(rng.integers(6, 30)), int(rng.integers(5))),))
        plan, before = decentralised_ratt(problem, faults=faults), decentralised_ratt(problem)
        if not plan.faults_met:
            continue
        (robot,) = plan.faults_met[0][2]
        stale = [j for j in plan.heard[robot] if plan.elements[j] != before.elements[j]]
        if stale:
            assert plan.cliques >= 2
            return
    pytest.fail("nobody changed after it was heard")


def test_cliques_are_the_components_with_greedy_robots():
    rng = np.random.default_rng(2)
    problem = team(rng, 6, objective="trace")
    nobody = ro.Problem(problem.objective, problem.robot, problem.graph, 0, 0)
    links = sorted(nobody.communication.links)
    assert decentralised_ratt(nobody).cliques == 1
    split = decentralised_ratt(nobody, faults=Faults(cuts=tuple((0, i, j) for i, j in links)))
    assert split.cliques == 1  # a robot that heard nobody has its individually best element, as bait has
    assert len(split.components) == 6
    assert len(links) > 5


def test_two_pairs_that_plan_apart_are_two_cliques():
    prior, information = np.eye(2)[None], np.tile(np.eye(2), (8, 1, 1, 1))
    path = nx.path_graph(4)
    problem = ro.Problem(ro.LogDetObjective(prior, information), np.repeat(np.arange(4), 2), path, 0, 0)
    assert decentralised_ratt(problem).cliques == 1
    apart = decentralised_ratt(problem, faults=Faults(cuts=((0, 1, 2),)), k=0.5)
    assert apart.components == ((0, 1), (2, 3))
    assert (apart.cliques, apart.guarantee) == (2, 0.375)


def test_what_no_guarantee_is_about_is_refused():
    with pytest.raises(ro.InputError, match="cliques"):
        heard_sets_bound(0, k=0.5)
    with pytest.raises(ro.InputError, match="one at a time"):
        decentralised_ratt(team(np.random.default_rng(0), 3), k=0.1, c=0.1)
