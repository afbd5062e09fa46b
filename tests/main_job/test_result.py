"""A bound report as a value: plain data, pickled, copied, compared, shown."""

import copy
import json
import pickle
from dataclasses import fields, replace

import jsonschema
import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.cli import run
from ratt_opt.report.schemas import output_schema
from ratt_opt.report.tables import report_tables
from ratt_opt.setfunctions.information import InformationObjective
from tests.main_job.engine import step
from tests.strategies import OBJECTIVES

SCENARIO = ro.random_scenario(4, 3, alpha_s=1, alpha_c=3, seed=3)


@pytest.fixture(scope="module", params=[*OBJECTIVES, "table"])
def report(request):
    if request.param == "table":
        return ro.bound(ro.Problem(ro.Modular([1.0, 2.0, 3.0, 4.0]), [0, 0, 1, 2], None, 1, 1))
    return ro.bound(SCENARIO, objective=request.param)


def test_to_dict_is_plain_and_strict(report):
    """JSON gives back exactly what went in: no arrays, no NumPy numbers, no tuples, no NaN."""
    document = report.to_dict()
    assert json.loads(json.dumps(document, allow_nan=False)) == document

    def plain(value):
        if isinstance(value, dict):
            return all(type(name) is str and plain(item) for name, item in value.items())
        if type(value) is list:
            return all(map(plain, value))
        return value is None or type(value) in {str, int, float, bool}

    assert plain(document)


def test_to_dict_says_what_the_report_says(report):
    document = report.to_dict()
    problem, best = report.problem, report.recommended
    assert document["objective"] == report.objective
    assert document["unit"] == report.unit
    assert document["n_links"] == len(problem.communication.links)
    assert document["guaranteed_share"] == max(document["guarantees"].values(), default=0.0)
    assert document["hypotheses"].keys() == document["guarantees"].keys()
    assert document["inapplicable"] == report.inapplicable
    shown = document["recommended"]
    assert shown["planner"] == best.planner
    assert shown["share"] == report.share(best)
    assert problem.best_group(shown["elements"], best.worst_case.attack) == set(shown["best_group"])
    groups = problem.communication.groups({tuple(link) for link in shown["worst_case"]["links"]})
    assert [set(group) for group in groups] == [set(group) for group in shown["groups"]]
    assert document["baselines"] == {
        plan.planner: plan.to_dict() | {"share": report.share(plan)} for plan in report.baselines
    }


def test_the_posterior_is_that_of_the_best_group(report):
    objective = report.problem.objective
    for plan in report.plans:
        if not isinstance(objective, InformationObjective):
            assert plan.posterior is None
            continue
        left = objective.criterion(np.linalg.inv(plan.posterior))
        before = objective.criterion(objective.prior_information)
        assert objective.combine(before) - objective.combine(left) == pytest.approx(plan.worst_case.upper, rel=1e-9)


@pytest.mark.parametrize(
    "remake",
    [copy.copy, copy.deepcopy, lambda value: pickle.loads(pickle.dumps(value))],
    ids=["copy", "deep", "pickle"],
)
def test_a_copy_is_equal_and_says_the_same(report, remake):
    again = remake(report)
    assert again == report
    assert again.to_dict() == report.to_dict()
    assert remake(report.ratt) == report.ratt
    assert hash(remake(report.ratt)) == hash(report.ratt)
    worst = again.ratt.worst_case.attack
    assert again.problem.team_value(again.ratt.elements, worst) == report.problem.team_value(
        report.ratt.elements, worst
    )


def test_equal_means_saying_the_same_whatever_time_it_took(report):
    assert replace(report, seconds={"everything": 1.0}) == report
    assert report != ro.bound(SCENARIO.replace(alpha_s=2))
    assert report != report.to_dict()
    assert replace(report.ratt, planner="mine") != report.ratt
    changed = replace(report.ratt, elements=report.ratt.elements[::-1])
    assert replace(report, ratt=changed) != report


def test_it_shows_itself_in_one_short_line(report):
    for value in (report, report.ratt):
        text = repr(value)
        assert text.startswith(type(value).__name__)
        assert "\n" not in text
        assert len(text) < 200


def test_numbers_are_python_floats(report):
    numbers = [
        report.upper,
        report.certified_ratio,
        report.guaranteed_share,
        report.optimum.lower,
        report.optimum.upper,
    ]
    for plan in report.plans:
        numbers += [plan.worst_case.lower, plan.worst_case.upper, report.share(plan)]
    assert {type(number) for number in numbers} == {float}
    assert {type(value) for value in report.seconds.values()} == {float}


def test_alpha_cs_is_computed_once(monkeypatch):
    """Off complete graphs it can take seconds."""
    calls = []
    step(monkeypatch, "link attacks", lambda real: lambda *a, **b: calls.append(0) or real(*a, **b))
    report = ro.bound(SCENARIO.replace(links=((0, 1), (1, 2), (2, 3))))
    assert len(calls) == 1
    assert report.alpha_cs == ro.ratt(report.problem).alpha_cs


def test_n_max_is_printed_as_a_number_only_where_a_cut_attains_it():
    for links in (None, ((0, 1), (1, 2), (2, 3))):
        report = ro.bound(SCENARIO.replace(links=links))
        assert report.n_max_upper == report.n_max
        for most, said in ((report.n_max, f"{report.n_max}"), (9, f"at least {report.n_max}, at most 9")):
            shown = replace(report, n_max_upper=most)
            cells = [cell for table in report_tables(shown) for column in table.columns for cell in column.cells]
            assert said in cells


def test_n_max_has_a_certificate(tmp_path, capsys):
    """Counting proves complete graphs, prices a star; a report whose certificate is not asked for says so."""
    for links, proof, size in ((None, "counting", 2), (((0, 1), (0, 2), (0, 3)), "prices", 2)):
        report = ro.bound(SCENARIO.replace(links=links, alpha_c=1 if links else 3))
        assert report.to_dict()["n_max_proof"]["certificate"]["reason"] == "not asked for"
        files = report.save(tmp_path)
        assert tmp_path / "cuts.json" in files
        stated = json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))
        told = stated["n_max_proof"]["certificate"]
        assert told["file"] == "cuts.json"
        assert (told["proof"], told["size"]) == (proof, size)
        assert run(["verify", str(tmp_path / "cuts.json"), "--json"]) == 0
        proved = json.loads(capsys.readouterr().out)
        assert proved["size"] == stated["n_max"] - 1
        assert proved["lower"] == told["least_links"] > stated["alpha_c"]
        assert len(stated["n_max_proof"]["cut"]) <= stated["alpha_c"]
        jsonschema.validate(stated, output_schema("report"))


class RootOfTrace(InformationObjective):
    """A user's own criterion: only a value per target and its supergradient, no name, no compiled loop."""

    def criterion(self, posterior_information):
        return np.sqrt(np.trace(np.linalg.inv(posterior_information), axis1=-2, axis2=-1))

    def gradient(self, posterior_information):
        covariance = np.linalg.inv(posterior_information)
        root = np.sqrt(np.trace(covariance, axis1=-2, axis2=-1))[..., None, None]
        return covariance @ covariance / (2 * root)


def test_a_criterion_of_ones_own_goes_through(tmp_path):
    trace = ro.random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=4).problem().objective
    problem = ro.Problem(RootOfTrace(trace.prior, trace.information), np.repeat([0, 1, 2], 12), None, 1, 1)
    report = ro.bound(problem, certificate=tmp_path / "certificate.json")
    exact = ro.exhaustive_optimum(problem)
    assert report.optimum.lower - 1e-9 <= exact.upper
    assert exact.lower <= report.upper + 1e-9
    assert report.objective == "RootOfTrace"
    assert report.unit == ""
    assert report.total_curvature.upper <= 1
    assert report.certificate.certificate is None
    assert not (tmp_path / "certificate.json").exists()
    assert {field.name for field in fields(report)} >= {"guarantees", "inapplicable"}


def test_guarantees_take_the_time_that_is_asked_for(tmp_path):
    """Bearings alone: curvatures are hard, the plan is not."""
    scenario = ro.limited_view_scenario(6, 4, alpha_s=2, alpha_c=4, seed=1, view=360.0)
    reports = {kind: ro.bound(scenario, guarantees=kind, time_limit=20) for kind in ("none", "quick", "full")}
    none, quick, full = reports.values()
    assert (none.guarantees, none.inapplicable, none.total_curvature) == ({}, {}, None)
    assert none.omitted["guarantees"] == "not asked for"
    assert set(quick.guarantees) == set(full.guarantees) != set()
    assert none.optimum.lower == quick.optimum.lower == full.optimum.lower
    assert full.total_curvature.upper <= quick.total_curvature.upper + 1e-9
    for kind, report in reports.items():
        report.save(tmp_path / kind, certificate=False)
        document = json.loads((tmp_path / kind / "report.json").read_text())
        assert document["omitted"] == report.omitted
        page = (tmp_path / kind / "report.html").read_text()
        assert ("Guaranteed before planning" in page) == (kind != "none")
        assert all(name in page and why in page for name, why in report.omitted.items())
    with pytest.raises(ro.InputError, match="guarantees must be none, quick, full; got some"):
        ro.bound(scenario, guarantees="some")


@pytest.mark.parametrize(
    ("objective", "guarantees", "absent"),
    [
        ("logdet", "quick", {"total_curvature"}),
        ("trace", "quick", {"curvature"}),
        ("trace", "none", {"curvature", "total_curvature"}),
    ],
)
def test_a_curvature_that_is_none_is_among_what_is_left_out(objective, guarantees, absent):
    report = ro.bound(
        ro.random_scenario(4, 2, alpha_s=1, alpha_c=1, seed=0), objective=objective, guarantees=guarantees
    )
    names = {"curvature", "total_curvature"}
    assert {name for name in names if getattr(report, name) is None} == absent == names & set(report.omitted)


def test_a_baseline_that_is_missing_is_named():
    report = ro.bound(ro.random_scenario(30, 10, alpha_s=3, alpha_c=30, seed=1), time_limit=0.5)
    names = {plan.planner for plan in report.plans}
    assert ("nonrobust_optimum" in report.omitted) == ("nonrobust_optimum" not in names)
    cramped = ro.bound(ro.random_scenario(12, 10, alpha_s=3, alpha_c=30, seed=1), time_limit=0)
    assert "in its share of the time" in cramped.omitted["nonrobust_optimum"]


@pytest.mark.parametrize(("busy", "expected"), [(10.0, 2.0), (2.5, 8.0), (0.1, 16.0), (0.0, 2.0)])
def test_quick_guarantees_have_seconds_of_the_processor(monkeypatch, busy: float, expected: float) -> None:
    """Ten seconds went by: the pace so far, at least one and at most eight, says how many seconds of the clock."""
    from ratt_opt.main_job import params

    whole = params.Budget(100.0)
    monkeypatch.setattr(params.Budget, "elapsed", property(lambda _self: 10.0))
    given = params.QUICK.within(whole, busy)
    assert given.time_limit == pytest.approx(expected)
    assert params.QUICK.within(params.Budget(11.0), busy).time_limit <= 1.0
