"""Certificates of fewest cuts: what is written is proved, and a forged one is refused."""

import json
from copy import deepcopy
from dataclasses import replace
from fractions import Fraction

import jsonschema
import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.certificates.verifier.edge_cuts import verify_cuts
from ratt_opt.cli import run
from ratt_opt.report.schemas import output_schema
from tests.attack.edge_cuts.test_fewest import by_all_partitions, random_case


def written(seed, path):
    """A certificate; ``None`` if protected links join robots above the size."""
    graph, weights, sizes, protected, size = random_case(seed)
    given = {"weights": weights, "sizes": sizes, "protected_links": protected}
    truth = by_all_partitions(graph, weights, sizes, size, protected)
    if truth is None:
        return None
    found = ro.fewest_cuts(graph, size, **given)
    verified = ro.certify_cuts(graph, found, path, **given)
    assert verified.n_protected == len(protected)
    assert verified.lower <= truth == found.upper
    if found.prices is not None:
        assert verified.lower >= found.by_prices
    document = json.loads(path.read_text(encoding="utf-8"))
    jsonschema.validate(document, output_schema("cut-certificate"))
    return document


def written_by(seed, kind, path):
    """The document that proves the optimum by listed groups or by elimination, and the optimum; ``None`` as above."""
    graph, weights, sizes, protected, size = random_case(seed)
    given = {"weights": weights, "sizes": sizes, "protected_links": protected}
    truth = by_all_partitions(graph, weights, sizes, size, protected)
    found = None if truth is None else ro.fewest_cuts(graph, size, **given)
    if not truth or found.prices is None:
        return None
    prices = tuple(price * Fraction(5, 4) for price in found.prices) if kind == "listed groups" else None
    claim = replace(found, proved_by=kind, prices=prices)
    verified = ro.certify_cuts(graph, claim, path, **given)
    assert verified.lower == truth
    return json.loads(path.read_text(encoding="utf-8")), verified.proof, truth


def refused(document):
    with pytest.raises((ro.ProofError, ro.InputError)):
        verify_cuts(document)


@pytest.mark.parametrize("first", range(0, 60, 20))
def test_what_is_found_is_proved_and_forgeries_are_refused(first, tmp_path):
    for seed in range(first, first + 20):
        document = written(seed, tmp_path / "cuts.json")
        if document is None:
            continue
        refused(document | {"claim": document["claim"] + 1})
        if "tree" not in document:
            continue  # nothing need be cut, or counting says so
        refused(document | {"tree": document["tree"][:-1]})
        refused(document | {"tree": [*document["tree"], document["tree"][-1]]})
        heavier = deepcopy(document)
        heavier["network"]["weights"] = [9 * weight + 9 for weight in document["network"]["weights"]]
        heavier["claim"] = sum(heavier["network"]["weights"]) - sum(document["prices"]) // document["unit"]
        if heavier["claim"] > by_all_partitions(*stated(heavier)):
            refused(heavier)


@pytest.mark.parametrize("kind", ["listed groups", "elimination"])
def test_other_proofs_reach_the_optimum_and_no_further(kind, tmp_path):
    """Prices that are a quarter too high leave a gap; the list of groups within it, or elimination, closes it."""
    seen = set()
    for seed in range(80):
        if (made := written_by(seed, kind, tmp_path / "cuts.json")) is None:
            continue
        document, proof, truth = made
        jsonschema.validate(document, output_schema("cut-certificate"))
        refused(document | {"claim": truth + 1})
        seen.add(proof)
        if proof == "elimination":
            refused(document | {"order": document["order"][:-1]})
            refused(document | {"order": [*document["order"][:-1], document["order"][0]]})
        elif proof == "listed groups":
            refused(document | {"levels": []})
            refused(document | {"tree": document["tree"][:-1]})
            lower = deepcopy(document)
            lower["levels"][-1]["prices"] = [0] * len(document["prices"])
            if any(document["prices"]) and document["network"]["links"]:
                refused(lower | {"claim": truth + 1})
    assert kind in seen


def test_triples_have_a_price_once():
    """Three robots in a triangle: a group of two keeps a link, so a triple's price of one proves that two are cut."""
    network = {
        "robots": 3,
        "links": [[0, 1], [0, 2], [1, 2]],
        "weights": [1, 1, 1],
        "sizes": [1, 1, 1],
        "protected": [],
        "scale": 1,
        "size_scale": 1,
    }
    leaves = [{"multiplier": 0, "parts": []}]
    splits = [{"split": 0}, {"split": 1}, *leaves, {"split": 2}, *leaves, *leaves]
    tree = [*splits, {"split": 1}, {"split": 2}, *leaves, *leaves, {"split": 2}, *leaves, *leaves]
    document = {
        "format": "ratt-opt cut certificate",
        "version": 1,
        "network": network,
        "size": 2,
        "claim": 2,
        "unit": 2,
        "prices": [2, 2, 2],
        "tree": tree,
        "levels": [{"prices": [0, 0, 0], "triples": [[0, 1, 2, 2]]}],
    }
    proved = verify_cuts(document)
    assert (proved.lower, proved.proof) == (2, "listed groups")
    refused(document | {"claim": 3})
    for level in (
        {"prices": [0, 0, 0], "triples": [[0, 1, 2, 1]]},
        {"prices": [0, 0, 0], "triples": [[0, 1, 1, 2]]},
        {"prices": [0, 0, 0], "triples": [[0, 1, 2, -2]]},
        {"prices": [0, 0, -1], "triples": [[0, 1, 2, 2]]},
        {"prices": [0, 0, 0], "triples": []},
        {"prices": [0, 0], "triples": [[0, 1, 2, 2]]},
    ):
        refused(document | {"levels": [level]})


@pytest.mark.parametrize("size", [2, 3, 5, 7])
def test_counting_links_proves_complete_graphs(size, tmp_path):
    graph = nx.complete_graph(11)
    for k in [k for k in range(56) if ro.caa(11, k).n_max == size + 1][-2:]:
        found = ro.smallest_largest_group(graph, k)
        proved = ro.certify_cuts(graph, found, tmp_path / "cuts.json")
        assert (proved.proof, proved.size) == ("counting", size)
        document = json.loads((tmp_path / "cuts.json").read_text(encoding="utf-8"))
        jsonschema.validate(document, output_schema("cut-certificate"))
        refused(document | {"links_inside": document["links_inside"] - 1})
        most = ro.fewest_cuts(graph, size).upper
        assert k < proved.lower == most
        refused(document | {"claim": most + 1})


def test_smallest_sizes_of_random_networks_are_proved(tmp_path):
    kinds = set()
    for seed in range(60):
        rng = np.random.default_rng(seed)
        graph = nx.gnp_random_graph(int(rng.integers(4, 11)), float(rng.uniform(0.2, 0.9)), seed=seed)
        k = int(rng.integers(0, graph.number_of_edges() + 1))
        found = ro.smallest_largest_group(graph, k)
        if found.lower == 1:
            with pytest.raises(ro.ProofError, match="nothing to prove"):
                ro.certify_cuts(graph, found, tmp_path / "cuts.json")
            continue
        proved = ro.certify_cuts(graph, found, tmp_path / "cuts.json")
        assert (proved.size, proved.lower) >= (found.lower - 1, k + 1)
        weights = {(min(link), max(link)): 1 for link in graph.edges}
        truth = by_all_partitions(graph, weights, [1] * len(graph), found.lower - 1, [])
        assert k < proved.lower <= truth
        kinds.add(proved.proof)
    assert kinds >= {"counting", "prices"}


def between(document):
    """Weight of the links that can be cut: not between robots that protected links join."""
    network = document["network"]
    solid = nx.empty_graph(network["robots"])
    solid.add_edges_from(network["protected"])
    home = {i: k for k, group in enumerate(nx.connected_components(solid)) for i in group}
    weights = zip(network["links"], network["weights"], strict=True)
    return sum(weight for (i, j), weight in weights if home[i] != home[j])


def test_a_hundred_forged_price_vectors_are_refused(tmp_path):
    """Prices that claim more than is true, each with the tree of the honest ones."""
    rng, forged, seed = np.random.default_rng(0), 0, 0
    while forged < 110:
        seed += 1
        if (document := written(seed, tmp_path / "cuts.json")) is None:
            continue
        if "prices" not in document:
            continue
        truth = by_all_partitions(*stated(document))
        for _ in range(4):
            prices = [int(price * rng.uniform(0.0, 1.0)) for price in document["prices"]]
            claim = between(document) - sum(prices) // document["unit"]
            if claim > truth:
                refused(document | {"prices": prices, "claim": claim})
                refused(document | {"prices": prices, "claim": truth + 1})
                forged += 2


def stated(document):
    """The question that a certificate is about, for the oracle."""
    network = document["network"]
    graph = nx.empty_graph(network["robots"])
    graph.add_edges_from(map(tuple, network["links"]))
    weights = dict(zip(map(tuple, network["links"]), network["weights"], strict=True))
    return graph, weights, network["sizes"], document["size"], [tuple(link) for link in network["protected"]]


@pytest.fixture(scope="module")
def karate(tmp_path_factory):
    path = tmp_path_factory.mktemp("cuts") / "karate.json"
    graph = nx.karate_club_graph()
    ro.certify_cuts(graph, ro.fewest_cuts(graph, 8), path)
    return path


def test_every_field_counts(karate):
    document = json.loads(karate.read_text(encoding="utf-8"))
    assert verify_cuts(document).lower == 31
    leaf = next(k for k, node in enumerate(document["tree"]) if node.get("parts"))
    changes = [
        lambda d: d.update(size=d["size"] + 1),
        lambda d: d.update(unit=0),
        lambda d: d.update(unit=d["unit"] // 2),
        lambda d: d.update(prices=[-1, *d["prices"][1:]]),
        lambda d: d.update(prices=d["prices"][1:]),
        lambda d: d.update(prices=[0] * 34, claim=78),
        lambda d: d["network"].update(links=d["network"]["links"][::-1][1:]),
        lambda d: d["network"]["links"].__setitem__(0, [1, 0]),
        lambda d: d["network"]["links"].__setitem__(0, d["network"]["links"][1]),
        lambda d: d["network"]["sizes"].__setitem__(0, 0),
        lambda d: d["network"].update(protected=[[0, 1]]),
        lambda d: d["network"].update(protected=[[0, 9]]),
        lambda d: d["network"].pop("protected"),
        lambda d: d["tree"][leaf]["parts"].__setitem__(1, -1),
        lambda d: d["tree"][leaf]["parts"].__setitem__(1, 2**40),
        lambda d: d["tree"][leaf]["parts"].__setitem__(0, 78),
        lambda d: d["tree"][leaf].update(multiplier=-1),
        lambda d: d["tree"][leaf].update(multiplier=2**40),
        lambda d: d["tree"][leaf].update(further=0),
        lambda d: d["tree"][0].update(split=34),
        lambda d: d.update(further=0),
    ]
    for change in changes:
        forged = deepcopy(document)
        change(forged)
        refused(forged)


def test_the_command_reads_it(karate, tmp_path, capsys):
    assert run(["verify", str(karate)]) == 0
    assert "links of weight at least 31 must be cut" in capsys.readouterr().out
    forged = json.loads(karate.read_text(encoding="utf-8")) | {"claim": 32}
    (tmp_path / "forged.json").write_text(json.dumps(forged))
    assert run(["verify", str(tmp_path / "forged.json")]) == 1
    assert "prices prove less" in capsys.readouterr().err
    assert run(["verify", str(karate), "--explain"]) == 2


def test_prices_are_searched_if_the_answer_came_without_them(tmp_path):
    graph = nx.karate_club_graph()
    found = replace(ro.fewest_cuts(graph, 8), prices=None)
    assert ro.certify_cuts(graph, found, tmp_path / "cuts.json").lower == 31
    with pytest.raises(ro.ProofError, match="no prices"):
        ro.certify_cuts(graph, found, tmp_path / "late.json", time_limit=0)
    assert not (tmp_path / "late.json").exists()


def test_listed_groups_prove_what_prices_leave_open(tmp_path):
    graph = nx.gnp_random_graph(22, 0.35, seed=1)
    found = ro.fewest_cuts(graph, 4)
    assert found.proved_by == "listed groups"
    proved = ro.certify_cuts(graph, found, tmp_path / "cuts.json")
    assert found.by_prices < found.lower == proved.lower
    assert proved.proof == "listed groups"
    document = json.loads((tmp_path / "cuts.json").read_text(encoding="utf-8"))
    refused(document | {"claim": found.lower + 1})
    refused({name: value for name, value in document.items() if name != "levels"})


@pytest.mark.slow
def test_triples_prove_the_novel(tmp_path):
    """Les Misérables for groups of eight: prices of robots prove 107, those of triples 110."""
    graph = nx.convert_node_labels_to_integers(nx.les_miserables_graph())
    found = ro.fewest_cuts(graph, 8)
    proved = ro.certify_cuts(graph, found, tmp_path / "cuts.json")
    assert (found.by_prices, proved.lower, proved.proof) == (107, 110, "listed groups")
    document = json.loads((tmp_path / "cuts.json").read_text(encoding="utf-8"))
    assert any(level["triples"] for level in document["levels"])
    refused(document | {"levels": [level | {"triples": []} for level in document["levels"]]})
