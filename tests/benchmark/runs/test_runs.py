"""Runs over a library: measures against their definitions, solvers of the library, resuming, the page."""

import json
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ratt_opt as ro
from ratt_opt.benchmark.runs.measures import gap_integral, gap_of, par10, profile, time_to
from ratt_opt.benchmark.runs.page import summaries, write_page
from ratt_opt.benchmark.runs.runner import read_rows
from ratt_opt.benchmark.runs.solvers import find_solver, names
from ratt_opt.cli import run as command
from tests.benchmark.small_library import small_library


@given(st.floats(-100, 100), st.floats(-100, 100))
def test_a_gap_is_a_share(value, best):
    gap = gap_of(value, best)
    assert 0 <= gap <= 1
    assert (gap == 0) == (value == best) or abs(value - best) < 1e-300
    assert gap == gap_of(best, value)


@given(st.lists(st.tuples(st.integers(0, 120), st.integers(0, 10)), max_size=8), st.integers(1, 100))
@settings(max_examples=300, deadline=None)
def test_the_integral_is_the_mean_of_the_least_gap_so_far(steps, limit):
    ordered = [(float(at), gap / 10) for at, gap in sorted(steps, key=lambda step: step[0])]
    moments = np.arange(limit) + 0.5  # gaps change at whole seconds
    least = [min([1.0, *(gap for at, gap in ordered if at <= moment)]) for moment in moments]
    assert gap_integral(ordered, float(limit)) == pytest.approx(np.mean(least))


def test_times_and_profiles_are_as_published():
    steps = [(0.5, 0.4), (1.0, 0.01), (3.0, 0.0)]
    assert [time_to(steps, tolerance) for tolerance in (0.5, 0.01, 0.0)] == [0.5, 1.0, 3.0]
    assert math.isinf(time_to([], 0.1))
    assert par10([1.0, math.inf, 3.0], 10.0) == pytest.approx((1 + 100 + 3) / 3)
    curves = profile({"a": [1.0, 4.0, math.inf], "b": [2.0, 2.0, 5.0]})
    assert curves["a"].factors.tolist() == [1.0, 2.0]
    assert curves["a"].shares.tolist() == pytest.approx([1 / 3, 2 / 3])
    assert curves["b"].factors.tolist() == [1.0, 1.0, 2.0]


def worst_plan(problem):
    """A planner of one's own, for ``planner:module:function``."""
    return [int(choice[-1]) for choice in problem.choices]


def test_solvers_of_the_library_by_name(tmp_path):
    library = small_library(tmp_path / "lib")
    out = tmp_path / "out"
    for solver in (
        "planner:maxmin",
        "planner:greedy",
        "planner:partitioned_robust",
        "attacker:worst",
        "cuts:fewest_cuts",
    ):
        rows = ro.run_benchmark(library, solver, out, seconds=8)
        assert [row["faults"] for row in rows] == [""] * len(rows)
        if solver in {"planner:maxmin", "attacker:worst", "cuts:fewest_cuts"}:
            for row in rows:
                assert float(row["proved"]) == pytest.approx(float(row["value"]), rel=1e-6)
    own = ro.run_benchmark(library, f"planner:{__name__}:worst_plan", out, name="own", seconds=8)
    assert [row["faults"] for row in own] == ["", ""]
    assert set(read_rows(out)) == {
        "maxmin",
        "greedy",
        "partitioned_robust",
        "attacker-worst",
        "cuts-fewest_cuts",
        "own",
    }
    found = {one.solver: one for one in summaries(read_rows(out))}
    assert (found["maxmin"].instances, found["maxmin"].best, found["maxmin"].proved) == (2, 2, 2)
    assert found["attacker-worst"].instances == found["cuts-fewest_cuts"].instances == 1
    page = write_page(out)[0].read_text(encoding="utf-8")
    for solver in found:
        assert f">{solver}<" in page
    assert "None." in page
    assert page.count("data:image/png") == 2
    assert "http" not in page


def test_a_second_run_does_nothing_twice(tmp_path):
    library = small_library(tmp_path / "lib")
    log = tmp_path / "log"
    script = tmp_path / "s.sh"
    script.write_text(f"echo x >> {log}; echo '{json.dumps({'elements': 'none'})}'\n", encoding="utf-8")
    given_command = f"sh {script} {{instance}} {{out}} --time {{s}}"
    first = ro.run_benchmark(library, given_command, tmp_path / "out", name="s", only=["P"], seconds=2)
    assert log.read_text().count("x") == 2
    again = ro.run_benchmark(library, given_command, tmp_path / "out", name="s", only=["P"], seconds=2)
    assert log.read_text().count("x") == 2
    assert again == first
    assert all("elements must be a list" in row["faults"] for row in first)
    page = write_page(tmp_path / "out")[0].read_text(encoding="utf-8")
    assert "elements must be a list; got str" in page
    with pytest.raises(ro.InputError, match="out"):  # other limits: other rows
        ro.run_benchmark(library, given_command, tmp_path / "out", name="s", only=["P"], seconds=3)


def test_names_of_solvers_are_listed_and_others_refused(tmp_path):
    assert {"maxmin", "scenario_program", "resilient_selection"} <= set(names()["planner"])
    library = small_library(tmp_path / "lib")
    for solver, fault in (
        ("planner:nobody", "solver must be one of planner:ratt"),
        ("planner:no.module:f", "must be module:function that can be imported"),
        ("attacker:nobody", "solver must be one of"),
        ("cuts:nobody", "solver must be one of"),
    ):
        with pytest.raises(ro.InputError, match=fault):
            ro.run_benchmark(library, solver, tmp_path / "out")
    for named, fault in (({"seconds": 0}, "seconds"), ({"grace": -1}, "grace"), ({"name": "a/b"}, "name must be")):
        with pytest.raises(ro.InputError, match=fault):
            ro.run_benchmark(library, "planner:ratt", tmp_path / "out", **named)
    assert not (tmp_path / "out").exists()
    assert callable(find_solver("planner", "ratt"))


def test_the_command_line(tmp_path, capsys):
    small_library(tmp_path / "lib")
    lib, out = str(tmp_path / "lib"), str(tmp_path / "out")
    assert command(["bench", "list", lib]) == 0
    assert "cover" in capsys.readouterr().out
    assert command(["bench", "verify", lib]) == 0
    assert "4 records hold, 4 of them closed, of 4 instances" in capsys.readouterr().out
    assert command(["bench", "verify", lib, "--sample", "2", "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out)["lines"]) == 2
    assert command(["bench", "run", lib, "--solver", "planner:myopic", "--only", "cover", "--out", out, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["instances"], len(found["rows"])) == (1, 1)
    assert command(["bench", "page", out]) == 0
    assert "page.html" in capsys.readouterr().out
    record = str(tmp_path / "lib" / "records" / "cover.json.xz")
    assert command(["bench", "submit", lib, record, "--who", "me"]) == 2
    assert "must better the known record" in capsys.readouterr().err
    assert command(["bench", "verify", out]) == 2
    assert "must be a folder that holds library.csv" in capsys.readouterr().err
    assert command(["bench", "page", lib]) == 2
    assert "must hold results of ratt-opt bench run" in capsys.readouterr().err
    (tmp_path / "lib" / "records" / "cuts.json.xz").unlink()
    assert command(["bench", "verify", lib]) == 1
    assert "1 of 4 records do not hold; cuts: " in capsys.readouterr().err
