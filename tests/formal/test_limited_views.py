"""The extracted checker and the Python verifier on upper ends by covers and by gains, where robots see few targets."""

import json

import numpy as np
import pytest

from ratt_opt import InputError, certify, limited_view_scenario, solve_maxmin
from tests.certificates.mutants import changed
from tests.formal.verified import bases, decisions, disagreements, python_decision, sweep
from tests.solvers.maxmin.engine import COVERS_ALONE, MARGINALS_ALONE
from tests.strategies import sparse_problem
from tests.ways import go

BUDGETS = {6: (8, 2, 4), 10: (10, 3, 8)}
"""Targets, robots blinded and links cut of teams of limited views."""
WAYS = {"covers": (COVERS_ALONE, ("trace", "logdet")), "marginals": (MARGINALS_ALONE, ("logdet",))}
"""How the search goes and the criteria, by what the leaves of the proof are."""
MUTATED = ("problem", "claim", "upper")


def proved_by(leaves, problem, path, **options):
    """The certificate of the search's answer; nothing where its proof has no such leaves."""
    try:
        certify(problem, solve_maxmin(problem, **options), path)
    except InputError:  # its values are too small for the arithmetic of the lower end
        return None
    document = json.loads(path.read_text())
    return document if any(leaves in node for node in document["upper"].get("tree", ())) else None


def limited_view(kind, robots, seed, path):
    targets, alpha_s, alpha_c = BUDGETS[robots]
    scenario = limited_view_scenario(robots, targets, alpha_s=alpha_s, alpha_c=alpha_c, seed=seed)
    return proved_by("covers" if kind == "trace" else "marginals", scenario.problem(kind), path, gap=1e-9)


def sparse_documents(leaves, folder, seeds):
    kinds = WAYS[leaves][1]
    for seed in seeds:
        rng = np.random.default_rng([49, seed])
        document = proved_by(leaves, sparse_problem(rng, kinds[seed % len(kinds)]), folder / "base.json")
        if document is not None:
            yield rng, document


LIMITED_VIEWS = [("trace", 6, range(6)), ("logdet", 6, range(6)), ("trace", 10, range(1)), ("logdet", 10, range(1, 2))]


@pytest.mark.parametrize(("kind", "robots", "seeds"), LIMITED_VIEWS)
def test_limited_views_are_proved_by_both(kind, robots, seeds, tmp_path):
    paths = [tmp_path / f"{seed}.json" for seed in seeds]
    written = [path for seed, path in zip(seeds, paths, strict=True) if limited_view(kind, robots, seed, path)]
    assert len(written) > len(paths) // 2
    assert decisions(written) == [python_decision(path) for path in written] == [0] * len(written)


def test_forged_covers_are_refused_by_both(tmp_path):
    document = limited_view("trace", 6, 0, tmp_path / "c.json")
    upper, whole = document["upper"], list(range(len(document["problem"]["owners"])))
    leaf = next(k for k, node in enumerate(upper["tree"]) if "covers" in node)
    weights = upper["tree"][leaf]["weights"]
    places_and_lies = [
        *((("upper", "covers", k, "left_out"), whole) for k in range(len(upper["covers"]))),
        *((("upper", "tree", leaf, "weights"), [factor * w for w in weights]) for factor in (0.0, -1.0)),
        *((("problem", "alpha_s"), fewer) for fewer in range(document["problem"]["alpha_s"])),
        (("claim", "upper"), document["claim"]["upper"] * (1 - 1e-9)),
        (("upper", "attacks", 0, "robots"), [0]),
    ]
    found, accepted = disagreements(tmp_path, ((at, changed(document, at, new)) for at, new in places_and_lies))
    assert not found
    assert not accepted


def test_covers_that_leave_one_element_less_out_are_decided_alike(tmp_path):
    """Most are refused; some are true, as leaves and levels have a little to spare."""
    document = limited_view("trace", 6, 0, tmp_path / "c.json")
    covers, rng = document["upper"]["covers"], np.random.default_rng(50)
    pairs = [(k, e) for k, cover in enumerate(covers) for e in cover["left_out"]]
    forged = [
        ((k, e), changed(document, ("upper", "covers", k, "left_out"), [x for x in covers[k]["left_out"] if x != e]))
        for k, e in rng.choice(pairs, 40, replace=False).tolist()
    ]
    found, accepted = disagreements(tmp_path, forged)
    assert not found
    assert accepted < len(forged) // 2


def test_forged_gains_are_refused_by_both(tmp_path):
    document = limited_view("logdet", 6, 0, tmp_path / "c.json")
    upper, claim = document["upper"], document["claim"]
    leaf = next(k for k, node in enumerate(upper["tree"]) if "marginals" in node)
    untouched = [{"robots": [], "links": []} for _ in upper["attacks"]]
    places_and_lies = [
        (("upper", "attacks"), untouched),
        (("claim", "upper"), claim["lower"] * (1 - 1e-9)),
        (("problem", "objective"), "trace"),
        (("upper", "tree"), [{"marginals": 0}]),
        (("upper", "tree", leaf, "marginals"), len(upper["attacks"])),
        (("problem", "alpha_s"), 0),
    ]
    found, accepted = disagreements(tmp_path, ((at, changed(document, at, new)) for at, new in places_and_lies))
    assert not found
    assert not accepted


@pytest.mark.parametrize("leaves", WAYS)
def test_mutations_are_decided_alike(leaves, monkeypatch, tmp_path):
    go(monkeypatch, WAYS[leaves][0])
    found, seen, accepted = sweep(tmp_path, sparse_documents(leaves, tmp_path, range(16)), 0.05, MUTATED)
    assert not found
    assert seen >= 200
    assert accepted >= 20


@pytest.mark.slow
@pytest.mark.parametrize("leaves", WAYS)
def test_five_thousand_mutations_are_decided_alike(leaves, monkeypatch, tmp_path):
    go(monkeypatch, WAYS[leaves][0])
    found, seen, _ = sweep(tmp_path, sparse_documents(leaves, tmp_path, range(100, 170)), 0.25, MUTATED)
    assert not found
    assert seen >= 5_000


def test_the_last_part_may_be_left_out_where_there_are_covers(tmp_path):
    document = next(document for _, document in bases(tmp_path, range(3)))
    document["upper"]["tree"] = [
        {**node, "parts": node["parts"][:-1]} if "parts" in node else node for node in document["upper"]["tree"]
    ]
    for covers, codes in (({"covers": []}, (0,)), ({}, (1, 2))):
        path = tmp_path / "c.json"
        path.write_text(json.dumps({**document, "upper": document["upper"] | covers}))
        assert decisions([path]) == [python_decision(path)]
        assert decisions([path])[0] in codes
