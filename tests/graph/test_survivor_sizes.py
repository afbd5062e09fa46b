from itertools import islice
from math import comb

import pytest

from ratt_opt import count_outcomes
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.survivor_sizes import (
    forced_group_size,
    iterate_non_dominated_sizes,
    non_dominated_sizes,
    sizes_of_largest,
)
from ratt_opt.graph.threat import Threat


def partitions(total, largest):
    if total == 0:
        yield ()
        return
    for part in range(min(total, largest), 0, -1):
        for rest in partitions(total - part, part):
            yield (part, *rest)


def feasible_by_definition(n_robots, n_blinded, alpha_c):
    """Vectors left by some partition of all robots whose groups lose blinded robots in some way."""

    def losses(group, left):
        if not group:
            if left == 0:
                yield ()
            return
        for lost in range(min(group[0], left) + 1):
            for rest in losses(group[1:], left - lost):
                yield (group[0] - lost, *rest)

    found = set()
    for groups in partitions(n_robots, n_robots):
        if comb(n_robots, 2) - sum(comb(g, 2) for g in groups) <= alpha_c:
            for sizes in losses(groups, n_blinded):
                found.add(tuple(sorted((s for s in sizes if s), reverse=True)))
    return found


def splits(sizes):
    """Vectors in which one group is divided in two."""
    return {
        tuple(sorted((*sizes[:k], *sizes[k + 1 :], size - part, part), reverse=True))
        for k, size in enumerate(sizes)
        for part in range(1, size)
    }


@pytest.mark.parametrize("n_robots", range(1, 10))
def test_sizes_and_forced_group_against_the_definition(n_robots):
    for n_blinded in range(n_robots + 1):
        for alpha_c in range(comb(n_robots, 2) + 1):
            expected = feasible_by_definition(n_robots, n_blinded, alpha_c)
            minimal = {sizes for sizes in expected if not expected & splits(sizes)}
            found = non_dominated_sizes(n_robots, n_blinded, alpha_c)
            assert found == sorted(minimal, reverse=True)
            forced = min(max(v, default=0) for v in expected)
            assert forced_group_size(n_robots, n_blinded, alpha_c) == forced


@pytest.mark.parametrize(
    ("budget", "vectors"),
    [
        ((20, 6, 47), {(12, 1, 1)}),
        ((20, 10, 63), {(7, 1, 1, 1)}),
        ((20, 13, 95), {(2, 1, 1, 1, 1, 1)}),
        ((30, 10, 108), {(16, 2, 2), (16, 3, 1), (17, 1, 1, 1)}),
        ((30, 15, 145), {(9, 6), (10, 1, 1, 1, 1, 1)}),
        ((30, 20, 217), {(2, 1, 1, 1, 1, 1, 1, 1, 1)}),
    ],
)
def test_vectors_of_the_paper_s_larger_settings(budget, vectors):
    assert set(non_dominated_sizes(*budget)) == vectors


@pytest.mark.parametrize("budget", [(1000, 143, 474525), (1000, 0, 300000), (100, 0, 4000)])
def test_vectors_of_huge_teams_come_without_going_through_partitions(budget):
    for sizes in islice(iterate_non_dominated_sizes(*budget), 200):
        assert sum(sizes) == budget[0] - budget[1]
        assert sizes[0] >= forced_group_size(*budget)


@pytest.mark.parametrize("n_robots", range(2, 11))
def test_vectors_of_one_largest_size_are_those_of_all(n_robots):
    for blinded in range(n_robots - 1):
        for cut in range(n_robots * (n_robots - 1) // 2 + 1):
            every = non_dominated_sizes(n_robots, blinded, cut)
            for first in (1, 2, 3):
                own = list(sizes_of_largest(n_robots, blinded, cut, first)) if first <= n_robots - blinded else []
                assert own == [sizes for sizes in every if sizes[0] == first]


@pytest.mark.parametrize("n_robots", [3, 5, 7])
def test_counting_ends_once_there_are_enough(n_robots):
    for blinded in range(n_robots):
        for cut in range(n_robots * (n_robots - 1) // 2 + 1):
            threat = Threat(CommunicationGraph.complete(n_robots), blinded, cut)
            count = count_outcomes(threat)
            for enough in (0, 3, count - 1, count, count + 1):
                assert (count_outcomes(threat, enough=enough) > enough) == (count > enough)
            assert count_outcomes(threat, enough=count) == count
