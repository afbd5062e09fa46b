"""Lower ends proved by sizes of groups: what sizes and cases claim by definition, dense graphs, and faults by name."""

import copy
from itertools import combinations

import networkx as nx
import numpy as np
import pytest

from ratt_opt import Problem, TraceObjective, worst_case_attack
from ratt_opt.budget import Budget
from ratt_opt.certificates.group_sizes.score_bounds import ScoreBounds
from ratt_opt.certificates.params import SizeProofParams
from ratt_opt.certificates.verifier.exact_matrices import is_positive
from ratt_opt.certificates.verifier.sizes import UNIT, LinkCosts, largest_groups
from tests.certificates.engine import accepted_leaves, lower_proof, network, proof, refuse, weaker_lower_proof
from tests.strategies import information_data


def random_graph(seed):
    rng = np.random.default_rng([56, seed])
    prior, information = information_data(rng, 7, 1)
    graph = nx.gnp_random_graph(7, 0.6, seed=seed)
    alpha_s, alpha_c = int(rng.integers(0, 4)), min(int(rng.integers(1, 7)), graph.number_of_edges())
    return Problem(TraceObjective(prior, information), range(7), graph, alpha_s, alpha_c), rng


def near_of(problem):
    near = [0] * problem.n_robots
    for i, j in problem.threat.graph.links:
        near[i], near[j] = near[i] | 1 << j, near[j] | 1 << i
    return near


def bounds_of(problem):
    return ScoreBounds(problem.threat.graph, problem.threat.alpha_c, Budget(), SizeProofParams())


def cost(one, duals, group):
    leaving = sum((one.near[i] & ~sum(1 << j for j in group)).bit_count() for i in group)
    return one.link * leaving - sum(duals[i] for i in group)


def test_sizes_by_definition():
    """No group of an attack costs less than its size says, and with some vector of duals one costs as little."""
    tight = 0
    for seed in range(6):
        problem, _ = random_graph(seed)
        bounds = bounds_of(problem)
        for one, given in zip(bounds.costs, bounds.duals, strict=True):
            for size, least in enumerate(one.least):
                groups = combinations(range(7), size)
                allowed = [c for group in groups if (c := cost(one, given["robots"], group)) <= one.most]
                assert min(allowed, default=np.inf) >= least
                tight += min(allowed, default=np.inf) == least
    assert tight >= 90


def test_cases_by_definition():
    """Whatever the diagonal, groups that are shown to cost more do; large diagonals show it."""
    shown = 0
    for seed in range(60):
        problem, rng = random_graph(seed)
        duals, drawn_robots = rng.integers(-4, 9, 7).tolist(), rng.permutation(7)
        one = LinkCosts(near_of(problem), problem.threat.alpha_c, int(rng.integers(1, 4)), duals)
        inside, others = drawn_robots[: seed % 3].tolist(), drawn_robots[seed % 3 : 6].tolist()
        masks, count = tuple(sum(1 << i for i in part) for part in (inside, others)), int(rng.integers(0, 5))
        known = [cost(one, duals, inside + list(more)) for more in combinations(others, count)]
        for spare in (0, 1, 5, 15) if known else ():
            diagonal = (UNIT * rng.integers(4, 20) + rng.integers(0, UNIT, 7)).tolist()
            more = one.are_above(min(known) - spare, diagonal, masks, count)
            assert not more or spare
            shown += more
    assert shown >= 30


def blinded_partitions(problem, rng):
    """Groups of attacks that blind all they may, drawn at random, with who is blinded."""
    n, threat = problem.n_robots, problem.threat
    for _ in range(60):
        home = rng.integers(0, int(rng.integers(1, 4)), n)
        blinded = set(rng.permutation(n)[: threat.n_blinded].tolist())
        cut = sum(home[i] != home[j] for i, j in threat.graph.links)
        if cut <= threat.alpha_c:
            yield [np.flatnonzero(home == k).tolist() for k in set(home.tolist())], blinded


def test_largest_groups_by_definition():
    """The largest group of every attack has sizes that are possible, and costs no more than it may."""
    seen = 0
    for seed in range(8):
        problem, rng = random_graph(seed)
        bounds = bounds_of(problem)
        duals = [given["robots"] for given in bounds.duals]
        possible = {(g.sensing, g.blinded): g for g in largest_groups(bounds.costs, problem.threat.n_blinded, 8)}
        for groups, blinded in blinded_partitions(problem, rng):
            largest = max(groups, key=lambda group: len(set(group) - blinded))
            seeing = len(set(largest) - blinded)
            found = possible[seeing, len(largest) - seeing]
            costs = [cost(one, own, largest) for one, own in zip(bounds.costs, duals, strict=True)]
            assert all(paid <= limit for paid, limit in zip(costs, found.limits, strict=True))
            seen += len(groups) > 1
    assert seen >= 30


def test_positive_definiteness():
    from flint import fmpz_mat

    rng, positive = np.random.default_rng(57), 0
    for _ in range(200):
        a = rng.integers(-3, 4, (4, 4))
        matrix = a @ a.T + int(rng.integers(-1, 2)) * np.eye(4, dtype=int)
        least = np.linalg.eigvalsh(matrix)[0]
        if abs(least) > 1e-9:
            assert is_positive(fmpz_mat(matrix.tolist())) == (least > 0)
            positive += least > 0
        else:
            assert not is_positive(fmpz_mat(matrix.tolist()))
    assert 50 <= positive <= 195


@pytest.fixture(scope="module")
def large():
    """A dense graph of 18 robots."""
    problem, plan = network("dense", 18, (0.3, 0.3), 2)
    found = worst_case_attack(problem, plan)
    return problem, plan, found, lower_proof(problem, plan, found.lower * (1 - 1e-9))


def test_dense_graphs(large):
    problem, plan, found, part = large
    assert part["conclusion"] == "sizes"
    assert part["trees"]
    assert part["bounds"]
    leaves = accepted_leaves(problem, plan, part, found.lower * (1 - 2e-9))
    assert leaves > 100
    assert proof("sizes", problem, plan, found.upper * (1 + 1e-6)) is None


def test_a_weaker_lower_end_by_sizes(large):
    problem, plan, found, _ = large
    lower, part = weaker_lower_proof(problem, plan, found.upper * 1.005)
    assert part["conclusion"] == "sizes"
    assert accepted_leaves(problem, plan, part, lower * (1 - 1e-9)) > 0


FAULTS = {
    "may cost less": lambda p: p["forms"][-1].update(least=p["forms"][-1]["least"] + 4 * UNIT),
    "must hold|must be a list of": lambda p: p["trees"].pop(),
    "may cost too little": lambda p: p["bounds"][0].update(diagonal=[0] * 18),
    "there are no duals": lambda p: p.update(duals=[], forms=[], bounds=[]),
    "may be part of an attack": lambda p: p["trees"][0].__setitem__(
        next(k for k, node in enumerate(p["trees"][0]) if node == "copies" or "form" in node), "budget"
    ),
    "decided twice": lambda p: p["trees"].__setitem__(0, [{"sense": 0}, {"sense": 0}]),
    "worth less": lambda p: p["trees"].__setitem__(0, ["worth"]),
    "a case has no leaf": lambda p: p["trees"][0].pop(),
    "a node is repeated": lambda p: p["trees"][0].append("worth"),
}


@pytest.mark.parametrize("text", FAULTS)
def test_every_fault_has_its_name(large, text):
    problem, plan, found, part = large
    broken = copy.deepcopy(part)
    FAULTS[text](broken)
    refuse(problem, plan, broken, found.lower * (1 - 2e-9), text)
