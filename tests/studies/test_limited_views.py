"""The study of limited views, small: what it counts against definitions, and that its page says what its rows say."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import groupby
from pathlib import Path

import numpy as np
import pytest

import ratt_opt as ro
from analysis.limited_views import bite, claim, flights, one_step, page, worth
from analysis.limited_views.flights import case_of, figures_of, scenario_of, sighted
from analysis.limited_views.verdicts import Outcome, outcome, relative_change
from analysis.measurements import values
from ratt_opt.studies.cases import Seeds
from ratt_opt.studies.engine import run
from ratt_opt.studies.progress import Progress
from ratt_opt.studies.statistics import column, estimate, select
from ratt_opt.studies.store import read_table


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


ONE_STEP = one_step.STUDY.planner_names


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three short trials of a part of each study."""
    folder = tmp_path_factory.mktemp("results")
    with pytest.MonkeyPatch.context() as patch, ThreadPoolExecutor(1) as executor:
        patch.setattr(flights, "STEPS", 3)
        patch.setattr(one_step, "NODES", 20)
        run(bite.STUDY, folder / bite.STUDY.name, executor, trials=3, progress=Progress())
        for study in (flights.MAIN, one_step.STUDY):
            small = replace(study, cases=study.cases[:2], planners=tuple(p for p in study.planners if p != "maxmin"))
            run(small, folder / study.name, executor, trials=3, progress=Progress())
    return folder


def test_the_page_says_what_the_rows_say(results: Path) -> None:
    text = page.page(results)
    rows = read_table(results / flights.MAIN.name)
    for case in flights.MAIN.cases:
        kept = select(rows, case=case.name)
        greedy, ratt = column(kept, "greedy/worst/rmse"), column(kept, "ratt/worst/rmse")
        table = text.partition("## Root mean squared error, exact attacks")[2].partition("##")[0]
        change = relative_change(ratt, greedy)
        word = {Outcome.PAYS: " pays", Outcome.COSTS: " costs", Outcome.UNSEEN: ""}[outcome(change)]
        assert f"| 3 | {greedy.mean():.3g} | {change.show(100)}{word} |" in table
    steps = read_table(results / one_step.STUDY.name)
    first = select(steps, case=one_step.STUDY.cases[0].name)
    shares = [(column(first, f"{name}/worst/value") / column(first, "optimum/upper")).mean() for name in ONE_STEP]
    assert f"| main cell | 3 | {' | '.join(f'{share:.3f}' for share in shares)} |" in text
    assert all(share <= 1 for share in shares)
    assert f"The rows were made with {rows[0]['versions']}." in text


def test_the_page_is_that_of_what_was_run(tmp_path: Path) -> None:
    assert "## Root mean" not in page.page(tmp_path)


def test_the_rule_chooses_the_first_cell_in_which_both_attacks_bite(results: Path) -> None:
    """Rows by hand; of the study's own rows, the shares are those of the definition and the page marks the choice."""
    cases = list(bite.STUDY.cases)
    rows = [
        {
            "case": case.name,
            "kept/blinded": str(70 + 30 * (k == 4)),
            "kept/cut": str(95 - 6 * (k > 3)),
            "kept/both": "50",
        }
        for k, case in enumerate(cases)
        for _ in range(2)
    ]
    assert bite.chosen(rows) == cases[5]
    for row in read_table(results / bite.STUDY.name)[:2]:
        shares = [float(row[f"kept/{name}"]) for name in ("blinded", "cut", "both")]
        assert 0 <= shares[2] <= min(shares) + 1e-9
        assert max(shares) <= 100 + 1e-9


def test_the_main_cell_is_the_demo_and_what_the_rule_chose() -> None:
    text = (page.ROOT / "docs" / "researchers" / "limited_views_tables.md").read_text(encoding="utf-8")
    assert "| **45 m** | **40 m** | 60 |" in text
    assert flights.MAIN.cases == (case_of(links=45, reach=40),)
    assert claim.STUDY.cases == flights.MAIN.cases
    known = values()
    low, high = known["mission_error_interval"].low, known["mission_error_interval"].high
    assert f"| -{known['mission_error'].low:g} [-{high:g}, -{low:g}] pays |" in text, "not the missions of the claim"


def rows_of_worth(effects: dict[tuple[str, str], float]) -> list[dict[str, str]]:
    """Twenty trials a cell whose errors are greedy's times a planner's ``effect`` in that cell, and a little noise."""
    rng, rows = np.random.default_rng(0), []
    cases = dict.fromkeys(case for cells in worth.FACTORS.values() for case in cells.values())
    for trial in range(20):
        for case in cases:
            common, row = rng.gamma(9.0, 0.1), {"case": case.name, "trial": str(trial)}
            row["greedy/worst/rmse"] = repr(float(common * rng.lognormal(0.0, 0.02)))
            for planner in worth.COMPARED:
                factor = effects.get((planner, case.name), 1.0)
                row[f"{planner}/worst/rmse"] = repr(float(common * factor * rng.lognormal(0.0, 0.02)))
            rows.append(row)
    return rows


def test_three_sentences_say_where_it_pays() -> None:
    """A planner that is a fifth better in two cells and a fifth worse in one is told so."""
    effects = {("maxmin", case_of().name): 0.8, ("maxmin", case_of(view=30).name): 0.8}
    rows = rows_of_worth({**effects, ("ratt", case_of(view=120).name): 1.2})
    first, second, third = worth.sentences(rows)
    assert f"`maxmin` {worth.change_of(rows, case_of(), 'maxmin').show()} %" in first
    assert second.startswith("With one factor varied, plans by `maxmin` pay at field of view [degrees] 30")
    costly = third.partition("costs accuracy at ")[2].partition(";")[0]
    assert "field of view [degrees] 120" in costly
    assert len(worth.figure_of(rows).axes) == len(worth.FACTORS)
