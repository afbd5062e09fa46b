"""Lower ends proved by prices: against brute force, another exact method, and mutations."""

from __future__ import annotations

import copy
from itertools import combinations

import networkx as nx
import numpy as np
import pytest
from flint import fmpq

from ratt_opt import FileFormatError, Problem, ProofError, network_scenario, ratt, worst_case_attack
from ratt_opt.budget import Budget
from ratt_opt.certificates.forced_by_trees import forced_size_proof
from ratt_opt.certificates.group_prices import group_price_proof
from ratt_opt.certificates.plan_sets import NotClosedError, PlanSets
from ratt_opt.certificates.verifier.lower import LowerCheck
from ratt_opt.certificates.verifier.statement import Statement
from ratt_opt.certificates.write import _prior_range, problem_document
from ratt_opt.graph.largest_group.spreading import forced_size_trees
from tests.certificates.test_mutations import refused_lower_ends
from tests.oracles import brute_force_worst_case
from tests.strategies import OBJECTIVES, random_problem

KINDS = list(OBJECTIVES)
NODES = 20_000


def proof(problem, plan, threshold):
    """The proof of a threshold, or ``None``."""
    try:
        return group_price_proof(PlanSets(problem, np.asarray(plan), threshold), NODES)
    except NotClosedError:
        return None


def checker(problem, plan):
    record, plan = problem_document(problem), np.asarray(plan).tolist()
    return LowerCheck(Statement(record, plan, _prior_range(problem, record, plan)))


def exact(value):
    return fmpq(*float(value).as_integer_ratio())


def drawn(seed):
    """A connected graph with things protected, a random plan, and the worst case by brute force."""
    rng = np.random.default_rng([51, seed])
    base = random_problem(rng, int(rng.integers(3, 8)), kind=KINDS[seed % 3], controls=2, complete=False)
    n = base.n_robots
    graph = nx.gnp_random_graph(n, 0.5, seed=seed)
    graph.add_edges_from(zip(range(n - 1), range(1, n), strict=True))
    links = sorted(tuple(sorted(link)) for link in graph.edges)
    safe = {links[int(rng.integers(len(links)))]} if seed % 4 == 1 else set()
    seeing = {int(rng.integers(n))} if seed % 4 == 2 else set()
    alpha_s, alpha_c = int(rng.integers(0, n // 2 + 1)), int(rng.integers(1, min(len(links), 6) + 1))
    problem = Problem(base.objective, base.robot, graph, alpha_s, alpha_c, seeing, safe)
    plan = [int(rng.choice(own)) for own in problem.choices]
    return problem, plan, brute_force_worst_case(problem, plan)


def small_proofs(seeds):
    for seed in seeds:
        problem, plan, worst = drawn(seed)
        if worst > 1e-3:
            yield problem, plan, worst, proof(problem, plan, worst * (1 - 1e-7))


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
        part = forced_size_proof(PlanSets(problem, np.array(plan), weakest * (1 - 1e-9)), NODES)
        assert checker(problem, plan).check(part, exact(weakest * (1 - 2e-9))) > 0
        for broken, text in broken_trees(part):
            with pytest.raises((ProofError, FileFormatError), match=text):
                checker(problem, plan).check(broken, exact(weakest * (1 - 2e-9)))
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


def check_small(seeds, least):
    closed = 0
    for problem, plan, worst, part in small_proofs(seeds):
        assert proof(problem, plan, worst * (1 + 1e-6)) is None
        if part is not None:
            closed += 1
            assert checker(problem, plan).check(part, exact(worst * (1 - 2e-7))) > 0
            with pytest.raises(ProofError):
                checker(problem, plan).check(part, exact(worst * (1 + 1e-6)))
    assert closed >= least


def test_small_teams_by_brute_force():
    """A proof of the worst case is accepted, of more there is none; not every worst case is in reach of prices.

    The last four: fewer robots may see because of an average that robots that cannot see spoil.
    """
    check_small([*range(24), 332, 401, 660, 731], 8)


@pytest.mark.slow
def test_more_small_teams_by_brute_force():
    check_small(range(100, 1100), 500)


def test_no_mutated_proof_hides_a_false_claim(tmp_path):
    assert refused_lower_ends(small_proofs(range(6)), np.random.default_rng(52), 0.05, tmp_path / "m.json") >= 50


@pytest.mark.slow
def test_many_mutated_proofs(tmp_path):
    assert (
        refused_lower_ends(small_proofs(range(100, 170)), np.random.default_rng(52), 1.0, tmp_path / "m.json") >= 20_000
    )


def network(family, n_robots, shares, seed, kind="trace"):
    scenario = network_scenario(family, n_robots, 8, alpha_s=shares[0], alpha_c=shares[1], seed=seed)
    problem = scenario.problem(kind)
    return problem, ratt(problem).elements


@pytest.fixture(scope="module")
def large():
    """A disk graph of 21 robots, a third blinded and 30 % of the links cut: no attack tree closes."""
    problem, plan = network("disk-6", 21, (1 / 3, 0.3), 1)
    found = worst_case_attack(problem, plan)
    return problem, plan, found, proof(problem, plan, found.lower * (1 - 1e-9))


def test_beyond_attack_trees(large):
    problem, plan, found, part = large
    assert part["kind"] == "group_prices"
    leaves = checker(problem, plan).check(part, exact(found.lower * (1 - 2e-9)))
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
    with pytest.raises(ProofError, match=text):
        checker(problem, plan).check(broken, exact(found.lower * (1 - 2e-9)))


def agreement(family, n_robots, shares, seed, kind):
    """Both exact methods, where both close: no proof above the attack found, and one at what the search proved."""
    problem, plan = network(family, n_robots, shares, seed, kind)
    found = worst_case_attack(problem, plan, time_limit=60)
    part = proof(problem, plan, found.lower * (1 - 1e-9))
    if part is not None:
        checker(problem, plan).check(part, exact(found.lower * (1 - 2e-9)))
    assert proof(problem, plan, found.upper * (1 + 1e-6)) is None
    return part is not None


def test_agrees_with_the_search():
    assert sum(agreement("disk-6", 20, (1 / 3, 0.3), seed, kind) for seed, kind in enumerate(KINDS)) >= 1


@pytest.mark.slow
@pytest.mark.parametrize("family", ["disk-6", "disk-12", "small-world", "hubs"])
@pytest.mark.parametrize("n_robots", [20, 24, 30])
def test_agrees_with_the_search_on_every_family(family, n_robots):
    """Of some families prices prove none of these."""
    proved = sum(agreement(family, n_robots, (1 / 3, 0.3), seed, KINDS[seed]) for seed in range(3))
    assert proved >= (family == "disk-6")
