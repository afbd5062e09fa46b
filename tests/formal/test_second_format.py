"""The extracted checker on proofs of format 2 that are written by hand: true ones, and forged ones of false claims.

Robots have one coordinate and a unit of information each: robots S are worth 1 - 1 / (1 + |S|).
"""

import json

import numpy as np
import pytest

from tests.certificates.engine import LIMITED, small_proofs
from tests.certificates.mutants import with_lower_end
from tests.formal.verified import decisions, python_decision, sweep

PATH, TRIANGLE = [[0, 1], [1, 2]], [[0, 1], [0, 2], [1, 2]]
PAIRS = {"size": 2, "tree": ["copies"]}  # any two robots are worth 2 / 3
NOTHING = {"size": 4, "tree": ["budget"]}  # there are no four robots
STILL = {"blinding": 0, "cut": 0, "flow": [0, 0]}
BLINDED = [{"inside": 0}, {"inside": 1}, {"inside": 2}, "budget", "budget", "budget", {"flow": 0}]
"""One robot of the path 0 - 1 - 2 can be blinded. The group of robot 0 holds all of them, so two sense."""


def document(lower, links, alpha_s, alpha_c, *, claim=0.6, protected=(), n=3):
    """A certificate of version 2 whose upper end is loose."""
    return {
        "format": "ratt-opt certificate",
        "version": 2,
        "problem": {
            "objective": "trace",
            "dimension": 1,
            "prior": [[1.0]],
            "information": [[[1.0]]] * n,
            "weights": [1.0],
            "owners": list(range(n)),
            "links": links,
            "alpha_s": alpha_s,
            "alpha_c": alpha_c,
            "protected_robots": list(protected),
            "protected_links": [],
        },
        "plan": list(range(n)),
        "claim": {"lower": claim, "upper": 1.0},
        "prior_eigenvalue": [],
        "upper": {
            "attacks": [{"robots": [], "links": []}],
            "points": [[[1.0 / (1 + n)]]],
            "cuts": [[0, 0, 0]],
            "tree": [{"part": 0}, {"fenchel": [0], "weights": [1.0]}],
        },
        "lower": lower,
    }


def by_duals(tree=BLINDED, *, sets=PAIRS, robots=(1, 0, 0), link=1, blinded=0, bounds=(STILL,)):
    duals = {"link": link, "robots": list(robots), "blinded": blinded}
    return {"conclusion": "duals", "sets": sets, "duals": duals, "bounds": list(bounds), "tree": tree}


def all_groups(n, most, high):
    """A tree that decides robot after robot, and lists each group with at most so many sensing and blinded robots."""

    def below(i, sensing, blinded):
        if sensing > most or blinded > high:
            return ["budget"]
        if i == n:
            return ["listed"]
        rest = [{"inside": i}, *below(i + 1, sensing, blinded + 1), *below(i + 1, sensing, blinded)]
        return [{"sense": i}, *below(i + 1, sensing + 1, blinded), *rest]

    return below(0, 0, 0)


def by_cover(partition, *, high=0, sets=PAIRS):
    groups = by_duals(all_groups(3, 1, high), robots=(0, 0, 0), link=0, sets=sets)
    return {**groups, "conclusion": "cover", "partition": partition}


def by_sizes(trees=(), forms=(), *, sets=PAIRS):
    """Each link that leaves a group costs one, and robots are worth nothing."""
    duals = [{"link": 1, "robots": [0, 0, 0]}]
    return {
        "conclusion": "sizes",
        "sets": sets,
        "duals": duals,
        "forms": list(forms),
        "bounds": [],
        "trees": list(trees),
    }


def decided(folder, *documents):
    """What both checkers say: they accept the same."""
    paths = [folder / f"{k}.json" for k in range(len(documents))]
    for path, found in zip(paths, documents, strict=True):
        path.write_text(json.dumps(found))
    codes = decisions(paths)
    assert [code == 0 for code in codes] == [python_decision(path) == 0 for path in paths]
    return codes


def test_each_conclusion_proves_a_true_claim(tmp_path):
    forced = {"conclusion": "forced", "sets": PAIRS}
    assert decided(tmp_path, document(forced, TRIANGLE, 1, 0)) == [0]
    assert decided(tmp_path, document(by_duals(), PATH, 1, 0)) == [0]
    assert decided(tmp_path, document(by_cover([1]), PATH, 0, 1)) == [0]  # who cuts one link leaves two robots together
    assert decided(tmp_path, document({"conclusion": "enumerated"}, PATH, 0, 0)) == [3]


def test_a_proof_of_a_false_claim_is_refused(tmp_path):
    forced = {"conclusion": "forced", "sets": PAIRS}
    assert decided(tmp_path, document(forced, TRIANGLE, 2, 0)) == [1]
    assert decided(tmp_path, document(forced, PATH, 0, 1)) == [1]  # the graph is not complete
    assert decided(tmp_path, document(by_duals(), PATH, 2, 0)) == [1]
    assert decided(tmp_path, document(by_duals(), PATH, 1, 1)) == [1]
    assert decided(tmp_path, document(by_duals(), PATH, 1, 0, claim=0.7)) == [1]
    assert decided(tmp_path, document(by_cover([1]), PATH, 0, 2)) == [1]  # three groups of one robot each
    assert decided(tmp_path, document(by_cover([0, 1, 2]), PATH, 0, 2)) == [1]


def test_sizes_of_groups(tmp_path):
    """After one cut, no largest group has one robot: three groups of one lose more links than are cut."""
    assert decided(tmp_path, document(by_sizes(), PATH, 0, 1)) == [0]
    assert decided(tmp_path, document(by_sizes(), PATH, 1, 0)) == [0]
    assert decided(tmp_path, document(by_sizes([["budget"]]), PATH, 0, 1)) == [1]
    for trees in ([], [["budget"]], [["worth"]], [["copies"]], [[{"form": 0}]]):
        assert decided(tmp_path, document(by_sizes(trees), PATH, 0, 2)) == [1]
        assert decided(tmp_path, document(by_sizes(trees), PATH, 1, 1)) == [1]


def test_forms_raise_what_groups_cost(tmp_path):
    """Two robots of the path lose a link at least; by sizes alone they might lose none."""
    form = {"duals": 0, "robots": 2, "least": 1, "diagonal": [-512, -1024, 1536]}
    changes = (
        {},
        {"least": 2},
        {"diagonal": [0, 0, 0]},
        {"robots": 3},
        {"robots": 4},
        {"duals": 1},
        {"diagonal": [0, 0]},
    )
    codes = [decided(tmp_path, document(by_sizes(forms=[form | change]), PATH, 0, 1))[0] for change in changes]
    assert codes[0] == 0
    assert all(code in (1, 2) for code in codes[1:])


def test_partitions_are_used_up_exactly(tmp_path):
    for partition in ([], [0], [1, 1], [1, 0], [3], [0, 2]):
        assert decided(tmp_path, document(by_cover(partition), PATH, 0, 1)) == [1]
    for partition in ([1], [0, 1], [2, 1], [2, 0, 1]):
        assert decided(tmp_path, document(by_cover(partition), PATH, 0, 1)) == [0]


def test_branches_on_numbers(tmp_path):
    counted = [{"blinded": 2}, *BLINDED, "budget"]
    assert decided(tmp_path, document(by_duals(counted), PATH, 1, 0)) == [0]
    counted = [{"sensing": 2}, "budget", *BLINDED]
    assert decided(tmp_path, document(by_duals(counted), PATH, 1, 0)) == [0]
    swapped = [{"sensing": 2}, *BLINDED, "budget"]
    assert decided(tmp_path, document(by_duals(swapped), PATH, 1, 0)) == [1]
    for name in ("blinded", "sensing"):
        assert decided(tmp_path, document(by_duals([{name: 4}, *BLINDED, *BLINDED]), PATH, 1, 0)) == [1]


def test_copies_of_robots_inside(tmp_path):
    """All robots are in the group of robot 0 and one is blinded at most: any two of them sense."""
    copies = [*BLINDED[:3], "copies", *BLINDED[4:]]
    assert decided(tmp_path, document(by_duals(copies, sets=NOTHING), PATH, 1, 0)) == [0]
    assert decided(tmp_path, document(by_duals(copies, sets=NOTHING), PATH, 1, 0, claim=0.7)) == [1]
    assert decided(tmp_path, document(by_duals(copies, sets=NOTHING), PATH, 2, 0)) == [1]


def limited(tree, robots=(0, 1, 2), size=2, lemma=("copies",)):
    limits = [{"robots": list(robots), "size": size, "tree": list(lemma)}]
    return by_duals(tree, sets=NOTHING) | {"limits": limits}


def test_limits(tmp_path):
    """Of two or three robots any two are worth 2 / 3: with at most one that sees, a group of all has two blinded."""
    tree = [*BLINDED[:3], {"limit": 0}, *BLINDED[3:]]
    for robots in ((0, 1, 2), (0, 1), (1, 2)):
        lower = limited(tree, robots)
        blinded = 2 if len(robots) == 3 else 1  # of those of the limit
        codes = decided(tmp_path, *(document(lower, PATH, alpha_s, 0) for alpha_s in range(3)))
        assert codes == [0 if alpha_s < blinded else 1 for alpha_s in range(3)]
        assert decided(tmp_path, document(lower, PATH, 0, 0, claim=0.7)) == [1]


def test_what_is_no_limit(tmp_path):
    tree = [*BLINDED[:3], {"limit": 0}, *BLINDED[3:]]
    for changes, code in (
        ({}, 0),
        ({"size": 1}, 1),
        ({"size": 3, "lemma": ["worth"]}, 1),
        ({"size": 3}, 1),
        ({"lemma": ["budget"]}, 1),
        ({"robots": (0,)}, 1),
        ({"robots": ()}, 1),
        ({"robots": (1, 0, 2)}, 2),
        ({"robots": (0, 1, 3)}, 2),
        ({"size": 4, "lemma": ["budget"]}, 1),
    ):
        found = decided(tmp_path, document(limited(tree, **changes), PATH, 1, 0))[0]
        assert found == code, changes
    for node in ({"limit": 1}, {"limit": -1}, {"limit": 0, "sense": 0}):
        other = [*BLINDED[:3], node, *BLINDED[3:]]
        assert decided(tmp_path, document(limited(other), PATH, 1, 0))[0] in (1, 2)
    forced = {"conclusion": "forced", "sets": PAIRS, "limits": []}
    assert decided(tmp_path, document(forced, TRIANGLE, 1, 0))[0] in (1, 2)
    assert decided(tmp_path, document(by_duals() | {"limits": []}, PATH, 1, 0)) == [0]


def test_limits_that_name_others(tmp_path):
    """If any two of robots 0 and 1 are worth it, so are any three; and not one."""
    tree, pair = [*BLINDED[:3], {"limit": 1}, *BLINDED[3:]], {"robots": [0, 1], "size": 2, "tree": ["copies"]}
    for lemma, size, code in (
        ([{"limit": 0}, "budget"], 3, 0),
        ([{"limit": 0}, "budget"], 2, 1),
        ([{"limit": 0}, "copies"], 2, 0),
        ([{"sense": 2}, "copies", {"limit": 0}, "budget"], 2, 0),
        ([{"sense": 2}, {"limit": 0}, "budget", "copies"], 2, 1),
        ([{"limit": 1}, "copies"], 2, 1),
        ([{"limit": 2}, "copies"], 2, 1),
    ):
        lower = limited(tree, size=size, lemma=lemma)
        lower["limits"] = [pair, *lower["limits"]]
        found = decided(tmp_path, document(lower, PATH, 1 if size == 2 else 0, 0))[0]
        assert found == code, (lemma, size)
        if code == 0:
            lower["limits"].reverse()
            names_later = any("limit" in node for node in lemma)
            assert decided(tmp_path, document(lower, PATH, 0, 0)) == [1 if names_later else 0]
    forward = {"size": 2, "tree": [{"limit": 0}, "copies"]}
    assert decided(tmp_path, document(limited(tree) | {"sets": forward}, PATH, 1, 0)) == [1]


def test_real_limits_are_decided_alike(tmp_path):
    def documents():
        for proof in small_proofs("cover", LIMITED):
            yield np.random.default_rng(54), with_lower_end(*proof, tmp_path / "base.json")

    paths = []
    for k, (_, written) in enumerate(documents()):
        paths.append(tmp_path / f"limits{k}.json")
        paths[-1].write_text(json.dumps(written))
    assert decisions(paths) == [python_decision(path) for path in paths] == [0] * len(LIMITED)
    found, seen, _ = sweep(tmp_path, documents(), 0.1, ("lower",))
    assert not found
    assert seen >= 100


def test_links_say_nothing_about_sets_of_robots(tmp_path):
    """A robot that is not one of the set may still be in the group: budgets of links close no case of a set."""
    torn = [{"sense": 0}, {"sense": 1}, {"sense": 2}, "budget", "budget", "budget", {"sense": 1}, "budget", "budget"]
    forced = {"conclusion": "forced", "sets": {"size": 2, "tree": torn}}
    assert decided(tmp_path, document(forced, TRIANGLE, 1, 0, claim=0.99)) == [1]


def test_blinded_robots_may_be_outside_of_those_known(tmp_path):
    """Robot 0 is inside, robot 1 blinded or out, one is blinded: if robot 0 senses, {0, 1} costs -1."""
    tree = [{"sense": 1}, "worth", {"inside": 0}, {"blinded": 1}, "copies", {"flow": 0}, {"flow": 0}]
    nothing, still = {"size": 3, "tree": ["budget"]}, {**STILL, "flow": [0]}
    lower = by_duals(tree, sets=nothing, robots=(0, 2), blinded=1, bounds=[still])
    assert decided(tmp_path, document(lower, [[0, 1]], 1, 0, claim=0.5, n=2)) == [1]


NO_NODES = ("sense", {"worth": 0}, {"form": 0}, {"sense": 3}, {"flow": 1}, {"flow": 0, "sense": 0}, 0, None)


@pytest.mark.parametrize("node", NO_NODES)
def test_nodes_that_are_none(tmp_path, node):
    tree = [*BLINDED[:-1], node]
    assert decided(tmp_path, document(by_duals(tree), PATH, 1, 0))[0] in (1, 2)


def test_what_a_flow_may_carry(tmp_path):
    for flow, cut, code in (([1, -1], 0, 0), ([2, 0], 0, 1), ([2, 0], 1, 0), ([-2, 0], 0, 1), ([0], 0, 2)):
        lower = by_duals(bounds=[{"blinding": 0, "cut": cut, "flow": flow}])
        assert decided(tmp_path, document(lower, PATH, 1, 0)) == [code]


def test_versions_have_their_own_words(tmp_path):
    second = document(by_duals(), PATH, 1, 0)
    assert decided(tmp_path, {**second, "version": 1}, {**second, "version": 3}) == [2, 2]
    upper = {**second["upper"], "tree": [{"attack": 0}, {"cuts": [0], "weights": [1.0]}]}
    assert decided(tmp_path, {**second, "upper": upper})[0] in (1, 2)
