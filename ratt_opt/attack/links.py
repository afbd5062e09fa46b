"""A communication graph as arrays for the compiled loops."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, IntArray
    from ratt_opt.graph.threat import Threat

__all__ = ["Links"]


class Links(NamedTuple):
    """A threat's graph: robot ``i`` has arcs ``start[i]:start[i + 1]`` to ``robot``.

    ``start`` : (N + 1,); ``robot`` : (A,) the other end; ``back`` : (A,) the same link's arc the other way;
    ``fixed`` : (A,) whether the link cannot be cut; ``seeing`` : (N,) whether the robot cannot be blinded
    """

    start: IntArray
    robot: IntArray
    back: IntArray
    fixed: BoolArray
    seeing: BoolArray

    @classmethod
    def of(cls, threat: Threat) -> Links:
        """The graph of a threat."""
        arcs = sorted([*threat.graph.links, *((j, i) for i, j in threat.graph.links)])
        place = {arc: a for a, arc in enumerate(arcs)}
        n_robots = threat.graph.n_robots
        start = np.searchsorted([i for i, _ in arcs], np.arange(n_robots + 1)) if arcs else np.zeros(n_robots + 1)
        fixed = [(min(arc), max(arc)) in threat.protected_links for arc in arcs]
        return cls(
            start.astype(np.int64),
            np.array([j for _, j in arcs], dtype=np.int64),
            np.array([place[j, i] for i, j in arcs], dtype=np.int64),
            np.array(fixed, dtype=np.bool_),
            np.array([i in threat.protected_robots for i in range(n_robots)], dtype=np.bool_),
        )
