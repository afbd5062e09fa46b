"""Parameters of certificates and limits of their check: whatever they are, no false claim is proved."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

import ratt_opt as ro
from ratt_opt import CertificateParams, VerifierLimits
from ratt_opt.certificates.params import AT_LEAST_ONE
from ratt_opt.cli import run
from ratt_opt.errors import UndecidedError
from tests.extremes import at_extremes, places, with_one


@cache
def solved(kind: str) -> tuple[ro.Problem, ro.MaxMinResult]:
    """A team that is attacked on a network of its own, one whose proof has rows, and its best plan."""
    if kind == "network":
        scenario = ro.network_scenario("hubs", 6, 3, alpha_s=1, alpha_c=2, seed=1)
    else:
        scenario = ro.limited_view_scenario(4, 4, alpha_s=1, alpha_c=2, seed=1)
    problem = scenario.problem("logdet" if kind == "views" else "trace")
    return problem, ro.solve_maxmin(problem)


@pytest.mark.parametrize("kind", ["network", "views"])
@pytest.mark.parametrize("place", [place for place in places(CertificateParams()) if not place.startswith("verifier.")])
def test_a_written_certificate_is_true_whatever_one_parameter_is(place: str, kind: str, tmp_path: Path) -> None:
    problem, found = solved(kind)
    for _, params in at_extremes(CertificateParams(), place, {*AT_LEAST_ONE, "covers.unit", "points.precision"}):
        try:
            written = ro.certify(problem, found, tmp_path / "c.json", time_limit=2.0, params=params)
        except UndecidedError:
            continue
        stated = ro.verify_certificate(tmp_path / "c.json")
        assert stated == written.verified
        assert stated.upper >= found.upper * (1 - 1e-12)
        assert not stated.lower_proved or stated.lower <= found.lower * (1 + 1e-12)


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> Path:
    problem, found = solved("views")
    return ro.certify(problem, found, tmp_path_factory.mktemp("good") / "c.json").path


@pytest.mark.parametrize("place", places(VerifierLimits()))
def test_limits_decide_if_a_file_is_decided_and_never_what_is_proved(place: str, good: Path) -> None:
    proved = ro.verify_certificate(good)
    for least, limits in at_extremes(VerifierLimits(), place, {"block", "told"}):
        try:
            assert ro.verify_certificate(good, limits=limits) == proved
        except (ro.FileFormatError, UndecidedError):
            assert least or place == "matrix.seconds"


@pytest.mark.parametrize("place", AT_LEAST_ONE)
def test_what_no_proof_can_be_found_with_is_refused(place: str) -> None:
    with pytest.raises(ro.InputError, match=rf"params.{place} must be at least 1; got 0"):
        with_one(CertificateParams(), place, 0)


def test_no_shave_no_precision_and_too_large_a_unit_are_refused() -> None:
    with pytest.raises(ro.InputError, match="shaves must hold"):
        with_one(CertificateParams(), "writing.shaves", ())
    with pytest.raises(ro.InputError, match="unit must be at most"):
        with_one(CertificateParams(), "covers.unit", 1 << 40)
    with pytest.raises(ro.InputError, match="at least 53"):
        with_one(CertificateParams(), "points.precision", 2)
    with pytest.raises(ro.InputError, match="precisions must hold"):
        VerifierLimits(precisions=())


def test_limits_from_a_file_of_toml(good: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "limits.toml"
    path.write_text("entries = 3\n[matrix]\nshort = 0.2\n")
    assert run(["verify", str(good), "--limits", str(path)]) == 2
    assert "size of lists must be at most 3" in capsys.readouterr().err
    path.write_text("entries = 3_000_000\n")
    assert run(["verify", str(good), "--limits", str(path)]) == 0
    path.write_text("entrys = 3\n")
    assert run(["verify", str(good), "--limits", str(path)]) == 2
    assert "limits must name some of bits" in capsys.readouterr().err
    path.write_text("block = 0\n")
    assert run(["verify", str(good), "--limits", str(path)]) == 2
    assert "limits.block must be at least 1; got 0" in capsys.readouterr().err


def test_parameters_that_are_passed_are_used(tmp_path: Path) -> None:
    problem, found = solved("network")
    plain = ro.certify(problem, found, tmp_path / "plain.json")
    points = replace(CertificateParams().points, digits=17)
    assert ro.certify(problem, found, tmp_path / "long.json", params=CertificateParams(points=points)).size > plain.size
