"""Graph files of other programs, by networkx's readers: GraphML, GML, JSON node-link, lists of edges."""

from __future__ import annotations

from codecs import BOM_UTF8
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

import networkx as nx

from ratt_opt.errors import FileFormatError
from ratt_opt.scenario.files import read_bytes, read_json

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["GRAPH_FILES", "read_graph"]


def read_graph(path: str | Path) -> nx.Graph:
    """Read a graph file; the ending of its name says what it is (``GRAPH_FILES``).

    Raises
    ------
    FileFormatError : the ending is unknown, or the file cannot be read as what it says.
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
    # What networkx raises for a file that is not of its format depends on where it first fails.
    except (nx.NetworkXException, SyntaxError, ValueError, TypeError, LookupError, AttributeError) as error:
        raise FileFormatError(str(path), f"must be {kind}", f"{error}" or type(error).__name__) from None
    except RecursionError:
        raise FileFormatError(str(path), f"must be {kind}", "elements nested too deeply") from None
    if not isinstance(graph, nx.Graph) or not len(graph):
        raise FileFormatError(str(path), "must hold a graph with at least one node", "none")
    return graph


def _graphml(path: Path) -> nx.Graph:
    return nx.read_graphml(BytesIO(read_bytes(path)))


def _gml(path: Path) -> nx.Graph:
    # By number: labels, which networkx takes by default, may stand twice.
    return nx.parse_gml(_text(path), label="id")


def _node_link(path: Path) -> nx.Graph:
    document = read_json(path)
    if not isinstance(document, dict):
        raise FileFormatError(str(path), "must be JSON node-link", type(document).__name__)
    return nx.node_link_graph(document, edges="edges" if "edges" in document else "links")


def _edge_list(path: Path) -> nx.Graph:
    """Two nodes a line, what follows is passed over; directed, as lists often have each edge in both directions."""
    graph = nx.MultiDiGraph()
    for number, line in enumerate(_text(path).splitlines(), start=1):
        words = line.partition("#")[0].split()
        if len(words) == 1:
            raise FileFormatError(f"{path} line {number}", "must name two nodes", words[0])
        if words:
            graph.add_edge(*words[:2])
    return graph


def _text(path: Path) -> str:
    return read_bytes(path).removeprefix(BOM_UTF8).decode("utf-8")


GRAPH_FILES: dict[str, tuple[str, Callable[[Path], nx.Graph]]] = {
    ".graphml": ("GraphML", _graphml),
    ".gml": ("GML", _gml),
    ".json": ("JSON node-link", _node_link),
    ".edgelist": ("a list of edges", _edge_list),
    ".edges": ("a list of edges", _edge_list),
    ".txt": ("a list of edges", _edge_list),
}
"""Ending of a file's name -> what it is, and its reader."""
