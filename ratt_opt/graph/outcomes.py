"""Non-dominated outcomes of attacks: the families of robots that can still pool measurements.

An outcome is the family of groups of non-blinded robots that an attack leaves. One outcome dominates another when it
refines it (every group of the first lies in a group of the second): a non-decreasing objective is then no larger on the
first. An attack that uses its whole budget of blinded robots dominates one that blinds fewer.
"""

from __future__ import annotations

from itertools import combinations
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.errors import InputError
from ratt_opt.graph.connected_partitions import finest_partitions
from ratt_opt.graph.survivor_sizes import iterate_non_dominated_sizes, labelled_count

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from ratt_opt._validation import IntArray
    from ratt_opt.graph.communication import Link
    from ratt_opt.graph.survivor_sizes import Sizes
    from ratt_opt.graph.threat import Threat

__all__ = ["Outcome", "count_outcomes", "non_dominated_outcomes", "realise"]

Outcome = tuple[frozenset[int], ...]
"""Disjoint, non-empty groups by lowest robot; ``(frozenset(),)`` when every robot is blinded."""

LARGEST_ENUMERATION = 12
"""Most robots whose outcomes are enumerated on a graph that is not complete, or has protected links."""


def non_dominated_outcomes(threat: Threat) -> Iterator[Outcome]:
    """Yield every outcome within the budgets that no other one refines, each once, in a fixed order.

    On a complete graph without protected links any number of robots is accepted and
    ``count_outcomes`` says beforehand how many will come.

    Raises
    ------
    InputError : another graph that can be attacked, with more than ``LARGEST_ENUMERATION`` robots.
    """
    n_robots = threat.graph.n_robots
    if threat.n_blinded == n_robots:
        return iter([(frozenset(),)])
    if threat.links_alike:
        return _by_sizes(threat)
    if threat.n_blinded == 0 and threat.alpha_c == 0:
        return iter([threat.graph.groups()])
    if n_robots > LARGEST_ENUMERATION:
        rule = (
            f"must have at most {LARGEST_ENUMERATION} robots to enumerate outcomes unless it is complete "
            "without protected links (use worst_case_attack)"
        )
        raise InputError("graph", rule, f"{n_robots} robots")
    return _by_partitions(threat)


def count_outcomes(threat: Threat, *, enough: float = inf) -> int:
    """Return how many outcomes ``non_dominated_outcomes`` yields on a complete graph, without enumerating them.

    ``enough`` : stop counting above this number; for hundreds of robots even the sizes are too many to list

    Raises
    ------
    InputError : the graph is not complete or has protected links; no formula is known then.
    """
    if not threat.links_alike:
        rule = "must be complete without protected links to count outcomes (enumerate them with non_dominated_outcomes)"
        raise InputError("graph", rule, f"{len(threat.graph.links)} links")
    n_robots, n_free = threat.graph.n_robots, threat.graph.n_robots - len(threat.protected_robots)
    count = 0
    for sizes in iterate_non_dominated_sizes(n_robots, threat.n_blinded, threat.alpha_c):
        count += labelled_count(n_robots, n_free, threat.n_blinded, sizes)
        if count > enough:
            break
    return count


def _survivor_sets(threat: Threat) -> Iterator[tuple[int, ...]]:
    robots = range(threat.graph.n_robots)
    free = [i for i in robots if i not in threat.protected_robots]
    for blinded in combinations(free, threat.n_blinded):
        yield tuple(i for i in robots if i not in blinded)


def _by_sizes(threat: Threat) -> Iterator[Outcome]:
    for survivors in _survivor_sets(threat):
        for sizes in iterate_non_dominated_sizes(threat.graph.n_robots, threat.n_blinded, threat.alpha_c):
            yield from _labelled(survivors, sizes)


def _labelled(robots: tuple[int, ...], sizes: Sizes) -> Iterator[Outcome]:
    """Partitions of ``robots`` into groups of these sizes: the lowest robot's group first."""
    if not robots:
        yield ()
        return
    for size in sorted(set(sizes)):
        k = sizes.index(size)
        for others in combinations(robots[1:], size - 1):
            group = frozenset((robots[0], *others))
            rest = tuple(i for i in robots if i not in group)
            for groups in _labelled(rest, sizes[:k] + sizes[k + 1 :]):
                yield (group, *groups)


def _by_partitions(threat: Threat) -> Iterator[Outcome]:
    """Restrict the finest partitions to each set of survivors and keep the minimal restrictions.

    Every feasible outcome is refined by a restriction of a finest partition to its survivors.
    """
    partitions = finest_partitions(threat)
    n_robots = threat.graph.n_robots
    home = np.zeros((len(partitions), n_robots), dtype=np.int64)
    for row, partition in enumerate(partitions):
        for k, group in enumerate(partition):
            home[row] += k * (group >> np.arange(n_robots) & 1)
    for survivors in _survivor_sets(threat):
        labels = home[:, survivors]
        for row in range(len(labels)) if threat.n_blinded == 0 else _minimal(labels):
            yield _outcome(survivors, labels[row].tolist())


def _minimal(labels: IntArray) -> list[int]:
    """Rows of ``labels`` (K, S), S <= 11, that no other row refines, one per distinct partition.

    A partition is the set of pairs it keeps together; with at most 55 pairs that is one integer,
    and refinement is inclusion.
    """
    together = np.zeros(len(labels), dtype=np.int64)
    for bit, (a, b) in enumerate(combinations(range(labels.shape[1]), 2)):
        together |= (labels[:, a] == labels[:, b]).astype(np.int64) << bit
    keys, rows = np.unique(together, return_index=True)
    order = np.argsort(np.bitwise_count(keys), kind="stable")
    keys, rows = keys[order], rows[order]
    minimal = []
    while len(keys):
        minimal.append(int(rows[0]))
        rest = (keys & keys[0]) != keys[0]
        keys, rows = keys[rest], rows[rest]
    return minimal


def _outcome(survivors: tuple[int, ...], labels: list[int]) -> Outcome:
    groups: dict[int, list[int]] = {}
    for robot, label in zip(survivors, labels, strict=True):
        groups.setdefault(label, []).append(robot)
    return tuple(frozenset(group) for group in groups.values())


def realise(threat: Threat, outcome: Outcome) -> tuple[frozenset[int], frozenset[Link]]:
    """Return blinded robots and cut links, within the budgets, that leave a non-dominated ``outcome``.

    The blinded robots relay: each joins the group where the fewest links have to be cut.
    """
    survivors: frozenset[int] = frozenset().union(*outcome)
    blinded = frozenset(range(threat.graph.n_robots)) - survivors
    home = {i: k for k, group in enumerate(outcome) for i in group}
    if threat.links_alike or len(outcome) == 1:
        largest = max(range(len(outcome)), key=lambda k: len(outcome[k]))
        home.update(dict.fromkeys(blinded, largest))
    else:
        home = _place(threat, home, sorted(blinded), len(outcome))
    cut = threat.graph.links_between([i for i in home if home[i] == k] for k in range(len(outcome)))
    assert len(cut) <= threat.alpha_c, "an outcome of this threat has an attack within its budget"
    return blinded, cut


def _place(threat: Threat, home: dict[int, int], blinded: Iterable[int], n_groups: int) -> dict[int, int]:
    """Depth-first search for homes of the blinded robots that keep the cut within the budget."""
    neighbours: dict[int, list[tuple[int, int]]] = {i: [] for i in range(threat.graph.n_robots)}
    for link in threat.graph.links:
        cost = threat.alpha_c + 1 if link in threat.protected_links else 1
        neighbours[link[0]].append((link[1], cost))
        neighbours[link[1]].append((link[0], cost))

    def cost_of(robot: int, group: int) -> int:
        return sum(cost for other, cost in neighbours[robot] if home.get(other, group) != group)

    def search(robots: tuple[int, ...], budget: int) -> bool:
        if not robots:
            return True
        for cost, group in sorted((cost_of(robots[0], k), k) for k in range(n_groups)):
            if cost > budget:
                return False
            home[robots[0]] = group
            if search(robots[1:], budget - cost):
                return True
            del home[robots[0]]
        return False

    between = sum(1 for i, j in threat.graph.links if i in home and j in home and home[i] != home[j])
    found = search(tuple(blinded), threat.alpha_c - between)
    assert found, "an outcome of this threat has an attack"
    return home
