"""Compiled covers of all sets of a forced size: no larger than plain ones, and never above the worst case."""

from __future__ import annotations

import numpy as np
import pytest

from ratt_opt import ProofError, random_scenario, ratt, worst_case_attack
from ratt_opt.attack.least_sets.packed_team import PackedTeam
from ratt_opt.certificates import forced_size, size_tree
from ratt_opt.certificates.forced_size import forced_size_tree
from ratt_opt.certificates.plan_sets import PlanSets
from ratt_opt.certificates.size_tree import _SizeTree
from ratt_opt.graph.survivor_sizes import forced_group_size
from tests.certificates.engine import UndecidedError, accepted_leaves, limited, lower_proof, watched
from tests.strategies import OBJECTIVES


def case(kind, seed, robots=14):
    """A problem in which one forced group decides, RATT's plan, its team, the forced size and the worst case."""
    alpha_s, alpha_c = ((3, 13), (4, 0), (0, 24))[seed % 3]
    problem = random_scenario(robots, 4, alpha_s=alpha_s, alpha_c=alpha_c, seed=seed).problem(kind)
    elements = ratt(problem).elements
    team = PackedTeam.planar(problem.objective, elements)
    size = forced_group_size(robots, alpha_s, alpha_c)
    sets = (np.bitwise_count(np.arange(2**robots)) == size).nonzero()[0]
    members = (sets[:, None] >> np.arange(robots)) & 1
    weakest = float(team.values(team.prior + np.tensordot(members, team.information, 1)).min())
    return problem, elements, team, size, weakest


def check(problem, elements, size, tree, level):
    """What the verifier says of the cover; a ProofError where it proves less."""
    return accepted_leaves(problem, elements, {"kind": "forced_size", "size": size, "tree": tree}, level)


@pytest.mark.parametrize("kind", OBJECTIVES)
@pytest.mark.parametrize("seed", range(3))
def test_a_cover_proves_the_weakest_set_and_nothing_above_it(kind, seed):
    problem, elements, team, size, weakest = case(kind, seed)
    assert worst_case_attack(problem, elements).upper >= weakest * (1 - 1e-12)
    tree = forced_size_tree(team, size, weakest * (1 - 1e-12), 100_000)
    assert check(problem, elements, size, tree, weakest * (1 - 1e-11)) == sum(node < 0 for node in tree)
    with pytest.raises(ProofError, match="worth less"):
        check(problem, elements, size, tree, weakest * (1 + 1e-9))
    assert forced_size_tree(team, size, weakest * (1 + 1e-9), 100_000) is None


@pytest.mark.parametrize("kind", OBJECTIVES)
def test_covers_are_smaller_than_those_that_decide_the_weakest_robot_first(kind):
    ours, plain = [], []
    for seed in range(6):
        problem, elements, team, size, weakest = case(kind, seed)
        level = weakest * (1 - 1e-12)
        ours.append(len(forced_size_tree(team, size, level, 100_000)))
        everyone = frozenset(range(problem.n_robots))
        plain.append(len(_SizeTree(PlanSets(problem, elements, level), size, 100_000, everyone).run()))
    assert sum(ours) < 0.9 * sum(plain)


def test_limits_of_nodes_cases_work_and_time(monkeypatch):
    _, _, team, size, weakest = case("trace", 0)
    nodes = len(forced_size_tree(team, size, weakest * (1 - 1e-12), 100_000))
    assert nodes > 50
    assert len(forced_size_tree(team, size, weakest * (1 - 1e-12), nodes)) == nodes
    assert forced_size_tree(team, size, weakest * (1 - 1e-12), nodes // 2) is None
    monkeypatch.setattr(forced_size, "AT_ONCE", 1)
    told = []
    with watched(told.append):
        assert len(forced_size_tree(team, size, weakest * (1 - 1e-12), nodes)) == nodes
    assert told[0] == "covering all attacks, 0 cases"
    with limited(0.0), pytest.raises(UndecidedError):
        forced_size_tree(team, size, weakest * (1 - 1e-12), 100_000)
    for limit in ("MOST_CASES", "MOST_LOOKED_AT"):
        with monkeypatch.context() as patch:
            patch.setattr(forced_size, limit, 100)
            assert forced_size_tree(team, size, weakest * (1 - 1e-12), 100_000) is None


def test_larger_teams_have_compiled_covers_and_small_ones_plain_ones(monkeypatch):
    problem, elements, team, size, weakest = case("logdet", 0)
    level = weakest * (1 - 1e-12)
    expected = forced_size_tree(team, size, level, 100_000)
    assert lower_proof(problem, elements, level)["tree"] == expected
    monkeypatch.setattr(size_tree, "LARGEST_PLAIN", 14)
    assert lower_proof(problem, elements, level)["tree"] != expected
