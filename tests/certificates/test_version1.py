"""Certificates of format 1 are verified as they were; the files are of that time, one or two of each kind."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from ratt_opt import FileFormatError, ProofError, verify_certificate
from tests.certificates.mutants import accepted, changed, is_false, places, refused

FILES = sorted((Path(__file__).parent / "version1").glob("*.json"))
KINDS = {"all_groups", "attack_tree", "forced_size", "group_covers", "group_prices", "group_sizes"}


def test_every_kind_is_there():
    assert {json.loads(file.read_text())["lower"]["kind"] for file in FILES} == KINDS


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_they_are_verified_and_no_false_claim_is(file, tmp_path):
    document = json.loads(file.read_text())
    verified = verify_certificate(file)
    assert verified.lower_proved
    assert verified.lower_method == document["lower"]["kind"]
    assert not is_false(document)
    lie = changed(document, ("claim", "lower"), document["claim"]["lower"] * (1 + 1e-5))
    lie["claim"]["upper"] = max(lie["claim"]["upper"], 2 * lie["claim"]["lower"])
    assert is_false(lie)
    part = {"lower": document["lower"]}
    share = min(1.0, 60 / len(list(places(part))))
    assert refused(lie, part, np.random.default_rng(53), share, tmp_path / "mutant.json") >= 20


def test_neither_version_reads_the_other_one_s_nodes(tmp_path):
    path = tmp_path / "mutant.json"
    for file in FILES:
        document = json.loads(file.read_text())
        assert not accepted(document | {"version": 2}, path)
        tree = document["upper"]["tree"]
        names = {"cuts": "fenchel", "attack": "part", "robot": "element"}
        for k, node in enumerate(tree):
            tree[k] = {names.get(name, name): value for name, value in node.items()}
        path.write_text(json.dumps(document))
        with pytest.raises((ProofError, FileFormatError)):
            verify_certificate(path)
