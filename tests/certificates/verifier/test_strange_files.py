"""Short files that ask the verifier for much: it ends in time, without recursion, with a documented error."""

import json
from itertools import combinations

import pytest
from flint import fmpq

from ratt_opt import FileFormatError, ProofError, VerifierLimits, verify_certificate
from ratt_opt.certificates.verifier import duals
from ratt_opt.certificates.verifier.cases import Cases
from ratt_opt.certificates.verifier.worth import Worth
from tests.certificates.engine import UndecidedError, stated_in


def document(n, links, alpha_c, lower):
    """``n`` robots of one element each and one target; the upper end is proved, the lower one as ``lower`` says."""
    problem = {
        "objective": "trace",
        "dimension": 1,
        "prior": [[1.0]],
        "information": [[[1.0]]] * n,
        "weights": [1.0],
        "owners": list(range(n)),
        "links": [list(link) for link in links],
        "alpha_s": 0,
        "alpha_c": alpha_c,
        "protected_robots": [],
        "protected_links": [],
    }
    upper = {
        "attacks": [{"robots": [], "links": []}],
        "points": [[[0.0]]],
        "cuts": [[0, 0, 0]],
        "tree": [{"fenchel": [0], "weights": [1.0]}],
    }
    return {
        "format": "ratt-opt certificate",
        "version": 2,
        "problem": problem,
        "plan": list(range(n)),
        "claim": {"lower": 0.4, "upper": 1.0},
        "prior_eigenvalue": [],
        "upper": upper,
        "lower": lower,
    }


def cover(n, tree, partition, **more):
    """A proof with duals that are nothing."""
    duals = {"link": 1, "robots": [0] * n, "blinded": 0}
    sets = {"size": n + 1, "tree": ["budget"]}
    return {
        "conclusion": "cover",
        "sets": sets,
        "duals": duals,
        "bounds": [],
        "tree": tree,
        "partition": partition,
        **more,
    }


def refusal(tmp_path, written, kind, **limits):
    path = tmp_path / "c.json"
    path.write_text(json.dumps(written))
    with pytest.raises(kind) as caught:
        verify_certificate(path, **limits)
    assert len(str(caught.value).splitlines()) == 1
    return str(caught.value)


def every_group(n, out=()):
    """A tree that lists each set of robots."""
    if len(out) == n:
        return ["listed"]
    return [{"inside": len(out)}, *every_group(n, (*out, 0)), *every_group(n, (*out, 1))]


def test_groups_that_partition_the_team_are_no_proof(tmp_path):
    written = document(3, [(0, 1), (1, 2)], 1, cover(3, every_group(3), [0]))
    assert "partition the team" in refusal(tmp_path, written, ProofError)


def test_many_lone_robots_are_no_recursion():
    """Each of them is a listed group of its own."""
    n = 990
    about = stated_in(document(n, [], 0, None))
    found = duals.Duals(Cases(about, Worth(about, fmpq(2, 5))), {"link": 1, "robots": [0] * n, "blinded": 0})
    found._listed = {1 << i: duals.ListedGroup(1 << i, 0, 0, 0) for i in range(n)}
    with pytest.raises(ProofError, match="partition the team"):
        duals.check_partition(found, list(range(n)))
    with pytest.raises(ProofError, match="a case has no leaf"):
        duals.check_partition(found, list(range(n - 1)))


def test_the_limit_counts_in_every_loop(tmp_path):
    """Deep trees, many flows, and partitions of which there are more than anybody can look at."""
    n = 10
    links = list(combinations(range(n), 2))
    tree = every_group(n)
    listed = document(n, links, len(links), cover(n, tree, [0] * 1000))
    assert refusal(tmp_path, listed, UndecidedError, time_limit=0.01) == "not decided within 0.01 s"
    flow = {"blinding": 0, "cut": 0, "flow": [0] * len(links)}
    many = document(n, links, len(links), cover(n, tree, [0], bounds=[flow] * 20_000))
    assert refusal(tmp_path, many, UndecidedError, time_limit=0.05) == "not decided within 0.05 s"


def test_a_deep_tree_is_refused(tmp_path):
    deep = [{"blinded": 1}] * 100_000
    written = document(3, [(0, 1), (1, 2)], 1, cover(3, deep, [0]))
    assert "depth" in refusal(tmp_path, written, FileFormatError)


def test_more_groups_than_a_check_may_hold(tmp_path):
    links = list(combinations(range(8), 2))
    written = document(8, links, len(links), cover(8, every_group(8), [0]))
    assert refusal(tmp_path, written, UndecidedError, limits=VerifierLimits(listed=100)) == (
        "not decided: more than 100 groups are listed"
    )
