"""Bad certificates: one clear line that names the first fault."""

from __future__ import annotations

import copy
import json

import numpy as np
import pytest

from ratt_opt import FileFormatError, Problem, ProofError, TraceObjective, verify_certificate
from ratt_opt.certificates.verifier import reading
from tests.certificates.cases import certified
from tests.strategies import information_data


@pytest.fixture(scope="module")
def good(tmp_path_factory):
    rng = np.random.default_rng(1)
    prior, information = information_data(rng, 6, 2)
    problem = Problem(TraceObjective(prior, information), np.repeat(np.arange(3), 2), None, 1, 1)
    document = certified(problem, tmp_path_factory.mktemp("good") / "c.json")[1]
    assert document["lower"]["kind"] == "forced_size"
    return document


def fault(document, tmp_path, kind=ProofError):
    path = tmp_path / "c.json"
    path.write_text(document if isinstance(document, str) else json.dumps(document))
    with pytest.raises(kind) as caught:
        verify_certificate(path)
    assert len(str(caught.value).splitlines()) == 1
    return str(caught.value)


def edited(document, edit):
    mutant = copy.deepcopy(document)
    edit(mutant)
    return mutant


def first(document, name):
    return next(node for node in document["upper"]["tree"] if name in node)


FILES = {
    "complete JSON": lambda d: json.dumps(d)[:-40],
    "must be finite": lambda d: json.dumps(d).replace(repr(d["claim"]["lower"]), "NaN"),
    "must not repeat a field": lambda d: json.dumps(d).replace('"plan"', '"claim": 1, "plan"', 1),
    "must be 'ratt-opt certificate'": lambda d: json.dumps({**d, "format": "other"}),
    "version must be 1": lambda d: json.dumps({**d, "version": 2}),
    "must be a record": lambda d: json.dumps({**d, "more": 1}),
    "must not nest this deep": lambda _: "[" * 200_000,
    "format must be": lambda _: "[]",
    "must be a number": lambda d: json.dumps({**d, "claim": {"lower": None, "upper": 1.0}}),
    "must be an integer": lambda d: json.dumps({**d, "plan": [0.5, 2, 4]}),
    "must be finite; got 1e999": lambda d: json.dumps({**d, "claim": 0}).replace('"claim": 0', '"claim": 1e999'),
    "claim lower must be a number": lambda d: json.dumps({**d, "claim": {"lower": 10**60, "upper": 1.0}}),
    "claim lower": lambda d: json.dumps({**d, "claim": {"lower": True, "upper": 1.0}}),
}


@pytest.mark.parametrize("text", FILES)
def test_files_that_are_no_certificate(text, good, tmp_path):
    assert text in fault(FILES[text](good), tmp_path, FileFormatError)


def test_unreadable_and_endless_files(tmp_path, monkeypatch, good):
    with pytest.raises(FileFormatError, match="can be read"):
        verify_certificate(tmp_path / "none.json")
    with pytest.raises(FileFormatError, match="can be read"):
        verify_certificate(tmp_path)
    monkeypatch.setattr(reading, "LARGEST_FILE", 1000)
    assert "size of file must be at most 1000; got 1001" in fault(good, tmp_path, FileFormatError)


def negative_weight(d):
    leaf = first(d, "weights")
    leaf["cuts"], leaf["weights"] = leaf["cuts"] * 2, [2.0, -1.0]


PROOFS = {
    "weights are negative or all zero": negative_weight,
    "all zero": lambda d: first(d, "weights").update(weights=[0.0]),
    "branches have no leaf|a case has no leaf": lambda d: d["upper"]["tree"].pop(),
    "repeated or follows": lambda d: d["upper"]["tree"].append(first(d, "weights")),
    "do not partition": lambda d: first(d, "robot")["parts"].pop(),
    "partition its elements": lambda d: first(d, "robot")["parts"].append([0]),
    "no branch before names the parts": lambda d: first(d, "robot").pop("parts"),
    "exceeds its budget": lambda d: d["upper"]["attacks"][0].update(robots=[0, 1]),
    "lower is above upper": lambda d: d["claim"].update(lower=d["claim"]["upper"] * 2),
    "more than the claim": lambda d: d["claim"].update(lower=0.0, upper=d["claim"]["upper"] * 0.999999),
    "worth less than the claim": lambda d: d["claim"].update(lower=d["claim"]["lower"] * 1.000001, upper=1e9),
    "claim: upper is negative": lambda d: d["claim"].update(lower=-2.0, upper=-1.0),
    "shown to leave a group": lambda d: d["lower"].update(size=d["lower"]["size"] + 1),
    "lower proof: a case has no leaf": lambda d: d["lower"]["tree"].pop(),
    "lower proof: a node is repeated": lambda d: d["lower"]["tree"].append(-1),
    "no robot is missing": lambda d: d["lower"].update(tree=[0, 1, -3, -3, 1, -3, -2]),
    "a leaf is not impossible": lambda d: d["lower"].update(tree=[-2]),
    "decided twice": lambda d: d["lower"].update(tree=[0, 0, -1, -1, -1]),
    "kind must be": lambda d: d.update(lower={"kind": "trust me"}),
    "an element is not its robot's": lambda d: d.update(plan=[2, 2, 4]),
    "a weight is not positive": lambda d: d["problem"].update(weights=[1.0, -1.0]),
    "prior is not positive definite": lambda d: d["problem"]["prior"][0].__setitem__(0, -1.0),
    "not positive semidefinite": lambda d: d["problem"]["information"][0][0].__setitem__(0, -1.0),
}


@pytest.mark.parametrize("text", PROOFS)
def test_proofs_with_a_fault(text, good, tmp_path):
    message = fault(edited(good, PROOFS[text]), tmp_path)
    assert any(part in message for part in text.split("|"))


def test_a_group_that_may_lose_is_not_used(tmp_path):
    """Several groups: the bound on one of them holds only where it is the declared winner."""
    rng = np.random.default_rng(2)
    prior, information = information_data(rng, 4, 1)
    problem = Problem(TraceObjective(prior, information), np.repeat(np.arange(2), 2), None, 0, 1)
    document = certified(problem, tmp_path / "c.json")[1]
    tree = document["upper"]["tree"]
    where = next(k for k, node in enumerate(tree) if "attack" in node)
    del tree[where], tree[where + 1]  # keep the first group's leaf alone
    assert "not known to win" in fault(document, tmp_path)


def test_an_attack_tree_must_place_and_blind_by_the_rules(tmp_path, good):
    worst = good["claim"]["lower"]
    for tree, text in (
        ([-1], "attack within the budgets"),
        ([0, -1, -1], "attack within the budgets"),
        ([1, -2], "worth less"),
        ([1, 1, -2], "decided twice"),
    ):
        document = {**good, "lower": {"kind": "attack_tree", "tree": tree}, "claim": {"lower": worst, "upper": 1e9}}
        assert text in fault(document, tmp_path)
