"""``ratt-opt cuts``: both questions, files as others write them, JSON, and what is refused."""

import json

import networkx as nx
import pytest
from jsonschema import validate

import ratt_opt as ro
from ratt_opt.cli import run
from ratt_opt.report.schemas import output_schema


@pytest.fixture
def asked(capsys):
    """Run ``ratt-opt cuts``: exit code, standard output, standard error."""

    def ask(*words):
        code = run(["cuts", *map(str, words)])
        printed = capsys.readouterr()
        return code, printed.out, printed.err

    return ask


@pytest.fixture
def karate(tmp_path):
    graph = nx.karate_club_graph()
    nx.write_graphml(graph, tmp_path / "karate.graphml")
    nx.write_edgelist(graph, tmp_path / "karate.edgelist", data=["weight"])
    return tmp_path


def test_both_questions_of_a_graphml_file(karate, asked):
    document = json.loads(asked(karate / "karate.graphml", "--largest-group", "8", "--json")[1])
    validate(document, output_schema("cuts"))
    plain = ro.communication_graph(nx.karate_club_graph())
    assert (document["lower"], document["upper"]) == (31, 31) == (ro.fewest_cuts(plain, 8).lower,) * 2
    assert len(document["cut"]) == 31
    assert max(map(len, document["groups"])) <= 8
    size = json.loads(asked(karate / "karate.graphml", "--cuts", "31", "--json")[1])
    validate(size, output_schema("cuts"))
    assert (size["lower"], size["upper"], size["cuts"]) == (8, 8, 31)
    assert "weight of the cut: 31, exact" in asked(karate / "karate.graphml", "--largest-group", "8")[1]


def test_weights_of_an_edge_list(karate, asked):
    words = ("--largest-group", "10", "--weights", "weight", "--json")
    document = json.loads(asked(karate / "karate.edgelist", *words)[1])
    graph = nx.karate_club_graph()
    expected = ro.fewest_cuts(nx.Graph(graph), 10, weights="weight")
    assert document["upper"] == expected.upper == expected.lower
    assert sum(graph[int(a)][int(b)]["weight"] for a, b in document["cut"]) == document["upper"]


def test_a_network_in_pieces_says_so(tmp_path, asked):
    nx.write_gml(nx.disjoint_union(nx.path_graph(3), nx.path_graph(2)), tmp_path / "two.gml")
    assert "falls into 2 groups" in asked(tmp_path / "two.gml", "--largest-group", "3")[1]


@pytest.mark.parametrize(
    ("given", "named"),
    [
        ([], "--largest-group"),
        (["--largest-group", "3", "--cuts", "2"], "--largest-group"),
        (["--largest-group", "0"], "size"),
        (["--largest-group", "nan"], "size"),
        (["--cuts", "1000"], "alpha_c"),
        (["--largest-group", "3", "--weights", "cost"], "weights"),
        (["--cuts", "3", "--weights", "weight"], "--weights"),
    ],
)
def test_bad_input_is_one_line(karate, given, named, asked):
    code, printed, error = asked(karate / "karate.graphml", *given)
    assert (code, printed) == (2, "")
    assert len(error.strip().splitlines()) == 1
    assert named in error


def test_files_that_are_no_edge_list_or_have_parallel_links_are_refused(tmp_path, asked):
    (tmp_path / "dimacs.txt").write_text("p edge 3 2\ne 1 2\ne 2 3\n")
    (tmp_path / "negative.edgelist").write_text("1 2 -1\n2 3 1\n")
    nx.write_graphml(nx.MultiGraph([(0, 1), (0, 1)]), tmp_path / "parallel.graphml")
    for name, said in (("dimacs.txt", "dimacs"), ("parallel.graphml", "parallel")):
        code, _, error = asked(tmp_path / name, "--largest-group", "2")
        assert (code, said in error) == (2, True)
    code, _, error = asked(tmp_path / "negative.edgelist", "--largest-group", "2", "--weights", "weight")
    assert (code, "weights" in error) == (2, True)


def test_certificates_of_both_questions(karate, asked, tmp_path, capsys):
    proof = tmp_path / "proof.json"
    words = ("--largest-group", "8", "--certificate", proof, "--json")
    document = json.loads(asked(karate / "karate.graphml", *words)[1])
    validate(document, output_schema("cuts"))
    assert document["certificate"] == {"file": str(proof), "size": 8, "least_weight": 31, "proof": "prices"}
    assert run(["verify", str(proof)]) == 0
    assert "weight at least 31" in capsys.readouterr().out
    code, printed, _ = asked(karate / "karate.graphml", "--cuts", "34", "--certificate", proof)
    assert code == 0
    assert "at least 35 must be cut for groups of at most 7" in printed
    assert run(["verify", str(proof)]) == 0
    capsys.readouterr()
    weighed = ("--largest-group", "10", "--weights", "weight", "--certificate", proof, "--json")
    assert json.loads(asked(karate / "karate.edgelist", *weighed)[1])["certificate"]["least_weight"] > 0


def test_nothing_is_written_if_there_is_nothing_to_prove(asked, tmp_path):
    nx.write_graphml(nx.path_graph(4), tmp_path / "path.graphml")
    proof = tmp_path / "proof.json"
    code, _, error = asked(tmp_path / "path.graphml", "--cuts", "3", "--certificate", proof)
    assert code == 1
    assert "nothing to prove" in error
    assert not proof.exists()
