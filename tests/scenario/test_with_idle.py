"""Information files in which few robots may choose."""

import json

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.cli import run


def sensors(at_most=2):
    half = np.random.default_rng(3).normal(size=(5, 2, 2, 2))
    return ro.InformationInput(
        prior=np.tile(np.eye(2), (2, 1, 1)),
        information=half @ half.swapaxes(-1, -2),
        robot=range(5),
        alpha_s=1,
        alpha_c=0,
        labels=tuple("abcde"),
    ).with_idle(at_most)


def test_the_file_keeps_the_limit_and_older_ones_have_none(tmp_path):
    team = sensors()
    ro.save_scenario(team, tmp_path / "team.json")
    again = ro.load_input(tmp_path / "team.json")
    assert again == team
    assert again.digest == team.digest
    assert again.problem("logdet").at_most == 2
    assert "at_most" not in ro.random_scenario(3, 2, alpha_s=0, alpha_c=0, seed=0).to_information().model_dump()


def test_idle_elements_are_added_where_they_are_missing():
    team = sensors()
    assert team.problem().idle.tolist() == [5, 6, 7, 8, 9]
    assert team.labels[5:] == ("idle",) * 5
    assert team.with_idle(1).robot == team.robot
    scenario = ro.limited_view_scenario(4, 3, alpha_s=1, alpha_c=1, seed=0).to_information().with_idle(2)
    idle = scenario.problem().idle
    assert not scenario.matrices[1][idle].any()
    assert len(scenario.element_positions) == len(scenario.robot)
    with pytest.raises(ro.InputError, match=r"at_most must be an integer in \[0, 5\]; got 6"):
        team.replace(at_most=6)
    with pytest.raises(ro.InputError, match="payload"):
        team.replace(payload=list(range(10))).with_idle(2)


def test_the_main_job_plans_proves_and_says_why_no_guarantee_applies(tmp_path, capsys):
    ro.save_scenario(sensors(), tmp_path / "team.json")
    out = tmp_path / "out"
    assert run(["bound", str(tmp_path / "team.json"), "--out", str(out)]) == 0
    report = json.loads((out / "report.json").read_text())
    assert report["at_most"] == 2
    assert report["guarantees"] == {}
    assert report["optimum"]["upper"] == pytest.approx(ro.exhaustive_optimum(sensors().problem()).lower)
    capsys.readouterr()
    assert run(["verify", str(out / "certificate.json"), "--problem", str(tmp_path / "team.json")]) == 0
    assert "at most 2 robots not idle" in capsys.readouterr().out
