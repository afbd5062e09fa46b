"""The command line as a stranger uses it: files, tables, JSON, refusals in one line with exit code 2."""

import json
import os
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from ratt_opt import (
    InformationInput,
    Scenario,
    breaking_budgets,
    criticality_ranking,
    limited_view_scenario,
    links_to_add,
    links_to_protect,
    load_scenario,
    network_scenario,
    random_scenario,
    save_scenario,
    worst_case_attack,
)
from ratt_opt.cli import run
from ratt_opt.report.schemas import output_schema
from ratt_opt.scenario.networks import NETWORK_FAMILIES
from tests.certificates.engine import step
from tests.cli.refusal import refused

REPORT_FIELDS = {
    "format", "version", "n_robots", "n_targets", "objective", "alpha_s", "alpha_c", "n_max", "alpha_cs", "ratt",
    "optimum", "certificate", "certified_ratio", "curvature", "total_curvature", "guarantees", "baselines",
}  # fmt: skip


def _strict(text: str) -> Any:
    def refuse(name: str) -> None:
        raise AssertionError(f"{name} is not strict JSON")

    return json.loads(text, parse_constant=refuse)


def test_demo_writes_report_and_figures(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["demo", "--out", str(tmp_path / "demo")]) == 0
    written = [
        "certificate.json",
        "cuts.json",
        "plan.csv",
        "plan.png",
        "plan.svg",
        "report.html",
        "report.json",
        "scenario.json",
    ]
    assert sorted(os.listdir(tmp_path / "demo")) == written
    report = _strict((tmp_path / "demo" / "report.json").read_text())
    assert report.keys() >= REPORT_FIELDS
    assert (report["n_robots"], report["n_targets"], report["alpha_s"], report["alpha_c"]) == (6, 6, 2, 4)
    assert report["certificate"]["verified"]
    assert report["optimum"]["upper"] - report["optimum"]["lower"] <= 1e-9 * report["optimum"]["upper"]
    assert report["optimum"]["lower"] <= report["optimum"]["upper"]
    assert report["ratt"]["worst_case"]["lower"] / report["optimum"]["upper"] == report["certified_ratio"] <= 1
    assert report["total_curvature"]["domain"] == "feasible"
    assert {"greedy", "myopic", "random", "nonrobust_optimum"} <= report["baselines"].keys()
    printed = capsys.readouterr().out
    assert "RATT's certified share of the best possible" in printed
    assert (tmp_path / "demo" / "plan.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "demo" / "plan.svg").read_text().startswith("<?xml")


def test_the_demo_s_scenario_is_the_first_by_its_rule_and_the_paper_s_is_an_option(tmp_path: Path) -> None:
    """By the rule that the help states, with its own words for it: connected, and every target in some view."""
    assert run(["demo", "--out", str(tmp_path / "demo"), "--no-certificate"]) == 0

    def drawn(seed: int) -> Scenario:
        return limited_view_scenario(6, 6, alpha_s=2, alpha_c=4, seed=seed, reach=40, communication_range=45)

    def fits(scenario: Scenario) -> bool:
        graph = scenario.problem().communication
        told = scenario.problem().objective.information.any(axis=(2, 3)).any(axis=0)
        return len(graph.groups()) == 1 and bool(told.all())

    first = next(scenario for seed in range(100) if fits(scenario := drawn(seed)))
    assert load_scenario(tmp_path / "demo" / "scenario.json") == first
    assert run(["demo", "--paper", "--out", str(tmp_path / "paper"), "--no-certificate"]) == 0
    paper = random_scenario(4, 4, alpha_s=1, alpha_c=3, seed=14)
    assert load_scenario(tmp_path / "paper" / "scenario.json") == paper


def test_new_writes_teams_that_turn(tmp_path: Path) -> None:
    words = "--robots 6 --targets 4 --sensing-attacks 2 --link-attacks 3 --seed 5 --view 75 --range 33"
    more = "--headings 6 --communication-range 40 --sensor radar"
    assert run(["new", *words.split(), *more.split(), "--out", str(tmp_path / "turn.json")]) == 0
    expected = limited_view_scenario(
        6, 4, alpha_s=2, alpha_c=3, seed=5, view=75, reach=33, headings=6, communication_range=40, sensor="radar"
    )
    assert load_scenario(tmp_path / "turn.json") == expected
    assert run(["new", *words.split(), "--out", str(tmp_path / "plain.json")]) == 0
    plain = limited_view_scenario(6, 4, alpha_s=2, alpha_c=3, seed=5, view=75, reach=33)
    assert load_scenario(tmp_path / "plain.json") == plain


@pytest.mark.parametrize("objective", ["trace", "logdet", "maxeig"])
def test_bound_reports_what_the_library_computes(
    scenario_file: Path, tmp_path: Path, objective: str, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert run(["bound", str(scenario_file), "--out", str(out), "--objective", objective, "--json"]) == 0
    report = _strict(capsys.readouterr().out)
    assert report == _strict((out / "report.json").read_text())
    problem = random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=5).problem(objective)
    for plan in (report["ratt"], report["optimum"]):
        assert worst_case_attack(problem, plan["elements"]).lower == pytest.approx(
            plan["worst_case"]["lower"], rel=1e-12
        )
        assert plan["controls"] == [e - 12 * i for i, e in enumerate(plan["elements"])]
    assert report["curvature" if objective == "logdet" else "total_curvature"]["lower"] > 0
    assert all(0 <= value <= report["certified_ratio"] + 1e-12 for value in report["guarantees"].values())


def test_blinding_everyone_is_worth_nothing_and_ratio_one(tmp_path: Path) -> None:
    path = tmp_path / "s.json"
    save_scenario(random_scenario(2, 2, alpha_s=2, alpha_c=0, seed=0), path)
    assert run(["bound", str(path), "--out", str(tmp_path / "o")]) == 0
    report = _strict((tmp_path / "o" / "report.json").read_text())
    assert report["optimum"]["upper"] == report["ratt"]["worst_case"]["lower"] == 0
    assert report["certified_ratio"] == 1.0
    assert report["certificate"]["lower_proved"]
    assert run(["verify", str(tmp_path / "o" / "certificate.json")]) == 0


def test_a_model_free_file_is_bounded(tmp_path: Path) -> None:
    document = {
        "format": "ratt-opt information", "version": 1, "alpha_s": 1, "alpha_c": 0, "robot": [0, 0, 1],
        "prior": [[[2.0]]], "information": [[[[1.0]]], [[[2.0]]], [[[0.5]]]],
    }  # fmt: skip
    path = tmp_path / "i.json"
    path.write_text(json.dumps(document))
    assert run(["bound", str(path), "--out", str(tmp_path / "o")]) == 0
    report = _strict((tmp_path / "o" / "report.json").read_text())
    assert report["optimum"]["upper"] == pytest.approx(2 - 1 / (0.5 + 0.5))


@pytest.mark.parametrize("objective", ["trace", "logdet", "maxeig"])
def test_a_bound_comes_with_a_certificate_that_verifies(
    scenario_file: Path, tmp_path: Path, objective: str, capsys: pytest.CaptureFixture[str]
) -> None:
    out, about = tmp_path / "out", ["--problem", str(scenario_file), "--objective", objective]
    assert run(["bound", str(scenario_file), "--out", str(out), "--objective", objective]) == 0
    printed = capsys.readouterr().out
    assert "verified, both ends proved in" in printed
    assert "certificate.json" in printed
    assert run(["verify", str(out / "certificate.json"), *about]) == 0
    text = capsys.readouterr().out
    assert "no plan has a worst-case value above" in text
    assert "not covered" in text
    assert run(["verify", str(out / "certificate.json"), "--json"]) == 0
    found = _strict(capsys.readouterr().out)
    report = _strict((out / "report.json").read_text())
    assert report["certificate"]["claim"] == {"lower": found["lower"], "upper": found["upper"]}
    assert report["certificate"]["problem_hash"] == found["problem_hash"]
    assert found["lower"] <= report["optimum"]["lower"] <= report["optimum"]["upper"] <= found["upper"]
    assert found["elements"] == report["optimum"]["elements"]


def test_an_earlier_runs_certificate_is_kept_under_another_name(
    scenario_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["bound", str(scenario_file), "--out", str(tmp_path / "o")]
    assert run(command) == 0
    assert run([*command, "--no-certificate"]) == 0
    assert not (tmp_path / "o" / "certificate.json").exists()
    assert "none: not asked for" in capsys.readouterr().out
    assert _strict((tmp_path / "o" / "report.json").read_text())["certificate"]["verified"] is False


def test_a_bound_whose_proof_has_a_fault_fails(
    scenario_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A solver that claims too much: its proof is refused, nothing is printed as a result, the report says so."""

    def without_last_leaf(real: Any) -> Any:
        def faulty(*arguments: Any) -> Any:
            record = real(*arguments)
            record["tree"].pop()
            return record

        return faulty

    step(monkeypatch, "upper end", without_last_leaf)
    assert run(["bound", str(scenario_file), "--out", str(tmp_path / "o")]) == 1
    shown = capsys.readouterr()
    assert shown.out == ""
    assert "error: upper proof: a case has no leaf" in shown.err
    report = _strict((tmp_path / "o" / "report.json").read_text())
    assert "a case has no leaf" in report["certificate"]["reason"]
    assert not (tmp_path / "o" / "certificate.json").exists()


@pytest.mark.parametrize(
    "case",
    [
        (lambda text: text[:-30], "complete JSON", 2),
        (lambda text: text.replace('"version":2', '"version":1'), "version must be 2: write the certificate again", 2),
        (lambda text: text.replace('"claim":{"lower":', '"claim":{"lower":9'), "lower is above upper", 1),
        (lambda text: text[:0], "complete JSON", 2),
    ],
)
def test_verify_names_the_first_fault_in_one_line(
    case: tuple[Any, str, int], scenario_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    edit, text, code = case
    path = tmp_path / "o" / "certificate.json"
    assert run(["bound", str(scenario_file), "--out", str(tmp_path / "o")]) == 0
    path.write_text(edit(path.read_text()))
    capsys.readouterr()
    for arguments in (["verify", str(path)], ["verify", str(path), "--json"]):
        assert run(arguments) == code
        shown = capsys.readouterr()
        assert shown.out == ""
        assert shown.err.startswith("error: ")
        assert text in shown.err
        assert shown.err.count("\n") == 1


def test_verify_refuses_a_missing_file_and_another_problem(
    scenario_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # messages shorten long paths
    assert run(["verify", "none.json"]) == 2
    assert "none.json" in capsys.readouterr().err
    assert run(["bound", str(scenario_file), "--out", str(tmp_path / "o")]) == 0
    certificate = str(tmp_path / "o" / "certificate.json")
    assert run(["verify", certificate, "--problem", str(scenario_file), "--objective", "logdet"]) == 1
    assert "different problem" in capsys.readouterr().err


def test_attack_says_what_to_protect(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Ranking and smallest budgets as the library finds them; what is protected already is never attacked."""
    path, plan = tmp_path / "scenario.json", tmp_path / "plan.json"
    free = random_scenario(5, 3, alpha_s=1, alpha_c=4, seed=2)
    scenario = free.replace(protected_robots=(1,), protected_links=((0, 2),))
    save_scenario(scenario, path)
    plan.write_text('{"controls": [0, 0, 0, 0, 0]}')
    problem, elements = scenario.problem("trace"), [0, 12, 24, 36, 48]
    worst = worst_case_attack(problem, elements).upper
    below = worst * 0.9
    command = ["attack", str(path), "--plan", str(plan), "--rank", "4", "--below", str(below)]
    assert run([*command, "--json"]) == 0
    document = _strict(capsys.readouterr().out)
    assert all(1 not in found["sensing"] and [0, 2] not in found["links"] for found in document["attacks"].values())
    ranking = criticality_ranking(problem, elements)
    assert [row["gain_lower"] for row in document["critical"]] == [row.gain_lower for row in ranking[:4]]
    assert [row.get("robot", tuple(row.get("link", ()))) for row in document["critical"]] == [
        row.target for row in ranking[:4]
    ]
    found = [(row["alpha_s"], row["alpha_c"], row["proved"]) for row in document["breaking_budgets"]]
    assert found == [(row.alpha_s, row.alpha_c, True) for row in breaking_budgets(problem, elements, below)]
    assert run(command) == 0
    printed = capsys.readouterr().out
    assert "what to protect" in printed
    assert "smallest budgets that leave less than" in printed
    assert run([*command[:-1], "0"]) == 0
    assert "no attack on what is" in capsys.readouterr().out
    refused([*command[:-1], "nan"], capsys, "--below must be a finite number; got nan")


def test_attack_finds_the_best_links(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """As the library finds them; new links no longer than the range that is asked for."""
    path, plan, reach = tmp_path / "scenario.json", tmp_path / "plan.json", 12.0
    scenario = network_scenario("disk-6", 9, 3, alpha_s=1, alpha_c=4, seed=1)
    save_scenario(scenario, path)
    problem = scenario.problem("trace")
    elements = [choice[0] for choice in problem.choices]
    plan.write_text(json.dumps({"elements": [int(e) for e in elements]}))
    command = ["attack", str(path), "--plan", str(plan), "--protect", "2", "--add", "2", "--reach", str(reach)]
    assert run([*command, "--json"]) == 0
    document = _strict(capsys.readouterr().out)["best_links"]
    near = set(scenario.pairs_within(reach)) - problem.communication.links
    for name, found in (
        ("protect", links_to_protect(problem, elements, 2)),
        ("add", links_to_add(problem, elements, 2, candidates=near)),
    ):
        assert document[name]["links"] == [list(link) for link in found.links]
        assert (document[name]["lower"], document[name]["upper"]) == (found.lower, found.upper)
    assert {tuple(link) for link in document["add"]["links"]} <= near
    assert run(command) == 0
    assert "the best links" in capsys.readouterr().out
    refused([*command[:-1], "nan"], capsys, "reach must be a finite number >= 0; got nan")


def test_new_links_are_drawn_where_a_model_free_file_places_its_robots(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Of robots 0, 3 and 5 m along a line, of which 1 alone has a link, only 1 and 2 are within 4 m."""
    path, plan = tmp_path / "team.json", tmp_path / "plan.json"
    plan.write_text('{"elements": [0, 1, 2]}')
    team = InformationInput(
        prior=[[[1.0]]], information=[[[[1.0]]]] * 3, robot=[0, 1, 2], alpha_s=0, alpha_c=0, links=[(0, 1)],
        robot_positions=[(0, 0), (3, 0), (5, 0)],
    )  # fmt: skip
    path.write_text(team.model_dump_json())
    command = ["attack", str(path), "--plan", str(plan), "--add", "1", "--reach", "4"]
    assert run([*command, "--json"]) == 0
    assert _strict(capsys.readouterr().out)["best_links"]["add"]["links"] == [[1, 2]]
    path.write_text(team.model_copy(update={"robot_positions": None}).model_dump_json())
    refused(command, capsys, "reach needs an input that says where the robots are")


def test_attack_explains_its_bracket(scenario_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Stages that ran, with the ends that they moved."""
    plan = tmp_path / "plan.json"
    plan.write_text('{"controls": [0, 4, 11]}')
    command = ["attack", str(scenario_file), "--plan", str(plan)]
    assert run([*command, "--explain", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["stages"]
    assert document["stages"][-1]["upper"] == pytest.approx(document["attacks"]["worst"]["upper"])
    assert run([*command, "--explain"]) == 0
    assert document["stages"][0]["stage"] in capsys.readouterr().out
    params = tmp_path / "params.toml"
    params.write_text("[annealing]\nmoves = 100\n[set_search]\nwhole = [[1000, 10]]\n")
    assert run([*command, "--explain", "--json", "--params", str(params)]) == 0
    explained = json.loads(capsys.readouterr().out)
    assert explained["params"] == {"annealing.moves": 100, "set_search.whole": [[1000, 10]]}
    assert explained["attacks"]["worst"]["upper"] == pytest.approx(document["attacks"]["worst"]["upper"])
    params.write_text("[annealing]\nmoves = -1\n")
    refused([*command, "--params", str(params)], capsys, "params.annealing.moves must be at least 0 and finite; got -1")
    params.write_text("[annealing]\nsteps = 1\n")
    refused([*command, "--params", str(params)], capsys, "params.annealing must name some of moves")
    assert run([*command, "--json"]) == 0
    assert "stages" not in json.loads(capsys.readouterr().out)


def test_attack_evaluates_the_users_plan(
    scenario_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan = tmp_path / "plan.json"
    plan.write_text('{"controls": [0, 4, 11]}')
    assert run(["attack", str(scenario_file), "--plan", str(plan), "--json"]) == 0
    document = _strict(capsys.readouterr().out)
    assert document["elements"] == [0, 16, 35]
    exact = document["attacks"]["worst"]
    assert 0 < exact["upper"] - exact["lower"] < 1e-9 * exact["upper"]
    assert all(exact["lower"] <= result["upper"] for result in document["attacks"].values())
    assert run(["attack", str(scenario_file), "--plan", str(plan)]) == 0
    assert "bounded_rational" in capsys.readouterr().out


def test_new_is_reproducible(tmp_path: Path) -> None:
    common = ["--robots", "4", "--targets", "3", "--sensing-attacks", "1", "--link-attacks", "2", "--seed", "7"]
    for name in ("a.json", "b.json"):
        assert run(["new", *common, "--out", str(tmp_path / name)]) == 0
    assert (tmp_path / "a.json").read_bytes() == (tmp_path / "b.json").read_bytes()


def test_new_draws_the_network_of_its_family(tmp_path: Path) -> None:
    common = ["--robots", "9", "--targets", "3", "--sensing-attacks", "1", "--link-attacks", "2", "--seed", "7"]
    for family in NETWORK_FAMILIES:
        path = tmp_path / f"{family}.json"
        assert run(["new", "--graph", family, *common, "--out", str(path)]) == 0
        assert load_scenario(path) == network_scenario(family, 9, 3, alpha_s=1, alpha_c=2, seed=7)


def test_every_command_has_help(capsys: pytest.CaptureFixture[str]) -> None:
    for command in ("demo", "new", "bound", "attack", "verify", "audit", "schema"):
        assert run([command, "--help"]) == 0
        assert "--help" in capsys.readouterr().out
    assert run(["--version"]) == 0
    assert capsys.readouterr().out.strip() == "1.0.0"


def test_decentralise_writes_plan_costs_and_picture(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, out = str(tmp_path / "s.json"), tmp_path / "out"
    words = "--robots 5 --targets 4 --sensing-attacks 1 --link-attacks 2 --seed 1 --out"
    assert run(["new", *words.split(), file]) == 0
    capsys.readouterr()
    command = ["decentralise", file, "--out", str(out), "--loss", "0.1", "--cut", "2:0-1", "--crash", "3:4"]
    assert run([*command, "--curvature-time", "0.2", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document == json.loads((out / "decentralised.json").read_text())
    jsonschema.validate(document, output_schema("decentralised"))
    assert document["components"] == [[0, 1, 2, 3], [4]]
    assert [fault["kind"] for fault in document["faults_met"]] == ["cut", "crashed"]
    assert {file.name for file in out.iterdir()} == {f"decentralised.{end}" for end in ("json", "png", "svg")}


@pytest.mark.parametrize(
    ("option", "value", "named"),
    [("--cut", "2:0", "--cut"), ("--cut", "2:0-9", "cuts"), ("--crash", "1:9", "crashed"), ("--loss", "1", "loss")],
)
def test_faults_that_cannot_be_are_refused_before_anything_is_written(
    option: str, value: str, named: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = str(tmp_path / "s.json")
    words = "--robots 4 --targets 4 --sensing-attacks 1 --link-attacks 2 --seed 1 --out"
    assert run(["new", *words.split(), file]) == 0
    assert run(["decentralise", file, "--out", str(tmp_path / "out"), option, value]) == 2
    assert named in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
