"""The checker extracted from its Coq proof and the Python verifier decide alike: certificates and mutations of them.

Kinds of refusal (a fault, no certificate) may differ; acceptance, and of which ends, may not.
"""

import json

import numpy as np
import pytest

from tests.certificates.cases import certified
from tests.formal.verified import KINDS, bases, decisions, python_decision, sweep
from tests.strategies import random_problem


def test_certificates_are_accepted_by_both(tmp_path):
    for seed in range(24):
        rng = np.random.default_rng([48, seed])
        problem = random_problem(rng, int(rng.integers(1, 5)), kind=KINDS[seed % 3], controls=2)
        path = tmp_path / f"{seed}.json"
        certified(problem, path)
        assert decisions([path]) == [python_decision(path)]


def test_what_a_certificate_was_made_from_is_read_alike(tmp_path):
    digest, path = "0123456789abcdef" * 4, tmp_path / "c.json"
    _, document = next(bases(tmp_path, range(3)))
    for made_from, code in ((digest, 0), (None, 2), ("", 2), (digest[1:], 2), (digest[1:] + "G", 2), ([digest], 2)):
        path.write_text(json.dumps(document | {"made_from": made_from}))
        assert decisions([path]) == [python_decision(path)] == [code]


def test_a_raised_claim_is_refused(tmp_path):
    path = tmp_path / "lie.json"
    for _, document in bases(tmp_path, range(9)):
        for side, factor in (("upper", 1 - 1e-9), ("lower", 1 + 1e-9)):
            lie = json.loads(json.dumps(document))
            lie["claim"][side] *= factor
            other = "lower" if side == "upper" else "upper"
            lie["claim"][other] = 0.0 if other == "lower" else document["claim"]["upper"] * 2
            path.write_text(json.dumps(lie))
            assert decisions([path]) == [1]


def test_mutations_are_decided_alike(tmp_path):
    found, seen, accepted = sweep(tmp_path, bases(tmp_path, range(4)), 0.12)
    assert not found
    assert seen >= 200
    assert accepted >= 20  # mutations that leave the claim proved, such as a larger upper end


@pytest.mark.slow
def test_ten_thousand_mutations_are_decided_alike(tmp_path):
    found, seen, _ = sweep(tmp_path, bases(tmp_path, range(12, 60)), 0.25)
    assert not found
    assert seen >= 10_000
