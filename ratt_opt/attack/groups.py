"""The groups that an attack on a small team may leave: the lists of the last few graphs are kept."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.graph.group_list import GroupList

if TYPE_CHECKING:
    from ratt_opt.graph.communication import CommunicationGraph, Link
    from ratt_opt.graph.threat import Threat

__all__ = ["groups_of"]


def groups_of(threat: Threat) -> GroupList:
    """The list of a threat's groups, of at most 32 robots."""
    return _kept(threat.graph, threat.alpha_c, threat.protected_links)


@lru_cache(maxsize=2)
def _kept(graph: CommunicationGraph, most_cut: int, protected_links: frozenset[Link]) -> GroupList:
    return GroupList(graph, most_cut, protected_links, (np.uint32, np.uint8))
