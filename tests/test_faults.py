"""A seeded sample of the fault campaign, and that the campaign finds the faults it looks for."""

from __future__ import annotations

from typing import Any

import pytest

from analysis import faults

KINDS = ("certificate", "input", "flags", "journal", "full disk", "interrupt", "closed stream")


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> faults.Campaign:
    made = faults.Campaign(seed=7, folder=tmp_path_factory.mktemp("faults"))
    made.prepare()
    return made


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # what interrupts leave to be collected
@pytest.mark.parametrize("kind", KINDS)
def test_a_sample_of_the_campaign_finds_nothing(
    kind: str, campaign: faults.Campaign, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(faults, "KINDS", {kind: (1.0, faults.KINDS[kind][1])})
    for number in range(20):
        campaign.run_case(number)
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
        faults.sys.stderr.write(said)
        return code

    monkeypatch.setattr(faults, "run", run)
    monkeypatch.setattr(faults, "KINDS", {"flags": (1.0, faults.KINDS["flags"][1])})
    campaign.faults.clear()
    campaign.run_case(0)
    assert found in campaign.faults.pop(0)


def test_the_campaign_sees_a_false_certificate(campaign: faults.Campaign, monkeypatch: pytest.MonkeyPatch) -> None:
    """A verifier that believes twice what was proved."""
    real: Any = faults._truth

    def twice(document: Any, elements: list[int]) -> tuple[float, float]:
        lower, upper = real(document, elements)
        return lower, 2 * upper

    monkeypatch.setattr(faults, "_truth", twice)
    monkeypatch.setattr(faults, "_damaged", lambda data, _: data)
    monkeypatch.setattr(faults, "KINDS", {"certificate": (1.0, faults.KINDS["certificate"][1])})
    campaign.run_case(0)
    assert "false upper end" in campaign.faults.pop(0)
