"""Communication network: a networkx graph of platforms and sensors, or edges of Stone Soup's network classes.

Stone Soup's own architectures are for networks without failures: an edge that ``failed()`` still delivers,
``propagate(failed_edges=)`` changes nothing, a removed edge only delays its messages, and information architectures do
not relay from sensor to sensor. So only who is joined to whom is read off them; the rest is done here. Edges that run
both ways are one link, and nodes without a sensor (fusion nodes, repeaters) relay.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import networkx as nx

from ratt_opt.errors import InputError
from ratt_opt.interop.stonesoup.nodes import title

if TYPE_CHECKING:
    from ratt_opt.interop.stonesoup.nodes import Node

__all__ = ["Network"]


@dataclass(frozen=True, slots=True, eq=False)
class Network:
    """``graph`` on the places of the nodes, 0 to N-1, and of the ``relays`` after them; ``None`` if all are joined."""

    graph: nx.Graph | None
    relays: tuple[Any, ...] = ()

    @classmethod
    def of(cls, given: Any, nodes: tuple[Node, ...]) -> Network:
        """Read a graph or edges.

        Platforms are named by themselves, their ``id`` or any of their sensors; sensors by themselves; both by their
        place in the list, or by Stone Soup's ``SensorNode``. Who is not named has no link.

        Raises
        ------
        InputError : it is neither, or names somebody whom the manager does not manage.
        """
        if given is None:
            return cls(None)
        if isinstance(given, nx.Graph):
            members, pairs = list(given.nodes), list(given.edges())
        elif isinstance(given, Iterable):
            pairs = [_pair(edge) for edge in given]
            members = list(dict.fromkeys(end for pair in pairs for end in pair))
        else:
            rule = "must be a networkx graph, or edges of Stone Soup's network classes"
            raise InputError("graph", rule, type(given).__name__)
        places = _places(nodes)
        relays = [member for member in members if _is_relay(member)]
        places |= {id(relay): len(nodes) + k for k, relay in enumerate(relays)}
        graph: nx.Graph = nx.Graph()
        graph.add_nodes_from(range(len(nodes) + len(relays)))
        found = {member: _place(member, places, nodes) for member in members}
        graph.add_edges_from((found[a], found[b]) for a, b in pairs if found[a] != found[b])
        return cls(graph, tuple(relays))


def _pair(edge: Any) -> tuple[Any, Any]:
    ends = getattr(edge, "nodes", edge)
    pair = () if isinstance(ends, str) or not isinstance(ends, Iterable) else tuple(ends)
    if len(pair) != 2:
        raise InputError("graph", "must hold pairs of nodes, as Edge((sender, recipient))", edge)
    return pair[0], pair[1]


def _is_relay(member: Any) -> bool:
    """One of Stone Soup's nodes that carries no sensor."""
    return hasattr(member, "messages_to_pass_on") and not hasattr(member, "sensor")


def _places(nodes: tuple[Node, ...]) -> dict[int, int]:
    return {id(actionable): k for k, node in enumerate(nodes) for actionable in node.actionables}


def _place(member: Any, places: dict[int, int], nodes: tuple[Node, ...]) -> int:
    own = getattr(member, "sensor", member)
    if id(own) in places:
        return places[id(own)]
    if isinstance(own, int) and 0 <= own < len(nodes):
        return own
    for k, node in enumerate(nodes):
        if node.platform is not None and isinstance(own, str) and node.platform.id == own:
            return k
    shown = own if isinstance(own, (int, str)) else title(own)
    raise InputError("graph", "must join platforms and sensors of this manager alone: unknown node", shown)
