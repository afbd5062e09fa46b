"""Lists of edges: each genuine one is read as it is, and what is another format is refused."""

import re
from collections.abc import Callable
from io import BytesIO

import networkx as nx
import numpy as np
import pytest
from scipy.io import mmwrite
from scipy.sparse import coo_matrix

from ratt_opt import FileFormatError
from ratt_opt.scenario.edge_list import parse_edge_list

TRIANGLE = "1 2\n2 3\n3 1"
IMPURE = {
    "KONECT": f"% sym unweighted\n% 3 3 3\n{TRIANGLE}",
    "MatrixMarket": f"%%MatrixMarket matrix coordinate pattern symmetric\n3 3 3\n{TRIANGLE}",
    "counts": f"300 3\n{TRIANGLE}",
    "counts, weights": "3 3\n1 2 0.5\n2 3 0.5\n3 1 0.5",
    "OR-Library": "3 3 2\n1 2 5\n2 3 6\n3 1 7",
    "sizes of a matrix": "3 3 3\n1 2 0.5\n2 3 0.5\n3 1 0.5",
    "counts with edges in both directions": "4 3\n1 2\n2 1\n2 3\n3 2\n3 4\n4 3",
    "counts that are too large": f"3 78\n{TRIANGLE}",
    "METIS": "3 3\n2 3\n1 3\n1 2",
    "METIS, a node alone": "4 2\n2 3\n\n1 4\n1 3",
    "header row": f"source target\n{TRIANGLE}",
    "header over names": "from to\nann bob\nbob cy",
    "header of one's own": f"left right\n{TRIANGLE}",
    "header row with weight": "from to weight\n1 2 1.0",
    "DIMACS": "c triangle\np edge 3 3\ne 1 2\ne 2 3\ne 3 1",
    "DIMACS, edges alone": "e 1 2\ne 2 3\ne 3 1",
    "nodes and edges": "v 0 1\nv 1 1\ne 0 1",
    "Pajek": f'*Vertices 3\n1 "a"\n2 "b"\n3 "c"\n*Edges\n{TRIANGLE}',
    "Trivial Graph Format": f"1 one\n2 two\n3 three\n#\n{TRIANGLE}",
    "// comment": f"// my network\n{TRIANGLE}",
    "; comment": f"; my network\n{TRIANGLE}",
    "adjacency list": "1 2 3\n2 3",
    "adjacency list of degree two": "1 2 3\n2 1 3\n3 1 2",
    "adjacency matrix": "0 1 1\n1 0 1\n1 1 0",
    "matrix of weights": "0 2.5 1\n2.5 0 3\n1 3 0",
    "edges after their numbers": "0 5 7\n1 7 9\n2 9 5",
    "commas": "1,2\n2,3",
    "commas and spaces": "1, 2\n2, 3",
    "semicolons": "1; 2\n2; 3",
    "quotes": '"New York" "Los Angeles"',
    "names with spaces": "New York\tBoston",
    "nodes that are pairs": "(0, 1) (0, 2) {}",
    "dot": "graph {\n1 -- 2\n}",
    "JSON": '[["a", "b"]]',
    "one node": "alone",
    "weight that is no number": "a b heavy",
    "weight that is infinite": "a b inf",
    "weight and time": "1 2 1.0 1083",
    "attributes that are none": "a b {'weight': }",
    "attributes that are a set": "a b {1}",
}


@pytest.mark.parametrize("text", IMPURE.values(), ids=list(IMPURE))
def test_what_is_no_bare_list_of_edges_is_refused(text: str):
    with pytest.raises(FileFormatError, match=r"^net line \d+ must ") as caught:
        parse_edge_list(text + "\n", "net")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "edges"),
    [
        (TRIANGLE, [("1", "2"), ("2", "3"), ("3", "1")]),
        ("# a comment\n\n1\t2  # another\n", [("1", "2")]),
        ("ap#1 ap#2\nap#2 ap#3", [("ap#1", "ap#2"), ("ap#2", "ap#3")]),
        ("hub ap#1", [("hub", "ap#1")]),
        ("u v\nw x", [("u", "v"), ("w", "x")]),
        ("source target\nsource sink", [("source", "target"), ("source", "sink")]),
        ("34 78\n34 7\n78 7", [("34", "78"), ("34", "7"), ("78", "7")]),
        ("99999999999 5\n1 2", [("99999999999", "5"), ("1", "2")]),
        ("", []),
    ],
)
def test_bare_lists_are_read(text: str, edges: list[tuple[str, str]]):
    assert list(parse_edge_list(text, "net").edges()) == edges


def test_weights_and_attributes_are_kept():
    assert list(parse_edge_list("1 2 5\n2 3 7\n3 4 6", "net").edges(data="weight")) == [
        ("1", "2", 5.0),
        ("2", "3", 7.0),
        ("3", "4", 6.0),
    ]
    graph = parse_edge_list("a b {'weight': 2, 'kind': 'radio'}", "net")
    assert graph.edges["a", "b", 0] == {"weight": 2, "kind": "radio"}


def _text(write: Callable[..., object], graph: nx.Graph) -> str:
    buffer = BytesIO()
    write(graph, buffer)
    return buffer.getvalue().decode()


def _links(graph: nx.Graph) -> set[frozenset[str]]:
    return {frozenset((str(a), str(b))) for a, b in graph.edges() if a != b}


def _drawn(rng: np.random.Generator) -> nx.Graph:
    n, first = int(rng.integers(4, 10)), int(rng.integers(2))
    graph = nx.gnp_random_graph(
        n, rng.choice([0.3, 0.6, 1.0]), seed=int(rng.integers(2**31)), directed=rng.random() < 0.3
    )
    names = (lambda i: i + first, lambda i: f"r{i}", lambda i: chr(97 + i))[rng.integers(3)]
    return nx.relabel_nodes(graph, {i: names(i) for i in graph})


def test_graphs_that_are_written_as_lists_come_back():
    """A list whose first line may be counts, or whose weights may be nodes, may be refused: rarely, never misread."""
    rng, refused, read = np.random.default_rng(0), 0, 0
    for _ in range(300):
        graph = _drawn(rng)
        edges = [f"{a} {b}" for a, b in rng.permutation(list(graph.edges()))]
        weighted = [f"{edge} {weight}" for edge, weight in zip(edges, rng.integers(1, 6, len(edges)), strict=True)]
        clear = [f"{edge} {weight:.3f}" for edge, weight in zip(edges, rng.random(len(edges)), strict=True)]
        for lines in (edges, weighted):
            try:
                assert _links(parse_edge_list("\n".join(lines), "net")) == _links(graph)
                read += 1
            except FileFormatError as error:
                refused += bool(re.search(r"\((an edge|a weight) is clear as ", error.rule))
        assert _links(parse_edge_list("\n".join(clear), "net")) == _links(graph)
        assert _links(parse_edge_list(_text(nx.write_edgelist, graph), "net")) == _links(graph)
    assert read + refused == 600
    assert refused < 0.02 * read


def test_graphs_that_are_written_in_other_formats_are_never_misread():
    rng = np.random.default_rng(1)
    for _ in range(300):
        graph = _drawn(rng)
        number = {node: i for i, node in enumerate(graph, start=1)}
        edges = [f"{a} {b}" for a, b in graph.edges()]
        if len(edges) < 3:
            continue
        matrix = nx.to_numpy_array(graph, dtype=int)
        others = {
            "adjacency list": "\n".join(" ".join(map(str, [node, *graph[node]])) for node in graph),
            "networkx's adjacency list": _text(nx.write_adjlist, graph),
            "its other one": _text(nx.write_multiline_adjlist, graph),
            "Pajek": _text(nx.write_pajek, graph),
            "matrix": "\n".join(" ".join(map(str, row)) for row in matrix),
            "MatrixMarket": _text(lambda of, to: mmwrite(to, coo_matrix(of)), matrix),
            "counts": "\n".join([f"{len(graph)} {len(edges)}", *edges]),
            "header": "\n".join(["source target", *edges]),
            "DIMACS": "\n".join(f"e {number[a]} {number[b]}" for a, b in graph.edges()),
            "numbered": "\n".join(f"{k} {number[b]} {number[a]}" for k, (a, b) in enumerate(graph.edges())),
        }
        for kind, text in others.items():
            try:
                found = parse_edge_list(text, "net")
            except FileFormatError:
                continue
            assert _links(found) == _links(graph), kind
