"""Lower ends proved by all groups that an attack may leave: the groups by definition, networks, and faults by name."""

from __future__ import annotations

import copy

import networkx as nx
import numpy as np
import pytest

from ratt_opt import Problem, TraceObjective, worst_case_attack
from ratt_opt.certificates.threatened import Team
from ratt_opt.certificates.verifier.lower_end.all_groups import cheap_groups
from ratt_opt.certificates.verifier.lower_end.group_costs import Groups
from ratt_opt.graph.separable_groups import separable_groups
from tests.certificates.engine import accepted_leaves, drawn, lower_proof, network, proof, refuse, weaker_lower_proof
from tests.strategies import information_data


def by_definition(threat):
    """Connected groups of few links to the others, none of them protected, by trying every set."""
    graph, found = nx.Graph(), set()
    graph.add_nodes_from(range(threat.graph.n_robots))
    graph.add_edges_from(threat.graph.links)
    for mask in range(1, 1 << threat.graph.n_robots):
        group = {i for i in range(threat.graph.n_robots) if mask >> i & 1}
        lost = {(i, j) for i, j in threat.graph.links if (i in group) != (j in group)}
        if len(lost) <= threat.alpha_c and not lost & threat.protected_links and nx.is_connected(graph.subgraph(group)):
            found.add(mask)
    return found


def test_all_groups_by_definition():
    """The verifier lists no others, and leaves out no cheap one; the builder lists the same."""
    left_out = 0
    for seed in range(60):
        problem, rng = drawn(seed)[0], np.random.default_rng([61, seed])
        groups = Groups(Team.of(problem.threat), 3, rng.integers(-2, 9, problem.n_robots).tolist(), 4)
        groups.sets, groups.slack = [((1 << problem.n_robots) - 1, int(rng.integers(1, 4)))], int(rng.integers(-1, 9))
        every, listed = by_definition(problem.threat), list(cheap_groups(groups))
        assert set(listed) <= every
        assert len(set(listed)) == len(listed)
        kept = {mask for mask in every if (group := groups.group_of(mask)) and group.cost <= groups.limit}
        assert kept <= set(listed)
        assert set(separable_groups(problem.threat, 10_000).by_robots().tolist()) == every
        left_out += len(every) - len(listed)
    assert left_out >= 100


def test_links_of_all_groups():
    for seed in range(20):
        threat = drawn(seed)[0].threat
        found = separable_groups(threat, 10_000)
        for mask, links in zip(found.by_robots().tolist(), found.links().tolist(), strict=True):
            assert links == sum((mask >> i & 1) != (mask >> j & 1) for i, j in threat.graph.links)


@pytest.fixture(scope="module")
def large():
    """A small world of 18 robots, a third blinded and 30 % of the links cut."""
    problem, plan = network("small-world", 18, (1 / 3, 0.3), 1)
    found = worst_case_attack(problem, plan)
    return problem, plan, found, lower_proof(problem, plan, found.lower * (1 - 1e-9))


def test_networks(large):
    problem, plan, found, part = large
    assert part["kind"] == "all_groups"
    leaves = accepted_leaves(problem, plan, part, found.lower * (1 - 2e-9))
    assert leaves > 100
    assert proof("all_groups", problem, plan, found.upper * (1 + 1e-6)) is None


def test_a_weaker_lower_end(large):
    problem, plan, found, _ = large
    lower, part = weaker_lower_proof(problem, plan, found.upper * 1.005)
    assert part["kind"] == "all_groups"
    assert accepted_leaves(problem, plan, part, lower * (1 - 1e-9)) > 0


FAULTS = {
    "costs less than nothing": lambda p: p["robots"].__setitem__(slice(None), [x + 2**24 for x in p["robots"]]),
    "cover the team": lambda p: p.update(robots=[0] * 18, blinded=0, group=0, sets=[], triples=[]),
    "worth less": lambda p: p["sets"][0].update(tree=[-1]),
    "a case has no leaf": lambda p: p["sets"][0]["tree"].pop(),
    "a node is repeated": lambda p: p["sets"][0]["tree"].append(-1),
    "a leaf is not impossible": lambda p: p["sets"][0].update(tree=[-2]),
    "must be a record of": lambda p: p.update(flows=[]),
    "must be a list of": lambda p: p["robots"].pop(),
}


@pytest.mark.parametrize("text", FAULTS)
def test_every_fault_has_its_name(large, text):
    problem, plan, found, part = large
    broken = copy.deepcopy(part)
    FAULTS[text](broken)
    refuse(problem, plan, broken, found.lower * (1 - 2e-9), text)


def test_groups_that_cover_the_team_are_a_fault():
    """Two robots that see too little apart: a proof without prices claims what they see together."""
    prior, information = information_data(np.random.default_rng(6), 2, 1)
    problem = Problem(TraceObjective(prior, information), [0, 1], nx.path_graph(2), 0, 1)
    both = [{"robots": [0, 1], "room": 1, "tree": [0, 1, -1, -2, -2]}]
    part = {
        "kind": "all_groups",
        "half_link": 1,
        "robots": [0, 0],
        "blinded": 0,
        "group": 0,
        "triples": [],
        "sets": both,
    }
    refuse(problem, [0, 1], part, problem.objective([0, 1]) * (1 - 1e-9), "groups within the budgets cover the team")
