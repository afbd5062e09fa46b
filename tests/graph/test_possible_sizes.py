"""Which sizes of groups an attack can leave, against every group and every partition of small graphs."""

from itertools import combinations

import networkx as nx
import numpy as np
import pytest

from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.link_scores import SHARES, LinkScores, link_scores, scoring_group
from ratt_opt.graph.possible_sizes import PossibleSizes


def _graph(n_robots: int, density: float, seed: int) -> CommunicationGraph:
    return CommunicationGraph.from_networkx(nx.gnp_random_graph(n_robots, density, seed=seed), n_robots)


def _score(graph: CommunicationGraph, group: frozenset[int], share: float) -> float:
    inside = sum(i in group and j in group for i, j in graph.links)
    ends = sum((i in group) + (j in group) for i, j in graph.links)
    return 2.0 * inside - (1.0 - share) * ends


def _partitions(robots: tuple[int, ...]) -> list[list[frozenset[int]]]:
    """Every partition, once."""
    if not robots:
        return [[]]
    first, rest = robots[0], robots[1:]
    found = []
    for size in range(len(rest) + 1):
        for others in combinations(rest, size):
            left = tuple(i for i in rest if i not in others)
            found.extend([frozenset((first, *others)), *partition] for partition in _partitions(left))
    return found


def _is_merger(sizes: tuple[int, ...], finer: tuple[int, ...]) -> bool:
    """Whether parts of ``finer`` can be put together to ``sizes``."""
    if not finer:
        return not any(sizes)
    tried = {size for size in sizes if size >= finer[0]}
    places = [sizes.index(size) for size in tried]
    return any(_is_merger((*sizes[:k], sizes[k] - finer[0], *sizes[k + 1 :]), finer[1:]) for k in places)


@pytest.mark.parametrize("density", [0.2, 0.5, 0.8])
@pytest.mark.parametrize("seed", range(4))
def test_no_group_scores_more_than_its_bound(density: float, seed: int) -> None:
    graph = _graph(8, density, seed)
    most = link_scores(graph, len(graph.links), Budget()).most
    for size in range(9):
        for k, share in enumerate(SHARES):
            scores = [_score(graph, frozenset(group), share) for group in combinations(range(8), size)]
            assert max(scores) <= most[k, size]


@pytest.mark.parametrize("seed", range(3))
def test_bounds_are_close_on_dense_graphs(seed: int) -> None:
    graph = _graph(12, 0.7, seed)
    most = link_scores(graph, 3, Budget()).most
    for size in (8, 10, 11, 12):
        scores = [_score(graph, frozenset(group), 1.0) for group in combinations(range(12), size)]
        assert most[0, size] <= max(scores) + 3.0


def test_bounds_without_time_hold() -> None:
    graph = _graph(9, 0.6, 1)
    quick, thorough = link_scores(graph, 3, Budget(time_limit=0)), link_scores(graph, 3, Budget())
    assert (quick.most >= thorough.most).all()
    assert (quick.most > thorough.most).any()


@pytest.mark.parametrize("seed", range(6))
def test_whether_a_set_can_score_is_decided_exactly(seed: int) -> None:
    rng = np.random.default_rng(seed)
    graph = _graph(9, 0.6, seed)
    link_scores(graph, 3, Budget())
    for joining in (0, 1, 3):
        members = rng.permutation(9) < 3
        inside, others = set(np.flatnonzero(members).tolist()), np.flatnonzero(~members).tolist()
        groups = [frozenset(inside.union(more)) for more in combinations(others, joining)]
        for k, share in enumerate(SHARES):
            needed = np.full(len(SHARES), -np.inf)
            needed[k] = max(_score(graph, group, share) for group in groups)
            found = scoring_group(graph, members, joining, needed, Budget())
            assert found is not None
            assert (_score(graph, frozenset(np.flatnonzero(found).tolist()), share), found.sum()) == (
                needed[k],
                3 + joining,
            )
            needed[k] += 0.5
            assert scoring_group(graph, members, joining, needed, Budget()) is None


def test_a_set_is_not_ruled_out_by_a_spent_budget() -> None:
    graph = _graph(9, 0.6, 0)
    with pytest.raises(OutOfBudget):
        scoring_group(graph, np.arange(9) < 3, 2, np.zeros(len(SHARES)), Budget(max_nodes=0))


@pytest.mark.parametrize("n_blinded", [0, 1, 2])
@pytest.mark.parametrize(("density", "seed"), [(0.4, 0), (0.6, 1), (0.8, 2), (1.0, 3)])
def test_every_attack_leaves_a_merger_of_possible_sizes(n_blinded: int, density: float, seed: int) -> None:
    graph = _graph(7, density, seed)
    for alpha_c in (0, len(graph.links) // 3, 2 * len(graph.links) // 3):
        possible = PossibleSizes(link_scores(graph, alpha_c, Budget()), n_blinded)
        vectors = possible.vectors(Budget(), 1000)
        assert vectors is not None
        left = set()
        for groups in _partitions(tuple(range(7))):
            if len(graph.links_between(groups)) <= alpha_c:
                for blinded in combinations(range(7), n_blinded):
                    sizes = sorted((len(group - set(blinded)) for group in groups), reverse=True)
                    left.add(tuple(size for size in sizes if size))
        assert possible.forced <= min(sizes[0] for sizes in left)
        for sizes in left:
            assert any(_is_merger(sizes, finer) for finer in vectors)
        for finer in vectors:
            assert not any(_is_merger(other, finer) for other in vectors if other != finer)


def test_on_a_complete_graph_sizes_are_those_of_partitions() -> None:
    from ratt_opt.graph.survivor_sizes import non_dominated_sizes

    for n_blinded, alpha_c in ((0, 9), (2, 14), (3, 20)):
        graph = CommunicationGraph.complete(10)
        possible = PossibleSizes(link_scores(graph, alpha_c, Budget()), n_blinded)
        vectors = possible.vectors(Budget(), 1000)
        assert vectors == sorted(non_dominated_sizes(10, n_blinded, alpha_c))
        assert possible.forced == vectors[0][0]


def test_what_is_known_of_the_largest_group_counts() -> None:
    graph = _graph(10, 0.5, 0)
    scores = link_scores(graph, len(graph.links) // 2, Budget())
    free = PossibleSizes(scores, 2)
    least = free.forced + 2
    bound = PossibleSizes(scores, 2, least)
    assert bound.forced == least
    vectors = bound.vectors(Budget(), 1000)
    assert vectors is not None
    assert min(sizes[0] for sizes in vectors) >= least


def test_too_many_vectors_are_none() -> None:
    scores = LinkScores(np.zeros((1, 13)), np.zeros(1), np.zeros(1))
    assert PossibleSizes(scores, 0).vectors(Budget(), 5) == [(1,) * 12]
    tight = LinkScores(np.array([[s * (s - 1.0) for s in range(31)]]), np.array([200.0]), np.zeros(1))
    assert PossibleSizes(tight, 0).vectors(Budget(), 2) is None
