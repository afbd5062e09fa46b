"""Five families of networks, checked against what defines them."""

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.scenario.networks import NETWORK_FAMILIES, network_links


@pytest.mark.parametrize("family", NETWORK_FAMILIES)
@pytest.mark.parametrize("n_robots", [1, 2, 3, 5, 24, 60])
def test_links_are_a_simple_graph_and_the_same_again(family, n_robots):
    positions = np.random.default_rng(n_robots).random((n_robots, 2))
    links = network_links(family, positions, 3)
    assert links == network_links(family, positions, 3)
    assert list(links) == sorted(set(links))
    assert all(0 <= i < j < n_robots for i, j in links)


@pytest.mark.parametrize(
    ("family", "degree"), [("dense", 0.7 * 59), ("disk-12", 12), ("disk-6", 6), ("small-world", 6)]
)
def test_mean_degrees(family, degree):
    positions = np.random.default_rng(0).random((60, 2))
    found = [2 * len(network_links(family, positions, seed)) / 60 for seed in range(20)]
    assert np.mean(found) == pytest.approx(degree, rel=0.03)


@pytest.mark.parametrize("family", ["disk-12", "disk-6"])
def test_a_disk_graph_links_exactly_the_nearest_pairs(family):
    positions = np.random.default_rng(1).random((30, 2))
    links = set(network_links(family, positions, 0))
    apart = {(i, j): np.linalg.norm(positions[i] - positions[j]) for j in range(30) for i in range(j)}
    longest = max(apart[link] for link in links)
    assert links == {pair for pair, distance in apart.items() if distance <= longest}


def test_hubs_have_far_more_links_than_the_mean():
    graph = nx.Graph(network_links("hubs", np.zeros((100, 2)), 0))
    degrees = [degree for _, degree in graph.degree]
    assert len(graph.edges) == 4 * 96
    assert max(degrees) > 3 * np.mean(degrees)


@pytest.mark.parametrize("family", NETWORK_FAMILIES)
def test_a_scenario_has_the_robots_of_its_seed_and_shares_of_the_network(family):
    scenario = ro.network_scenario(family, 20, 5, alpha_s=0.2, alpha_c=0.15, seed=4)
    plain = ro.random_scenario(20, 5, alpha_s=0, alpha_c=0, seed=4)
    assert scenario.robots == plain.robots
    assert scenario.targets == plain.targets
    assert (scenario.alpha_s, scenario.alpha_c) == (4, round(0.15 * len(scenario.links)))
    assert scenario.problem().communication.links == frozenset(scenario.links)


def test_numbers_of_robots_and_links_are_taken_as_they_are():
    scenario = ro.network_scenario("disk-6", 20, 5, alpha_s=1, alpha_c=0, seed=4)
    assert (scenario.alpha_s, scenario.alpha_c) == (1, 0)


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"family": "ring"}, "graph must be one of dense, disk-12"),
        ({"alpha_s": 1.5}, "alpha_s must be a number of them or a share"),
        ({"alpha_s": "1"}, "alpha_s must be a number of them or a share"),
        ({"alpha_c": 10_000}, "alpha_c must be an integer in"),
        ({"seed": -1}, "seed must be"),
    ],
)
def test_bad_input_is_refused_in_one_line(arguments, text):
    given = {"family": "dense", "n_robots": 6, "n_targets": 2, "alpha_s": 1, "alpha_c": 1, "seed": 0} | arguments
    with pytest.raises(ro.InputError, match=text):
        ro.network_scenario(given.pop("family"), given.pop("n_robots"), given.pop("n_targets"), **given)
