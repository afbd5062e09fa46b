"""Bad command lines and plans are refused in one line, with exit code 2 and nothing written."""

import os
from pathlib import Path

import pytest

from tests.cli.refusal import refused

NEW = ["new", "--sensing-attacks", "1", "--link-attacks", "1", "--out", "OUT/s.json"]
BAD = [
    (["bound", "OUT/none.json", "--out", "OUT/o"], "none.json must be a file that can be read"),
    (["bound", "FILE", "--out", "FILE"], "out must be a folder that can be written"),
    (
        ["bound", "FILE", "--out", "OUT/o", "--objective", "area"],
        "Invalid value for '--objective': 'area' is not one of",
    ),
    (["bound", "FILE", "--out", "OUT/o", "--time-limit", "-1"], "time_limit must be"),
    (["bound", "FILE", "--out", "OUT/o", "--gap", "-1"], "gap must be a number >= 0; got -1.0"),
    (["bound", "FILE", "--out", "OUT/o", "--time-limit", "soon"], "soon"),
    (["bound", "FILE", "--colour", "red"], "--colour"),
    (["bound"], "Missing argument 'file'"),
    (["plan"], "plan"),
    (["audit", "--out", "FILE"], "out must be a folder that can be written"),
    ([*NEW, "--robots", "2", "--targets", "2"], "--seed must be given for a random scenario"),
    ([*NEW, "--robots", "2", "--targets", "0", "--seed", "1"], "n_targets must be an integer >= 1; got 0"),
    ([*NEW, "--robots", "1", "--targets", "1", "--seed", "1"], "alpha_c must be an integer in [0, 0]; got 1"),
    ([*NEW, "--robots", "2", "--mrclam", "OUT", "--time", "0"], "--robots must come with no --mrclam"),
    (
        [*NEW, "--graph", "ring", "--robots", "2", "--targets", "2", "--seed", "1"],
        "graph must be one of dense, disk-12",
    ),
    (
        [*NEW, "--graph", "hubs", "--range", "9", "--robots", "4", "--targets", "2", "--seed", "1"],
        "--range must come with no --graph; got 9.0",
    ),
    *(
        ([*NEW, "--robots", "4", "--targets", "2", "--seed", "1", *words.split()], text)
        for words, text in (
            ("--view 361", "view must be in (0, 360] degrees; got 361"),
            ("--view 0", "view must be in (0, 360] degrees; got 0"),
            ("--view nan", "view must be in (0, 360] degrees; got nan"),
            ("--view 60 --range 0", "reach must be a finite number > 0 [m], or None; got 0"),
            ("--view 60 --range 1e-6", "view and reach must let a robot see a target"),
            ("--view 60 --headings 0", "headings must be an integer >= 1"),
            ("--view 60 --sensor sonar", "sensor must be camera, radar"),
            ("--view 60 --graph hubs", "--view must come with no --graph"),
            ("--view 60 --communication-range -1", "communication_range must be"),
            ("--range 9", "--range must come with --view"),
            ("--headings 4", "--headings must come with --view"),
            ("--sensor radar", "--sensor must come with --view"),
        )
    ),
    ([*NEW, "--view", "60"], "--robots must be given for a random scenario"),
    ([*NEW, "--view", "60", "--mrclam", "OUT", "--time", "0"], "--view must come with no --mrclam; got 60"),
    ([*NEW, "--graph", "hubs", "--mrclam", "OUT", "--time", "0"], "--graph must come with no --mrclam; got hubs"),
    ([*NEW, "--mrclam", "OUT"], "--time must be given with --mrclam"),
    ([*NEW, "--corrections", "1=2,2=1"], "--corrections must come with --mrclam; got 1=2,2=1"),
    ([*NEW, "--mrclam", "OUT", "--time", "0", "--corrections", "1-2"], "--corrections must be pairs of subjects"),
    (
        [*NEW, "--mrclam", "OUT", "--time", "0", "--corrections", "1=2,2=1", "--no-label-correction"],
        "--corrections must come with no --no-label-correction",
    ),
    ([*NEW, "--mrclam", "OUT", "--time", "0"], "Landmark_Groundtruth.dat"),
    (
        [*NEW, "--time", "3", "--robots", "2", "--targets", "2", "--seed", "1"],
        "--time must come with --mrclam; got 3.0",
    ),
]


@pytest.mark.parametrize(("arguments", "text"), BAD, ids=range(len(BAD)))
def test_bad_command_lines(
    arguments: list[str], text: str, scenario_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = sorted(os.listdir(tmp_path))
    filled = [a.replace("OUT", str(tmp_path)).replace("FILE", str(scenario_file)) for a in arguments]
    refused(filled, capsys, text)
    assert [name for name in sorted(os.listdir(tmp_path)) if name != "o"] == before
    assert not (tmp_path / "o").exists() or os.listdir(tmp_path / "o") == []


@pytest.mark.parametrize(
    ("words", "name"),
    [
        ("demo", "plan.csv"),
        ("bound FILE --no-certificate", "certificate.earlier.json"),
        ("bound FILE", "incomplete.txt"),
        ("track FILE --steps 2", "tracks.csv"),
        ("audit --quick", "audit.md"),
    ],
)
def test_what_must_not_be_replaced_is_refused_before_the_work(
    words: str, name: str, scenario_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Nothing else is in the folder then: no scenario, journal or report."""
    out = tmp_path / "o"
    out.mkdir()
    (out / name).symlink_to(scenario_file)
    filled = words.replace("FILE", str(scenario_file)).split()
    refused([*filled, "--out", str(out)], capsys, "out must be a new or a regular file, not a symbolic link")
    assert os.listdir(out) == [name]
    assert (out / name).is_symlink()


@pytest.mark.parametrize(
    ("plan", "text"),
    [
        ("{}", 'must be an object with "elements" or "controls"'),
        ("[0, 1, 2]", "must be an object"),
        ('{"elements": [0, 12]}', "elements must be a list of 3 integers, one per robot"),
        ('{"elements": [0, 12, 13]}', "elements[2] must be an element of robot 2; got 13 of robot 1"),
        ('{"elements": [0, 12, 99]}', "elements[2] must be an integer in [0, 35]; got 99"),
        ('{"elements": [0, 12, "x"]}', "elements[2] must be an integer"),
        ('{"controls": [0, 1, 12]}', "controls[2] must be an integer in [0, 11]; got 12"),
        ('{"controls": [0, 1, [2]]}', "controls must be a list of 3 integers"),
        ("{", "line 1"),
    ],
)
def test_bad_plans(
    plan: str, text: str, scenario_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "plan.json"
    path.write_text(plan)
    refused(["attack", str(scenario_file), "--plan", str(path)], capsys, text)
