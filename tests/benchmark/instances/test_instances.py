"""Instances: what is written is read back, classes follow from problems, faults are named."""

import json

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.benchmark.instances.forms import NetworkInput, SumInput, TableInput
from ratt_opt.benchmark.instances.instance import write_document
from ratt_opt.benchmark.instances.published import library_folder
from tests.benchmark.small_library import (
    attack_instance,
    coverage_instance,
    cuts_instance,
    plan_instance,
    small_library,
    table_instance,
)

ALL = (coverage_instance, table_instance, plan_instance, attack_instance, cuts_instance)


@pytest.mark.parametrize("make", ALL)
@pytest.mark.parametrize("suffix", [".json", ".json.xz"])
def test_what_is_written_is_read_back(make, suffix, tmp_path):
    instance = make()
    path = tmp_path / f"one{suffix}"
    write_document(instance.document, path)
    again = ro.read_instance(path)
    assert again.document == instance.document
    assert again.class_code == instance.class_code
    if instance.track != "cuts":
        sets = np.random.default_rng(0).random((50, instance.team.objective.n)) < 0.5
        assert np.array_equal(again.team.objective.evaluate(sets), instance.team.objective.evaluate(sets))


def test_classes_follow_from_problems():
    assert [make().class_code for make in ALL] == ["PCKs", "PXKb", "PTKb", "ATKb", "CNGu"]
    ring = ((0, 1), (1, 2), (2, 3), (0, 3))
    assert coverage_instance(lost=0, cut=2, links=ring).class_code == "PCGl"
    assert coverage_instance(lost=0).class_code == "PCKn"
    assert plan_instance(objective="maxeig").class_code == "PEKb"
    assert cuts_instance(weights=[2] * 15).class_code == "CNGw"
    assert [make().track for make in ALL] == ["plan", "plan", "plan", "attack", "cuts"]


CHANGES = {
    "another format": ({"format": "x"}, "format must be 'ratt-opt benchmark instance'; got x"),
    "no problem": ({"problem": 3}, "problem.format must be ratt-opt information"),
    "a bad name": ({"name": "../x"}, "name"),
    "an unknown criterion": ({"objective": "median"}, "objective must be trace, logdet, maxeig; got median"),
    "another class": ({"code": "PTKb"}, "code must be PCKs, the class of the problem; got PTKb"),
    "a new field": ({"colour": "red"}, "colour is not a field of this format"),
    "a later version": ({"version": 2}, "version"),
}


@pytest.mark.parametrize("change", CHANGES)
def test_faults_of_a_file_are_named(change, tmp_path):
    fields, expected = CHANGES[change]
    path = tmp_path / "one.json"
    path.write_text(json.dumps({**coverage_instance().document, **fields}), encoding="utf-8")
    with pytest.raises(ro.InputError) as refused:
        ro.read_instance(path)
    assert expected in str(refused.value)
    assert str(path) in str(refused.value)


FORMS = {
    "an item that is none": (
        lambda: SumInput(kind="coverage", covers=[[5]], weights=[1.0], robot=[0], alpha_s=0, alpha_c=0),
        "covers must name items below 1; got 5",
    ),
    "no covers": (
        lambda: SumInput(kind="coverage", weights=[1.0], robot=[0], alpha_s=0, alpha_c=0),
        "covers must have 1 entries",
    ),
    "ragged utilities": (
        lambda: SumInput(kind="facility location", utility=[[1, 2], [1]], robot=[0, 1], alpha_s=0, alpha_c=0),
        "utility must have rows of one length",
    ),
    "a short table": (
        lambda: TableInput(values=[0, 1, 2], robot=[0, 1], alpha_s=0, alpha_c=0),
        "values must have 2**2 entries",
    ),
    "a budget too large": (
        lambda: TableInput(values=[0, 1], robot=[0], alpha_s=2, alpha_c=0),
        "alpha_s must be",
    ),
    "a link to nobody": (lambda: NetworkInput(robots=2, links=[[0, 5]], size=1), "links must join robots below 2"),
    "too few weights": (lambda: NetworkInput(robots=2, links=[[0, 1]], size=1, weights=[]), "weights must have 1"),
    "a robot too large": (lambda: NetworkInput(robots=2, links=[], size=1, sizes=[1, 2]), "size must be at least"),
    "a robot far away": (lambda: TableInput(values=[0, 1], robot=[10**9], alpha_s=0, alpha_c=0), "robot must name"),
}


@pytest.mark.parametrize("fault", FORMS)
def test_faults_of_a_form_are_named(fault):
    make, expected = FORMS[fault]
    with pytest.raises(ro.InputError) as refused:
        make()
    assert expected in str(refused.value)


def test_files_that_are_none_are_refused(tmp_path):
    (tmp_path / "torn.json.xz").write_bytes(b"\xfd7zXZ\x00 no more")
    (tmp_path / "list.json").write_text("[1]", encoding="utf-8")
    for name in ("torn.json.xz", "list.json", "none.json"):
        with pytest.raises(ro.InputError, match=name):
            ro.read_instance(tmp_path / name)


def test_a_library_is_read_back_and_its_faults_are_named(tmp_path):
    library = small_library(tmp_path)
    again = ro.BenchmarkLibrary.load(tmp_path)
    assert again.entries == library.entries
    assert again.best == library.best
    assert again.chosen(["P"]) == ["cover", "plan"]
    assert again.chosen(["P", "cuts"]) == ["cover", "cuts", "plan"]
    assert again.chosen(curated=True) == ["attack", "cover", "plan"]
    with pytest.raises(ro.InputError, match="--only must begin the name or class of an instance; got z"):
        again.chosen(["z"])
    with pytest.raises(ro.InputError, match="instance must be one of the 4"):
        again.instance("z")
    write_document(table_instance(name="cover").document, again.path("cover"))
    with pytest.raises(ro.InputError, match=r"cover\.json\.xz must have the SHA-256 of the index"):
        again.instance("cover")
    (tmp_path / "best.csv").write_text("instance,value\n", encoding="utf-8")
    with pytest.raises(ro.InputError, match=r"best\.csv line 1 must be instance,value,bound"):
        ro.BenchmarkLibrary.load(tmp_path)
    assert library_folder(tmp_path) == tmp_path
    with pytest.raises(ro.InputError, match=r"library must be a folder that holds library\.csv"):
        library_folder(tmp_path / "none")
