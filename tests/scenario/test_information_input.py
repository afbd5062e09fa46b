"""Matrices given in many ways are the same input; entries at fault are named; payloads stay with their elements."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ratt_opt import FileFormatError, InformationInput, InputError, load_input, ratt, save_scenario
from tests.strategies import information_data


def parts(seed: int = 0) -> dict[str, Any]:
    prior, information = information_data(np.random.default_rng(seed), 4, 2, 3)
    return {"prior": prior, "information": information, "robot": [0, 0, 1, 1], "alpha_s": 1, "alpha_c": 0}


WAYS = {
    "array": lambda x: x,
    "lists": lambda x: x.tolist(),
    "arrays of arrays": list,
    "NumPy numbers": lambda x: (
        [[[list(row) for row in m] for m in e] for e in x] if x.ndim == 4 else list(map(list, x))
    ),
    "Fortran order": np.asfortranarray,
}


@pytest.mark.parametrize("way", WAYS)
def test_every_way_to_give_matrices_is_the_same_input(way: str) -> None:
    given = parts()
    expected = InformationInput(**given)
    same = InformationInput(**given | {name: WAYS[way](given[name]) for name in ("prior", "information")})
    assert same == expected
    assert {type(entry) for matrix in same.prior for row in matrix for entry in row} == {float}
    assert {type(x) for e in same.information for m in e for row in m for x in row} == {float}
    np.testing.assert_array_equal(same.matrices[1], given["information"])


def test_whole_numbers_count_as_numbers() -> None:
    record = InformationInput(
        prior=[[[2]]], information=[[[[1]]], [[[np.int32(3)]]]], robot=[0, 1], alpha_s=0, alpha_c=0
    )
    assert record.information == (((((1.0,),),)), (((3.0,),),))
    assert type(record.prior[0][0][0]) is float


@pytest.mark.parametrize(
    ("entry", "rule"),
    [
        (True, "must be a number; got True"),
        (np.bool_(True), "must be a number"),
        ("1", "must be a number; got '1'"),
        (None, "must be a number"),
        (float("nan"), "must be finite; got nan"),
        (1e101, r"must be <= 1e\+100"),
    ],
)
def test_the_entry_at_fault_is_named(entry: object, rule: str) -> None:
    given = parts()
    nested = given["information"].tolist()
    nested[2][1][0][1] = entry
    with pytest.raises(InputError, match=r"information\[2\]\[1\]\[0\]\[1\] " + rule):
        InformationInput(**given | {"information": nested})


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("prior", np.eye(3)),
        ("prior", np.zeros((1, 1, 1, 1))),
        ("information", np.zeros((4, 2, 3))),
        ("information", np.ones((4, 2, 3, 3), dtype=bool)),
        ("information", np.zeros((0, 2, 3, 3))),
        ("information", "matrices"),
    ],
)
def test_other_shapes_and_types_are_refused_as_before(name: str, value: object) -> None:
    with pytest.raises(InputError, match=f"^{name}"):
        InformationInput(**parts() | {name: value})


def test_a_payload_stays_with_its_elements(tmp_path: Path) -> None:
    given, commands = parts(), [object(), {"turn": 1}, None, np.zeros(2)]
    record = InformationInput(**given, payload=commands)
    assert [record.payload[e] for e in ratt(record.problem())] == [commands[e] for e in ratt(record.problem())]
    assert record == InformationInput(**given)
    assert hash(record) == hash(InformationInput(**given))
    assert record.digest == InformationInput(**given).digest
    assert record.replace(alpha_s=0).payload[1] is commands[1]
    assert record.replace(payload=None).payload is None
    save_scenario(record, tmp_path / "in.json")
    assert load_input(tmp_path / "in.json") == record
    with pytest.raises(InputError, match="payload must have 4 entries, one per element; got 2"):
        InformationInput(**given, payload=[1, 2])
    document = json.loads((tmp_path / "in.json").read_text())
    (tmp_path / "in.json").write_text(json.dumps(document | {"payload": [1, 2, 3, 4]}))
    with pytest.raises(FileFormatError, match="payload is not a field of this format"):
        load_input(tmp_path / "in.json")
