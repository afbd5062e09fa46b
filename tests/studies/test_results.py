"""What a study is made of afterwards: means, intervals, data frame, LaTeX, figure; and studies in one call."""

import csv
import subprocess
import sys
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import ttest_1samp

import ratt_opt as ro
from ratt_opt.studies import Case, Seeds, Study, SweepError, run
from ratt_opt.studies.plots import comparison
from tests.studies.own import STUDY, boldest, first_robot

CASES = tuple(Case(n_robots=3, n_targets=2, alpha_s=s, alpha_c=0) for s in (0, 1))


def shifted(problem: ro.Problem, by: int) -> np.ndarray:
    """Every robot's element number ``by``."""
    return np.array([own[by % len(own)] for own in problem.choices])


@dataclass(frozen=True)
class Shifted:
    """The same as an object with a setting."""

    by: int

    def __call__(self, problem: ro.Problem) -> np.ndarray:
        return shifted(problem, self.by)


def no_plan(problem: ro.Problem) -> str:  # noqa: ARG001
    return "none"


@pytest.fixture(scope="module")
def results() -> object:
    study = Study(
        name="s", cases=CASES, planners=("ratt", "random", boldest), attackers=("worst",), metrics=("value", "mse")
    )
    return run(study, trials=4)


def test_a_study_runs_in_one_call_and_leaves_nothing_behind(results) -> None:
    assert len(results.rows) == 8
    assert results.path is None
    assert "8 rows" in repr(results)


def test_rows_are_the_same_with_a_folder_and_are_not_run_again(tmp_path: Path, results) -> None:
    kept = run(results.study, tmp_path, trials=3)
    again = run(results.study, tmp_path, trials=4)
    assert again.path == tmp_path / "table.csv"
    assert again.rows == results.rows
    assert len(kept.rows) == 6


def test_means_have_the_intervals_of_students_t(results) -> None:
    for mean in results.means(minus="ratt"):
        kept = [row for row in results.rows if row["case"] == mean.case]
        ours, base = (
            np.array([float(row[f"{name}/{mean.attacker}/{mean.metric}"]) for row in kept])
            for name in (mean.planner, "ratt")
        )
        assert mean.estimate.mean == pytest.approx((ours - base).mean())
        if (ours - base).std() > 0:
            low, high = ttest_1samp(ours - base, 0).confidence_interval()
            assert (mean.estimate.low, mean.estimate.high) == pytest.approx((low, high))
    assert {mean.planner for mean in results.means(minus="ratt")} == {"random", "boldest"}
    assert len(results.means()) == 2 * 3 * 2
    assert len(results.means(metric="mse")) == 2 * 3


def test_intervals_of_what_is_never_negative_stop_at_zero(results) -> None:
    rows = tuple({**row, "ratt/worst/mse": str(k % 4 == 0)} for k, row in enumerate(results.rows))
    rows = tuple({**row, "ratt/worst/mse": "100" if row["ratt/worst/mse"] == "True" else "0"} for row in rows)
    wild = replace(results, rows=rows)
    found = [mean.estimate for mean in wild.means(metric="mse") if mean.planner == "ratt"]
    assert [e.low for e in found] == [0.0, 0.0]
    assert all(e.mean == 25 and e.high > 25 for e in found)
    assert any(mean.estimate.low < 0 for mean in wild.means(metric="mse", minus="random") if mean.planner == "ratt")


def test_latex_has_a_row_for_each_case_and_planner_and_escapes_names(results) -> None:
    text = results.to_latex(caption="What planners_keep")
    body = text[text.index("\\midrule") : text.index("\\bottomrule")].splitlines()[1:]
    assert len(body) == 2 * 3
    assert all(line.count(" & ") == 4 and line.endswith(r" \\") for line in body)
    assert r"$\alpha_s$=1 $\alpha_c$=0" in text
    assert "value [m$^2$]" in text
    assert "value, difference from ratt [m$^2$]" in results.to_latex(minus="ratt")
    assert r"\caption{What planners\_keep}" in text
    assert text.count("{") == text.count("}")
    assert "begin{table}" not in results.to_latex()


def test_a_data_frame_has_numbers_as_numbers(results) -> None:
    pytest.importorskip("pandas")
    frame = results.to_dataframe()
    assert frame.shape == (8, len(results.rows[0]))
    assert frame["trial"].dtype.kind == "i"
    assert frame["ratt/worst/value"].tolist() == [float(row["ratt/worst/value"]) for row in results.rows]
    means = results.to_dataframe(means=True)
    by_hand = frame.groupby("case")["ratt/worst/value"].mean()
    ours = means[(means.planner == "ratt") & (means.metric == "value")].set_index("case")["mean"]
    assert ours.to_dict() == pytest.approx(by_hand.to_dict())


def test_a_missing_pandas_is_one_line(results, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ro.InputError, match="needs pandas: pip install"):
        results.to_dataframe()


def test_figures_take_planners_of_ones_own(tmp_path: Path, results) -> None:
    for minus in (None, "ratt"):
        figure = results.plot("value", minus=minus)
        (axes,) = figure.axes
        labels = axes.get_legend_handles_labels()[1]
        assert labels == (["ratt", "random", "boldest"] if minus is None else ["random", "boldest"])
    written = {path.name for path in results.save(tmp_path)}
    assert written == {"means.csv", "means.tex", "means.png", "means.svg"}
    table = list(csv.DictReader((tmp_path / "means.csv").read_text().splitlines()))
    assert len(table) == 12
    assert {row["trials"] for row in table} == {"4"}


def test_one_trial_has_no_interval(tmp_path: Path, results) -> None:
    one = run(results.study, trials=1)
    one.save(tmp_path)
    table = list(csv.DictReader((tmp_path / "means.csv").read_text().splitlines()))
    assert {row["low"] for row in table} == {""}


def test_planners_with_settings_and_names_of_their_own() -> None:
    study = Study(
        name="s",
        cases=CASES[:1],
        planners={"first": Shifted(0), "second": partial(shifted, by=1), "ratt": "ratt"},
        attackers=(first_robot,),
        metrics=("value",),
    )
    row = run(replace(study, cases=CASES[1:]), trials=1).rows[0]
    same = run(replace(study, cases=CASES[1:], planners=(Shifted(0), partial(shifted, by=1))), trials=1).rows[0]
    assert row["first/first_robot/value"] == same["Shifted(by=0)/first_robot/value"]
    assert row["second/first_robot/value"] == same["shifted(by=1)/first_robot/value"]
    assert study.definition()["planners"]["first"].endswith(":Shifted(by=0)")
    assert study.fingerprint() != replace(study, planners={**study.planners, "first": Shifted(2)}).fingerprint()


def test_attackers_and_planners_are_those_of_missions() -> None:
    """The same two functions fly a mission and play a study."""
    scenario = ro.random_scenario(3, 2, alpha_s=1, alpha_c=0, seed=1)
    mission = ro.run_mission(scenario, steps=2, planner=boldest, attacker=first_robot)
    assert all(step.attack.sensing == {0} for step in mission.steps)
    row = run(replace(STUDY, attackers=(first_robot, "worst")), trials=1).rows[0]
    assert float(row["boldest/worst/value"]) <= float(row["boldest/first_robot/value"])
    assert row["boldest/first_robot/proved"] == "0.0"  # an attack alone proves nothing


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"planners": ("rat",)}, "planners must be among maxmin, ratt, .* or functions; got rat"),
        ({"attackers": ("wurst",)}, "attackers must be among none, worst"),
        ({"metrics": ("values",)}, "metrics must be among value, proved, trace, mse; got values"),
        ({"quantities": ("x",)}, "quantities must be among"),
        ({"planners": {"a/b": boldest}}, "names without '/'"),
    ],
)
def test_names_are_refused_before_a_trial_is_run(change, text) -> None:
    with pytest.raises(ro.InputError, match=text):
        replace(STUDY, **change)


def test_a_planner_that_returns_no_plan_is_named() -> None:
    with pytest.raises(SweepError, match="planner must return a plan or its elements"):
        run(replace(STUDY, planners=(no_plan,)), trials=1)


@pytest.mark.parametrize("bad", [{"trials": 0}, {"workers": 0}])
def test_numbers_break_their_rules_in_one_line(bad) -> None:
    with pytest.raises(ro.InputError, match="must be an integer >= 1"):
        run(STUDY, **bad)


@pytest.mark.parametrize("bad", [{"metric": "x"}, {"minus": "x"}])
def test_what_is_not_there_is_refused(results, bad) -> None:
    with pytest.raises(ro.InputError, match="got x"):
        results.means(**bad)


def test_a_script_outside_the_repository_compares_its_planner(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text(
        "import sys\n"
        "from ratt_opt.studies import Case, Entry, Study, main\n"
        "def mine(problem):\n"
        "    return [own[0] for own in problem.choices]\n"
        "case = Case(n_robots=3, n_targets=2, alpha_s=1, alpha_c=1)\n"
        "study = Study(name='mine', cases=(case,), planners=('ratt', mine), attackers=('exact',), metrics=('value',))\n"
        "if __name__ == '__main__':\n"
        "    sys.exit(main('Mine.', [Entry(study)], trials=2))\n"
    )
    command = [sys.executable, "mine.py", "--workers", "1", "--out", "out"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert "mine" in done.stdout
    assert "mean of 2 trials, with its 95 % interval" in done.stdout
    assert (tmp_path / "out" / "mine" / "means.svg").exists()
    done = subprocess.run([*command, "--latex"], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert r"\begin{tabular}" in done.stdout


def test_the_papers_figures_take_planners_and_attackers_of_ones_own(tmp_path: Path) -> None:
    from analysis.paper.comparison_figure import draw_comparison
    from analysis.paper.small_scale import STUDY as PAPER

    planners, cases = (*PAPER.planners, boldest), PAPER.cases[:2]
    study = replace(PAPER, cases=cases, planners=planners, attackers=("worst", first_robot))
    draw_comparison(run(study, trials=2).rows, tmp_path, name="small_scale", panels=[cases])
    names = {path.stem for path in tmp_path.glob("*.svg")}
    assert names == {"small_scale" + a + b for a in ("", "_first_robot") for b in ("", "_paired")}
    assert "boldest" in (tmp_path / "small_scale.svg").read_text()


@pytest.mark.parametrize("n_planners", [5, 7])
@pytest.mark.parametrize("minus", [None, "ratt"])
def test_everything_of_a_figure_is_within_its_edges(results, n_planners, minus) -> None:
    names = ["ratt", *("W" * 40 + str(k) for k in range(n_planners - 1))]
    means = [replace(mean, planner=names[0]) for mean in results.means(metric="value") if mean.planner == "ratt"]
    means = [replace(mean, planner=name, minus=minus or "") for name in names for mean in means]
    figure = comparison(means, results.note(minus), results.unit)
    figure.draw_without_rendering()
    (legend,) = figure.legends
    texts = [*legend.get_texts(), figure._supxlabel, figure.axes[0].yaxis.label, figure.axes[0].title]
    assert texts[0].get_text() == "ratt"
    boxes = [legend.get_window_extent(), *(text.get_window_extent() for text in texts)]
    assert all(figure.bbox.x0 <= box.x0 <= box.x1 <= figure.bbox.x1 for box in boxes)
    assert all(figure.bbox.y0 <= box.y0 <= box.y1 <= figure.bbox.y1 for box in boxes)
    assert not legend.get_window_extent().overlaps(figure.axes[0].get_tightbbox())
    assert figure.axes[0].get_ylabel().startswith("value [m²]")


def cameras(case: Case, seeds: object) -> ro.Scenario:
    """Turning cameras instead of the paper's teams."""
    sizes = {"alpha_s": case.alpha_s, "alpha_c": case.alpha_c, "seed": seeds.scenario}
    return ro.limited_view_scenario(case.n_robots, case.n_targets, view=60, **sizes)


def test_brackets_of_the_optimum_have_the_unit_of_values() -> None:
    for metrics in (("value",), ("mse",)):
        study = Study(
            name="s",
            cases=CASES[:1],
            planners=("ratt",),
            attackers=("worst",),
            metrics=metrics,
            quantities=("optimum",),
        )
        heads, _ = run(study, trials=1).mean_rows()
        assert {"optimum/lower [m²]", "optimum/upper [m²]", f"{metrics[0]} [m²]"} <= set(heads)


def test_a_study_makes_scenarios_of_its_own() -> None:
    study = Study(
        name="s", cases=CASES[1:], planners=("ratt",), attackers=("worst",), metrics=("value", "mse"), problem=cameras
    )
    row = run(study, trials=1).rows[0]
    problem = cameras(CASES[1], Seeds.of(study.seed, 0)).problem()
    worst = ro.worst_case_attack(problem, ro.ratt(problem))
    assert worst.lower <= float(row["ratt/worst/value"]) <= worst.upper
    assert float(row["ratt/worst/mse"]) > 0
