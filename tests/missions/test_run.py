"""Missions: the textbook filter, the same to the bit, resumed after a kill, every attack model, bad arguments."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratt_opt import (
    Attack,
    InputError,
    MaxMinPlanner,
    MissionModel,
    PermanentFailures,
    PersistentAttacks,
    PositionSensor,
    Robot,
    Scenario,
    Sensor,
    Target,
    random_scenario,
    ratt,
    run_mission,
    solve_maxmin,
    worst_case_attack,
)
from ratt_opt.budget import Budget
from tests.missions import numpy_filter


def scenario_of(seed=3, n_robots=4, **options):
    return random_scenario(n_robots, 3, **({"alpha_s": 1, "alpha_c": 3, "seed": seed} | options))


@pytest.mark.parametrize("linearisation", ["first order", "second order"])
@pytest.mark.parametrize("view", [None, 1.5])
def test_without_attack_it_is_an_independent_filter(monkeypatch, linearisation: str, view: float | None) -> None:
    """Robots' measurements, taken from the mission, through a filter in plain NumPy, whatever the filter expected."""
    from ratt_opt.missions import run

    taken = []
    simulate = run.simulated_readings
    monkeypatch.setattr(run, "simulated_readings", lambda *a: taken.append(simulate(*a)) or taken[-1])
    scenario = scenario_of(sensor=Sensor(field_of_view=view))
    mission = run_mission(scenario, steps=8, attacker="none", model=MissionModel(linearisation=linearisation))
    first = scenario.targets
    mean, covariance = [np.array([t.x, t.y]) for t in first], [np.array(t.covariance) for t in first]
    for k, (step, readings) in enumerate(zip(mission.steps, taken, strict=True)):
        for j, target in enumerate(first):
            angle = target.heading + (k + 1) * target.turn_rate
            mean[j] = mean[j] + target.speed * np.array([np.cos(angle), np.sin(angle)])
            covariance[j] = covariance[j] + target.process_std**2 * np.eye(2)
            seen = [(p, r.values[j], None) for p, r in zip(step.poses, readings, strict=True) if r.seen[j]]
            mean[j], covariance[j] = numpy_filter.updated(
                *(mean[j], covariance[j], seen, scenario.sensor.noise_variances),
                second_order=linearisation == "second order",
            )
        np.testing.assert_allclose(step.team.belief.mean, mean, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(step.team.belief.covariance, covariance, rtol=1e-9, atol=1e-10)
    assert view is None or not all(reading.seen.all() for readings in taken for reading in readings)


def test_the_first_step_is_the_one_step_problem() -> None:
    scenario = scenario_of(seed=5)
    mission = run_mission(scenario, steps=1, model=MissionModel(linearisation="first order"))
    elements, attack = mission.decisions[0]
    problem = scenario.problem()
    assert np.array_equal(elements, ratt(problem).elements)
    assert attack == worst_case_attack(problem, elements).attack
    step = mission.steps[0]
    assert step.value == problem.team_value(elements, attack)
    prior = problem.objective.prior.trace(axis1=1, axis2=2).sum()
    assert step.team.belief.trace == pytest.approx(prior - step.value)
    assert np.array_equal(step.poses, scenario.predicted_poses[elements])


@pytest.mark.parametrize("attacks", ["renewed", "persistent", "permanent"])
@pytest.mark.parametrize("sharing", ["best group", "all surviving"])
def test_the_same_to_the_bit_and_resumed(attacks: str, sharing: str, tmp_path) -> None:
    scenario = scenario_of()
    arguments = {"steps": 9, "attacks": attacks, "sharing": sharing, "seed": 4}
    whole = run_mission(scenario, **arguments)
    assert whole == run_mission(scenario, **arguments)
    journal = tmp_path / "journal.jsonl"
    run_mission(scenario, **(arguments | {"steps": 5}), journal=journal)
    text = journal.read_text()
    journal.write_text(text[:-9])  # killed in the middle of a line
    assert run_mission(scenario, **arguments, journal=journal) == whole
    assert run_mission(scenario, **arguments, journal=journal) == whole
    assert len(journal.read_text().splitlines()) == 10
    assert run_mission(scenario, **(arguments | {"seed": 5})) != whole


@pytest.mark.parametrize("who", ["planner", "attacker"])
def test_an_interrupted_search_decides_nothing(who, tmp_path) -> None:
    """Its bracket is valid, but not what a whole search decides: the mission ends, and can be resumed."""
    scenario, journal = scenario_of(), tmp_path / "journal.jsonl"
    asked = []

    def search(problem, *elements):
        asked.append(0)
        budget = Budget()
        if len(asked) == 3:
            budget.interrupt()
        return (
            worst_case_attack(problem, *elements, budget=budget) if elements else solve_maxmin(problem, budget=budget)
        )

    with pytest.raises(KeyboardInterrupt):
        run_mission(scenario, steps=5, **{who: search}, journal=journal)
    assert len(journal.read_text().splitlines()) == 1 + 2
    whole = run_mission(scenario, steps=5, **{who: search})
    resumed = run_mission(scenario, steps=5, **{who: search}, journal=journal)
    assert resumed == whole


def test_a_callables_mission_resumes_in_another_process(tmp_path) -> None:
    def own():
        return lambda problem: np.array([choice[0] for choice in problem.choices])

    scenario, journal = scenario_of(), tmp_path / "journal.jsonl"
    first, again = own(), own()
    assert repr(first) != repr(again)
    run_mission(scenario, steps=2, planner=first, journal=journal)
    assert len(run_mission(scenario, steps=4, planner=again, journal=journal).steps) == 4


def test_targets_move_alike_under_every_player() -> None:
    scenario = scenario_of()
    first = run_mission(scenario, steps=4)
    second = run_mission(scenario, steps=4, planner="myopic", attacker="none")
    for a, b in zip(first.steps, second.steps, strict=True):
        assert np.array_equal(a.truth, b.truth)


def test_persistent_attacks_are_held_and_renewed() -> None:
    mission = run_mission(scenario_of(), steps=6, attacks=PersistentAttacks(hold=3))
    attacks = [step.attack for step in mission.steps]
    assert attacks[0] == attacks[1] == attacks[2]
    assert attacks[3] == attacks[4] == attacks[5]
    assert attacks[0] != Attack()


def test_failures_add_up_within_the_budgets() -> None:
    scenario = scenario_of(n_robots=5, alpha_s=2, alpha_c=4)
    model = PermanentFailures(sensor_rate=0.3, link_rate=0.2)
    for sharing in ("best group", "all surviving"):
        mission = run_mission(scenario, steps=12, attacks=model, sharing=sharing)
        before = Attack()
        for step in mission.steps:
            assert before.sensing <= step.attack.sensing
            assert before.links <= step.attack.links
            before = step.attack
        assert (len(before.sensing), len(before.links)) == (2, 4)


def test_surviving_measurements_are_worth_at_least_the_best_groups() -> None:
    """With linear sensors and without attack both kinds of sharing are the same filter; under attack more is known."""
    scenario = scenario_of(alpha_s=1, alpha_c=3)
    model = MissionModel(sensor=PositionSensor(2.0))
    same = [
        run_mission(scenario, steps=5, attacker="none", sharing=s, model=model) for s in ("best group", "all surviving")
    ]
    np.testing.assert_allclose(same[0].rmse, same[1].rmse, rtol=1e-9)
    apart, together = (
        run_mission(scenario, steps=8, attacker="worst", sharing=s, model=model, planner="random")
        for s in ("best group", "all surviving")
    )
    assert together.traces[-1] <= apart.traces[-1] * (1 + 1e-9)


@pytest.mark.parametrize("motion", ["known velocity", "constant velocity"])
def test_groups_that_meet_again_believe_what_a_team_does_that_never_split(motion: str) -> None:
    """Robots 0 and 1 are cut off for three steps, each with its measurements; when links return nothing was lost."""
    cuts = iter([Attack(links={(0, 1), (0, 2), (0, 3), (1, 2), (1, 3)}), Attack()])
    arguments = {
        "steps": 4,
        "planner": lambda problem: np.array([choice[0] for choice in problem.choices]),
        "attacks": PersistentAttacks(hold=3),
        "sharing": "all surviving",
        "model": MissionModel(sensor=PositionSensor(2.0), motion=motion),
    }
    scenario = scenario_of(alpha_s=0, alpha_c=5)
    split = run_mission(scenario, attacker=lambda *_: next(cuts), **arguments)
    whole = run_mission(scenario, attacker="none", **arguments)
    assert [len(step.groups) for step in split.steps] == [3, 3, 3, 1]
    assert split.steps[2].team.belief.trace > whole.steps[2].team.belief.trace * 1.01
    np.testing.assert_allclose(split.steps[3].team.belief.mean, whole.steps[3].team.belief.mean, rtol=1e-9)
    np.testing.assert_allclose(split.steps[3].team.belief.covariance, whole.steps[3].team.belief.covariance, rtol=1e-8)


@pytest.mark.parametrize("motion", ["constant velocity", "coordinated turn"])
def test_other_motions_and_sensors(motion: str) -> None:
    scenario = scenario_of()
    for linearisation in ("first order", "second order", "iterated"):
        model = MissionModel(motion=motion, robot_motion="arc", linearisation=linearisation)
        mission = run_mission(scenario, steps=5, model=model)
        assert mission.dimension == {"constant velocity": 4, "coordinated turn": 5}[motion]
        assert np.isfinite(mission.nees).all()


def test_a_consistent_filter_stays_within_its_bands() -> None:
    """Linear sensors: NEES and NIS are chi-square; their means over a long mission are within five deviations."""
    scenario = scenario_of(n_robots=3, alpha_s=0, alpha_c=0)
    mission = run_mission(
        scenario, steps=120, attacker="none", planner="myopic", model=MissionModel(sensor=PositionSensor(3.0))
    )
    numbers = 2 * 3 * 120
    # Errors of successive steps are correlated; the band is that of a tenth as many.
    assert abs(mission.nees.mean() - 2) < 5 * 2 * np.sqrt(2 / (numbers / 10))
    assert abs(mission.nis.mean() - 1) < 5 * np.sqrt(2 / (3 * numbers))
    low, high = mission.nees_band()
    for band in (mission.nees_band, mission.nis_band):
        with pytest.raises(InputError, match="level must be between 0 and 1; got 2"):
            band(2)
    assert np.mean((low <= mission.nees) & (mission.nees <= high)) > 0.85
    band = mission.nis_band()
    assert np.mean((band[:, 0] <= mission.nis) & (mission.nis <= band[:, 1])) > 0.9


@pytest.mark.parametrize("motion", ["known velocity", "constant velocity"])
def test_the_default_filter_is_as_uncertain_as_its_errors_are_large(motion: str) -> None:
    """Mean NEES over d of twelve missions: some 1 by default, and far above it with the textbook filter."""
    teams = [random_scenario(5, 4, alpha_s=1, alpha_c=4, seed=seed) for seed in range(12)]

    def ratio(**options) -> float:
        model = MissionModel(motion=motion, **options)
        flown = [run_mission(t, steps=20, attacker="greedy", seed=s, model=model) for s, t in enumerate(teams)]
        return float(np.mean([mission.nees.mean() / mission.dimension for mission in flown]))

    honest = ratio()
    assert 0.75 < honest < 1.25
    assert ratio(linearisation="first order") > honest + 0.15


@pytest.mark.parametrize("aside", [0.0, 0.3])
def test_driving_over_a_target_leaves_the_filter_honest(aside: float) -> None:
    """A robot passes a target that stands still: the median NEES is that of chi-square with two degrees, 1.39."""
    precise = Sensor(bearing_noise=1e-4, bearing_noise_slope=0.0, range_noise=0.1, range_noise_slope=0.0)
    team = Scenario(
        robots=[Robot(x=-10.3, y=aside, controls=((1.0, 0.0),))],
        targets=[Target(x=0.0, y=0.0, process_std=0.0)],
        sensor=precise,
        alpha_s=0,
        alpha_c=0,
    )
    last = [run_mission(team, steps=20, attacker="none", seed=seed).nees[-1] for seed in range(40)]
    assert 0.8 < np.median(last) < 2.2


def test_robots_stay_in_the_area() -> None:
    scenario = scenario_of()
    places = scenario.poses[:, :2]
    low, high = places.min(axis=0) - 1.5, places.max(axis=0) + 1.5
    model = MissionModel(area=(*low.tolist(), *high.tolist()))
    mission = run_mission(scenario, steps=15, model=model)
    for step in mission.steps:
        assert (step.poses[:, :2] >= low - 3.1).all()
        assert (step.poses[:, :2] <= high + 3.1).all()
    inside = [((s.poses[:, :2] >= low) & (s.poses[:, :2] <= high)).all() for s in mission.steps]
    assert np.mean(inside) > 0.5


def test_targets_out_of_reach_stay_as_uncertain_as_their_motion_makes_them() -> None:
    scenario = scenario_of(sensor=Sensor(max_range=1e-3))
    mission = run_mission(scenario, steps=4)
    assert np.isnan(mission.nis).all()
    np.testing.assert_allclose(mission.traces, [2 * (9 + 0.25 * (k + 1)) for k in range(4)])
    assert mission.to_dict()["nis"] == [None] * 4


@settings(max_examples=12)
@given(
    seed=st.integers(0, 99),
    attacks=st.sampled_from(["renewed", "persistent", "permanent"]),
    attacker=st.sampled_from(["none", "greedy", "worst"]),
    sharing=st.sampled_from(["best group", "all surviving"]),
)
def test_links_that_are_lost_on_the_way_cap_the_budget(seed: int, attacks: str, attacker: str, sharing: str) -> None:
    """Robots drive apart until fewer links are left than may be cut: the mission goes on, and says so."""
    rng = np.random.default_rng(seed)
    scenario = random_scenario(4, 2, alpha_s=1, alpha_c=2, seed=seed)
    robots = tuple(
        robot.replace(x=3.0 * i, y=0.0, heading=0.0, controls=((float(rng.uniform(-4, 4)), 0.0),))
        for i, robot in enumerate(scenario.robots)
    )
    team = scenario.replace(robots=robots, communication_range=6.0)
    mission = run_mission(team, steps=8, attacker=attacker, attacks=attacks, sharing=sharing)
    places = [mission.start, *(step.poses for step in mission.steps[:-1])]
    links = [sum(np.linalg.norm(p[i, :2] - p[j, :2]) <= 6.0 for i in range(4) for j in range(i)) for p in places]
    assert mission.to_dict()["links_short"] == [step.links_short for step in mission.steps]
    if attacks == "renewed":
        assert [step.links_short for step in mission.steps] == [max(2 - count, 0) for count in links]


def test_own_planners_and_attackers() -> None:
    scenario = scenario_of()
    mission = run_mission(
        scenario,
        steps=2,
        planner=lambda problem: np.array([choice[-1] for choice in problem.choices]),
        attacker=lambda _problem, _elements: Attack({0}, set()),
    )
    assert all(step.attack == Attack({0}, set()) for step in mission.steps)
    assert mission.steps[0].role(0) == "blinded"
    assert run_mission(scenario, steps=1, planner=MaxMinPlanner(max_nodes=5)).steps[0].value > 0


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"planner": "best"}, "planner must be ratt"),
        ({"planner": 3}, "planner must be ratt"),
        ({"attacker": "evil"}, "attacker must be none"),
        ({"attacker": 3}, "attacker must be none"),
        ({"attacks": "sometimes"}, "attacks must be renewed"),
        ({"sharing": "nothing"}, "sharing must be best group"),
        ({"steps": 0}, r"steps must be an integer in \[1, 1000000\]"),
        ({"steps": 10**10}, r"steps must be an integer in \[1, 1000000\]"),
        ({"horizon": 0}, "horizon must be an integer >= 1"),
        ({"horizon": 9}, "horizon must give robot 0"),
        ({"seed": -1}, "seed must be an integer"),
        ({"planner": lambda _: np.zeros(4, dtype=int)}, r"elements\[1\] must be an element of robot 1"),
        ({"attacker": lambda *_: Attack({0, 1}, set())}, "attack must blind at most"),
        ({"attacker": lambda *_: 3}, "attacker must return an Attack"),
    ],
)
def test_bad_arguments(change: dict[str, object], text: str) -> None:
    with pytest.raises(InputError, match=text) as caught:
        run_mission(scenario_of(), **({"steps": 1} | change))  # type: ignore[arg-type]
    assert "\n" not in str(caught.value)


def test_bad_models_and_journals(tmp_path) -> None:
    with pytest.raises(InputError, match="linearisation must be first order"):
        MissionModel(linearisation="third order")
    for area in ((0, 0, 0, 1), (0, 0, 1), (0, float("nan"), 1, 1), "field"):
        with pytest.raises(InputError, match="area must be x and y"):
            MissionModel(area=area)
    with pytest.raises(InputError, match="model must be a MissionModel"):
        run_mission(scenario_of(), steps=1, model=3)
    for sensor in (3, "radar", [], [3]):
        with pytest.raises(InputError, match="sensor must be range and bearing, range, bearing, position, doppler, "):
            MissionModel(sensor=sensor)
    with pytest.raises(InputError, match="sensor must be a SensorModel, or one for each of"):
        run_mission(scenario_of(), steps=1, model=MissionModel(sensor=[PositionSensor(1.0)]))
    with pytest.raises(InputError, match="motion must be"):
        MissionModel(motion="teleporting")
    with pytest.raises(InputError, match="robot_motion must be"):
        MissionModel(robot_motion="sideways")
    with pytest.raises(InputError, match="planner must return a plan"):
        run_mission(scenario_of(), steps=1, planner=lambda _: 3)
    with pytest.raises(InputError, match="objective must be trace or maxeig if"):
        run_mission(scenario_of(), steps=1, horizon=2, model=MissionModel(objective="logdet"))
    with pytest.raises(InputError, match="hold must be"):
        PersistentAttacks(hold=0)
    with pytest.raises(InputError, match="sensor_rate must be a probability"):
        PermanentFailures(sensor_rate=2)
    journal = tmp_path / "j"
    with pytest.raises(InputError, match="planner must return"):  # a mission that is refused leaves no journal
        run_mission(scenario_of(), steps=1, journal=journal, planner=lambda _: 3)
    run_mission(scenario_of(), steps=1, journal=journal)
    with pytest.raises(InputError, match="journal must be of the same mission"):
        run_mission(scenario_of(), steps=1, journal=journal, seed=9)
    for text in ('{"format": "else"}\n', "my notes", "[" * 100_000 + "\n", "9" * 5000 + "\n"):
        journal.write_text(text)
        with pytest.raises(InputError, match=r"must be a mission's journal|line 1 must be a JSON object"):
            run_mission(scenario_of(), steps=1, journal=journal)
        assert journal.read_text() == text


def test_going_on_never_writes_whole_lines_again(tmp_path, monkeypatch) -> None:
    """On a full disk, or killed just then, they would be lost."""
    journal = tmp_path / "j"
    run_mission(scenario_of(), steps=2, journal=journal)
    before = journal.read_bytes()
    journal.write_bytes(before + b'{"step"')
    with monkeypatch.context() as full:
        full.setattr(type(journal), "write_text", lambda *_, **__: pytest.fail("written again"))
        full.setattr(type(journal), "open", lambda *_, **__: pytest.fail("written again"))
        full.setattr(type(journal), "read_bytes", lambda _: before + b'{"step"')
        run_mission(scenario_of(), steps=2, journal=journal)
    assert journal.read_bytes() == before
    journal.write_bytes(before[:-20])
    run_mission(scenario_of(), steps=2, journal=journal)
    assert journal.read_bytes() == before


def test_a_damaged_journal_is_refused_by_its_line(tmp_path) -> None:
    journal = tmp_path / "j"
    run_mission(scenario_of(), steps=2, journal=journal)
    lines = journal.read_text().splitlines()
    step = json.loads(lines[1])
    first = step["elements"][0]
    changes = ({"elements": [first + 1, *step["elements"][1:]]}, {"sensing": []}, {"checksum": "0" * 16}, {"more": 1})
    damaged = [json.dumps(step | change) for change in changes if step | change != step]
    without = json.dumps({name: value for name, value in step.items() if name != "checksum"})
    for line in (*damaged, without, lines[1].replace('"step": 0', '"step": true'), lines[1] + " ", "[" * 100_000, "7"):
        journal.write_text("\n".join([lines[0], line, lines[2], ""]))
        with pytest.raises(InputError, match=r"j line 2 must be (as it was written|a JSON object)") as refused:
            run_mission(scenario_of(), steps=2, journal=journal)
        assert str(refused.value).isprintable()
        assert journal.read_text().splitlines()[1] == line
    assert len(damaged) >= 3
