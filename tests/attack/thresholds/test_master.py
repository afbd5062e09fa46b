"""Dual prices claim what they say."""

import networkx as nx
import numpy as np
import pytest

from ratt_opt.attack.params.groups import MasterParams
from ratt_opt.attack.thresholds.dual_prices import GroupPrices, KnownGroup
from tests.strategies import team_problem


@pytest.mark.parametrize("seed", range(12))
def test_prices_claim_what_they_say_and_no_known_group_costs_less_than_nothing(seed):
    """Also when groups of much slack are forgotten; and the best prices of all groups are found again."""
    params = MasterParams(most_rows=[6_000, 20][seed % 2])
    problem, _ = team_problem(2 * seed, 6, graph=nx.complete_graph(6))
    rng, threat = np.random.default_rng(seed), problem.threat
    prices, groups = GroupPrices(threat, params), list[KnownGroup]()
    for mask in [1, 2, 4, 8, 16, 32, *rng.permutation(np.arange(1, 64)).tolist()]:
        robots = np.array([bool(mask >> i & 1) for i in range(6)])
        groups.append(KnownGroup(robots=robots, need=int(rng.integers(0, 3)), value=float(rng.integers(0, 2))))
        prices.add(groups[-1:])
        found = prices.solve(0.5)
        choices = [found, found.scaled(0.6 * found.links)] if found.links > 0 else [found]
        for chosen, share in zip(choices, (1.0, 0.6), strict=False):
            assert chosen.links == pytest.approx(share * found.links)
            assert chosen.links == pytest.approx(chosen.robot.sum() - chosen.blinded * threat.n_blinded)
            for group in groups if seed % 2 == 0 else ():
                paid = chosen.robot[group.robots].sum() - chosen.blinded * group.need
                assert group.value > 0.5 or paid <= prices.half_cuts(group.robots[None])[0] + 1e-6
    again = GroupPrices(threat, params)
    again.add(groups)
    if seed % 2 == 0:
        assert prices.solve(0.5).links == pytest.approx(again.solve(0.5).links)
        assert again.solve(1.5).links <= again.solve(0.5).links + 1e-9
