"""Lower ends proved by prices: sizes forced by trees, and faults by name."""

from __future__ import annotations

import copy
from itertools import combinations

import pytest

from ratt_opt import worst_case_attack
from ratt_opt.budget import Budget
from ratt_opt.graph.largest_group.spreading import forced_size_trees
from tests.certificates.engine import accepted_leaves, drawn, network, proof, refuse


def check_sizes(seeds, least):
    """What trees of links force is left by every attack; the proof of the weakest set of that size, or none."""
    proved = 0
    for seed in seeds:
        problem, plan, worst = drawn(seed)
        size, _ = forced_size_trees(problem.threat, Budget())
        if not size:
            continue
        weakest = min(problem.objective([plan[i] for i in s]) for s in combinations(range(problem.n_robots), size))
        assert weakest <= worst * (1 + 1e-9) + 1e-12
        if weakest <= 1e-3:
            continue
        part = proof("forced_size_trees", problem, plan, weakest * (1 - 1e-9))
        assert accepted_leaves(problem, plan, part, weakest * (1 - 2e-9)) > 0
        for broken, text in broken_trees(part):
            refuse(problem, plan, broken, weakest * (1 - 2e-9), text)
        proved += 1
    assert proved >= least


def broken_trees(part):
    """Proofs with one fault each, and its name."""
    yield part | {"trees": []}, "not every attack"
    yield part | {"size": part["size"] + 1}, "not every attack|must be an integer"
    trees = copy.deepcopy(part["trees"])
    with_links = next((tree for tree in trees if tree["links"]), None)
    if with_links is not None:
        i, j = with_links["links"][0]
        with_links["links"].append([j, i])
        yield part | {"trees": trees}, "no tree of the graph"
        with_links["links"] = []
        yield part | {"trees": trees}, "in no tree"


def test_forced_sizes_by_trees():
    check_sizes(range(30), 5)


@pytest.mark.slow
def test_more_forced_sizes_by_trees():
    check_sizes(range(100, 700), 100)


@pytest.fixture(scope="module")
def large():
    """A disk graph of 21 robots, a third blinded and 30 % of the links cut: no attack tree closes."""
    problem, plan = network("disk-6", 21, (1 / 3, 0.3), 1)
    found = worst_case_attack(problem, plan)
    return problem, plan, found, proof("group_prices", problem, plan, found.lower * (1 - 1e-9))


def test_beyond_attack_trees(large):
    problem, plan, found, part = large
    assert part["kind"] == "group_prices"
    leaves = accepted_leaves(problem, plan, part, found.lower * (1 - 2e-9))
    assert 10 < leaves < len(part["tree"]) + len(part["sizes"])


FAULTS = {
    "prices claim no more": lambda p: p["robots"].__setitem__(0, p["robots"][0] - 2**22),
    "a flow exceeds": lambda p: p["flows"][0]["links"].__setitem__(3, 2**22 + 1),
    "may pay": lambda p: p["flows"][-1].update(links=[0] * len(p["flows"][-1]["links"])),
    "cannot be placed": lambda p: p.update(tree=[1]),
    "decided twice": lambda p: p.update(tree=[0, 0]),
    "worth less": lambda p: p.update(tree=[-1]),
    "a case has no leaf": lambda p: p["tree"].pop(),
    "a node is repeated": lambda p: p["tree"].append(-1),
    "a leaf is not impossible": lambda p: p.update(sizes=[-2]),
}


@pytest.mark.parametrize("text", FAULTS)
def test_every_fault_has_its_name(large, text):
    problem, plan, found, part = large
    broken = copy.deepcopy(part)
    FAULTS[text](broken)
    refuse(problem, plan, broken, found.lower * (1 - 2e-9), text)
