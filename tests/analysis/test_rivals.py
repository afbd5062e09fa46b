"""The benchmark against rivals: its families, and rivals that are right on instances small enough to enumerate."""

import time

import numpy as np
import pytest

import ratt_opt as ro


@pytest.fixture
def rivals(monkeypatch):
    monkeypatch.setattr(time, "monotonic", time.monotonic)  # the benchmark lets limits count processor seconds
    from analysis.benchmarks import rivals

    return rivals


@pytest.mark.parametrize("lost", [0, 1, 2])
def test_rivals_are_right_on_a_small_instance(rivals, lost):
    case = rivals.coverage(4, 3, 12, lost).draw(0)
    best = ro.exhaustive_optimum(case.rivals).lower
    program = rivals.scenario_bracket(case.rivals, 20)
    walked = rivals.exchanges(case.rivals, ro.greedy(case.rivals), 20)
    assert program.lower == pytest.approx(best)
    assert program.upper == pytest.approx(best)
    assert walked.lower <= best
    assert ro.solve_maxmin(case.asked).lower == pytest.approx(best, rel=1e-5)


@pytest.mark.parametrize("network", ["complete", "disk"])
def test_rivals_of_cameras_are_right_on_a_small_team(rivals, network):
    near = {"complete": None, "disk": 45}[network]
    drawn = ro.limited_view_scenario(4, 4, alpha_s=1, alpha_c=1, seed=1, headings=3, communication_range=near)
    problem = drawn.problem("logdet")
    best = ro.exhaustive_optimum(problem).lower
    program = rivals.tangent_milp(problem, 20)
    walked = rivals.attacked_exchanges(problem, ro.greedy(problem), 20)
    assert program.lower == pytest.approx(best, rel=2e-4)
    assert program.upper == pytest.approx(best, rel=2e-4)
    assert walked.lower <= best * (1 + 1e-9)


def test_one_list_names_every_family_once(rivals):
    names = [family.name for family in rivals.FAMILIES]
    assert len(set(names)) == len(names)


def test_p_median_files_give_shortest_paths(rivals, tmp_path):
    (tmp_path / "pmed1.txt").write_text("3 3 1\n1 2 5\n2 3 1\n1 2 2\n", encoding="ascii")
    distance, facilities = rivals.read_p_median(tmp_path / "pmed1.txt")
    assert facilities == 1
    assert distance.tolist() == [[0, 2, 3], [2, 0, 1], [3, 1, 0]]
    case = rivals.p_median(1, 0, tmp_path).draw(0)
    best = ro.solve_maxmin(case.asked)
    assert case.most - best.lower == 3  # at the second site
    assert rivals.p_median(1, 0, tmp_path).draw(1) is None
    assert np.array_equal(case.asked.robot, np.zeros(3))


def test_rows_are_printed_and_kept_in_a_table(rivals, tmp_path, capsys):
    out = tmp_path / "rows.csv"
    for most, upper in ((None, 0.0), (100.0, 40.0), (None, np.inf)):  # a bound of 0 has no share
        row = rivals.Row(table=rivals.Table(out), instance="team", seed=3, most=most)
        row.show("solve", rivals.RivalBracket(lower=0.0 if upper == 0.0 else 30.0, upper=upper, seconds=1.0))
    kept = out.read_text(encoding="utf-8").splitlines()
    assert kept[0].split(",") == list(rivals.Table.titles)
    assert kept[1:] == [
        "team,3,solve,0.0,0.0,inf,1.0",
        f"team,3,solve,60.0,70.0,{10 / 70},1.0",
        "team,3,solve,30.0,inf,inf,1.0",
    ]
    assert capsys.readouterr().out.count("team") == 3
