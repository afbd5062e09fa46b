"""The least weight of links for groups of a size, by eliminating one robot after the other: exact on sparse networks.

A tree decomposition says in which order. Robots of a bag still have links to come. Only three things of a partial cut
matter to these: its weight, which robots of the bag kept links join (classes), and the sizes of the classes. Partial
cuts with the same classes are dropped if another one is as good. If few links are cut, few of these states are left,
however large the network is; on trees, however many links are cut.

Source: Bodlaender, A tourist guide through treewidth, Acta Cybernetica 11 (1993).
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import networkx as nx
import numpy as np
from networkx.algorithms.approximation import treewidth_min_fill_in

from ratt_opt.graph.communication import mask_of, robots_of
from ratt_opt.native.library import address
from ratt_opt.native.loops import CutFrontRecord, CutStatesRecord, loops

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt._validation import IntArray
    from ratt_opt.attack.edge_cuts.network import CutNetwork
    from ratt_opt.budget import Budget

__all__ = ["Elimination", "EliminationParams", "TooManyStates"]

Classes = tuple[int, ...]
"""Masks of the nodes of a bag that kept links join, ascending."""
Table = dict[Classes, "IntArray"]
"""(k, 2 + classes) states by their classes: weight cut, number, sizes of eliminated nodes; by ascending weight.

Joined states are numbered from 1 on; 0 is a state in which no link was decided, ``-1 - k`` one that cuts link ``k``.
"""
Side = tuple["IntArray", list[int]]
"""States, and the places of their classes among joined ones."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EliminationParams:
    """Work after which elimination is given up; more closes denser networks, and delays others.

    ``width`` : nodes of a bag less 1
    ``states`` : partial cuts of a bag, each some hundred bytes
    ``nodes`` : for each robot of the network. A node is a join of two tables, and a thousand pairs of states
    ``pairs_at_once`` : of states, between two looks at the clock; ``pairs_of_node`` : the thousand
    """

    width: int = 16
    states: int = 50_000
    nodes: int = 200
    pairs_at_once: int = 2_000_000
    pairs_of_node: int = 1_000


class _Front:
    """Joined states with the same classes, of ``room`` each."""

    def __init__(self, room: list[int], most_cut: int) -> None:
        self._room, self._most_cut = np.array([*room, 0], dtype=np.int64), most_cut
        self.states = np.zeros((64, 3 + len(room)), np.int64)
        self.count = 0

    def add(self, one: Side, other: Side, pairs: int) -> Iterator[int]:
        """Join two tables of states, with the maps of their classes; yields the pairs looked at, some at a time."""
        maps = [np.array([*into, -1], dtype=np.int64) for _, into in (one, other)]
        first, second = (
            CutStatesRecord(classes=len(into), count=len(states), map=address(own), states=address(states))
            for (states, into), own in zip((one, other), maps, strict=True)
        )
        start = 0
        while start < first.count:
            if self.count + second.count >= len(self.states):
                more = np.zeros((2 * len(self.states) + second.count, self.states.shape[1]), np.int64)
                more[: self.count] = self.states[: self.count]
                self.states = more
            record = CutFrontRecord(
                classes=len(self._room) - 1,
                most_cut=self._most_cut,
                capacity=len(self.states),
                count=self.count,
                room=address(self._room),
                states=address(self.states),
            )
            end = loops.join_cut_states(record, first, second, start, pairs)
            self.count = record.count
            yield (end - start) * second.count
            start = end


class TooManyStates(Exception):  # noqa: N818  (a signal within a search, never seen by a user)
    """More work than the parameters allow; the text says which limit was met."""


class Elimination:
    """Cuts of the least weight of one network, if bags of its tree decomposition are small."""

    def __init__(self, network: CutNetwork, params: EliminationParams | None = None) -> None:
        self._network, self._params = network, params or EliminationParams()
        self._graph = nx.empty_graph(network.n_nodes)
        self._graph.add_edges_from(network.ends.tolist())
        self.width, self._bags = treewidth_min_fill_in(self._graph)

        self.reason = f"elimination: no partial cuts of less weight join to a whole one (tree width {self.width})"

    def least_cut(self, size: int, most_cut: int, budget: Budget) -> IntArray | None:
        """(n,) labels of groups of at most ``size`` between which the least weight is cut; ``None`` if > ``most_cut``.

        Raises
        ------
        OutOfBudget : the budget is spent.
        TooManyStates : as the parameters say.
        """
        if self.width > self._params.width:
            raise TooManyStates(f"the network's tree width is above {self._params.width}")
        states = _States(self._network, size, most_cut, budget, self._params)
        cut = self._last(states)
        if cut is None:
            return None
        left = nx.Graph(self._graph)
        left.remove_edges_from(self._network.ends[cut].tolist())
        label = np.zeros(self._network.n_nodes, np.int64)
        for group in nx.connected_components(left):
            label[list(group)] = min(group)
        return label

    def order(self) -> list[int]:
        """Nodes in the order in which they are eliminated."""
        return [node for bag, above in self._upwards() for node in sorted(bag - above)]

    def _upwards(self) -> Iterator[tuple[frozenset[int], frozenset[int]]]:
        """Bags and those above them, leaves of the tree first; nothing is above the last one."""
        root = next(iter(self._bags))
        above = {bag: parent for parent, bag in nx.dfs_edges(self._bags, root)}
        for bag in nx.dfs_postorder_nodes(self._bags, root):
            yield bag, above.get(bag, frozenset())

    def _last(self, states: _States) -> list[int] | None:
        """Links of the best state once all nodes are eliminated, leaves of the tree of bags first."""
        below: dict[frozenset[int], list[Table]] = defaultdict(list)
        links = {(i, j): k for k, (i, j) in enumerate(self._network.ends.tolist())}
        for bag, above in self._upwards():
            inside = [link for link in combinations(sorted(bag), 2) if link in links]
            parts = [states.of_link(links.pop(link), *link) for link in inside] + below.pop(bag, [])
            table: Table = {tuple(1 << i for i in sorted(bag)): states.nothing(len(bag))}
            for part in sorted(parts, key=lambda one: sum(map(len, one.values()))):
                table = states.join(table, part)
            table = states.forget(table, mask_of(bag - above))
            if not table:
                return None
            if not above:
                return states.links_of(int(table[()][0, 1]))
            below[above].append(table)
        raise AssertionError("the root is the last bag")


class _States:
    """Tables of the states of parts, and which were joined to which."""

    def __init__(
        self, network: CutNetwork, size: int, most_cut: int, budget: Budget, params: EliminationParams
    ) -> None:
        self._network, self._size, self._most_cut = network, size, most_cut
        self._budget, self._params, self._nodes = budget, params, 0
        self._joined: list[IntArray] = []
        self._count = 0
        self._room: dict[int, int] = {}

    @staticmethod
    def nothing(classes: int) -> IntArray:
        """(1, 2 + classes) the state of a part without links."""
        return np.zeros((1, 2 + classes), dtype=np.int64)

    def of_link(self, link: int, i: int, j: int) -> Table:
        """A link kept, or cut."""
        apart = self.nothing(2)
        apart[0, :2] = self._network.weight[link], -1 - link
        return {(1 << i | 1 << j,): self.nothing(1), (1 << i, 1 << j): apart}

    def join(self, one: Table, other: Table) -> Table:
        """States of two parts together."""
        fronts: dict[Classes, _Front] = {}
        for first, states in one.items():
            for second, others in other.items():
                if states[0, 0] + others[0, 0] <= self._most_cut:
                    classes, into = _merged([*first, *second])
                    self._add(fronts, classes, (states, into[: len(first)]), (others, into[len(first) :]))
        return self._table(fronts)

    def forget(self, table: Table, gone: int) -> Table:
        """States once the nodes of a mask have no link to come: their sizes are those of their classes."""
        fronts: dict[Classes, _Front] = {}
        for before, states in table.items():
            own = states + np.array([0, 0, *(self._size_of(mask & gone) for mask in before)])
            classes = tuple(sorted(mask & ~gone for mask in before if mask & ~gone))
            into = [classes.index(mask & ~gone) if mask & ~gone else -1 for mask in before]
            self._add(fronts, classes, (own, into), (self.nothing(0), []))
        return self._table(fronts)

    def links_of(self, number: int) -> list[int]:
        """The links that a state cuts."""
        joined = np.concatenate(self._joined)
        found, open_ = [], [number]
        while open_:
            state = open_.pop()
            if state > 0:
                open_ += joined[state - 1].tolist()
            elif state < 0:
                found.append(-1 - state)
        return found

    def _add(self, fronts: dict[Classes, _Front], classes: Classes, one: Side, other: Side) -> None:
        if classes not in fronts:
            room = [self._size - self._size_of(mask) for mask in classes]
            fronts[classes] = _Front(room, self._most_cut)
        for pairs in fronts[classes].add(one, other, self._params.pairs_at_once):
            nodes = 1 + pairs // self._params.pairs_of_node
            self._budget.spend(nodes)
            self._nodes += nodes
            most = self._params.nodes * self._network.n_nodes
            if self._nodes > most:
                raise TooManyStates(f"more than {most:,} steps of elimination: too many")

    def _table(self, fronts: dict[Classes, _Front]) -> Table:
        """Numbered states of the fronts that have any."""
        table: Table = {}
        for classes, front in fronts.items():
            rows = front.states[: front.count]
            rows = rows[np.argsort(rows[:, 0], kind="stable")]
            self._joined.append(rows[:, 1:3].copy())
            numbers = self._count + 1 + np.arange(len(rows))
            self._count += len(rows)
            if len(rows):
                table[classes] = np.ascontiguousarray(np.column_stack([rows[:, 0], numbers, rows[:, 3:]]))
        if sum(map(len, table.values())) > self._params.states:
            raise TooManyStates(f"more than {self._params.states:,} partial cuts of a part: too many to keep")
        return table

    def _size_of(self, mask: int) -> int:
        if mask not in self._room:
            self._room[mask] = int(self._network.size[robots_of(mask)].sum())
        return self._room[mask]


def _merged(masks: list[int]) -> tuple[Classes, list[int]]:
    """Classes of masks that overlap, ascending, and the place of each mask's class."""
    classes: list[int] = []
    for mask in masks:
        apart = []
        whole = mask
        for other in classes:
            if other & mask:
                whole |= other
            else:
                apart.append(other)
        classes = [*apart, whole]
    classes.sort()
    return tuple(classes), [next(k for k, other in enumerate(classes) if other & mask) for mask in masks]
