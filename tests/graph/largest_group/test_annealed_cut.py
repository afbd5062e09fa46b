"""Annealed cuts are attacks, and leave groups no larger than cheapest cuts do."""

from __future__ import annotations

import networkx as nx
import numpy as np
import pytest

from ratt_opt.budget import Budget
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.largest_group.annealed_cut import annealed_cut
from ratt_opt.graph.largest_group.heuristic_cut import heuristic_cut
from ratt_opt.graph.threat import Threat


def separated(graph, cut, blinded):
    """Seeing robots of the largest group that a cut leaves."""
    left = nx.Graph(graph)
    left.remove_edges_from(cut)
    return max(len(group - blinded) for group in nx.connected_components(left))


@pytest.mark.parametrize("seed", range(6))
def test_annealed_groups_are_achieved_and_never_larger_than_by_cheapest_cuts(seed):
    """The cut itself is looked at: within the links, no protected one, groups of that many seeing robots."""
    graph = nx.random_geometric_graph(24, 0.32, seed=seed)
    links = sorted((min(e), max(e)) for e in graph.edges)
    protected = frozenset(links[:: 7 + seed])
    blinded = frozenset(np.random.default_rng(seed).permutation(24)[:5].tolist())
    cuts_only = Threat(CommunicationGraph(24, frozenset(links)), 0, len(links) // 6, protected_links=protected)
    quick = heuristic_cut(cuts_only, ignoring=blinded)
    cut = annealed_cut(cuts_only, quick, 1, Budget(), ignoring=blinded)
    assert len(cut) <= cuts_only.alpha_c
    assert not cut & protected
    assert separated(graph, cut, blinded) <= separated(graph, quick, blinded)
