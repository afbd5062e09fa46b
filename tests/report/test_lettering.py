"""What users name is drawn letter by letter, and a figure that cannot be drawn costs nothing else."""

import json
import re
import warnings
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.figure import Figure

import ratt_opt as ro
from ratt_opt.cli import run
from ratt_opt.report.lettering import Lettering, choose_fonts, literal
from ratt_opt.report.notebook import report_view
from ratt_opt.studies import Case, Study
from ratt_opt.studies import run as run_study

NAMES = ("$5", "$$", "Ba$$in", "$5 or $6", "$x_{$", r"$\frac$", r"\textbf{a}", "100% & _#^~", r"a\$b", "$a_b$")
NAMES += (
    "名前",
    "\U0001f6a4 boat",
    "e\u0301",
    "x" * 300,
    "שלום",
    "سلام",
    "two\nlines",
    "\u202ereversed",
    "\x1b[2J",
    "",
)


def shown(figure: Figure) -> list[str]:
    """All texts of a figure as matplotlib draws them; none is mathematics."""
    from matplotlib.cbook import is_math_text
    from matplotlib.text import Text

    figure.savefig(BytesIO(), format="svg")
    texts = [artist.get_text() for artist in figure.findobj(Text) if isinstance(artist, Text)]
    assert not any(is_math_text(re.sub(r"\$\\alpha_[sc]\$", "", text)) for text in texts)  # the paper's symbols
    return [text.replace(r"\$", "$") for text in texts]


@given(st.text(st.characters(codec="utf-8"), max_size=60))
def test_any_text_is_one_short_line_without_mathematics(text: str) -> None:
    from matplotlib.cbook import is_math_text

    kept = literal(text)
    assert not is_math_text(kept)
    assert kept.isprintable()
    assert len(literal(text, Lettering(longest=8)).replace(r"\$", "$")) <= 8 * len(r"\U00012345")


def test_long_names_keep_both_ends() -> None:
    names = {literal(f"{'x' * 200}{k}") for k in range(5)} | {literal(f"{k}{'x' * 200}") for k in range(5)}
    assert len(names) == 10
    assert {len(name) for name in names} == {Lettering().longest}


def first_choices(problem: ro.Problem) -> list[int]:
    return [int(choices[0]) for choices in problem.choices]


def test_names_of_planners_robots_and_targets_are_drawn_as_they_are() -> None:
    names = [name for name in NAMES if name and name.isprintable()]
    team = ro.random_scenario(len(names), 2, alpha_s=1, alpha_c=1, seed=0)
    team = team.replace(
        robots=[robot.replace(name=name) for robot, name in zip(team.robots, names, strict=True)],
        targets=[target.replace(name="$t_{$") for target in team.targets],
    )
    report = ro.bound(team, time_limit=2, planners=dict.fromkeys(names, first_choices), guarantees="none")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        texts = shown(report.plot())
    whole = ["".join(text.split()) for text in texts]  # beside a bar long names stand in lines
    for name in names:
        assert whole.count("".join(literal(name).replace(r"\$", "$").split())) >= 2  # on the map and beside a bar
    assert sum("$t_{$" in text for text in texts) == 2
    assert all(len(text) < 200 for text in texts)
    assert "<svg" in report_view(report)


@pytest.mark.parametrize("name", ["$x_{$", "Ba$$in", "x" * 300, "two\nlines"])
def test_names_in_figures_of_missions_and_studies_are_drawn_as_they_are(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from ratt_opt.missions.drawing.figures import mission_figure

    monkeypatch.setattr(first_choices, "__name__", name)
    drawn = literal(name).replace(r"\$", "$")
    mission = ro.run_mission(ro.random_scenario(3, 2, alpha_s=1, alpha_c=0, seed=0), steps=2, planner=first_choices)
    assert any(f"planner {drawn}" in text for text in shown(mission_figure([mission])))
    study = Study(
        name="costs",
        cases=(Case(n_robots=3, n_targets=2, alpha_s=1, alpha_c=0),),
        planners=("ratt", first_choices),
        attackers=("worst",),
        metrics=("value",),
    )
    results = run_study(study, tmp_path / "rows", trials=2)
    assert drawn in shown(results.plot())


def test_letters_that_the_font_lacks_are_taken_from_another_or_escaped(monkeypatch: pytest.MonkeyPatch) -> None:
    from matplotlib.figure import Figure
    from matplotlib.font_manager import fontManager

    from ratt_opt.report import lettering

    assert literal("drone 1") == "drone 1"
    for name in ("無人機", "цель", "🚗"):
        text = Figure().text(0, 0, literal(name))
        choose_fonts(text)
        assert text.get_text() == name or "\\" in text.get_text()
        assert len(text.get_fontfamily()) == 1 + (text.get_text() == name != "цель")
    lettering._font_with.cache_clear()
    monkeypatch.setattr(fontManager, "ttflist", [])
    assert literal("機 1") == "\\u6a5f 1"
    lettering._font_with.cache_clear()


def broken(*_: object) -> None:
    raise RuntimeError("no fonts\nat all")


def test_a_figure_that_fails_is_a_remark(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    team = ro.random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=0)
    ro.save_scenario(team, tmp_path / "team.json")
    report = ro.bound(team, time_limit=5)
    report.save(tmp_path / "saved")
    monkeypatch.setattr("ratt_opt.report.write.plan_figure", broken)
    remark = "the figures could not be drawn (RuntimeError: no fonts at all)"
    with pytest.warns(RuntimeWarning, match="could not be drawn"):
        report.save(tmp_path / "saved")
    assert run(["bound", str(tmp_path / "team.json"), "--out", str(tmp_path / "run")]) == 0
    assert remark in " ".join(capsys.readouterr().out.split())
    for folder in (tmp_path / "saved", tmp_path / "run"):
        files = {file.name for file in folder.iterdir()}
        assert files == {"report.json", "report.html", "plan.csv", "certificate.json", "cuts.json"}
        assert remark in json.loads((folder / "report.json").read_text(encoding="utf-8"))["remarks"]
        assert remark[1:] in (folder / "report.html").read_text(encoding="utf-8")
        assert ro.verify_certificate(folder / "certificate.json").lower_proved


def test_tables_of_missions_and_studies_do_not_wait_for_figures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    ro.save_scenario(ro.random_scenario(3, 2, alpha_s=1, alpha_c=0, seed=0), tmp_path / "team.json")
    monkeypatch.setattr("ratt_opt.missions.drawing.write.mission_figure", broken)
    assert run(["track", str(tmp_path / "team.json"), "--steps", "2", "--out", str(tmp_path / "run")]) == 0
    assert "the figures could not be drawn" in capsys.readouterr().out
    assert {"mission.json", "mission.csv", "tracks.csv"} <= {file.name for file in (tmp_path / "run").iterdir()}
    study = Study(
        name="costs",
        cases=(Case(n_robots=3, n_targets=2, alpha_s=1, alpha_c=0),),
        planners=("ratt", "greedy"),
        attackers=("worst",),
        metrics=("value",),
    )
    results = run_study(study, tmp_path / "rows", trials=2)
    monkeypatch.setattr("ratt_opt.studies.plots.comparison", broken)
    with pytest.warns(RuntimeWarning, match="could not be drawn"):
        files = results.save(tmp_path / "means")
    assert np.array_equal(sorted(file.name for file in files), ["means.csv", "means.tex"])
