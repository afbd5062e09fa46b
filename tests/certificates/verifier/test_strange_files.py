"""Short files that ask the verifier for much: it ends in time, without recursion, with a documented error."""

from __future__ import annotations

import json
from itertools import combinations

import pytest

from ratt_opt import FileFormatError, ProofError, verify_certificate
from ratt_opt.certificates.verifier.lower_end import partitions
from tests.certificates.engine import UndecidedError, check, stated_in


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
        "tree": [{"cuts": [0], "weights": [1.0]}],
    }
    return {
        "format": "ratt-opt certificate",
        "version": 1,
        "problem": problem,
        "plan": list(range(n)),
        "claim": {"lower": 0.4, "upper": 1.0},
        "prior_eigenvalue": [],
        "upper": upper,
        "lower": lower,
    }


def prices(kind, robots, **more):
    return {"kind": kind, "half_link": 1, "robots": robots, "blinded": 0, "group": 0, "sets": [], "triples": [], **more}


def refusal(tmp_path, written, kind, **limits):
    path = tmp_path / "c.json"
    path.write_text(json.dumps(written))
    with pytest.raises(kind) as caught:
        verify_certificate(path, **limits)
    assert len(str(caught.value).splitlines()) == 1
    return str(caught.value)


@pytest.mark.parametrize("robots", [[0, 0, -5], [0, 0, 0], [1, 1, 1]])
def test_flows_without_sets(robots, tmp_path):
    """A cover is looked for without the bounds that flows give for sets: these claims have no proof."""
    tree = [0, 1, 2, -1, -1, 2, -1, -1, 1, 2, -1, -1, 2, -1, -1]
    lower = prices("group_covers", robots, flows=[[0, 0]], tree=tree)
    assert refusal(tmp_path, document(3, [(0, 1), (1, 2)], 1, lower), (ProofError, FileFormatError))


def test_many_lone_robots_are_no_recursion():
    written = document(990, [], 0, prices("all_groups", [0] * 990))
    with pytest.raises(ProofError, match="cover the team"):
        check(stated_in(written), written["lower"], 0.4)


def test_the_limit_counts_while_groups_are_listed_and_ordered(tmp_path):
    """Of 16 robots there are 65,535 groups; ordering them took minutes in which nobody looked at the clock."""
    few, many = (list(combinations(range(n), 2)) for n in (11, 16))
    assert "cover the team" in refusal(tmp_path, document(11, few, 55, prices("all_groups", [0] * 11)), ProofError)
    text = refusal(tmp_path, document(16, many, 120, prices("all_groups", [0] * 16)), UndecidedError, time_limit=0.2)
    assert text == "not decided within 0.2 s"


def test_more_groups_than_a_check_may_hold(tmp_path, monkeypatch):
    monkeypatch.setattr(partitions, "MOST_LISTED", 100)
    links = list(combinations(range(8), 2))
    text = refusal(tmp_path, document(8, links, len(links), prices("all_groups", [0] * 8)), UndecidedError)
    assert text == "not decided: more than 100 groups are within the budgets"
