"""Annealed cuts are attacks, and leave groups no larger than cheapest cuts do; moves are those of the definition."""

import networkx as nx
import numpy as np
import pytest

from ratt_opt import InputError
from ratt_opt.budget import Budget
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.largest_group.annealed_cut import DEFAULT as PARAMS
from ratt_opt.graph.largest_group.annealed_cut import Cooling, PricedArcs, annealed_cut
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


def links_cut(links, prices, group):
    return sum(price for (i, j), price in zip(links, prices, strict=True) if group[i] != group[j])


def plainly_cooled(n_robots, links, prices, counts, group, labels, size, rng, moves, oversize):  # noqa: PLR0917
    """Labels after all moves, fewest links cut (of 10 to begin with) and the labels then."""

    def too_many():
        sizes = [sum(c for c, label in zip(counts, group, strict=True) if label == g) for g in range(labels)]
        return sum(max(one - size, 0) for one in sizes)

    near = [sorted(sum(link) - i for link in links if i in link) for i in range(n_robots)]
    fewest, best = 10, list(group)
    for move in range(moves):
        i = int(rng.random() * n_robots)
        if near[i] and rng.random() < 0.95:
            to = group[near[i][int(rng.random() * len(near[i]))]]
        else:
            to = int(rng.random() * labels)
        if to == group[i]:
            continue
        before, home = links_cut(links, prices, group) + oversize * too_many(), group[i]
        group[i] = to
        worse = links_cut(links, prices, group) + oversize * too_many() - before
        heat = PARAMS.hot * (PARAMS.cold / PARAMS.hot) ** (move / moves)
        if worse > 0 and rng.random() >= np.exp(-worse / heat):
            group[i] = home
        elif too_many() == 0 and links_cut(links, prices, group) < fewest:
            fewest, best = links_cut(links, prices, group), list(group)
    return group, fewest, best


@pytest.mark.parametrize("seed", range(12))
def test_a_cooling_makes_the_moves_of_the_definition(seed):
    """In one part and in several."""
    rng = np.random.default_rng(seed)
    n_robots, labels, size = [1, 2, 5, 8][seed % 4], int(rng.integers(1, 4)), int(rng.integers(1, 4))
    links = [(i, j) for j in range(n_robots) for i in range(j) if rng.random() < 0.5]
    protected = frozenset(links[::4])
    threat = Threat(CommunicationGraph(n_robots, frozenset(links)), 0, 0, protected_links=protected)
    prices = [len(links) + 1 if link in protected else 1 for link in links]
    counts, group = rng.integers(0, 2, n_robots), rng.integers(0, labels, n_robots)
    oversize = max(PARAMS.oversize, 1.5 * 2 * len(links) / n_robots)
    expected = plainly_cooled(
        n_robots, links, prices, counts, group.tolist(), labels, size, np.random.default_rng(seed), 200, oversize
    )
    cooling = Cooling(PricedArcs.of(threat), counts, group, labels, size, np.random.default_rng(seed))
    fewest = 10
    for first, last in ([(0, 200)], [(0, 1), (1, 50), (50, 50), (50, 200)])[seed % 2]:
        fewest = cooling.run(first, last, 200, fewest)
    assert (group.tolist(), fewest, cooling.best.tolist()) == expected


def test_what_c_may_not_read_is_refused():
    threat = Threat(CommunicationGraph(3, frozenset({(0, 1), (1, 2)})), 0, 1)
    network, counts, group = PricedArcs.of(threat), np.ones(3, dtype=np.int64), np.zeros(3, dtype=np.int64)
    rng, locked = np.random.default_rng(0), np.zeros(3, dtype=np.int64)
    locked.setflags(write=False)
    Cooling(network, counts, group, 2, 1, rng)
    for bad in (counts.astype(np.int32), counts[:2].copy(), np.ones(6, dtype=np.int64)[::2]):
        with pytest.raises(InputError):
            Cooling(network, bad, group, 2, 1, rng)
    for bad in (group.astype(np.int32), np.zeros(4, dtype=np.int64), group + 2, group - 1, locked):
        with pytest.raises(InputError):
            Cooling(network, counts, bad, 2, 1, rng)
