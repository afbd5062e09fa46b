"""Lemmas of single targets, rows and spaced values: the extracted checker and the Python verifier decide alike."""

import json
import subprocess

import numpy as np
import pytest

from ratt_opt import CertificateParams
from tests.certificates import lemmas
from tests.certificates.mutants import changed, places, variants
from tests.formal.verified import decisions, python_decision, ratt_check, sweep
from tests.strategies import random_problem

NAMES = ("tangents", "lemmas", "usual", "rows", "spacing")


def bases(folder, seeds, params=None):
    """Certificates by rows: traces and log-dets with lemmas, and coverage with spaced values; of small teams."""
    for seed in seeds:
        rng = np.random.default_rng([68, seed])
        if seed % 3 == 2:
            problem = lemmas.covering(rng, robots=2, targets=3)
            proof = lemmas.spaced(problem)
        else:
            problem = random_problem(rng, 3, kind=["trace", "logdet"][seed % 3], controls=2, complete=True)
            proof = lemmas.by_rows(problem, rng)
        written, document = lemmas.certified_by_rows(
            problem, proof, folder / "base.json", params or CertificateParams()
        )
        if written.verified.lower > 1e-3 and document["upper"].get("lemmas"):
            yield rng, document


def test_lemmas_rows_and_spaced_values_are_accepted_by_both(tmp_path):
    paths = []
    for k, (_, document) in enumerate(bases(tmp_path, range(9))):
        paths.append(tmp_path / f"{k}.json")
        paths[-1].write_text(json.dumps(document))
    assert len(paths) >= 5
    assert decisions(paths) == [0] * len(paths) == [python_decision(path) for path in paths]


def test_no_forged_lemma_row_or_spacing_is_accepted_by_either(tmp_path):
    paths, seen = [], 0
    for rng, document in bases(tmp_path, range(9)):
        spaced = "spacing" in document["upper"]
        lie = changed(document, ("claim", "upper"), document["claim"]["upper"] * (1 - (1e-2 if spaced else 1e-5)))
        lie["claim"]["lower"] = 0.0
        part = {"upper": {name: lie["upper"][name] for name in NAMES if name in lie["upper"]}}
        for at, value in places(part):
            for new in variants(value, rng):
                if new != value and rng.random() < 0.05:
                    paths.append(tmp_path / f"{seen}.json")
                    paths[-1].write_text(json.dumps(changed(lie, at, new)))
                    seen += 1
    assert seen >= 100
    assert not {0, 3} & set(decisions(paths))
    assert not {0, 3} & {python_decision(path) for path in paths}


@pytest.mark.slow
def test_thousands_of_mutations_of_lemmas_are_decided_alike(tmp_path):
    found, seen, _ = sweep(tmp_path, bases(tmp_path, range(30)), 0.2)
    assert not found
    assert seen >= 2_000


def test_spaced_log_determinants_are_refused_in_one_line(tmp_path):
    """The extracted checker knows the spacing of values for the trace only."""
    document = changed(next(iter(bases(tmp_path, [1])))[1], ("upper", "spacing"), {"count": 0, "lemmas": []})
    path = tmp_path / "spaced.json"
    path.write_text(json.dumps(document))
    done = subprocess.run([ratt_check(), str(path)], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout.count("\n")) == (1, 1)
    assert "reads the spacing of values for the trace only" in done.stdout


def test_base_sets_are_read_alike(tmp_path):
    """Leaves that gains beside a base set bound, for the log-det: files, and forged ones."""
    paths, based = [], 0
    for _, document in bases(tmp_path, range(10, 19, 3), lemmas.BASES):
        nodes = [node for lemma in document["upper"]["lemmas"] for node in lemma["tree"]]
        based += any(isinstance(node, dict) and "base" in node for node in nodes)
        paths.append(tmp_path / f"true{len(paths)}.json")
        paths[-1].write_text(json.dumps(document))
    assert based
    assert decisions(paths) == [0] * len(paths) == [python_decision(path) for path in paths]
    found, seen, _ = sweep(tmp_path, bases(tmp_path, range(10, 19, 3), lemmas.BASES), 0.02)
    assert not found
    assert seen >= 20
