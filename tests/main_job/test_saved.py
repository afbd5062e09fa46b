"""What a report leaves behind: files, plain data, a figure, a notebook's view; and what reads them again."""

import csv
import json

import pytest

import ratt_opt as ro
from ratt_opt.cli import run
from tests.oracles import brute_force_worst_case

SCENARIO = ro.random_scenario(5, 3, alpha_s=1, alpha_c=4, seed=3)


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    folder = tmp_path_factory.mktemp("saved")
    report = ro.bound(SCENARIO, certificate=folder / "proof.json")
    return report, folder / "out", report.save(folder / "out")


def test_save_returns_the_files_it_wrote(saved):
    report, out, files = saved
    assert sorted(files) == sorted(out.iterdir())
    assert json.loads((out / "report.json").read_text()) == report.to_dict()
    assert ro.verify_certificate(out / "certificate.json").upper == report.certificate.certificate.verified.upper


def test_save_writes_a_certificate_that_was_not_asked_for_before(tmp_path):
    report = ro.bound(SCENARIO)
    files = report.save(tmp_path / "with")
    assert tmp_path / "with" / "certificate.json" in files
    verified = ro.verify_certificate(tmp_path / "with" / "certificate.json")
    assert (verified.lower, verified.upper) == pytest.approx((report.optimum.lower, report.optimum.upper))
    said = json.loads((tmp_path / "with" / "report.json").read_text())["certificate"]
    assert "not asked for" not in json.dumps(said)
    assert not any(file.name == "certificate.json" for file in report.save(tmp_path / "without", certificate=False))


def test_the_archive_runs_again_and_says_the_same(saved, tmp_path):
    """The input in it is whole: planned again, it gives the same report."""
    report, out, _ = saved
    document = json.loads((out / "report.json").read_text())
    (tmp_path / "again.json").write_text(json.dumps(document["input"]["document"]))
    again = ro.load_input(tmp_path / "again.json")
    assert again == SCENARIO
    redone = ro.bound(again).to_dict()
    for name in ("input", "ratt", "optimum", "baselines", "guarantees", "seeds", "control_values", "views"):
        assert redone[name] == document[name], name
    other = ro.bound(SCENARIO.replace(alpha_s=0)).to_dict()
    assert other["input"]["sha256"] != document["input"]["sha256"]
    assert document["software"] == f"ratt-opt {ro.__version__}"
    assert document["created"].endswith("+00:00")
    assert ro.bound(SCENARIO.problem()).to_dict()["input"] is None
    assert len(document["labels"]) == len(document["owners"]) == report.problem.objective.n


def test_plan_csv_says_what_each_robot_does(saved):
    report, out, _ = saved
    with (out / "plan.csv").open() as file:
        rows = list(csv.DictReader(file))
    plan = report.recommended
    assert [int(row["element"]) for row in rows] == plan.elements.tolist()
    roles = {int(row["robot"]): row["under attack"] for row in rows}
    assert {i for i, role in roles.items() if role == "blinded"} == plan.worst_case.attack.sensing
    assert {i for i, role in roles.items() if role == "sees"} == plan.best_group
    for row in rows:
        pose = SCENARIO.predicted_poses[int(row["element"])]
        assert [float(row[name]) for name in ("x", "y", "heading")] == pose.tolist()
        assert row["control"] == SCENARIO.element_labels[int(row["element"])]


def test_attack_takes_a_whole_report(saved, tmp_path, capsys):
    report, out, _ = saved
    ro.save_scenario(SCENARIO, tmp_path / "s.json")
    assert run(["attack", str(tmp_path / "s.json"), "--plan", str(out / "report.json"), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["elements"] == report.recommended.elements.tolist()
    assert found["attacks"]["worst"]["upper"] == pytest.approx(report.recommended.worst_case.upper, rel=1e-12)


@pytest.mark.parametrize("seed", range(6))
def test_views_are_attacks_in_order_of_harm(seed):
    """The next worst spares a robot: the oracle's worst case of the problems with one attacked robot protected."""
    scenario = ro.random_scenario(4, 3, alpha_s=2, alpha_c=2, seed=seed)
    report = ro.bound(scenario)
    plan, problem = report.recommended, report.problem
    assert list(report.views) == ["worst", "next worst", "none"]
    worst, following, none = report.views.values()
    assert worst == plan
    spared = [
        brute_force_worst_case(scenario.replace(protected_robots=(i,)).problem(), plan.elements)
        for i in worst.worst_case.attack.sensing
    ]
    assert following.worst_case.upper == pytest.approx(min(spared), rel=1e-9)
    assert following.worst_case.attack != worst.worst_case.attack
    assert none.worst_case.upper == pytest.approx(problem.objective(plan.elements), rel=1e-12)
    assert worst.worst_case.upper <= following.worst_case.upper <= none.worst_case.upper


def test_nothing_to_attack_has_no_next_worst():
    report = ro.bound(ro.random_scenario(2, 1, alpha_s=0, alpha_c=0, seed=0))
    assert list(report.views) == ["worst", "none"]


def test_notebooks_show_names_and_numbers(saved):
    report, _, _ = saved
    shown = report._repr_html_()
    assert all(plan.planner in shown for plan in report.plans)
    assert "<svg" in shown
    assert "http" not in shown.partition("<svg")[0]
    problem = report.problem
    plan, worst = ro.ratt(problem), report.ratt.worst_case
    for value in (plan, worst, worst.attack, report.optimum):
        assert json.loads(json.dumps(value.to_dict(), allow_nan=False)) == value.to_dict()
        assert type(value).__name__ in value._repr_html_()
    assert f"{worst.upper:.10g}" in worst._repr_html_()
    assert plan.to_dict()["elements"] == report.ratt.elements.tolist()


def test_plot_has_a_map_even_where_no_places_are_known(saved):
    report, _, _ = saved
    assert report.plot().axes[0].get_xlabel() == "x [m]"
    assert "layout" in ro.bound(SCENARIO.problem()).plot().axes[0].get_xlabel()
