"""Bounds of a mission's first step, units by state, outputs in model-free files, remarks on silent elements."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.missions.first_step import first_step
from ratt_opt.report.description import named

QUICK = {"guarantees": "none", "time_limit": 20}


def team(**options: object) -> ro.Scenario:
    return ro.random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=2, **options)


@pytest.mark.parametrize("objective", ["trace", "logdet", "maxeig"])
def test_the_textbook_model_is_the_scenario_itself(objective: str) -> None:
    """Range and bearing to first order, targets of known velocity: the paper's problem, to the bit."""
    model = ro.MissionModel(linearisation="first order", objective=objective)
    ours, own = first_step(team(), model).problem(objective), team().problem(objective)
    assert np.array_equal(ours.objective.information, own.objective.information)
    assert np.array_equal(ours.objective.prior, own.objective.prior)
    assert ro.bound(team(), model=model, **QUICK).upper == ro.bound(team(), objective=objective, **QUICK).upper


@pytest.mark.parametrize(
    "model",
    [
        ro.MissionModel(),
        ro.MissionModel(sensor="bearing"),
        ro.MissionModel(motion="constant velocity", objective="maxeig"),
    ],
)
def test_a_bound_is_about_the_problem_that_the_mission_plans_for(model: ro.MissionModel) -> None:
    seen = []

    def spy(problem: ro.Problem) -> np.ndarray:
        seen.append(problem)
        return ro.ratt(problem).elements

    ro.run_mission(team(), steps=1, planner=spy, model=model)
    report = ro.bound(team(), model=model, **QUICK)
    assert report.objective == model.objective
    assert np.array_equal(report.problem.objective.information, seen[0].objective.information)
    assert np.array_equal(report.problem.objective.prior, seen[0].objective.prior)
    other = ro.bound(team(), objective=model.objective, **QUICK)
    assert report.upper != pytest.approx(other.upper, rel=1e-4)


def test_its_report_keeps_names_places_controls_and_links(tmp_path: Path) -> None:
    plain = team(communication_range=70.0)
    robots = tuple(robot.replace(name=f"r{i}x") for i, robot in enumerate(plain.robots))
    named_team = plain.replace(robots=robots, alpha_c=0)
    report = ro.bound(named_team, model=ro.MissionModel(area=(-50, -50, 150, 150)), **QUICK)
    assert report.problem.communication.links == named_team.problem().communication.links
    report.save(tmp_path)
    rows = list(csv.DictReader((tmp_path / "plan.csv").read_text().splitlines()))
    for row, robot, element in zip(rows, robots, report.recommended.elements, strict=True):
        speed, turn = named_team.controls[element]
        assert (row["name"], float(row["speed"]), float(row["turn_rate"])) == (robot.name, speed, turn)
        assert float(row["heading"]) == named_team.predicted_poses[element, 2]
    document = json.loads((tmp_path / "report.json").read_text())["input"]["document"]
    assert ro.InformationInput(**document).problem().objective(report.recommended.elements) > 0


@pytest.mark.parametrize(
    ("given", "model", "text"),
    [
        (team().to_information(), ro.MissionModel(), "model must be absent, or come with a Scenario"),
        (team().problem(), ro.MissionModel(), "model must be absent, or come with a Scenario"),
        (team(), "bearing", "model must be a MissionModel"),
    ],
)
def test_models_that_do_not_fit_are_one_line(given, model, text) -> None:
    with pytest.raises(ro.InputError, match=text):
        ro.bound(given, model=model)


def tracks(**fields: object) -> ro.InformationInput:
    """Two robots, one target with position and velocity; a position sensor and one of velocities."""
    h = np.eye(4)
    told = [np.outer(h[k], h[k]) * strength for k, strength in ((0, 1.0), (1, 2.0), (2, 0.5), (3, 1.5))]
    return ro.InformationInput(
        prior=[np.diag([4.0, 9.0, 1.0, 2.0]).tolist()],
        information=[[matrix.tolist()] for matrix in told],
        robot=[0, 0, 1, 1],
        alpha_s=0,
        alpha_c=0,
        **fields,
    )


POSITION = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0))
VELOCITY = ((0.0, 0.0, 1.0, 0.0),)
UNITS = ("m", "m", "m/s", "m/s")


@pytest.mark.parametrize(
    ("fields", "objective", "unit"),
    [
        ({}, "trace", "units of the state, squared"),
        ({"units": UNITS}, "trace", "mixed: m², (m/s)²"),
        ({"units": UNITS, "output": POSITION}, "trace", "m²"),
        ({"units": UNITS, "output": VELOCITY}, "maxeig", "(m/s)²"),
        ({"units": UNITS}, "logdet", "nat"),
        ({"units": ("rad",) * 4}, "trace", "rad²"),
    ],
)
def test_units_are_those_of_the_state(tmp_path: Path, fields, objective, unit) -> None:
    report = ro.bound(tracks(**fields), objective=objective, **QUICK)
    assert report.unit == unit
    report.save(tmp_path, certificate=False)
    page = (tmp_path / "report.html").read_text()
    assert f"worst-case value [{unit}]" in page
    symbol = f"[{unit}]" if " " in unit else unit
    for said in ("has a worst-case value of", "No plan has more than", "value left", "Best possible:"):
        start = page.index(said)
        assert symbol in page[start : start + 80], f"{said} has no unit"
    assert "<th>speed [m/s]</th>" in page.replace(' scope="col"', "")
    assert json.loads((tmp_path / "report.json").read_text())["unit"] == unit


def test_the_units_of_positions_and_of_set_functions() -> None:
    assert ro.bound(team(), **QUICK).unit == "m²"
    assert ro.bound(ro.Problem(ro.Modular([1.0, 2.0]), [0, 1], None, 0, 0), **QUICK).unit == ""


def test_files_without_the_later_fields_keep_their_digest() -> None:
    """As the release before wrote them: the certificates made then name it."""
    document = tracks().model_dump(mode="json")
    assert not {"output", "units", "element_headings", "element_controls"} & document.keys()
    assert tracks().digest == "4e79571edac90d756d1bf9ac035fec5262facd959d37041b0cd619b1cca16a4a"
    assert tracks(units=UNITS).digest != tracks().digest


def test_an_output_of_a_file_is_that_of_the_criterion(tmp_path: Path) -> None:
    given = tracks(output=POSITION, units=UNITS)
    ro.save_scenario(given, tmp_path / "tracks.json")
    read = ro.load_input(tmp_path / "tracks.json")
    assert read == given
    f, own = read.problem().objective, tracks().matrices
    by_hand = ro.TraceObjective(*own, output=np.array(POSITION))
    assert f([0, 3]) == by_hand([0, 3])
    assert f([2, 3]) == 0  # velocities do not count
    report = ro.bound(given, certificate=tmp_path / "c.json", **QUICK)
    assert ro.verify_certificate(tmp_path / "c.json").lower_proved
    assert report.certificate.certificate.verified.made_from == given.digest
    with pytest.raises(ro.InputError, match="objective must be trace or maxeig, as an output is given"):
        given.problem("logdet")


@pytest.mark.parametrize(
    ("fields", "text"),
    [
        ({"output": ((1.0, 0.0),)}, "output must"),
        ({"output": ((1.0, 0.0, 0.0, 0.0), (2.0, 0.0, 0.0, 0.0))}, "output must"),
        ({"output": ((1.0, 0.0), (1.0,))}, "output must hold"),
        ({"units": ("m",)}, "units must have 4 entries, one per coordinate"),
        ({"element_headings": (0.0,)}, "element_headings must have 4 entries"),
    ],
)
def test_outputs_and_units_that_do_not_fit_are_one_line(fields, text) -> None:
    with pytest.raises(ro.InputError, match=text):
        tracks(**fields)


def test_elements_that_tell_nothing_are_remarked() -> None:
    far = ro.Scenario(
        robots=[ro.Robot(x=0.0, y=0.0), ro.Robot(x=500.0, y=0.0)],
        targets=[ro.Target(x=10.0, y=5.0)],
        sensor=ro.Sensor(max_range=11.0),
        alpha_s=0,
        alpha_c=0,
    )
    report = ro.bound(far, **QUICK)
    silent = int((far.information == 0).all(axis=(1, 2, 3)).sum())
    assert 12 < silent < 24
    assert report.remarks == (
        f"{silent} of 24 elements tell nothing about any target; none of robot 1 tells anything: check its sensor",
    )
    assert report.to_dict()["remarks"] == list(report.remarks)
    assert ro.bound(team(), **QUICK).remarks == ()


@pytest.mark.parametrize(
    ("number", "name", "kind", "shown"),
    [
        (0, "ada", "robot", "0 ada"),
        (0, "robot 0", "robot", "0"),
        (12, "R-12", "robot", "12"),
        (1, "R11", "robot", "1 R11"),
        (3, "T3", "target", "T3"),
        (3, "target 03", "target", "T3"),
        (3, "Titan", "target", "T3 Titan"),
        (3, "", "target", "T3"),
    ],
)
def test_names_that_are_the_number_are_not_said_twice(number, name, kind, shown) -> None:
    assert named(number, name, kind) == shown


def test_one_word_for_each_role_on_screen_and_in_files(tmp_path: Path) -> None:
    scenario = ro.limited_view_scenario(6, 6, alpha_s=1, alpha_c=2, seed=1, view=60, communication_range=45)
    report = ro.bound(scenario, **QUICK)
    report.save(tmp_path, certificate=False)
    rows = list(csv.DictReader((tmp_path / "plan.csv").read_text().splitlines()))
    roles = [row["under attack"] for row in rows]
    assert set(roles) == {"blinded", "sees", "cut off"}
    page = (tmp_path / "report.html").read_text()
    from ratt_opt.report.tables import report_tables

    table = list(report_tables(report))[1]
    on_screen = list(table.columns[3].cells)
    for i, role in enumerate(roles):
        assert on_screen[i].startswith(role)
        assert f"; {role}" in page
        assert report.recommended.role(i) == role


def test_the_smallest_largest_group_is_exact_where_a_cut_attains_it() -> None:
    from ratt_opt import smallest_largest_group
    from ratt_opt.report.tables import report_tables

    for seed in range(4):
        scenario = ro.network_scenario("disk-6", 8, 3, alpha_s=1, alpha_c=2, seed=seed)
        report = ro.bound(scenario, **QUICK)
        exact = smallest_largest_group(report.problem.graph, 2)
        assert (report.n_max, report.n_max_upper) == (exact.lower, exact.upper)
        cells = [list(column.cells) for column in list(report_tables(report))[2].columns]
        assert dict(zip(*cells, strict=True))["smallest largest group, n_max"] == f"{exact.upper}"


def test_what_to_protect_is_said_by_names(tmp_path: Path, capsys) -> None:
    from ratt_opt.cli import run

    plain = ro.random_scenario(4, 2, alpha_s=1, alpha_c=3, seed=1)
    names = ("ada", "bob", "", "robot 3")
    robots = tuple(robot.replace(name=name) for robot, name in zip(plain.robots, names, strict=True))
    ro.save_scenario(plain.replace(robots=robots), tmp_path / "team.json")
    plan = ro.ratt(plain.problem())
    (tmp_path / "plan.json").write_text(json.dumps({"elements": list(plan)}))
    command = ["attack", str(tmp_path / "team.json"), "--plan", str(tmp_path / "plan.json"), "--rank", "99"]
    assert run([*command, "--protect", "6"]) == 0
    printed = capsys.readouterr().out
    assert "robot 0 ada" in printed
    assert "link 0 ada - 1 bob" in printed
    assert "link 2-3" in printed  # without names, and with a name that is the number
    best = ro.links_to_protect(plain.problem(), plan, 6).links
    shown = next(line for line in printed.splitlines() if line.strip().startswith("protect"))
    assert best
    assert all(names[i] in shown for link in best for i in link if i < 2)


def last(problem: ro.Problem) -> list[int]:
    return [own[-1] for own in problem.choices]


def first(problem: ro.Problem) -> ro.Plan:
    return ro.Plan(elements=np.array([own[0] for own in problem.choices]), evaluations=1)


def test_planners_of_ones_own_stand_in_every_table_and_figure(tmp_path: Path) -> None:
    from ratt_opt.report.tables import report_tables

    report = ro.bound(team(), planners={"last": last, "first": first}, **QUICK)
    assert [plan.planner for plan in report.baselines][-2:] == ["last", "first"]
    problem = team().problem()
    for plan, planner in zip(report.baselines[-2:], (last, first), strict=True):
        worst = ro.worst_case_attack(problem, planner(problem))
        assert (plan.worst_case.lower, plan.worst_case.upper) == (worst.lower, worst.upper)
        assert plan.worst_case.lower <= report.upper
    report.save(tmp_path, certificate=False)
    assert {"last", "first"} <= json.loads((tmp_path / "report.json").read_text())["baselines"].keys()
    assert '<th scope="row">last</th>' in (tmp_path / "report.html").read_text()
    assert "last" in list(next(iter(report_tables(report))).columns[0].cells)
    bars = report.plot().axes[1]
    assert [label.get_text() for label in bars.get_yticklabels()][-2:] == ["last", "first"]
    colours = [bar.get_facecolor() for bar in bars.patches]
    assert len(set(colours)) == len(colours) == 8


def test_a_better_plan_of_ones_own_is_recommended() -> None:
    """Where the search has no time, what a user brings may be the best there is."""
    problem = ro.random_scenario(8, 6, alpha_s=2, alpha_c=6, seed=5).problem()
    best = ro.solve_maxmin(problem, time_limit=20)
    report = ro.bound(problem, planners={"mine": lambda _: best.elements}, time_limit=0.0, guarantees="none")
    assert report.recommended.worst_case.lower >= report.ratt.worst_case.lower
    assert report.upper >= best.lower


@pytest.mark.parametrize(
    ("planners", "text"),
    [
        ({"ratt": last}, "planners must have names that are none of ratt"),
        ({"": last}, "planners must have names"),
        ({"mine": 3}, r"planners\['mine'\] must be a function of the problem; got int"),
        ({"mine": lambda _: "x"}, r"planners\['mine'\]: planner must return a plan"),
        ({"mine": lambda _: [0, 0, 0]}, r"planners\['mine'\]: elements\[1\] must be an element of robot 1"),
    ],
)
def test_planners_that_do_not_plan_are_one_line(planners, text) -> None:
    with pytest.raises(ro.InputError, match=text):
        ro.bound(team(), planners=planners, **QUICK)


def test_an_interrupted_planner_is_left_out_by_name() -> None:
    def hit(_problem: ro.Problem) -> None:
        raise KeyboardInterrupt

    report = ro.bound(team(), planners={"last": last, "slow": hit, "first": first}, **QUICK)
    assert report.interrupted
    assert report.omitted["slow"] == report.omitted["first"] == "interrupted"
    assert "last" in {plan.planner for plan in report.baselines}


def test_attackers_of_ones_own_stand_in_the_survey() -> None:
    problem = team().problem()
    plan = ro.ratt(problem).elements
    found = ro.attack_survey(problem, plan, attackers={"first robot": lambda _p, _e: ro.Attack(frozenset({0}))})
    assert found["first robot"].upper == pytest.approx(problem.team_value(plan, ro.Attack(frozenset({0}))))
    assert found["first robot"].lower == 0
    for attackers, text in (
        ({"worst": lambda _p, _e: ro.Attack()}, "attackers must have names that are none of worst"),
        ({"x": lambda _p, _e: 3}, r"attackers\['x'\] must return an Attack"),
        ({"x": lambda _p, _e: ro.Attack(frozenset({0, 1, 2}))}, "at most"),
    ):
        with pytest.raises(ro.InputError, match=text):
            ro.attack_survey(problem, plan, attackers=attackers)
