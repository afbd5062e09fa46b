"""Scenario files: round trips, the schema, and every refusal in one line."""

import json
import tempfile
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ratt_opt import (
    FileFormatError,
    InformationInput,
    InputError,
    Robot,
    Scenario,
    Sensor,
    load_input,
    load_scenario,
    random_scenario,
    save_scenario,
    scenario_schema,
)
from ratt_opt.scenario.files import read_json
from tests.strategies import information_data


def _document() -> dict[str, Any]:
    scenario = random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=0)
    return scenario.model_dump(mode="json")


def _information() -> dict[str, Any]:
    prior, information = information_data(np.random.default_rng(3), 4, 2, 3)
    document = {"format": "ratt-opt information", "version": 1, "prior": prior.tolist(), "alpha_s": 1, "alpha_c": 0}
    return document | {"information": information.tolist(), "robot": [0, 0, 1, 1]}


def _write(tmp_path: Path, document: object) -> Path:
    path = tmp_path / "in.json"
    path.write_text(document if isinstance(document, str) else json.dumps(document))
    return path


def test_round_trip_is_exact(tmp_path: Path) -> None:
    scenario = random_scenario(4, 3, alpha_s=1, alpha_c=2, seed=9, sensor=Sensor(law="std", max_range=40.0))
    path = tmp_path / "s.json"
    save_scenario(scenario, path)
    again = load_scenario(path)
    assert again == scenario
    assert (again.information == scenario.information).all()


def test_files_satisfy_the_printed_schema() -> None:
    jsonschema.validate(_document(), scenario_schema())
    jsonschema.validate(_information(), scenario_schema("information"))
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(_document() | {"colour": "red"}, scenario_schema())
    with pytest.raises(InputError, match="kind must be"):
        scenario_schema("plan")


def test_a_model_free_file_is_a_problem(tmp_path: Path) -> None:
    document = _information()
    loaded = load_input(_write(tmp_path, document | {"links": [], "labels": list("abcd"), "weights": [1, 2]}))
    assert isinstance(loaded, InformationInput)
    problem = loaded.problem("logdet")
    assert problem.objective.n == 4
    assert problem.communication.links == frozenset()
    assert loaded.element_labels == ("a", "b", "c", "d")
    with pytest.raises(FileFormatError, match="format must be 'ratt-opt scenario'"):
        load_scenario(_write(tmp_path, document))


def _robot(**change: object) -> dict[str, Any]:
    document = _document()
    document["robots"][1].update(change)
    return document


def _target(**change: object) -> dict[str, Any]:
    document = _document()
    document["targets"][0].update(change)
    return document


def _without(document: dict[str, Any], name: str) -> dict[str, Any]:
    return {key: value for key, value in document.items() if key != name}


BAD = [
    ("", "line 1, column 1 must be strict JSON"),
    ('{"format": "ratt-opt sc', "line 1"),
    ('{"a": 1,\n "b": }', "line 2, column 7 must be strict JSON"),
    ('{"a": 1, "a": 2}', "the field 'a' twice"),
    ('{"NaN \\\\": 1,\n "b\\"": "NaN",\n "c": [NaN]}', "line 3 must be strict JSON; got the constant NaN"),
    ('{"a": -Infinity}', "the constant -Infinity"),
    ("[" * 100_000, "nested too deeply"),
    ([], "must hold a JSON object; got list"),
    ({}, "format must be 'ratt-opt scenario' or 'ratt-opt information'; got nothing"),
    (_document() | {"format": "x"}, "format must be .*; got x"),
    (_without(_document(), "version"), "version must be 1; got nothing"),
    (_document() | {"version": 2}, "version must be 1; got 2"),
    (_document() | {"version": True}, "version must be 1; got True"),
    (_document() | {"colour": 1}, "colour is not a field of this format; got 1"),
    (_without(_document(), "robots"), "robots is missing"),
    (_document() | {"robots": []}, "robots must not be empty"),
    (_document() | {"targets": []}, "targets must not be empty"),
    (_document() | {"robots": 3}, "robots must be a list; got 3"),
    (_robot(controls=[]), r"robots\[1\].controls must not be empty"),
    (_robot(controls=[[1]]), r"robots\[1\].controls\[0\]"),
    (_robot(x="far"), r"robots\[1\].x must be a number; got far"),
    (_robot(x=True), r"robots\[1\].x must be a number; got True"),
    (_robot(wheels=4), r"robots\[1\].wheels is not a field"),
    (_robot(sensor={"max_range": -1}), r"robots\[1\].sensor.max_range"),
    (_target(covariance=[[1, 2], [3, 9]]), r"targets\[0\].covariance must be symmetric"),
    (_target(covariance=[[1, 2], [2, 1]]), r"targets\[0\].covariance must be positive definite"),
    (_target(covariance=[[1, 0, 0], [0, 1, 0]]), r"targets\[0\].covariance"),
    (_target(weight=0), r"targets\[0\].weight"),
    (_document() | {"alpha_s": 4}, r"alpha_s must be an integer in \[0, 3\]; got 4"),
    (_document() | {"alpha_c": 4}, r"alpha_c must be an integer in \[0, 3\]; got 4"),
    (_document() | {"alpha_s": -1}, "alpha_s"),
    (_document() | {"alpha_s": 1.5}, "alpha_s must be an integer; got 1.5"),
    (_document() | {"links": [[0, 3]]}, r"links\[0\] must join robots in \[0, 2\]"),
    (_document() | {"links": [[1, 1]]}, r"links\[0\] must join two different robots"),
    (_document() | {"links": [[0, 1], [1, 0]]}, r"links\[1\] must not be repeated"),
    (_document() | {"links": [[0, 1]], "communication_range": 3}, "communication_range must be absent"),
    (_document() | {"sampling_period": 0}, "sampling_period"),
    (_document() | {"protected_robots": [7]}, "protected robot must be"),
    (_document() | {"links": [[0, 1]], "protected_links": [[1, 2]]}, "protected link must be a link"),
    (_document() | {"sensor": {"law": "cubic"}}, "sensor.law"),
    (_document() | {"sensor": {"range_noise": 0}}, "sensor.range_noise"),
    (_information() | {"robot": [0, 0, 2, 2]}, "none for robot 1"),
    (_information() | {"robot": [0, 1]}, "robot must have shape"),
    (_information() | {"prior": [[[1, 0], [0, 1]], [[1]]]}, "prior must hold square matrices of one size"),
    (_information() | {"prior": [[[1, 0, 0], [0, -1, 0], [0, 0, 1]]] * 2}, r"prior\[0\] must be positive definite"),
    (_information() | {"weights": [1]}, "weights must have shape"),
    (_information() | {"labels": ["a"]}, "labels must have 4 entries"),
    (_information() | {"robot": [0, 0, 1, 10**9]}, "robot must give every robot at least one element; got none for"),
    (_information() | {"robot": [0, 0, 1, 10**20]}, "robot must give every robot at least one element; got none for"),
    (_information() | {"prior": [[[1e200]]]}, r"prior\[0\]\[0\]\[0\] must be <= 1e\+100; got 1e\+200"),
    (_document() | {"self": 1}, "self is not a field of this format"),
    (_document() | {"two\nlines": 1}, r"'two\\nlines' is not a field of this format"),
    (_document() | {"notes": ["\x1b[31m"]}, r"notes\[0\] must be one line of printable text"),
    (_document() | {"notes": ["\ud800"]}, r"notes\[0\] must be one line of printable text"),
    (_robot(name="a\nb"), r"robots\[1\].name must be one line of printable text"),
    (_robot(x=1e200), r"robots\[1\].x must be <= 1e\+12; got 1e\+200"),
    (_robot(controls=[[1e308, 0]]), r"robots\[1\].controls\[0\]\[0\] must be <= 1e\+12"),
    (_target(process_std=1e200), r"targets\[0\].process_std must be <= 1e\+12"),
    (_target(covariance=[[1, 1 - 1e-16], [1 - 1e-16, 1]], process_std=0), r"prior\[0\] must be positive definite"),
    (_document() | {"sensor": {"range_noise": 1e-320}}, "sensor.range_noise must be >= 1e-12"),
    (_document() | {"links": [[0, 1, 2]]}, r"links\[0\] must have at most 2 entries"),
    ('{"version": ' + "1" * 5000 + "}", "must be strict JSON; got an integer with too many digits"),
    ("\ufeff\ufeff{}", "line 1, column 1 must be strict JSON"),
]


@pytest.mark.parametrize(("document", "text"), BAD, ids=range(len(BAD)))
def test_bad_files_are_refused_in_one_line(tmp_path: Path, document: object, text: str) -> None:
    path = _write(tmp_path, document)
    with pytest.raises(FileFormatError, match=text) as caught:
        load_input(path)
    assert "\n" not in str(caught.value)
    assert str(caught.value).startswith(str(path))
    assert "Error" not in str(caught.value)


def test_unreadable_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match="must be a file that can be read; got No such file"):
        load_input(tmp_path / "missing.json")
    with pytest.raises(FileFormatError, match="must be a file that can be read"):
        load_input(tmp_path)
    (tmp_path / "latin.json").write_bytes(b'{"format": "\xe9"}')
    with pytest.raises(FileFormatError, match="must be UTF-8 text; got byte 12"):
        load_input(tmp_path / "latin.json")


def test_an_oversized_file_is_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ratt_opt.scenario.files.LARGEST_FILE", 10)
    with pytest.raises(FileFormatError, match="must be at most 10 bytes"):
        load_input(_write(tmp_path, _document()))


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="no endless file here")
def test_an_endless_file_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ratt_opt.scenario.files.LARGEST_FILE", 1000)
    with pytest.raises(FileFormatError, match="/dev/zero must be at most 1000 bytes; got more"):
        load_input("/dev/zero")


def test_records_refuse_bad_values_when_built_in_python() -> None:
    with pytest.raises(InputError, match="x must be finite; got nan"):
        Robot(x=float("nan"), y=0)
    with pytest.raises(InputError, match="controls must not be empty"):
        Robot(x=0, y=0, controls=())
    with pytest.raises(InputError, match="targets is missing"):
        Scenario(robots=(Robot(x=0, y=0),), alpha_s=0, alpha_c=0)
    scenario = random_scenario(1, 1, alpha_s=0, alpha_c=0, seed=0)
    with pytest.raises(InputError, match="objective must be trace, logdet or maxeig; got area"):
        scenario.problem("area")


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"n_robots": 0}, "n_robots must be an integer >= 1; got 0"),
        ({"n_targets": 0}, "n_targets must be"),
        ({"seed": -1}, "seed must be"),
        ({"seed": 1.5}, "seed must be"),
        ({"alpha_s": 9}, r"alpha_s must be an integer in \[0, 2\]; got 9"),
        ({"side": 0}, "side must be positive"),
        ({"prior_std": float("nan")}, "prior_std must be positive; got nan"),
        ({"prior_std": -3.0}, "prior_std must be positive; got -3.0"),
        ({"side": float("inf")}, "x must be finite"),
    ],
)
def test_the_generator_refuses_bad_numbers(change: dict[str, Any], text: str) -> None:
    arguments: dict[str, Any] = {"n_robots": 2, "n_targets": 1, "alpha_s": 0, "alpha_c": 0, "seed": 0}
    with pytest.raises(InputError, match=text):
        random_scenario(**(arguments | change))


@given(st.dictionaries(st.text(max_size=5), st.integers(), max_size=4))
def test_a_byte_order_mark_changes_nothing(document: dict[str, int]) -> None:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "marked.json"
        file.write_text(json.dumps(document, ensure_ascii=False), encoding="utf-8-sig")
        assert read_json(file) == document


@given(st.integers(0, 2), st.integers(0, 2))
def test_budgets_written_as_floats_count_as_integers(alpha_s: int, alpha_c: int) -> None:
    document = _document() | {"alpha_s": float(alpha_s), "alpha_c": float(alpha_c)}
    document = {name: value for name, value in document.items() if name not in {"format", "version"}}
    scenario = Scenario(**document)
    assert [scenario.alpha_s, scenario.alpha_c] == [alpha_s, alpha_c]
    assert type(scenario.alpha_s) is int is type(scenario.alpha_c)
