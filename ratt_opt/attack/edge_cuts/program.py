"""The linear program over known groups: prices of robots so that no known group holds more than its prices.

    minimise  sum of q_i   subject to  q(S) >= kept(S) for every known group S,   q >= 0

Its dual chooses groups that keep the most, each robot in at most one. Exact pricing decides whether the prices hold
for all groups; then every partition keeps at most their sum.

Source: Johnson, Mehrotra and Nemhauser, Min-cut clustering, Mathematical Programming 62 (1993).
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.highs import LinearProgram, rows_of

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.attack.edge_cuts.network import CutNetwork

__all__ = ["KeptProgram", "chosen_labels"]


class KeptProgram:
    """Known groups of at least two nodes, each once, and the program over them."""

    def __init__(self, network: CutNetwork) -> None:
        self._network = network
        self._known: dict[bytes, BoolArray] = {}
        self._program = LinearProgram(np.ones(network.n_nodes))

    def add(self, groups: BoolArray) -> int:
        """Add groups (k, n); returns how many are new."""
        fresh = []
        for group in groups:
            key = group.tobytes()
            if key not in self._known and group.sum() > 1:
                self._known[key] = group
                fresh.append(group)
        if fresh:
            entries = [(np.flatnonzero(group).tolist(), [1.0] * int(group.sum())) for group in fresh]
            self._program.add_rows(rows_of(entries, self._network.kept(np.array(fresh)).astype(np.float64)))
        return len(fresh)

    def prices(self, seconds: float = inf) -> FloatArray | None:
        """(n,) the best prices by HiGHS's claim, in steps of weights; ``None`` if it has none."""
        claimed = self._program.solve(seconds).x
        return np.maximum(claimed, 0.0) if len(claimed) == self._network.n_nodes else None

    def labels(self, most_nodes: int, seconds: float) -> IntArray | None:
        """(n,) labels of a partition into known groups that HiGHS finds by integers, if it finds one."""
        groups = np.array(list(self._known.values()))
        if not len(groups):
            return None
        program = LinearProgram(
            self._network.kept(groups),
            0.0,
            1.0,
            maximise=True,
            integer=[True] * len(groups),
            rows=rows_of([(np.flatnonzero(of).tolist(), [1.0] * int(of.sum())) for of in groups.T], -inf, 1.0),
            mip_max_nodes=most_nodes,
        )
        claimed = program.solve(seconds, is_long=True)
        return chosen_labels(groups[claimed.x > 0.5]) if len(claimed.x) == len(groups) else None


def chosen_labels(groups: BoolArray) -> IntArray | None:
    """(n,) labels of disjoint groups (k, n) and of nodes in none, each by itself; ``None`` if two overlap."""
    if (groups.sum(axis=0) > 1).any():
        return None
    label = np.arange(groups.shape[1])
    for group in groups:
        label[group] = np.flatnonzero(group)[0]
    return label
