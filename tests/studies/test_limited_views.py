"""The study of limited views: what it counts against definitions, and that the pages tell of its missions."""

from __future__ import annotations

from itertools import groupby

import numpy as np
import pytest

import ratt_opt as ro
from analysis.limited_views import claim, flights
from analysis.limited_views.flights import case_of, figures_of, scenario_of, sighted
from analysis.limited_views.verdicts import Outcome, outcome, relative_change
from analysis.measurements import values
from ratt_opt.studies.cases import Seeds
from ratt_opt.studies.statistics import estimate
from tests.documents import ROOT


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("reach", ["unlimited", 25])
def test_sightings_are_those_that_the_filter_took(seed, reach):
    """Each is two numbers of the team's innovation; counted robot by robot, a target that nobody measures is unseen."""
    scenario = scenario_of(case_of(reach=reach), Seeds.of(1, seed))
    mission = ro.run_mission(scenario, steps=8, planner="greedy", seed=seed)
    for step, row in zip(mission.steps, sighted(mission), strict=True):
        pairs = np.zeros((6, 6), dtype=bool)
        for i in step.team.see:
            offset = step.truth[:, :2] - step.poses[i, :2]
            ahead = offset @ [np.cos(step.poses[i, 2]), np.sin(step.poses[i, 2])]
            apart = np.linalg.norm(offset, axis=1)
            pairs[i] = (ahead >= apart * np.cos(np.radians(30))) & (
                apart <= (np.inf if reach == "unlimited" else reach)
            )
        assert 2 * pairs.sum() == step.team.innovation.count
        assert (row == pairs.any(axis=0)).all()


def test_figures_are_their_definitions():
    scenario = scenario_of(case_of(view=30), Seeds.of(2, 0))
    mission = ro.run_mission(scenario, steps=9, planner="myopic", seed=5)
    found = figures_of(mission)
    errors = np.array(
        [[np.hypot(*(step.team.belief.mean[j, :2] - step.truth[j, :2])) for j in range(6)] for step in mission.steps]
    )
    assert found["rmse"] == pytest.approx(np.sqrt((errors**2).mean()))
    assert found["rmse_first_half"] == pytest.approx(np.sqrt((errors[:4] ** 2).mean()))
    assert found["rmse_last_half"] == pytest.approx(np.sqrt((errors[4:] ** 2).mean()))
    assert found["largest"] == pytest.approx(errors.max())
    seen = sighted(mission)
    runs = [len(list(run)) for j in range(6) for is_seen, run in groupby(seen[:, j]) if not is_seen]
    assert found["longest"] == max(runs, default=0)
    assert found["unseen"] == pytest.approx(100 * (~seen).sum() / seen.size)


def test_a_network_with_few_links_can_lose_all_of_them():
    for trial in range(20):
        scenario = scenario_of(case_of(links=12), Seeds.of(3, trial))
        assert scenario.alpha_c == min(4, len(scenario.problem().communication.links))


def test_a_relative_change_covers_the_true_one_as_often_as_it_says():
    rng = np.random.default_rng(0)
    covered = 0
    for _ in range(400):
        common = rng.gamma(4.0, 1.0, 60)
        theirs = common * rng.lognormal(0.0, 0.3, 60)
        ours = 0.8 * common * rng.lognormal(0.0, 0.3, 60)
        change = relative_change(ours, theirs)
        covered += change.low <= -0.2 <= change.high
    assert 0.92 <= covered / 400 <= 0.98


def test_a_relative_change_to_a_constant_is_that_of_the_mean():
    values = np.array([1.0, 2.0, 4.0])
    change, plain = relative_change(values, [2.0, 2.0, 2.0]), estimate(values / 2 - 1)
    assert (change.mean, change.low, change.high) == pytest.approx((plain.mean, plain.low, plain.high))
    scaled = relative_change(10 * values, [10.0, 20.0, 30.0])
    assert scaled.mean == pytest.approx(7 / 6 - 1)
    assert relative_change(values, values).high == pytest.approx(0)


def test_words_follow_the_interval():
    rising = relative_change([2.0, 2.1, 2.0], [1.0, 1.0, 1.1])
    assert outcome(rising) is Outcome.COSTS
    assert outcome(relative_change([1.0, 1.0, 1.1], [2.0, 2.1, 2.0])) is Outcome.PAYS
    assert outcome(relative_change([1.0, 2.0, 3.0], [3.0, 2.0, 1.0])) is Outcome.UNSEEN


def test_the_main_cell_is_the_demo_and_what_the_rule_chose() -> None:
    text = (ROOT / "docs" / "researchers" / "limited_views_tables.md").read_text(encoding="utf-8")
    assert "| **45 m** | **40 m** | 60 |" in text
    assert flights.MAIN.cases == (case_of(links=45, reach=40),)
    assert claim.STUDY.cases == flights.MAIN.cases
    known = values()
    low, high = known["mission_error_interval"].low, known["mission_error_interval"].high
    assert f"| -{known['mission_error'].low:g} [-{high:g}, -{low:g}] pays |" in text, "not the missions of the claim"
