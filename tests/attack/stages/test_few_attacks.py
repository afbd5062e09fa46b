"""Few cuts on large sparse networks: every attack is tried, and equals the definition."""

from itertools import combinations

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from tests.attack.engine import searched
from tests.brackets import attained, is_exact
from tests.oracles import brute_force_worst_case
from tests.strategies import OBJECTIVES, random_elements, random_problem


def tried(problem, elements, max_nodes=None):
    first = ro.bounded_rational_attack(problem, elements).attack
    return searched("every attack", problem, elements, first, max_nodes=max_nodes)[0]


@pytest.mark.parametrize("seed", range(80))
def test_every_attack_against_the_definition(seed):
    """Any graph, connected or not, protected robots and links, any of the set functions; also where nodes run out."""
    rng = np.random.default_rng([seed, 37])
    problem = random_problem(rng, int(rng.integers(1, 6)))
    elements = random_elements(rng, problem)
    worst = brute_force_worst_case(problem, elements)
    whole = tried(problem, elements)
    assert whole.lower == whole.upper == pytest.approx(worst, abs=1e-9)
    assert problem.team_value(elements, whole.attack) == pytest.approx(whole.upper, abs=1e-12)
    part = tried(problem, elements, max_nodes=2)
    assert part.lower <= worst + 1e-9
    assert part.upper >= worst - 1e-9


def sparse_network(rng, n_robots, more_links):
    graph = nx.random_labeled_tree(n_robots, seed=int(rng.integers(2**31)))
    while graph.number_of_edges() < n_robots - 1 + more_links:
        i, j = rng.integers(n_robots, size=2)
        if i != j:
            graph.add_edge(int(i), int(j))
    return graph


@pytest.mark.parametrize(("seed", "n_robots", "alpha_s"), [(0, 25, 0), (1, 40, 0), (2, 60, 0), (3, 30, 1), (4, 127, 0)])
@pytest.mark.parametrize("kind", ["trace", "own"])
def test_one_cut_on_a_sparse_network(seed, n_robots, alpha_s, kind):
    rng = np.random.default_rng([seed, 370])
    graph = sparse_network(rng, n_robots, 3)
    worths = rng.exponential(size=(n_robots, 3, 1, 1)) * np.eye(2) * 0.02
    weights = worths[:, :, 0, 0].sum(axis=1)
    trace, own = ro.TraceObjective(np.stack([np.eye(2)] * 3), worths), ro.Modular(weights)
    problem = ro.Problem(trace if kind == "trace" else own, np.arange(n_robots), graph, alpha_s, 1)

    def groups_after(link):
        left = graph.copy()
        left.remove_edge(*link)
        return [frozenset(group) for group in nx.connected_components(left)]

    outcomes = [groups_after(link) for link in graph.edges]
    values = {group: problem.objective(group) for groups in outcomes for group in groups}
    if alpha_s:
        values |= {g - {i}: problem.objective(g - {i}) for groups in outcomes for g in groups for i in g}
    blinded = [frozenset(chosen) for chosen in combinations(range(n_robots), alpha_s)]
    truth = min(max(values[group - blind] for group in groups) for groups in outcomes for blind in blinded)
    found = ro.worst_case_attack(problem, np.arange(n_robots))
    assert found.stop is ro.Stop.CLOSED
    assert is_exact(problem, np.arange(n_robots), found)
    assert attained(problem, np.arange(n_robots), found) == pytest.approx(truth, rel=1e-12)
    largest = ro.smallest_largest_group(graph, 1)
    assert (largest.lower, largest.upper) == (min(max(map(len, groups)) for groups in outcomes),) * 2


@pytest.mark.parametrize("name", OBJECTIVES)
def test_two_blinded_and_one_cut_in_a_tree_of_sixty_robots_closes(name):
    """104,430 attacks: the bracket was left 4 to 9 % open after 12 s, and the attack was too mild."""
    rng = np.random.default_rng(0)
    graph = nx.random_labeled_tree(60, seed=0)
    h = rng.normal(size=(60, 3, 1, 2)) * np.exp(rng.normal(size=(60, 1, 1, 1)))
    objective = OBJECTIVES[name](np.stack([np.eye(2)] * 3), np.swapaxes(h, -1, -2) @ h)
    problem = ro.Problem(objective, np.arange(60), graph, 2, 1)
    found = ro.worst_case_attack(problem, np.arange(60), time_limit=60)
    assert is_exact(problem, np.arange(60), found)
    blinded = [frozenset(pair) for pair in combinations(range(60), 2)]
    links = list(graph.edges)
    for k in rng.integers(0, len(links) * len(blinded), 200).tolist():
        i, j = sorted(links[k % len(links)])
        attack = ro.Attack(blinded[k // len(links)], frozenset({(i, j)}))
        assert problem.team_value(np.arange(60), attack) >= found.lower
