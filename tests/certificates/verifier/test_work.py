"""The verifier ends on every file: files that ask for too much are neither proved nor refuted, in bounded time."""

import json
from pathlib import Path
from time import monotonic, process_time
from typing import Any

import pytest

from ratt_opt import FileFormatError, InputError, ProofError, VerifierLimits, verify_certificate
from ratt_opt.certificates.verifier.verify import verify_document
from ratt_opt.errors import UndecidedError


def _document(d: int, exponent: int, tree: list[Any], upper: float = 1.0) -> dict[str, Any]:
    """One robot with two elements, one target with d coordinates whose scales span ``2 ** exponent``."""
    scales = [2.0 ** (exponent * i / max(d - 1, 1) - exponent / 2) * (1 + i / 7) for i in range(d)]
    # Diagonally dominant, and full: exact elimination meets every width.
    full = [[s if i == j else 0.01 * min(s, scales[j]) / d for j in range(i + 1)] for i, s in enumerate(scales)]
    prior = [x for row in full for x in row]
    zero = [0.0] * len(prior)
    point = [zero]
    return {
        "format": "ratt-opt certificate",
        "version": 2,
        "problem": {
            "objective": "trace", "dimension": d, "prior": [prior], "information": [[zero], [prior]], "weights": [1.0],
            "owners": [0, 0], "links": [], "alpha_s": 0, "alpha_c": 0, "protected_robots": [], "protected_links": [],
        },
        "plan": [0],
        "claim": {"lower": 0.0, "upper": upper},
        "prior_eigenvalue": [],
        "upper": {"attacks": [{"robots": [], "links": []}], "points": [point], "cuts": [[0, 0, 0]], "tree": tree},
        "lower": {"conclusion": "enumerated"},
    }  # fmt: skip


LEAF = {"fenchel": [0], "weights": [1.0]}


def _verify(document: dict[str, Any], path: Path, seconds: float, limits: VerifierLimits | None = None) -> float:
    """Verify; return the seconds it took."""
    path.write_text(json.dumps(document))
    began = monotonic()
    with pytest.raises(UndecidedError, match="not decided"):
        verify_certificate(path, time_limit=seconds, limits=limits)
    return monotonic() - began


def test_the_documents_are_certificates_where_they_are_small(tmp_path: Path) -> None:
    path = tmp_path / "c.json"
    path.write_text(json.dumps(_document(2, 4, [LEAF], upper=1e9)))
    found = verify_certificate(path)
    assert found.upper == 1e9
    assert not found.lower_proved
    path.write_text(json.dumps(_document(2, 4, [LEAF], upper=1e-9)))
    with pytest.raises(ProofError, match="only proves") as refuted:
        verify_certificate(path)
    assert not isinstance(refuted.value, UndecidedError)


def test_short_files_with_wide_numbers_are_refused_before_the_work(tmp_path: Path) -> None:
    document = _document(30, 1800, [LEAF])
    assert len(json.dumps(document)) < 60_000
    assert _verify(document, tmp_path / "c.json", 60.0) < 5


def test_many_leaves_end_at_the_limit(tmp_path: Path) -> None:
    """Two megabytes of nodes over wide numbers."""
    branch = {"element": 0, "parts": [[0], [1]]}
    tree = [branch, LEAF, LEAF]
    for _ in range(12):  # a robot's single element may be branched on again and again
        tree = [{"element": 0, "parts": [[0, 1]]}, *tree]
    wide = {"fenchel": [0] * 100_000, "weights": [1.5] * 100_000}
    document = _document(12, 300, [*tree[:-1], wide])
    assert _verify(document, tmp_path / "c.json", 0.2) < 5


@pytest.mark.parametrize(("d", "exponent"), [(12, 1500), (30, 40)])
def test_wide_matrices_of_many_targets_end_at_the_limit(d: int, exponent: int, tmp_path: Path) -> None:
    """Each takes a part of a second to invert, to test, or to value."""
    document, targets = _document(d, exponent, [LEAF], upper=1e300), 40
    problem = document["problem"]
    problem |= {"prior": problem["prior"] * targets, "weights": [1.0] * targets}
    problem["information"] = [row * targets for row in problem["information"]]
    document["upper"]["points"][0] *= targets
    document["claim"]["lower"] = 1e-30
    document["lower"] = {"conclusion": "forced", "sets": {"size": 1, "tree": ["worth"]}}
    assert _verify(document, tmp_path / "c.json", 0.5) < 5


def test_memory_is_a_limit_too(tmp_path: Path) -> None:
    _verify(_document(4, 200, [LEAF]), tmp_path / "c.json", 60.0, VerifierLimits(bits=1000))


@pytest.mark.parametrize("limit", [0, -1, float("nan"), "1"])
def test_a_limit_is_a_positive_number(limit: Any, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="time_limit must be a positive number"):
        verify_certificate(tmp_path / "none.json", time_limit=limit)


@pytest.mark.parametrize("rows", [2, 150, 2000])
def test_rows_of_an_output_are_no_more_than_coordinates(rows: int, tmp_path: Path) -> None:
    """Structure is looked at before any number is: short files of many rows held the verifier for minutes."""
    document = _document(1, 4, [LEAF])
    document["problem"]["output"] = [[10.0 ** (37 * k % 280 - 140) for k in range(rows)]]
    path = tmp_path / "c.json"
    path.write_text(json.dumps(document))
    began = process_time()
    with pytest.raises(FileFormatError, match="output must hold rows of 1 numbers, 1 to 1 of them; got"):
        verify_certificate(path, time_limit=2)
    assert process_time() - began < 1


@pytest.mark.parametrize(("d", "exponent"), [(30, 150), (40, 80), (18, 2000)])
@pytest.mark.parametrize("seconds", [0.02, 0.5])
def test_one_long_operation_does_not_outlast_the_limit(d: int, exponent: int, seconds: float, tmp_path: Path) -> None:
    path = tmp_path / "c.json"
    path.write_text(json.dumps(_document(d, exponent, [LEAF])))
    began = process_time()
    with pytest.raises((UndecidedError, ProofError)):
        verify_certificate(path, time_limit=seconds)
    assert process_time() - began < seconds + 0.5


@pytest.mark.parametrize(
    ("field", "value"), [("format", "another"), ("version", 99), ("version", True), ("format", None)]
)
def test_documents_of_other_formats_are_refused_like_files(field: str, value: object) -> None:
    document = _document(2, 4, [LEAF], upper=1e9)
    assert verify_document(document).upper == 1e9
    with pytest.raises(FileFormatError, match=f"certificate {field} must be"):
        verify_document({**document, field: value})
    with pytest.raises(FileFormatError, match="certificate format must be"):
        verify_document([])  # type: ignore[arg-type]


def test_names_in_faults_are_shown_as_text() -> None:
    document = _document(2, 4, [LEAF], upper=1e9)
    document["lower"] = {"conclusion": "forced", "sets": {"size": 1, "tree": [{"\x1b[2J\nx\u202e": 1}]}}
    with pytest.raises(ProofError) as caught:
        verify_document(document)
    assert str(caught.value).isprintable()
