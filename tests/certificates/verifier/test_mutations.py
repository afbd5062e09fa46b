"""A corrupted certificate is never believed: no mutant whose claim is false is accepted.

Truth is decided without the verifier: the mutated problem is rebuilt, its optimum found by the exhaustive search
and the plan's worst case by trying every raw attack.
"""

import json

import numpy as np
import pytest

from ratt_opt import (
    certify,
    limited_view_scenario,
    network_scenario,
    solve_maxmin,
)
from tests.certificates.cases import certified
from tests.certificates.mutants import (
    accepted,
    believed,
    changed,
    is_false,
    places,
    refused,
    variants,
)
from tests.strategies import OBJECTIVES, random_problem


def bases(tmp_path, seeds):
    for seed in seeds:
        rng = np.random.default_rng([31, seed])
        kind = list(OBJECTIVES)[seed % 3]
        problem = random_problem(rng, 3, kind=kind, controls=2, complete=True if seed % 2 else None)
        written, document = certified(problem, tmp_path / "base.json")
        if written.verified.lower > 1e-3:  # where every robot can be blinded there is nothing to mutate
            assert not is_false(document)
            assert accepted(document, tmp_path / "base.json")
            yield rng, document


def sweep_data(tmp_path, seeds, share):
    """Mutate problem, plan and claim; return how many mutants had a false claim."""
    false = 0
    for rng, document in bases(tmp_path, seeds):
        part = {name: document[name] for name in ("problem", "plan", "claim")}
        for at, value in list(places(part)):
            for new in variants(value, rng):
                mutant = changed(document, at, new)
                if new == value or rng.random() > share or not is_false(mutant):
                    continue
                false += 1
                assert not accepted(mutant, tmp_path / "mutant.json"), (at, value, new)
    return false


def sweep_proofs(tmp_path, seeds, share):
    """Make the claim false by little, then mutate the proofs so that they might hide it."""
    false = 0
    for rng, document in bases(tmp_path, seeds):
        claim = document["claim"]
        for side, factor in (("upper", 1 - 1e-5), ("lower", 1 + 1e-5)):
            lie = changed(document, ("claim", side), claim[side] * factor)
            other = "lower" if side == "upper" else "upper"
            lie["claim"][other] = 0.0 if other == "lower" else claim["upper"] * 2
            assert is_false(lie)
            part = {name: document[name] for name in ("prior_eigenvalue", side)}
            false += refused(lie, part, rng, share, tmp_path / "mutant.json")
    return false


def test_no_false_claim_about_mutated_data_is_accepted(tmp_path):
    assert sweep_data(tmp_path, range(24), 0.25) >= 400


def test_no_mutated_proof_hides_a_false_claim(tmp_path):
    assert sweep_proofs(tmp_path, range(24), 0.15) >= 1000


@pytest.mark.slow
def test_full_sweep(tmp_path):
    assert sweep_data(tmp_path, range(100, 220), 1.0) >= 5000
    assert sweep_proofs(tmp_path, range(100, 220), 1.0) >= 20000


@pytest.mark.slow
def test_pairs_of_mutations(tmp_path):
    """Two fields at once: no false claim is accepted either."""
    for rng, document in bases(tmp_path, range(300, 330)):
        spots = list(places({name: document[name] for name in document if name not in ("format", "version")}))
        for _ in range(300):
            mutant = document
            for k in rng.integers(len(spots), size=2):
                options = variants(spots[k][1], rng)
                if options:
                    try:
                        mutant = changed(mutant, spots[k][0], options[int(rng.integers(len(options)))])
                    except (IndexError, KeyError, TypeError):  # the second spot is gone
                        continue
            if is_false(mutant):
                assert not accepted(mutant, tmp_path / "mutant.json")


def reshaped(value, rng):
    """Another value of another size, depth or kind."""
    if isinstance(value, list):
        deep = value
        for _ in range(300):
            deep = [deep]
        return [value * 2, value * 300, [value], deep, value[: len(value) // 2], [], None][int(rng.integers(7))]
    if isinstance(value, str):
        return ["", "copies", "enumerated", 3, None][int(rng.integers(5))]
    if isinstance(value, int):
        return [0, -1, 50, 10**6, 10**30, 2**63, True, None, "1", 1.5][int(rng.integers(10))]
    return [0.0, -value, 1e300, 1e-300, 5e-324, None, "1"][int(rng.integers(7))]


def test_proofs_of_other_shapes_end_in_documented_errors(tmp_path):
    """Of real networks and limited views, too: their proofs have trees of attacks, groups and covers."""
    documents = [document for _, document in bases(tmp_path, range(3))]
    for seed, kind in enumerate(OBJECTIVES):
        scenarios = (
            network_scenario("disk-6", 12, 3, alpha_s=2, alpha_c=4, seed=seed),
            limited_view_scenario(5, 5, alpha_s=2, alpha_c=4, seed=seed),
        )
        for problem in (scenario.problem(kind) for scenario in scenarios):
            written = certify(problem, solve_maxmin(problem, time_limit=10), tmp_path / "base.json")
            documents.append(json.loads(written.path.read_text()))
    rng, path = np.random.default_rng(37), tmp_path / "mutant.json"
    for document in documents:
        spots = list(places({name: document[name] for name in document if name not in ("format", "version")}))
        for _ in range(60):
            mutant = document
            for k in rng.integers(len(spots), size=int(rng.integers(1, 4))):
                try:
                    mutant = changed(mutant, spots[k][0], reshaped(spots[k][1], rng))
                except (IndexError, KeyError, TypeError):  # the spot is gone
                    continue
            path.write_text(json.dumps(mutant))
            believed(path)


def test_bytes_flipped_or_cut_never_crash(tmp_path):
    path = tmp_path / "mutant.json"
    for rng, document in bases(tmp_path, range(3)):
        raw = json.dumps(document).encode()
        for _ in range(150):
            flipped = bytearray(raw)
            for k in rng.integers(len(raw), size=int(rng.integers(1, 4))):
                flipped[k] = int(rng.integers(256))
            cut = raw[: int(rng.integers(len(raw)))] if rng.random() < 0.3 else bytes(flipped)
            path.write_bytes(cut)
            believed(path)
