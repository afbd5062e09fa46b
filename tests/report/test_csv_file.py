"""Names that are formulas in a spreadsheet stay text."""

import csv
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ratt_opt import InformationInput, bound
from ratt_opt.report.csv_file import write_csv


def read(path: Path) -> list[list[str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.reader(file))


@given(st.text(st.characters(codec="utf-8", exclude_categories=["Cc", "Cs"]), max_size=20))
def test_no_text_cell_begins_like_a_formula(tmp_path_factory: pytest.TempPathFactory, name: str):
    path = tmp_path_factory.getbasetemp() / "table.csv"
    write_csv(path, ("name", "number"), [(name, -1.5)])
    (_, row) = read(path)
    assert row[0].removeprefix("'") == name.removeprefix("'")
    assert not row[0].startswith(("=", "@", "＝", "＋", "－", "＠", "\t", "\r"))
    assert not row[0].startswith(("-", "+")) or (row[0][1:2].isdigit() and not set(row[0]) & set("|!()=@&;"))
    assert row[1] == "-1.5"


def test_the_plan_of_robots_with_such_names(tmp_path: Path):
    team = InformationInput(
        prior=[[[2.0]]],
        information=[[[[1.0]]], [[[0.5]]]],
        robot=[0, 1],
        alpha_s=1,
        alpha_c=0,
        robot_names=["=HYPERLINK(1)", "ada"],
    )
    bound(team, certificate=None).save(tmp_path)
    names = [row[1] for row in read(tmp_path / "plan.csv")[1:]]
    assert names == ["'=HYPERLINK(1)", "ada"]
