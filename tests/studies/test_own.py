"""Studies by others: planners, attackers, problems and measures given as functions."""

import sys
from dataclasses import replace
from types import SimpleNamespace

import pytest

from ratt_opt import InputError
from ratt_opt.studies.cases import Case
from ratt_opt.studies.engine import run
from ratt_opt.studies.executors import local_processes
from ratt_opt.studies.progress import Progress
from ratt_opt.studies.store import read_table
from ratt_opt.studies.study import Study, path_of, run_trial
from tests.studies import toy
from tests.studies.own import STUDY, boldest


def test_own_functions_are_columns_by_their_names_also_in_other_processes(tmp_path):
    with local_processes(1) as executor:
        run(STUDY, tmp_path, executor, trials=3, progress=Progress())
    for trial, row in enumerate(read_table(tmp_path)):
        assert row == {name: str(value) for name, value in run_trial(STUDY, 0, trial).items()}
        for planner in ("ratt", "boldest"):
            assert float(row[f"{planner}/worst/value"]) <= float(row[f"{planner}/first_robot/value"])
            assert float(row[f"{planner}/worst/value"]) <= float(row["optimum/upper"])


def test_a_measure_is_a_function_or_its_path():
    by_path, by_itself = toy.STUDY, replace(toy.STUDY, measure=toy.measure)
    assert run_trial(by_path, 1, 2) == run_trial(by_itself, 1, 2)
    assert by_path.definition() == by_itself.definition()
    assert by_path.modules() == by_itself.modules() == ("tests.studies.toy",)


def test_the_definition_names_every_function():
    definition = STUDY.definition()
    assert definition["planners"] == ["ratt", "tests.studies.own:boldest"]
    assert definition["problem"] == "tests.studies.own:cover"
    assert set(STUDY.modules()) == {"ratt_opt.studies.comparison", "tests.studies.own"}
    assert STUDY.fingerprint() != replace(STUDY, planners=("ratt",)).fingerprint()
    assert "problem" not in toy.STUDY.definition()  # older results stay those of their study


@pytest.mark.parametrize(("spec", "found"), [(SimpleNamespace(name="tests.own"), "tests.own"), (None, "__main__")])
def test_a_module_that_is_run_goes_by_its_own_name(monkeypatch, spec, found):
    """Its journal is then the same whoever runs it."""

    def measure():
        pass

    measure.__module__, measure.__qualname__ = "__main__", "measure"
    monkeypatch.setattr(sys.modules["__main__"], "__spec__", spec)
    assert path_of(measure) == f"{found}:measure"


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"planners": (lambda instance: instance,)}, "functions that stand at the top of a module"),
        ({"planners": (boldest, "boldest")}, "planners must have different names"),
        ({"attackers": ("worst", "worst")}, "attackers must have different names"),
    ],
)
def test_what_workers_could_not_find_is_refused(change, text):
    with pytest.raises(InputError, match=text):
        replace(STUDY, **change)


@pytest.mark.parametrize("metric", ["trace", "mse"])
def test_metrics_of_scenarios_are_refused_for_other_problems(metric):
    with pytest.raises(InputError, match="metrics must not need"):
        run_trial(replace(STUDY, metrics=(metric,)), 0, 0)


def test_a_study_of_random_scenarios_takes_own_planners():
    case = Case(n_robots=3, n_targets=2, alpha_s=1, alpha_c=1)
    study = Study(name="s", cases=(case,), planners=(boldest, "myopic"), attackers=("worst",), metrics=("mse", "trace"))
    row = run_trial(study, 0, 0)
    assert row["boldest/worst/trace"] == row["myopic/worst/trace"]
