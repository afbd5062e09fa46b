"""Graph files of other programs, by networkx's readers: GraphML, GML, GEXF, JSON node-link; and lists of edges."""

from __future__ import annotations

from codecs import BOM_UTF8
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import networkx as nx

from ratt_opt.errors import FileFormatError
from ratt_opt.scenario.edge_list import parse_edge_list
from ratt_opt.scenario.files import read_bytes, read_json

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

__all__ = ["GRAPH_FILES", "read_graph"]

PLACES = ("graphics", "position", "pos")
"""Attributes in which Gephi and others keep where a node is drawn: a record of x and y, or a list of them."""


def read_graph(path: str | Path) -> nx.Graph:
    """Read a network as it stands in a file; the ending of its name says what it is (``GRAPH_FILES``).

    The graph is directed and has parallel edges if the file says so; :func:`communication_graph` makes it simple and
    numbers its nodes. Nodes and edges have the file's attributes: ``label`` or ``name``, ``weight``. Where a node is
    drawn (GEXF, Gephi's GML, ``pos``) becomes its attributes ``x`` and ``y``.

    Raises
    ------
    FileFormatError : the ending is unknown, or the file cannot be read as what it says: a node is given twice, an edge
        ends at a node that is not given, a list of edges is no bare one (:mod:`ratt_opt.scenario.edge_list`).
    """
    path = Path(path)
    kind, read = GRAPH_FILES.get(path.suffix.lower(), ("", None))
    if read is None:
        rule = f"must end in {', '.join(GRAPH_FILES)}"
        raise FileFormatError(str(path), rule, path.suffix or "no ending")
    try:
        graph = read(path)
    except FileFormatError:
        raise
    except UnicodeDecodeError as error:
        raise FileFormatError(str(path), "must be UTF-8 text", f"byte {error.start} is not") from None
    # networkx raises many types for a file that is not of its format: it depends on where it first fails.
    except (nx.NetworkXException, SyntaxError, ValueError, TypeError, LookupError, AttributeError) as error:
        raise FileFormatError(str(path), f"must be {kind}", f"{error}" or type(error).__name__) from None
    except RecursionError:
        raise FileFormatError(str(path), f"must be {kind}", "elements nested too deeply") from None
    if not isinstance(graph, nx.Graph) or not len(graph):
        raise FileFormatError(str(path), "must hold a graph with at least one node", "none")
    for attributes in graph.nodes.values():
        attributes |= {k: v for k, v in _drawn_at(attributes).items() if k not in attributes}
    return graph


def _drawn_at(attributes: dict[str, Any]) -> dict[str, Any]:
    """``x`` and ``y`` of the first of ``PLACES`` that has both."""
    viewed = attributes.get("viz")
    for given in (*map(attributes.get, PLACES), viewed.get("position") if isinstance(viewed, dict) else None):
        if isinstance(given, dict) and {"x", "y"} <= given.keys():
            return {"x": given["x"], "y": given["y"]}
        if isinstance(given, (list, tuple)) and len(given) in {2, 3}:
            return {"x": given[0], "y": given[1]}
    return {}


def _graphml(path: Path) -> nx.Graph:
    content = read_bytes(path)
    _check_xml(path, content)
    return nx.read_graphml(BytesIO(content))


def _gexf(path: Path) -> nx.Graph:
    content = read_bytes(path)
    _check_xml(path, content)
    return nx.read_gexf(BytesIO(content))


def _check_xml(path: Path, content: bytes) -> None:
    """networkx reads the first of several graphs, and makes the nodes that edges name."""
    by_tag: dict[str, list[ElementTree.Element]] = {}
    for element in ElementTree.fromstring(content).iter():
        by_tag.setdefault(element.tag.rpartition("}")[2], []).append(element)
    nodes = by_tag.get("node", [])
    if len(by_tag.get("graph", [])) > 1 and not any(node.get("yfiles.foldertype") for node in nodes):
        raise FileFormatError(str(path), "must hold one graph", "more")
    ends = (edge.get(side) for edge in by_tag.get("edge", []) for side in ("source", "target"))
    _check_ends(path, [node.get("id") for node in nodes], ends)


def _check_ends(path: Path, nodes: Iterable[Any], ends: Iterable[Any]) -> None:
    """Refuse a node that is given twice, and an edge of a node that is not given."""
    known = set()
    for node in nodes:
        if node in known:
            raise FileFormatError(str(path), "must give each node once", node)
        known.add(node)
    for end in ends:
        if end not in known:
            raise FileFormatError(str(path), "must have edges between nodes that it gives", end)


def _gml(path: Path) -> nx.Graph:
    # By number: labels, which networkx takes by default, may stand twice.
    return nx.parse_gml(_text(path), label="id")


def _node_link(path: Path) -> nx.Graph:
    document = read_json(path)
    if not isinstance(document, dict):
        raise FileFormatError(str(path), "must be JSON node-link", type(document).__name__)
    edges = "edges" if "edges" in document else "links"
    graph = nx.node_link_graph(document, edges=edges)
    nodes = [_hashable(node.get("id", number)) for number, node in enumerate(document["nodes"])]
    _check_ends(path, nodes, (_hashable(edge[side]) for edge in document[edges] for side in ("source", "target")))
    return graph


def _hashable(node: Any) -> Any:
    return tuple(map(_hashable, node)) if isinstance(node, list) else node


def _edge_list(path: Path) -> nx.Graph:
    return parse_edge_list(_text(path), str(path))


def _text(path: Path) -> str:
    return read_bytes(path).removeprefix(BOM_UTF8).decode("utf-8")


GRAPH_FILES: dict[str, tuple[str, Callable[[Path], nx.Graph]]] = {
    ".graphml": ("GraphML", _graphml),
    ".gml": ("GML", _gml),
    ".gexf": ("GEXF", _gexf),
    ".json": ("JSON node-link", _node_link),
    ".edgelist": ("a list of edges", _edge_list),
    ".edges": ("a list of edges", _edge_list),
    ".txt": ("a list of edges", _edge_list),
}
"""Ending of a file's name -> what it is, and its reader."""
