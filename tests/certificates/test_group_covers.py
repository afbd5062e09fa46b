"""Lower ends proved by covers of groups: what prices miss, covers by definition, and faults by name."""

from __future__ import annotations

import copy
from types import SimpleNamespace

import networkx as nx
import numpy as np
import pytest

from ratt_opt import (
    Problem,
    TraceObjective,
    exhaustive_optimum,
    worst_case_attack,
)
from ratt_opt.certificates.verifier.lower_end.group_costs import Group
from ratt_opt.certificates.verifier.lower_end.partitions import Partitions
from tests.certificates.cases import certified
from tests.certificates.engine import (
    ENUMERATED,
    accepted_leaves,
    drawn,
    network,
    proof,
    refuse,
    small_proofs,
    step,
    weaker_lower_proof,
)
from tests.strategies import information_data


def check_beyond_prices(seeds, least):
    """So many worst cases are proved by covers and not by prices alone."""
    proofs = [(one, worst) for *one, worst, part in small_proofs("group_covers", seeds) if part is not None]
    assert sum(proof("group_prices", *one, worst * (1 - 1e-7)) is None for one, worst in proofs) >= least


def test_what_prices_alone_do_not_prove():
    check_beyond_prices(range(24), 1)


@pytest.mark.slow
def test_more_that_prices_alone_do_not_prove():
    check_beyond_prices(range(100, 400), 5)


def test_a_weaker_lower_end_is_proved_where_the_first_is_not():
    """A threshold above the worst case by 2 %: what is lower by 1 % is too much still, by 3 % no more."""
    problem, plan, worst = drawn(0)
    lower, part = weaker_lower_proof(problem, np.array(plan), worst * 1.02)
    assert lower == pytest.approx(worst * 1.02 * 0.97)
    assert accepted_leaves(problem, plan, part, lower * (1 - 1e-9)) > 0


def test_a_certificate_says_how_much_less_it_proves(tmp_path, monkeypatch):
    step(monkeypatch, "lower end", lambda _: lambda *_: ENUMERATED)
    problem = drawn(0)[0]
    best = exhaustive_optimum(problem).lower
    written, document = certified(problem, tmp_path / "c.json")
    assert document["lower"]["kind"] == "all_groups"
    assert written.verified.lower_proved
    assert written.verified.lower == pytest.approx(best * 0.99)
    assert written.lower_shaved == pytest.approx(best * 0.01)


@pytest.fixture(scope="module")
def large():
    """A small world of 18 robots."""
    problem, plan = network("small-world", 18, (0.2, 0.15), 1)
    found = worst_case_attack(problem, plan)
    return problem, plan, found, proof("group_covers", problem, plan, found.lower * (1 - 1e-9))


def test_where_attack_trees_do_not_close(large):
    problem, plan, found, part = large
    leaves = accepted_leaves(problem, plan, part, found.lower * (1 - 2e-9))
    assert leaves > 100
    assert proof("group_covers", problem, plan, found.upper * (1 + 1e-6)) is None


def _first(part, kind):
    return next(k for k, node in enumerate(part["tree"]) if kind(node))


FAULTS = {
    "cost too little": lambda p: p["robots"].__setitem__(slice(None), [x + 2**23 for x in p["robots"]]),
    "a flow exceeds": lambda p: p["flows"][0].__setitem__(3, 2**22 + 1),
    "is not complete": lambda p: p.update(tree=[-1]),
    "may be part of an attack": lambda p: p["tree"].__setitem__(_first(p, lambda node: node < -2), -2),
    "decided twice": lambda p: p.update(tree=[0, 0]),
    "worth less": lambda p: p["sets"][0].update(tree=[-1]),
    "a case has no leaf": lambda p: p["tree"].pop(),
    "a node is repeated": lambda p: p["tree"].append(-1),
    "a leaf is not impossible": lambda p: p["sets"][0].update(tree=[-2]),
}


@pytest.mark.parametrize("text", FAULTS)
def test_every_fault_has_its_name(large, text):
    problem, plan, found, part = large
    broken = copy.deepcopy(part)
    FAULTS[text](broken)
    refuse(problem, plan, broken, found.lower * (1 - 2e-9), text)


def test_groups_that_cover_the_team_are_a_fault():
    """Two robots that see too little apart: a proof that lists both and claims what they see together."""
    prior, information = information_data(np.random.default_rng(6), 2, 1)
    problem = Problem(TraceObjective(prior, information), [0, 1], nx.path_graph(2), 0, 1)
    prices = {"half_link": 1, "robots": [0, 0], "blinded": 0, "group": 0, "triples": [], "flows": []}
    both = [{"robots": [0, 1], "room": 1, "tree": [0, 1, -1, -2, -2]}]
    part = {"kind": "group_covers", **prices, "sets": both, "tree": [0, 1, -1, -1, 1, -1, -1]}
    refuse(problem, [0, 1], part, problem.objective([0, 1]) * (1 - 1e-9), "groups within the budgets cover the team")


def by_definition(groups, n, budgets, last):
    """Whether disjoint groups, and all other robots as one more or none, are within the budgets."""

    def fits(chosen):
        left = (1 << n) - 1 - sum(group.robots for group in chosen)
        rest = last(left) if left else None
        parts = [*chosen, rest] if rest else chosen
        sums = [sum(getattr(g, name) for g in parts) for name in ("cost", "need", "links")]
        return (not left or rest is not None) and all(s <= b for s, b in zip(sums, budgets, strict=True))

    chosen = [[]]
    for group in groups:
        chosen += [[*some, group] for some in chosen if not any(group.robots & other.robots for other in some)]
    return any(map(fits, chosen))


def test_covers_by_definition():
    found = 0
    for seed in range(150):
        rng = np.random.default_rng([55, seed])
        n = 5
        costs = rng.integers(0, 4, (1 << n, 3))
        every = [Group(mask, *map(int, costs[mask])) for mask in range(1, 1 << n)]
        budgets = (int(rng.integers(0, 7)), int(rng.integers(0, 5)), 2 * int(rng.integers(0, 4)))
        groups = [every[k] for k in rng.permutation(len(every))[:10]]
        allowed = {mask for mask in range(1, 1 << n) if rng.random() < 0.3}

        def last(mask, every=every, allowed=allowed):
            return every[mask - 1] if mask in allowed else None

        about = SimpleNamespace(slack=budgets[0], most=budgets[1], about=SimpleNamespace(alpha_c=budgets[2] // 2))
        about.robot, about.everyone, about.group_of, about.sets, about.flows = [0] * n, (1 << n) - 1, last, [], []
        about.need = about.impossible = lambda *_: 0
        cover = Partitions(groups, about).first()
        assert (cover is not None) == by_definition(groups, n, budgets, last)
        found += cover is not None
    assert 30 <= found <= 120
