"""A seeded sample of the fault campaign, and that the campaign finds the faults it looks for."""

from __future__ import annotations

import sys
from typing import Any

import pytest

from analysis.faults import campaign as faults
from analysis.faults import kinds
from analysis.faults.kinds import KINDS

SAMPLED = (
    "certificate",
    "input",
    "flags",
    "journal",
    "full disk",
    "closed stream",
    pytest.param("interrupt", marks=pytest.mark.slow),  # real signals at random moments: not the same in every run
)


def _only(kind: str) -> dict[str, tuple[float, faults.Kind]]:
    return {kind: (1.0, KINDS[kind][1])}


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> faults.Campaign:
    made = faults.Campaign(seed=7, folder=tmp_path_factory.mktemp("faults"))
    made.prepare()
    return made


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # what interrupts leave to be collected
@pytest.mark.parametrize("kind", SAMPLED)
def test_a_sample_of_the_campaign_finds_nothing(kind: str, campaign: faults.Campaign) -> None:
    for number in range(20):
        campaign.run_case(number, _only(kind))
    assert campaign.faults == {}
    assert sum(count for name, count in campaign.counts.items() if name.startswith(f"{kind}: ")) == 20


@pytest.mark.parametrize(
    ("code", "said", "found"),
    [
        (70, "error: x", "exit code 70"),
        (2, "a\nTraceback", "traceback"),
        (2, "error: \x1b", "unprintable"),
        (2, "", "0 error"),
    ],
)
def test_the_campaign_sees_a_faulty_program(
    code: int, said: str, found: str, campaign: faults.Campaign, monkeypatch: pytest.MonkeyPatch
) -> None:
    def run(arguments: list[str]) -> int:
        del arguments
        sys.stderr.write(said)
        return code

    monkeypatch.setattr(faults, "run", run)
    campaign.faults.clear()
    campaign.run_case(0, _only("flags"))
    assert found in campaign.faults.pop(0)


def test_the_campaign_sees_a_false_certificate(campaign: faults.Campaign, monkeypatch: pytest.MonkeyPatch) -> None:
    """A verifier that believes twice what was proved."""
    real: Any = kinds.truth

    def twice(document: Any, elements: list[int]) -> tuple[float, float]:
        lower, upper = real(document, elements)
        return lower, 2 * upper

    monkeypatch.setattr(kinds, "truth", twice)
    monkeypatch.setattr(kinds, "damaged", lambda data, _: data)
    campaign.run_case(0, _only("certificate"))
    assert "false upper end" in campaign.faults.pop(0)
