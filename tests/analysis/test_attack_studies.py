from __future__ import annotations

import csv

import pytest

from analysis.benchmarks import attack
from analysis.benchmarks.network_tables import network_table, read_rows, summary
from analysis.tables import append_csv, print_table, write_csv
from ratt_opt import random_scenario, ratt, worst_case_attack
from tests.documents import ROOT


def test_tables_are_printed_and_written(tmp_path, capsys):
    rows = [{"name": "a", "value": 1 / 3}, {"name": "bcd", "value": 2}]
    print_table("Title", rows)
    assert capsys.readouterr().out.split() == ["Title", "name", "value", "a", "0.3333", "bcd", "2"]
    write_csv(tmp_path / "new" / "t.csv", rows)
    with (tmp_path / "new" / "t.csv").open() as file:
        assert [float(row["value"]) for row in csv.DictReader(file)] == [1 / 3, 2.0]


def test_the_benchmark_s_plain_ways_agree():
    problem = random_scenario(10, 15, alpha_s=3, alpha_c=11, seed=0).problem("logdet")
    plan = ratt(problem).elements
    assert attack.plain_enumeration(problem, plan) == pytest.approx(worst_case_attack(problem, plan).upper, rel=1e-12)
    assert attack.evaluations()[0]["ratio"] >= 100


def test_tables_of_networks_keep_the_last_row_of_an_instance_and_count_what_is_open(tmp_path):
    log = tmp_path / "log.csv"
    first = {"robots": 24, "family": "hubs", "seed": 0, "alpha_s": 4, "alpha_c": 9}
    shared = {"processor_seconds": 2.04, "plain_over_exact": 1.05}
    append_csv(log, first | {"stop": "time", "gap": 0.5} | shared)
    append_csv(log, first | {"alpha_s": 8, "stop": "time", "gap": 0.0301} | shared)
    append_csv(log, first | {"seed": 2, "stop": "time", "gap": 0.011, "processor_seconds": 30, "plain_over_exact": 0.9})
    append_csv(log, first | {"stop": "closed", "gap": 0.0} | shared)
    append_csv(log, first | {"family": "dense", "stop": "gap", "gap": 1e-7} | shared)
    ((robots, rows),) = read_rows([log]).items()
    assert robots == 24
    assert network_table(rows).splitlines() == [
        "| graph | seed 0 | seed 2 |",
        "| --- | --- | --- |",
        "| hubs | 2.0 s, 3.1 % | 1.1 % |",
        "| dense | 2.0 s | not run |",
    ]
    assert summary(rows, 0.02) == (
        "2 of 4 closed, 3 within 2 %; beyond: hubs (8, 9) seed 0 3.1 %. "
        "Plain annealing found a worse attack on 1 of 4, a milder one by up to 5.0 %."
    )
    besides = [
        {"stop": "closed", "earlier_stop": "time", "earlier_lower": "1.0", "earlier_upper": "1.004"},
        {"stop": "gap", "earlier_stop": "closed", "earlier_lower": "1.0", "earlier_upper": "1.0"},
        {"stop": "gap", "earlier_stop": "none", "earlier_lower": "0.0", "earlier_upper": "inf"},
    ]
    assert summary(besides, 0.005) == (
        "3 of 3 closed, 3 within 0.5 %. The earlier edition closed 1 of 3, 2 within 0.5 %, and left up to 100 %."
    )


WITHIN = {"attack": {24: 0.02, 30: 0.02, 50: 0.02, 100: 0.05}, "maxmin": {24: 0.005, 30: 0.005, 50: 0.04, 100: 0.08}}


@pytest.mark.parametrize("what", WITHIN)
def test_the_tables_of_networks_on_the_page_are_those_of_the_rows_measured(what):
    page = (ROOT / "docs" / "researchers" / "benchmarks.md").read_text(encoding="utf-8")
    rows = read_rows([ROOT / "analysis" / "measured" / f"networks_{what}.csv"])
    assert set(rows) == set(WITHIN[what])
    for robots, of_team in rows.items():
        assert network_table(of_team) in page
        assert summary(of_team, WITHIN[what][robots]) in page
        for row in of_team:
            assert float(row["lower"]) <= float(row["upper"])
