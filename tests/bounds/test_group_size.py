"""The guarantees from how few and how many robots an attack leaves together, against what RATT keeps: brute force."""

from itertools import combinations

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt import BoundParams
from ratt_opt.bounds.group_size import achievable_group_size
from ratt_opt.bounds.survivors import largest_survivor_group
from ratt_opt.budget import Budget
from tests.oracles import brute_force_optimum, brute_force_worst_case
from tests.strategies import monotone_table, random_graph, random_objective

FAMILIES = ("coverage", "matroid rank", "facility location", "concave of modular")


def random_problem(rng, *, submodular):
    robots = int(rng.integers(2, 5))
    owners = np.sort(np.concatenate([np.arange(robots), rng.integers(0, robots, int(rng.integers(0, 3)))]))
    if submodular:
        f = ro.reference(str(rng.choice(FAMILIES)), len(owners), rng).function
    else:
        f = (
            random_objective(rng, len(owners))
            if rng.random() < 0.5
            else ro.TableFunction(monotone_table(rng, len(owners)))
        )
    graph = random_graph(rng, robots) if rng.random() < 0.4 else None
    links = robots * (robots - 1) // 2 if graph is None else graph.number_of_edges()
    protected = frozenset(i for i in range(robots) if rng.random() < 0.15)
    return ro.Problem(f, owners, graph, int(rng.integers(0, robots)), int(rng.integers(0, links + 1)), protected)


def check(seeds, *, submodular):
    """Kept share minus promise over random problems; how many had something to keep."""
    useful = 0
    for seed in seeds:
        problem = random_problem(np.random.default_rng([51, submodular, seed]), submodular=submodular)
        optimum = brute_force_optimum(problem)
        if optimum <= 1e-9:
            continue
        useful += 1
        given = (
            {"k": ro.curvature(problem.objective, problem.robot)}
            if submodular
            else {"c": ro.total_curvature(problem.objective, problem.robot)}
        )
        planned = ro.ratt(problem)
        alpha_cs, plan = planned.alpha_cs, planned.elements
        promised = ro.all_guarantees(problem, alpha_cs, **given)
        promised["this instance"] = ro.instance_bound(problem, plan, **given)
        kept = brute_force_worst_case(problem, plan)
        for name, share in promised.items():
            assert kept >= share * optimum - 1e-9 * max(1.0, optimum), (seed, name)
        if alpha_cs > 0:
            assert promised["this instance"] >= promised[f"group size ({next(iter(given))})"] - 1e-9, seed
    return useful


def fewest_together(problem):
    """Smallest largest group of robots that see, by all cuts, with the strongest unprotected robots blinded."""
    single = problem.objective.singletons()
    strength = [single[choice].max() for choice in problem.choices]
    free = sorted((i for i in range(problem.n_robots) if i not in problem.protected_robots), key=lambda i: -strength[i])
    blinded, links = set(free[: problem.alpha_s]), sorted(problem.communication.links)
    cuts = combinations(links, min(problem.alpha_c, len(links)))
    return min(max(len(group - blinded) for group in problem.communication.groups(cut)) for cut in cuts)


def test_the_group_size_is_the_smallest_by_definition():
    for seed in range(300):
        problem = random_problem(np.random.default_rng([52, seed]), submodular=True)
        assert achievable_group_size(problem) == fewest_together(problem), seed


def test_the_group_size_of_a_large_graph_is_achieved():
    objective = ro.random_scenario(16, 3, alpha_s=3, alpha_c=4, seed=0).problem().objective
    graph = nx.random_regular_graph(3, 16, seed=0)
    problem = ro.Problem(objective, np.repeat(np.arange(16), objective.n // 16), graph, 3, 4)
    exact = ro.smallest_largest_group(problem.communication, 4).n_max
    assert exact - 3 <= achievable_group_size(problem) <= 13


@pytest.mark.parametrize("seed", range(6))
def test_annealed_groups_are_never_larger_than_by_cheapest_cuts(seed):
    objective = ro.random_scenario(24, 2, alpha_s=0, alpha_c=0, seed=seed).problem().objective
    graph = nx.random_geometric_graph(24, 0.32, seed=seed)
    links = sorted((min(e), max(e)) for e in graph.edges)
    held = frozenset(links[:: 7 + seed])
    problem = ro.Problem(objective, np.repeat(np.arange(24), 12), graph, 5, len(links) // 6, protected_links=held)
    found = achievable_group_size(problem)
    assert found <= achievable_group_size(problem, params=BoundParams(annealed_links=0))


def test_annealing_finds_smaller_groups_than_cheapest_cuts():
    objective = ro.random_scenario(30, 2, alpha_s=0, alpha_c=0, seed=0).problem().objective
    graph = nx.random_geometric_graph(30, 0.252, seed=0)
    problem = ro.Problem(objective, np.repeat(np.arange(30), 12), graph, 9, 21)
    annealed = achievable_group_size(problem)
    assert 2 * annealed < achievable_group_size(problem, params=BoundParams(annealed_links=0))


def test_a_spent_budget_weakens_the_group_size_at_most():
    objective = ro.random_scenario(30, 2, alpha_s=0, alpha_c=0, seed=0).problem().objective
    graph = nx.random_geometric_graph(30, 0.252, seed=0)
    problem = ro.Problem(objective, np.repeat(np.arange(30), 12), graph, 9, 21)
    assert achievable_group_size(problem) <= achievable_group_size(problem, Budget(0.0)) <= 30 - 9


def test_no_outcome_leaves_more_survivors_together():
    for seed in range(100):
        problem = random_problem(np.random.default_rng([53, seed]), submodular=True)
        left = max(len(group) for outcome in ro.non_dominated_outcomes(problem.threat) for group in outcome)
        assert left <= largest_survivor_group(problem)
        assert left == largest_survivor_group(problem) or not problem.threat.is_symmetric


@pytest.mark.parametrize("submodular", [True, False])
def test_ratt_keeps_every_guarantee(submodular):
    assert check(range(250), submodular=submodular) > 120


@pytest.mark.slow
@pytest.mark.parametrize("start", range(1000, 31_000, 3000))
@pytest.mark.parametrize("submodular", [True, False])
def test_ratt_keeps_every_guarantee_on_twenty_thousand_problems(submodular, start):
    """Ten parts of each kind; every part has at least 2,000 problems in which there is something to keep."""
    assert check(range(start, start + 3000), submodular=submodular) >= 2000


@pytest.mark.parametrize(
    ("given", "bound"),
    [
        ({"g": 1, "k": 1.0}, 1.0),
        ({"g": 2, "k": 0.3}, 0.5),
        ({"g": 0, "c": 1.0}, 1.0),
        ({"g": 1, "c": 1.0}, 1.0),
        ({"g": 3, "c": 0.5}, 0.2),
        ({"g": 3, "c": 1.0}, 0.0),
        ({"g": 2, "k": 1.0, "baits_survive": False}, 0.5),
        ({"g": 1, "k": 0.25, "baits_survive": False}, 1.0),
        ({"g": 2, "c": 0.25, "baits_survive": False}, 3 / 7),
        ({"g": 2, "c": 0.75, "baits_survive": False}, 0.2),
        ({"g": 3, "k": 0.25, "baits_survive": False}, 1 / 3),
    ],
)
def test_values(given, bound):
    assert ro.group_size_bound(**given) == pytest.approx(bound)


def test_the_paper_budget_with_one_robot_a_group_makes_ratt_optimal():
    problem = ro.random_scenario(4, 4, alpha_s=2, alpha_c=4, seed=0).problem()
    assert achievable_group_size(problem) == 1
    best = ro.solve_maxmin(problem)
    assert ro.worst_case_attack(problem, ro.ratt(problem).elements).upper == pytest.approx(best.upper, rel=1e-9)


@pytest.mark.parametrize(
    ("given", "bound"),
    [
        ({"size": 0, "c": 1.0}, 1.0),
        ({"size": 1, "k": 1.0}, 1.0),
        ({"size": 2, "k": 0.5}, 0.625),
        ({"size": 5, "k": 0.5}, 0.5),
        ({"size": 3, "c": 0.5}, 0.4),
        ({"size": 2, "c": 1.0}, 0.0),
    ],
)
def test_values_of_the_survivor_bound(given, bound):
    assert ro.survivor_bound(**given) == pytest.approx(bound)


@pytest.mark.parametrize("size", [2, 3, 10, 1000])
def test_the_survivor_bound_is_above_the_pattern_free_one(size):
    for share in np.linspace(0.05, 0.95, 7):
        assert ro.survivor_bound(size, k=share) >= ro.pattern_free_bound(k=share)
        assert ro.survivor_bound(size, c=share) > ro.pattern_free_bound(c=share)


def test_ratt_is_said_to_be_optimal_where_one_robot_sees_in_every_group(tmp_path):
    report = ro.bound(ro.random_scenario(4, 4, alpha_s=2, alpha_c=4, seed=0), time_limit=20)
    assert report.guaranteed_share == 1.0
    assert report.guarantees["one robot a group"].hypotheses[0] == "normalised, non-decreasing"
    assert report.to_dict()["proofs"]["one robot a group"] == "group_size_bound; in Coq paper_optimal"
    report.save(tmp_path)
    assert "RATT&#x27;s plan is optimal" in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_coq_is_named_for_what_it_covers_only():
    assert ro.group_size_bound(2, k=0.5).proof.endswith("paper_group_size_submodular")
    assert ro.group_size_bound(2, k=0.5, baits_survive=False).proof.endswith("paper_group_size_submodular")
    assert ro.group_size_bound(1, k=0.5, baits_survive=False).proof == "group_size_bound"
    assert ro.survivor_bound(2, k=0.5).proof.endswith("survivor_submodular")
    assert ro.survivor_bound(5, k=0.5).proof.endswith("ratt_submodular")  # no more than the pattern-free bound
    assert ro.survivor_bound(5, c=0.5).proof.endswith("survivor_total_curvature")


@pytest.mark.parametrize(
    ("given", "text"), [({"g": -1, "k": 0.5}, "g must"), ({"g": 1}, "k, c"), ({"g": 1, "c": 2}, "c must")]
)
def test_bad_input(given, text):
    with pytest.raises(ro.InputError, match=text):
        ro.group_size_bound(**given)
