"""The studies of missions, small: what must hold whatever the random numbers."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from analysis.missions import consistency, exact_flights, flights
from ratt_opt.studies.cases import Seeds

if TYPE_CHECKING:
    import pytest


def test_every_planner_and_attacker_is_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(flights, "STEPS", 4)
    monkeypatch.setattr(flights, "SETTLED", 1)
    for study in (flights.STUDIES[0], flights.MILD, exact_flights.STUDIES[0]):
        case = replace(study.cases[0], n_robots=3, n_targets=2, alpha_c=1, alpha_s=1)
        row = flights.measure(study, case, Seeds.of(1, 0))
        assert len(row) == len(study.planner_names) * len(study.attacker_names) * len(study.metrics)
        assert row == flights.measure(study, case, Seeds.of(1, 0))
        assert all(float(value) > 0 for value in row.values())
    assert row["maxmin/worst/trace"] <= row["ratt/worst/trace"] * 1.5


def test_the_second_order_term_tells_the_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sixteen robots pooled at the paper's largest case: the textbook filter is overconfident, the others are not."""
    monkeypatch.setattr(consistency, "DRAWS", 25)
    case = next(c for c in consistency.STUDY.cases if (c.n_robots, c.alpha_c) == (30, 108))
    rows = [
        {name: str(value) for name, value in consistency.measure(consistency.STUDY, case, Seeds.of(3, k)).items()}
        | {"case": case.name}
        for k in range(4)
    ]
    first, second, iterated = (consistency.ratios(rows, name)[case.name] for name in consistency.LINEARISATIONS)
    assert first > 1.2
    assert 0.9 < second < 1.2
    assert 0.9 < iterated < 1.15
