"""Certificates of tiny teams before a second checker that knows only the file format, and forged ones."""

import copy
import json

import networkx as nx
import numpy as np
import pytest

from ratt_opt import Problem, TraceObjective, certify, solve_maxmin, verify_certificate
from tests.certificates.independent_checker import RefusedError, check
from tests.strategies import random_problem


def certificate(seed, folder):
    """Write and read the certificate of a random tiny team, every third on a complete graph."""
    rng = np.random.default_rng([62, seed])
    problem = random_problem(rng, int(rng.integers(2, 6)), kind="trace", controls=2, complete=seed % 3 == 0)
    written = certify(problem, solve_maxmin(problem), folder / f"{seed}.json")
    return written.path, json.loads(written.path.read_text(encoding="utf-8"))


def test_proofs_by_covers_are_accepted_too(tmp_path):
    """Each element tells of two of four targets."""
    covers = 0
    for seed in range(12):
        rng = np.random.default_rng([62, 1, seed])
        information = np.zeros((15, 4, 1, 1))
        for element in range(15):
            information[element, rng.choice(4, 2, replace=False), 0, 0] = rng.integers(1, 6, 2)
        graph = nx.gnp_random_graph(5, 0.7, seed=seed)
        graph.add_edges_from(zip(range(4), range(1, 5), strict=True))
        objective = TraceObjective(prior=np.full((4, 1, 1), 2.0), information=information)
        problem = Problem(objective, np.repeat(range(5), 3), graph, 1, 2)
        file = certify(problem, solve_maxmin(problem), tmp_path / "c.json").path
        document = json.loads(file.read_text(encoding="utf-8"))
        assert check(document)[0] == 3**5
        if any("covers" in node for node in document["upper"]["tree"]):
            covers += 1
            attack = document["upper"]["attacks"][document["upper"]["covers"][0]["attack"]]
            attack["robots"] = [0]  # one robot is blinded here, another by the cover
            with pytest.raises(RefusedError):
                check(document)
    assert covers > 3


def test_the_second_checker_accepts_what_the_verifier_accepts(tmp_path):
    conclusions, plans, groups = set(), 0, 0
    for seed in range(24):
        path, document = certificate(seed, tmp_path)
        verified = verify_certificate(path)
        if not verified.lower_proved:
            continue
        walked = check(document)
        plans, groups = plans + walked[0], groups + walked[1]
        conclusions.add(document["lower"]["conclusion"])
    assert {"forced", "duals"} <= conclusions
    assert plans > 100
    assert groups > 50


def forged(document):
    """Yield certificates of something false, by what was done to each."""
    claim = document["claim"]
    yield "lower", {**document, "claim": {**claim, "lower": 1.02 * claim["upper"] + 0.01}}
    yield "upper", {**document, "claim": {**claim, "upper": 0.98 * claim["lower"] - 0.01}}
    false = copy.deepcopy(document)
    for point in false["upper"]["points"]:
        point[0] = [2 * x for x in point[0]]
    yield "points", false
    for budget in ("alpha_s", "alpha_c"):
        false = copy.deepcopy(document)
        false["problem"][budget] += 1
        yield budget, false
    false = copy.deepcopy(document)
    false["upper"]["tree"] = false["upper"]["tree"][:-1]
    yield "tree", false
    yield "rows", {**document, "upper": {**document["upper"], "rows": []}}
    yield "at_most", {**document, "problem": {**document["problem"], "at_most": {}}}


def test_the_second_checker_has_teeth(tmp_path):
    refused = {}
    for seed in range(12):
        _, document = certificate(seed, tmp_path)
        if document["lower"]["conclusion"] == "enumerated":
            continue
        for what, false in forged(document):
            try:
                check(false)
            except RefusedError:
                refused.setdefault(what, []).append(seed)
            else:
                assert what in ("alpha_s", "alpha_c", "points"), f"{what} of seed {seed} was accepted"
    assert {"lower", "upper", "tree", "alpha_s", "alpha_c", "points", "rows", "at_most"} <= set(refused)


def test_an_enumerated_lower_end_is_no_proof(tmp_path):
    _, document = certificate(0, tmp_path)
    with pytest.raises(RefusedError, match="not proved"):
        check({**document, "lower": {"conclusion": "enumerated"}})
