"""Rows of a study are printed and written in full."""

import csv

from analysis.tables import print_table, write_csv


def test_tables_are_printed_and_written(tmp_path, capsys):
    rows = [{"name": "a", "value": 1 / 3}, {"name": "bcd", "value": 2}]
    print_table("Title", rows)
    assert capsys.readouterr().out.split() == ["Title", "name", "value", "a", "0.3333", "bcd", "2"]
    write_csv(tmp_path / "new" / "t.csv", rows)
    with (tmp_path / "new" / "t.csv").open() as file:
        assert [float(row["value"]) for row in csv.DictReader(file)] == [1 / 3, 2.0]
