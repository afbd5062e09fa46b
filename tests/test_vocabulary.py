"""One name for each planner and attacker; former ones are read, with a warning."""

from pathlib import Path

import pytest

import ratt_opt as ro
from ratt_opt.cli import run as command
from ratt_opt.studies import ATTACKERS, PLANNERS, Case, Study, read_table, run

CASE = Case(n_robots=3, n_targets=2, alpha_s=1, alpha_c=1)


def test_studies_missions_and_reports_share_their_names() -> None:
    """What one of them calls a planner or attacker, the others accept."""
    own = ro.random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=0)
    for planner in PLANNERS:
        ro.run_mission(own, steps=1, planner=planner)
    for attacker in ATTACKERS:
        ro.run_mission(own, steps=1, attacker=attacker)
    assert {plan.planner for plan in ro.bound(own).plans} <= set(PLANNERS)
    assert ro.attack_survey(own.problem(), ro.ratt(own.problem())).keys() <= set(ATTACKERS)


def test_former_names_are_read_with_a_warning() -> None:
    own = ro.random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=0)
    with pytest.warns(FutureWarning, match="planner 'nonrobust' is called 'nonrobust_optimum' now"):
        old = ro.run_mission(own, steps=1, planner="nonrobust")
    assert old == ro.run_mission(own, steps=1, planner="nonrobust_optimum")
    with pytest.warns(FutureWarning, match="attacker 'exact' is called 'worst' now"):
        study = Study(name="s", cases=(CASE,), planners=("ratt",), attackers=("exact",), metrics=("value",))
    assert study.attacker_names == ("worst",)
    with pytest.warns(FutureWarning, match="planner 'optimum' is called 'maxmin' now"):
        assert Study(name="s", cases=(CASE,), planners={"best": "optimum"}).named_planners == {"best": "maxmin"}
    found = ro.attack_survey(own.problem(), ro.ratt(own.problem()))
    with pytest.warns(FutureWarning, match="'exact' is called 'worst'"):
        assert found["exact"] is found["worst"]
    with pytest.raises(KeyError):
        found["nobody"]
    with pytest.warns(FutureWarning, match="called planner now"):
        assert ro.bound(own).ratt.name == "ratt"


def test_tables_of_earlier_studies_are_read(tmp_path: Path) -> None:
    study = Study(name="s", cases=(CASE,), planners=("maxmin",), attackers=("worst",), metrics=("value",))
    rows = run(study, tmp_path, trials=1).rows
    table = tmp_path / "table.csv"
    table.write_text(table.read_text().replace("maxmin/worst/", "optimum/exact/"))
    assert read_table(tmp_path) == list(rows)


def test_the_command_takes_former_names_with_a_note(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["track", "nowhere.json", "--steps", "1", "--out", "nowhere", "--attacker", "bounded rational"]
    assert command(words) == 2
    assert "note: the attacker 'bounded rational' is called 'bounded_rational' now" in capsys.readouterr().err
