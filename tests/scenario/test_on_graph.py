"""Scenarios on the graphs of other programs' files."""

import json
from pathlib import Path

import networkx as nx
import numpy as np
import pytest

from ratt_opt import FileFormatError, InputError, graph_scenario, load_scenario
from ratt_opt.cli import run
from ratt_opt.scenario.graph_files import GRAPH_FILES, read_graph
from tests.cli.refusal import refused

WRITERS = {
    ".graphml": nx.write_graphml,
    ".gml": nx.write_gml,
    ".edgelist": nx.write_edgelist,
    ".edges": nx.write_edgelist,
    ".txt": nx.write_edgelist,
    ".gexf": nx.write_gexf,
    ".json": lambda graph, path: path.write_text(json.dumps(nx.node_link_data(graph, edges="links")), encoding="utf-8"),
}


GRAPHML = '<graphml xmlns="http://graphml.graphdrawing.org/xmlns">{}</graphml>'
GEPHI_GML = """graph [
  node [ id 0 label 7 graphics [ x -1.0 y 0.0 z 0.0 w 10.0 h 10.0 fill "#999999" ] ]
  node [ id 1 label "b" graphics [ x 3.0 y 2.0 z 0.0 w 10.0 h 10.0 fill "#999999" ] ]
  edge [ id 0 source 0 target 1 value 1.0 ]
]"""
GEPHI_GEXF = """<gexf xmlns="http://www.gexf.net/1.2draft" xmlns:viz="http://www.gexf.net/1.2draft/viz" version="1.2">
<graph defaultedgetype="undirected"><nodes>
<node id="0" label="7"><viz:position x="-1.0" y="0.0"/></node>
<node id="1" label="b"><viz:position x="3.0" y="2.0"/></node>
</nodes><edges><edge source="0" target="1"/></edges></graph></gexf>"""


def provider_network(rng: np.random.Generator, directed: bool) -> nx.Graph:
    """A tree with a few links more, nodes named and placed as in collections of real networks."""
    n = int(rng.integers(2, 12))
    tree = nx.random_labeled_tree(n, seed=int(rng.integers(2**31)))
    graph = (nx.MultiDiGraph if directed else nx.MultiGraph)()
    for i in tree:
        graph.add_node(f"n{i}", Longitude=float(rng.uniform(5, 15)), Latitude=float(rng.uniform(45, 55)))
    graph.add_edges_from((f"n{i}", f"n{j}") for i, j in tree.edges)
    extra = rng.integers(0, n, (int(rng.integers(0, 4)), 2)).tolist()
    graph.add_edges_from((f"n{i}", f"n{j}") for i, j in extra)
    return graph


@pytest.mark.parametrize("ending", GRAPH_FILES)
@pytest.mark.parametrize("directed", [False, True])
def test_every_kind_of_file_gives_the_same_team(ending: str, directed: bool, tmp_path: Path):
    for seed in range(10):
        graph = provider_network(np.random.default_rng(seed), directed)
        path = tmp_path / f"network{ending}"
        WRITERS[ending](graph, path)
        team = graph_scenario(read_graph(path), 3, alpha_s=1, alpha_c=1, seed=seed)
        names = [robot.name for robot in team.robots]
        between = {frozenset((names[i], names[j])) for i, j in team.links}
        assert between == {frozenset((a, b)) for a, b in graph.edges() if a != b}
        assert team.problem().communication.n_robots == len(graph)


def test_robots_stand_where_the_nodes_are():
    graph = nx.path_graph(4)
    nx.set_node_attributes(graph, {0: {"x": 0, "y": 0}, 1: {"x": 2, "y": 0}, 3: {"x": 4, "y": 1}})
    team = graph_scenario(graph, 2, alpha_s=0, alpha_c=0, seed=0, side=40.0)
    places = [(robot.x, robot.y) for robot in team.robots]
    assert places == [(0, 0), (20, 0), (pytest.approx(30), pytest.approx(5)), (40, 10)]
    assert any("x and y" in note and "1 without" in note for note in team.notes)


def test_without_places_robots_are_placed_at_random_and_it_is_said():
    team = graph_scenario(nx.path_graph(5), 2, alpha_s=0, alpha_c=0, seed=0)
    assert "robots placed at random" in team.notes
    assert team.robots == tuple(
        robot.replace(name=str(i))
        for i, robot in enumerate(graph_scenario(nx.cycle_graph(5), 2, alpha_s=0, alpha_c=0, seed=0).robots)
    )


@pytest.mark.parametrize(
    ("name", "content", "rule"),
    [
        ("a.graphml", "<graphml>", "must be GraphML"),
        ("a.gml", "graph [ node [", "must be GML"),
        ("a.json", "[]", "must be JSON node-link"),
        ("a.json", '{"links": []}', "must be JSON node-link"),
        ("a.edgelist", "one\n", "must name two nodes"),
        ("a.txt", "# nothing\n", "at least one node"),
        ("a.csv", "1,2\n", "must end in"),
        ("a.txt", "source target\n1 2\n", "a.txt line 1 must be an edge, not a header row"),
        (
            "a.json",
            '{"nodes": [{"id": "a"}, {"id": "b"}], "links": [{"source": 0, "target": 1}]}',
            "between nodes that it",
        ),
        ("a.json", '{"nodes": [{"id": "a"}, {"id": "a"}], "links": []}', "must give each node once"),
        (
            "a.graphml",
            GRAPHML.format('<graph><node id="a"/><edge source="a" target="b"/></graph>'),
            "between nodes that it",
        ),
        (
            "a.graphml",
            GRAPHML.format('<graph><node id="a"/></graph><graph><node id="b"/></graph>'),
            "must hold one graph",
        ),
        ("a.gexf", "<gexf>", "must be GEXF"),
    ],
)
def test_other_files_are_refused_in_one_line(name: str, content: str, rule: str, tmp_path: Path):
    path = tmp_path / name
    path.write_text(content, encoding="utf-8")
    with pytest.raises(FileFormatError, match=rule) as caught:
        read_graph(path)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.gml", GEPHI_GML),
        ("a.gexf", GEPHI_GEXF),
        (
            "a.json",
            '{"nodes": [{"id": 7, "pos": [0, 0]}, {"id": "b", "x": 4, "y": 2}], '
            '"links": [{"source": 7, "target": "b"}]}',
        ),
        (
            "a.graphml",
            GRAPHML.format(
                '<key id="d" for="node" attr.name="x" attr.type="string"/><key id="e" for="node" attr.name="y"/>'
                '<graph><node id="7"><data key="d">0</data><data key="e">0</data></node>'
                '<node id="b"><data key="d">4.0</data><data key="e">2</data></node>'
                '<edge source="7" target="b"/></graph>'
            ),
        ),
    ],
)
@pytest.mark.filterwarnings("ignore:No key type")
def test_names_and_places_of_drawn_graphs_are_kept(name: str, content: str, tmp_path: Path):
    path = tmp_path / name
    path.write_text(content, encoding="utf-8")
    team = graph_scenario(read_graph(path), 2, alpha_s=0, alpha_c=0, seed=0, side=40.0)
    assert [(robot.name, robot.x, robot.y) for robot in team.robots] == [("7", 0.0, 0.0), ("b", 40.0, 20.0)]
    assert any("placed by x and y" in note for note in team.notes)


def test_no_graph_is_refused():
    with pytest.raises(InputError, match="graph must be a networkx graph"):
        graph_scenario([(0, 1)], 2, alpha_s=0, alpha_c=0, seed=0)  # type: ignore[arg-type]


def test_the_command_draws_a_scenario_on_a_graph_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path, out = tmp_path / "network.graphml", tmp_path / "s.json"
    graph = provider_network(np.random.default_rng(1), directed=True)
    nx.write_graphml(graph, path)
    words = [
        "new",
        "--graph",
        str(path),
        "--targets",
        "3",
        "--seed",
        "1",
        "--sensing-attacks",
        "1",
        "--link-attacks",
        "1",
    ]
    assert run([*words, "--out", str(out)]) == 0
    assert {robot.name for robot in load_scenario(out).robots} == set(graph)
    capsys.readouterr()
    refused(
        [*words, "--robots", "3", "--out", str(tmp_path / "t.json")], capsys, "--robots must come with no --graph file"
    )
    assert not (tmp_path / "t.json").exists()
