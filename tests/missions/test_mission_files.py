"""What a mission writes: tables that say what happened, figures, an animation and a player that open."""

import csv
import importlib.util
import json
import re

import numpy as np
import pytest

from ratt_opt import InputError, random_scenario, run_mission, save_scenario, solve_maxmin
from ratt_opt.budget import Budget
from ratt_opt.cli import run
from ratt_opt.missions.drawing.frames import frames_of
from ratt_opt.missions.players import planners


@pytest.fixture(scope="module")
def mission():
    scenario = random_scenario(4, 2, alpha_s=1, alpha_c=3, seed=3)
    return run_mission(scenario, steps=4, attacks="persistent", sharing="all surviving")


def rows(path):
    with path.open() as file:
        return list(csv.DictReader(file))


def test_tables_say_what_happened(mission, tmp_path) -> None:
    files = {file.name: file for file in mission.save(tmp_path)}
    robots = rows(files["mission.csv"])
    assert len(robots) == 5 * 4
    for row in robots[4:]:
        step, i = mission.steps[int(row["step"]) - 1], int(row["robot"])
        assert [float(row[c]) for c in ("x", "y", "heading")] == step.poses[i].tolist()
        assert [float(row[c]) for c in ("speed", "turn_rate")] == step.controls[i].tolist()
        assert row["role"] == step.role(i)
        assert i in step.groups[int(row["group"])].robots
    tracks = rows(files["tracks.csv"])
    assert {row["team"] for row in tracks} == {"0", "1"}  # groups that are apart believe different things
    for row in tracks:
        step, j = mission.steps[int(row["step"]) - 1], int(row["target"])
        belief = step.groups[int(row["group"])].belief
        assert [float(row[c]) for c in ("true_x", "true_y")] == step.truth[j, :2].tolist()
        assert [float(row[c]) for c in ("x", "y")] == belief.mean[j, :2].tolist()
        assert float(row["covariance_xy"]) == belief.covariance[j, 0, 1]
    team = [row for row in tracks if row["team"] == "1"]
    squared = [(float(r["x"]) - float(r["true_x"])) ** 2 + (float(r["y"]) - float(r["true_y"])) ** 2 for r in team]
    document = json.loads(files["mission.json"].read_text())
    np.testing.assert_allclose(np.sqrt(np.reshape(squared, (4, 2)).mean(axis=1)), document["rmse"])
    nees = np.reshape([float(r["nees"]) for r in team], (4, 2)).mean(axis=1)
    np.testing.assert_allclose(nees, document["nees"])


def test_the_animation_has_a_picture_a_step(mission, tmp_path) -> None:
    from PIL import Image

    path = mission.animate(tmp_path / "mission.gif")
    with Image.open(path) as picture:
        assert picture.n_frames == 4
    with pytest.raises(InputError, match="path must end in"):
        mission.animate(tmp_path / "mission.mp4")


def test_the_log_holds_every_step(mission, tmp_path) -> None:
    path = tmp_path / "mission.mcap"
    if importlib.util.find_spec("mcap") is None:
        with pytest.raises(InputError, match="needs the extra viewers"):
            mission.animate(path)
        assert not path.exists()
        return
    from mcap.reader import make_reader

    mission.animate(path)
    with path.open("rb") as stream:
        read = [(c.topic, m.log_time, json.loads(m.data)) for _, c, m in make_reader(stream).iter_messages()]
    assert len(read) == 4 * 5
    for k, step in enumerate(mission.steps):
        now = {topic: message for topic, time, message in read if time == (k + 1) * 10**9}
        places = [[p["position"]["x"], p["position"]["y"]] for p in now["/robots"]["poses"]]
        assert places == step.poses[:, :2].tolist()
        assert now["/mission"]["rmse"] == mission.rmse[k]
        assert len(now["/scene"]["entities"][0]["lines"][1]["points"]) == 2 * len(step.attack.links)


def test_the_player_needs_nothing_else(mission, tmp_path) -> None:
    page = mission.animate(tmp_path / "player.html").read_text()
    assert not re.search(r"(src|href)\s*=|https?://|@import", page)
    data = json.loads(re.search(r'id="mission">(.*?)</script>', page)[1])
    assert data["frames"] == json.loads(json.dumps(frames_of(mission)))
    low_x, high_x, low_y, high_y = data["view"]
    for frame in data["frames"]:
        for x, y, *_ in frame["robots"] + frame["targets"] + frame["estimates"]:
            assert low_x < x < high_x
            assert low_y < y < high_y


def test_ellipses_hold_95_percent(mission) -> None:
    covariance = mission.steps[-1].team.belief.position_covariance[0]
    long, short, angle = frames_of(mission)[-1]["ellipses"][0]
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    np.testing.assert_allclose(turn @ np.diag([long**2, short**2]) @ turn.T, -2 * np.log(0.05) * covariance, rtol=1e-9)


def test_an_interrupted_command_goes_on_from_its_journal(tmp_path, capsys, monkeypatch) -> None:
    path, out, whole = tmp_path / "scenario.json", tmp_path / "out", tmp_path / "whole"
    save_scenario(random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=1), path)
    command = ["track", str(path), "--steps", "4", "--planner", "maxmin"]
    assert run([*command, "--out", str(whole)]) == 0
    asked = []

    def interrupted_at_third(*given, **named):
        asked.append(0)
        return solve_maxmin(*given, **named, budget=_interrupted() if len(asked) == 3 else None)

    monkeypatch.setattr(planners, "solve_maxmin", interrupted_at_third)
    capsys.readouterr()
    assert run([*command, "--out", str(out)]) == 130
    said = capsys.readouterr()
    assert said.out == ""
    assert "journal.jsonl holds the steps flown" in said.err
    assert len(said.err.splitlines()) == 1
    assert [file.name for file in out.iterdir()] == ["journal.jsonl"]
    assert run([*command, "--out", str(out)]) == 0
    assert (out / "mission.csv").read_bytes() == (whole / "mission.csv").read_bytes()


def _interrupted() -> Budget:
    budget = Budget()
    budget.interrupt()
    return budget


def test_the_command(tmp_path, capsys) -> None:
    path, out = tmp_path / "scenario.json", tmp_path / "out"
    save_scenario(random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=1), path)
    command = ["track", str(path), "--steps", "3", "--out", str(out), "--seeds", "2", "--attacks", "permanent"]
    assert run(command) == 0
    text = capsys.readouterr().out
    assert "RMSE [m]" in text
    first = (out / "mission.csv").read_bytes()
    (out / "mission.csv").unlink()
    assert run([*command, "--json"]) == 0  # resumed from its journal: the same
    assert json.loads(capsys.readouterr().out)["settings"]["attacks"] == "permanent"
    assert (out / "mission.csv").read_bytes() == first
    assert run([*command, "--planner", "greedy"]) == 2
    assert "journal must be of the same mission" in capsys.readouterr().err
    assert run(["track", str(path), "--steps", "3", "--out", str(out), "--attacker", "evil"]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
    assert run(["track", str(path), "--steps", "1", "--out", str(out), "--time-limit", "1"]) == 2
    assert "--planner maxmin" in capsys.readouterr().err
