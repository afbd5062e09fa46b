"""Few cuts of large sparse networks are tried one by one."""

from itertools import combinations

import numpy as np

import ratt_opt as ro
from ratt_opt.attack.edge_cuts.smallest import PARAMS
from ratt_opt.graph.threat import Threat
from tests.attack.stages.test_few_attacks import sparse_network


def test_two_cuts_and_a_limit():
    rng = np.random.default_rng(371)
    graph = sparse_network(rng, 60, 3)
    threat = Threat(ro.Problem(ro.Modular(np.ones(60)), np.arange(60), graph, 0, 2).communication, 0, 2)
    assert threat.n_attacks <= PARAMS.one_by_one
    truth = min(
        max(len(group) for group in threat.graph.groups(cut)) for cut in combinations(sorted(threat.graph.links), 2)
    )
    found = ro.smallest_largest_group(graph, 2)
    assert (found.lower, found.upper) == (truth, truth)
    soon = ro.smallest_largest_group(graph, 2, max_nodes=5)
    assert soon.lower <= truth <= soon.upper
    assert ro.smallest_largest_group(graph, 2, time_limit=0).upper >= truth
