"""Dual prices claim what they say."""

from __future__ import annotations

import networkx as nx
import numpy as np
import pytest

from ratt_opt.attack.dual_prices.program import GroupPrices, KnownGroup
from tests.strategies import team_problem


@pytest.mark.parametrize("seed", range(6))
def test_every_choice_of_prices_claims_what_it_says_and_no_known_group_pays_it(seed):
    problem, _ = team_problem(2 * seed, 6, graph=nx.complete_graph(6))
    rng, threat = np.random.default_rng(seed), problem.threat
    prices = GroupPrices(threat)
    groups = [
        KnownGroup(robots=np.array([bool(mask >> i & 1) for i in range(6)]), need=int(rng.integers(0, 3)), value=0.0)
        for mask in {*rng.integers(1, 63, 20).tolist(), 1, 2, 4, 8, 16, 32}
    ]
    prices.add(groups)
    found = prices.solve(1.0)
    links = 0.6 * found.links
    scaled, for_robots = found.scaled(links), found.for_robots(links, threat.n_blinded)
    dearest = prices.dearest(1.0, links)
    for chosen in (scaled, prices.slackest(1.0, links), for_robots, dearest):
        assert chosen is not None
        assert chosen.links == pytest.approx(links)
        assert chosen.links == pytest.approx(chosen.robot.sum() - chosen.blinded * threat.n_blinded)
        paid = [chosen.robot[group.robots].sum() - chosen.blinded * group.need for group in groups]
        assert all(p <= prices.half_cut(group.robots) + 1e-6 for p, group in zip(paid, groups, strict=True))
    assert dearest.blinded >= found.blinded
    assert prices.solve(1.0).links == pytest.approx(found.links)
    assert prices.dearest(1.0, found.links + 1.0) is None


@pytest.mark.parametrize("seed", range(12))
def test_prices_for_dear_blinded_robots_hold_while_groups_are_added(seed):
    """The price of a blinded robot stays while enough can be claimed at it, and is chosen again where it cannot."""
    problem, _ = team_problem(2 * seed, 6, graph=nx.complete_graph(6))
    rng, threat = np.random.default_rng(seed), problem.threat
    prices = GroupPrices(threat)
    groups = [KnownGroup(robots=np.arange(6) == i, need=0, value=0.0) for i in range(6)]
    prices.add(groups)
    links, chosen = 0.25 * prices.solve(1.0).links, list[float]()
    for mask in rng.permutation(np.arange(1, 64)).tolist():
        dear = prices.dearest(1.0, links)
        assert (dear is not None) == (prices.solve(1.0).links >= links)
        if dear is not None:
            assert dear.links == pytest.approx(links)
            paid = [dear.robot[group.robots].sum() - dear.blinded * group.need for group in groups]
            assert all(p <= prices.half_cut(group.robots) + 1e-6 for p, group in zip(paid, groups, strict=True))
            chosen.append(dear.blinded)
        robots = np.array([bool(mask >> i & 1) for i in range(6)])
        groups.append(KnownGroup(robots=robots, need=int(rng.integers(0, 3)), value=0.0))
        prices.add(groups[-1:])
    assert len(set(chosen)) < len(chosen)
