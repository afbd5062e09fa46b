"""Bad certificates: one clear line that names the first fault."""

import copy
import json

import numpy as np
import pytest

from ratt_opt import FileFormatError, Problem, ProofError, TraceObjective, VerifierLimits, verify_certificate
from tests.certificates.cases import certified
from tests.strategies import information_data


@pytest.fixture(scope="module")
def good(tmp_path_factory):
    rng = np.random.default_rng(1)
    prior, information = information_data(rng, 6, 2)
    problem = Problem(TraceObjective(prior, information), np.repeat(np.arange(3), 2), None, 1, 1)
    document = certified(problem, tmp_path_factory.mktemp("good") / "c.json")[1]
    assert document["lower"]["conclusion"] == "forced"
    return document


def fault(document, tmp_path, kind=ProofError, **limits):
    path = tmp_path / "c.json"
    path.write_text(document if isinstance(document, str) else json.dumps(document))
    with pytest.raises(kind) as caught:
        verify_certificate(path, limits=VerifierLimits(**limits))
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
    "version must be 2: write": lambda d: json.dumps({**d, "version": 1}),
    "must be a record": lambda d: json.dumps({**d, "more": 1}),
    "must not nest this deep": lambda _: "[" * 200_000,
    "format must be": lambda _: "[]",
    "must be a number": lambda d: json.dumps({**d, "claim": {"lower": None, "upper": 1.0}}),
    "must be an integer": lambda d: json.dumps({**d, "plan": [0.5, 2, 4]}),
    "finite; got the number 1e999": lambda d: json.dumps({**d, "claim": 0}).replace('"claim": 0', '"claim": 1e999'),
    "claim lower must be a number": lambda d: json.dumps({**d, "claim": {"lower": 10**60, "upper": 1.0}}),
    "claim lower": lambda d: json.dumps({**d, "claim": {"lower": True, "upper": 1.0}}),
}


@pytest.mark.parametrize("text", FILES)
def test_files_that_are_no_certificate(text, good, tmp_path):
    assert text in fault(FILES[text](good), tmp_path, FileFormatError)


def test_unreadable_and_endless_files(tmp_path, good):
    with pytest.raises(FileFormatError, match="can be read"):
        verify_certificate(tmp_path / "none.json")
    with pytest.raises(FileFormatError, match="can be read"):
        verify_certificate(tmp_path)
    assert "size of file must be at most 1000; got 1001" in fault(good, tmp_path, FileFormatError, file=1000)


def negative_weight(d):
    leaf = first(d, "weights")
    leaf["fenchel"], leaf["weights"] = leaf["fenchel"] * 2, [2.0, -1.0]


def tree(d):
    return d["lower"]["sets"]["tree"]


PROOFS = {
    "weights are negative or all zero": negative_weight,
    "all zero": lambda d: first(d, "weights").update(weights=[0.0]),
    "branches have no leaf|a case has no leaf": lambda d: d["upper"]["tree"].pop(),
    "repeated or follows": lambda d: d["upper"]["tree"].append(first(d, "weights")),
    "do not partition": lambda d: first(d, "element")["parts"].pop(),
    "partition its elements": lambda d: first(d, "element")["parts"].append([0]),
    "no branch before names the parts": lambda d: first(d, "element").pop("parts"),
    "exceeds its budget": lambda d: d["upper"]["attacks"][0].update(robots=[0, 1]),
    "lower is above upper": lambda d: d["claim"].update(lower=d["claim"]["upper"] * 2),
    "more than the claim": lambda d: d["claim"].update(lower=0.0, upper=d["claim"]["upper"] * 0.999999),
    "worth less than the claim": lambda d: d["claim"].update(lower=d["claim"]["lower"] * 1.000001, upper=1e9),
    "claim: upper is negative": lambda d: d["claim"].update(lower=-2.0, upper=-1.0),
    "shown to leave a group": lambda d: d["lower"].update(sets={"size": 4, "tree": ["budget"]}),
    "lower proof: a case has no leaf": lambda d: tree(d).pop(),
    "lower proof: a node is repeated": lambda d: tree(d).append("worth"),
    "no robot is missing": lambda d: tree(d).__setitem__(slice(None), [{"sense": 0}, {"sense": 1}, "copies"]),
    "may have robots enough": lambda d: tree(d).__setitem__(slice(None), ["budget"]),
    "decided twice": lambda d: tree(d).__setitem__(slice(None), [{"sense": 0}, {"sense": 0}]),
    "none of this proof: flow": lambda d: tree(d).__setitem__(slice(None), [{"flow": 0}]),
    "not as worth must be": lambda d: tree(d).__setitem__(slice(None), [{"worth": 0}]),
    "not as sense must be": lambda d: tree(d).__setitem__(slice(None), ["sense"]),
    "a record of one": lambda d: tree(d).__setitem__(slice(None), [{"sense": 0, "inside": 0}]),
    "conclusion must be": lambda d: d.update(lower={"conclusion": "trust me"}),
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
    where = next(k for k, node in enumerate(tree) if "part" in node)
    del tree[where], tree[where + 1]  # keep the first group's leaf alone
    assert "not known to win" in fault(document, tmp_path)


def test_conclusions_of_other_kinds_keep_their_rules(tmp_path, good):
    """Of duals and covers: what each demands of its fields, by the first thing that is wrong."""
    sets = {"size": 4, "tree": ["budget"]}
    duals = {"link": 1, "robots": [0, 0, 0], "blinded": 0}
    flow = {"blinding": 0, "cut": 0, "flow": [0, 0, 0]}
    for more, text in (
        ({"conclusion": "duals"}, "more than the budgets is wrong"),
        ({"conclusion": "cover", "partition": [0]}, "cost too little"),
        ({"conclusion": "cover", "partition": [0], "duals": duals | {"robots": [9, 9, 9]}}, "budgets is wrong"),
        ({"conclusion": "cover", "partition": [0], "bounds": [flow | {"flow": [2, 0, 0]}]}, "exceeds what a link may"),
        ({"conclusion": "cover", "partition": [0], "tree": ["listed"]}, "is not decided"),
        ({"conclusion": "cover", "partition": [0], "tree": [{"blinded": 1}, "copies"]}, "no robot is missing"),
        (
            {"conclusion": "cover", "partition": [0], "tree": whole([])},
            "partition proof: a case has no leaf|partition the team",
        ),
        ({"conclusion": "cover", "partition": [0, 0], "tree": whole([])}, "has its group already|partition the team"),
    ):
        lower = {"sets": sets, "duals": duals, "bounds": [flow], "tree": [{"flow": 0}]} | more
        message = fault({**good, "lower": lower, "claim": good["claim"] | {"upper": 1e9}}, tmp_path)
        assert any(part in message for part in text.split("|")), message


def test_limits_keep_their_rules(tmp_path, good):
    limit, lower = {"robots": [0, 1], "size": 2, "tree": ["budget"]}, good["lower"]
    duals = {"link": 0, "robots": [1, 0, 0], "blinded": 0}
    proof = {"conclusion": "duals", "sets": {"size": 4, "tree": ["budget"]}, "duals": duals, "bounds": []}
    tree = [{"limit": 0}, "budget"]
    for changes, kind, text in (
        (lower | {"limits": []}, FileFormatError, "lower proof must be a record of conclusion, sets; got"),
        ({"limits": 0}, FileFormatError, "limits must be a list"),
        ({"limits": [limit | {"robots": [1, 0]}]}, FileFormatError, "limit robots must be strictly ascending"),
        ({"limits": [limit | {"robots": [3]}]}, FileFormatError, "limit robots must be an integer in [0, 2]"),
        ({"limits": [limit | {"size": -1}]}, FileFormatError, "limit size must be an integer in [0, 4]"),
        ({"limits": [limit | {"most": 1}]}, FileFormatError, "limit must be a record of robots, size, tree"),
        ({"limits": [limit]}, ProofError, "may have robots enough"),
        ({"limits": [limit | {"tree": [{"sense": 2}, "budget", "budget"]}]}, ProofError, "is decided twice"),
        ({"limits": [limit | {"tree": [{"inside": 0}, "budget", "budget"]}]}, ProofError, "is none of this proof"),
        ({"limits": [limit | {"tree": tree}]}, FileFormatError, "lower tree limit must be an integer in"),
        ({"sets": {"size": 4, "tree": tree}, "limits": []}, FileFormatError, "lower tree limit must be an integer in"),
        ({"limits": []}, FileFormatError, "lower tree limit must be an integer in"),
        ({}, FileFormatError, "lower tree limit must be an integer in"),
    ):
        part = changes if "conclusion" in changes else {**proof, "tree": tree, **changes}
        message = fault({**good, "lower": part, "claim": good["claim"] | {"upper": 1e9}}, tmp_path, kind)
        assert text in message, message


def whole(out):
    """A tree that lists every group of three robots."""
    robot = len(out)
    return ["listed"] if robot == 3 else [{"inside": robot}, *whole([*out, 0]), *whole([*out, 1])]
