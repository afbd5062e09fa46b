"""Upper ends by covers and by gains, of robots that see few targets: what gains claim, and each fault by its name."""

import copy
import json
from itertools import product

import numpy as np
import pytest
from flint import ctx

from ratt_opt import FileFormatError, ProofError, certify, limited_view_scenario, solve_maxmin, verify_certificate
from ratt_opt.certificates.verifier.marginals import MarginalBounds
from tests.certificates.engine import statement
from tests.strategies import sparse_problem


def test_gains_bound_every_plan():
    """No plan of what is left to robots has a group that is worth more; of one plan the bound is its value."""
    tight = 0
    for seed in range(60):
        rng = np.random.default_rng([62, seed])
        problem = sparse_problem(rng, "logdet")
        about = statement(problem, [own[0] for own in problem.choices])
        left = tuple(own[: int(rng.integers(1, len(own) + 1))] for own in about.choices)
        groups = [frozenset(np.flatnonzero(row).tolist()) for row in rng.random((2, about.n)) < 0.7]
        plans = [[plan[i] for i in group] for plan in product(*left) for group in groups]
        best = max(problem.objective(chosen) for chosen in plans)
        with ctx.workprec(128):
            bound = float(MarginalBounds(about).bound(groups, left).upper())
        assert bound >= best - 1e-12
        tight += bound <= best + 1e-9
        assert bound <= best + 1e-9 or any(len(own) > 1 for own in left)
    assert 15 <= tight < 60


@pytest.fixture(scope="module")
def documents(tmp_path_factory):
    """Proofs of one team: covers for the trace, gains for the log-det."""
    path = tmp_path_factory.mktemp("limited views") / "c.json"
    scenario = limited_view_scenario(6, 8, alpha_s=2, alpha_c=4, seed=0)
    made = {}
    for kind, leaf in (("trace", "covers"), ("logdet", "marginals")):
        problem = scenario.problem(kind)
        certify(problem, solve_maxmin(problem, gap=1e-9), path)
        made[leaf] = json.loads(path.read_text())
        assert any(leaf in node for node in made[leaf]["upper"]["tree"])
    return made


def leaf(document, name):
    return max((node for node in document["upper"]["tree"] if name in node), key=lambda node: len(json.dumps(node)))


def at_cover(document, **changes):
    document["upper"]["covers"][leaf(document, "covers")["covers"][0]].update(changes)


def blinding(document):
    document["upper"]["attacks"].append({"robots": [0], "links": []})
    at_cover(document, attack=len(document["upper"]["attacks"]) - 1)


def first_alone(document):
    node = leaf(document, "covers")
    node.update(covers=node["covers"][:1], weights=[1.0])
    at_cover(document, left_out=list(range(len(document["problem"]["owners"]))))


FAULTS = {
    ("covers", "weights are not positive"): lambda d: leaf(d, "covers").update(
        weights=[-w for w in leaf(d, "covers")["weights"]]
    ),
    ("covers", "not positive"): lambda d: leaf(d, "covers").update(covers=[], weights=[]),
    ("covers", "may meet all its covers"): first_alone,
    ("covers", "blinds robots"): blinding,
    ("covers", "more than the claim"): lambda d: at_cover(d, left_out=[]),
    ("covers", "strictly ascending"): lambda d: at_cover(d, left_out=[1, 0]),
    ("covers", "cover points must be a list of"): lambda d: at_cover(d, points=[]),
    ("covers", "leaf covers must be an integer"): lambda d: leaf(d, "covers")["covers"].__setitem__(0, 10**6),
    ("marginals", "marginal leaf must be an integer"): lambda d: leaf(d, "marginals").update(marginals=10**6),
    ("marginals", "more than the claim"): lambda d: d["claim"].update(lower=0.0, upper=0.9 * d["claim"]["upper"]),
    ("marginals", "gains diminish with the log-det alone"): lambda d: d["problem"].update(objective="trace"),
}


@pytest.mark.parametrize(("kind", "text"), FAULTS)
def test_every_fault_has_its_name(kind, text, documents, tmp_path):
    broken, path = copy.deepcopy(documents[kind]), tmp_path / "c.json"
    FAULTS[kind, text](broken)
    path.write_text(json.dumps(broken))
    with pytest.raises((ProofError, FileFormatError), match=text):
        verify_certificate(path)
