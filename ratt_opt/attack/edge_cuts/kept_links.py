"""Groups that hold more weight of links than their robots' prices, and the tree that proves that none exist."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.native.library import Answered, address, checked
from ratt_opt.native.loops import KeptLinksRecord, loops

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from ratt_opt._validation import BoolArray, IntArray
    from ratt_opt.attack.edge_cuts.network import CutNetwork
    from ratt_opt.budget import Budget

__all__ = ["KeptGroups", "groups_above", "proof_tree", "some_groups_above"]


@dataclass(frozen=True, slots=True, kw_only=True)
class KeptGroupParams:
    """``nodes_at_once`` : between two looks at the clock (some milliseconds); ``groups_at_once`` : of one pricing."""

    nodes_at_once: int = 500
    groups_at_once: int = 60
    listed_at_once: int = 20_000


PARAMS = KeptGroupParams()


@dataclass(frozen=True, slots=True)
class KeptGroups:
    """``groups`` : (k, n) found; ``is_complete`` : whether every part of the search was looked at."""

    groups: BoolArray
    is_complete: bool


class _Search:
    """One search; its arrays live as long as it does."""

    def __init__(  # noqa: PLR0917
        self, network: CutNetwork, prices: IntArray, room: int, threshold: int, most_found: int, most_length: int
    ) -> None:
        n, m = network.n_nodes, len(network.weight)
        weight = network.weight * network.unit
        start, arc = network.arcs
        given = [("ends", network.ends, (m, 2)), ("start", start, (n + 1,)), ("arc", arc, (2 * m,))]
        given += [("weight", weight, (m,)), ("prices", prices, (n,)), ("size", network.size, (n,))]
        self._arrays = [checked(name, np.ascontiguousarray(array), np.int64, shape) for name, array, shape in given]
        self.groups = np.zeros((most_found, n), np.uint8)
        self._values = np.zeros(most_found, np.int64)
        self.tree: NDArray[np.int64] = np.zeros(most_length, np.int64)
        self.record = KeptLinksRecord(
            robots=n,
            links=m,
            ends=address(self._arrays[0]),
            start=address(self._arrays[1]),
            arc=address(self._arrays[2]),
            weight=address(self._arrays[3]),
            price=address(self._arrays[4]),
            size=address(self._arrays[5]),
            room=room,
            threshold=threshold,
            listing=0,
            most_found=most_found,
            found=0,
            groups=address(self.groups),
            values=address(self._values),
            most_length=most_length,
            length=0,
            tree=address(self.tree),
            nodes=0,
        )

    def run(self, budget: Budget, most_nodes: int | None = None) -> Iterator[tuple[BoolArray, bool]]:
        """Groups as they are found, and whether the search is finished.

        Raises
        ------
        OutOfBudget : nodes or seconds are spent, or the user interrupted.
        """
        search = loops.open_kept_links(self.record)
        if not search:
            raise MemoryError("groups of robots")
        try:
            code: int = Answered.PAUSED
            while code != Answered.FINISHED and (most_nodes is None or self.record.nodes < most_nodes):
                before = self.record.nodes
                code = loops.search_kept_links(search, budget.nodes_left(PARAMS.nodes_at_once))
                budget.nodes += self.record.nodes - before
                if code != Answered.PAUSED:
                    yield self.groups[: self.record.found].astype(np.bool_), code == Answered.FINISHED
                    self.record.found = 0
            if code == Answered.PAUSED:
                yield self.groups[: self.record.found].astype(np.bool_), False
        finally:
            loops.close_kept_links(search)


def some_groups_above(network: CutNetwork, prices: IntArray, room: int, budget: Budget, most_nodes: int) -> KeptGroups:
    """Some connected groups of at most ``room`` that hold more than their prices (n,), in units of ``network.unit``.

    If the search is complete and finds none, there is none: then a partition keeps at most the sum of all prices.

    Raises
    ------
    OutOfBudget : the budget is spent.
    """
    search = _Search(network, prices, room, 0, PARAMS.groups_at_once, 0)
    for groups, is_complete in search.run(budget, most_nodes):
        return KeptGroups(groups, is_complete)
    raise AssertionError("a search ends with its groups")


def groups_above(  # noqa: PLR0917
    network: CutNetwork, prices: IntArray, room: int, threshold: int, most: int, budget: Budget
) -> KeptGroups:
    """All connected groups of at most ``room`` that hold more than their prices and ``threshold``, each once.

    The list is not complete if there are more than ``most``.

    Raises
    ------
    OutOfBudget : the budget is spent.
    """
    search = _Search(network, prices, room, threshold, min(most, PARAMS.listed_at_once), 0)
    search.record.listing = 1
    parts, count = [np.zeros((0, network.n_nodes), np.bool_)], 0
    for groups, is_complete in search.run(budget):
        parts.append(groups)
        count += len(groups)
        if is_complete or count > most:
            return KeptGroups(np.concatenate(parts), is_complete and count <= most)
    raise AssertionError("a search ends with its groups")


def proof_tree(  # noqa: PLR0917
    network: CutNetwork, prices: IntArray, room: int, most_length: int, budget: Budget, threshold: int = 0
) -> IntArray | None:
    """The tree of the search for groups above their prices and ``threshold``, as integers; ``None`` if it is longer.

    With threshold 0 there must be none; with a lower one each has a leaf of its own.

    Raises
    ------
    OutOfBudget : the budget is spent.
    """
    most_found = PARAMS.listed_at_once if threshold < 0 else 1
    search = _Search(network, prices, room, threshold, most_found, most_length)
    search.record.listing = int(threshold < 0)
    for groups, is_complete in search.run(budget):
        if (threshold == 0 and (len(groups) or not is_complete)) or search.record.length > most_length:
            return None
    return search.tree[: search.record.length].copy()
