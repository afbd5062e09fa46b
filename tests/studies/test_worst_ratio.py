"""The study of worst ratios: the theorem's own numbers, brackets in order, files that others can read."""

from __future__ import annotations

import csv
from fractions import Fraction
from typing import TYPE_CHECKING

import pytest

from analysis.worst_ratio import draw, sweep, theorem1, write_csv
from ratt_opt import theorem1_bound

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.parametrize("alpha_cs", [0, 1, 2, 5])
@pytest.mark.parametrize("value", [Fraction(0), Fraction(3, 10), Fraction(1)])
def test_theorem_1_as_the_library_states_it(alpha_cs: int, value: Fraction) -> None:
    assert float(theorem1("submodular", value, alpha_cs)) == pytest.approx(theorem1_bound(alpha_cs, k=float(value)))
    assert float(theorem1("nondecreasing", value, alpha_cs)) == pytest.approx(theorem1_bound(alpha_cs, c=float(value)))


def test_brackets_fall_with_the_curvature_and_stay_above_both_bounds(tmp_path: Path) -> None:
    cases = [("submodular", 3, 1, 0), ("nondecreasing", 3, 0, 2)]
    points = sweep(cases, [Fraction(i, 4) for i in range(5)], planners=("ratt", "myopic"))
    assert len(points) == 20
    for point in points:
        assert point.theorem1 <= point.pattern_free + 1e-12
        assert point.pattern_free <= point.upper + 1e-12
        assert point.lower <= point.upper
        assert point.stop == "closed"
    for start in range(0, 20, 5):
        uppers = [point.upper for point in points[start : start + 5]]
        assert uppers == sorted(uppers, reverse=True)
        assert uppers[0] == 1
    write_csv(points, tmp_path / "points.csv")
    with (tmp_path / "points.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [Fraction(row["exact_upper"]) for row in rows] == [Fraction(point.exact_upper) for point in points]
    figure = draw(points)
    assert [axis.get_title() for axis in figure.axes] == [
        "submodular, curvature k",
        "non-decreasing, total curvature c",
    ]
