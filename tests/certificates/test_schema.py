"""The schema of certificates says what the verifier reads: no less than it accepts, and nothing that no file holds."""

import copy
import json
from pathlib import Path
from typing import Any

import jsonschema
import networkx as nx
import numpy as np
import pytest

from analysis.faults.damage import damaged
from ratt_opt import (
    FileFormatError,
    LogDetObjective,
    MaxEigenvalueObjective,
    Problem,
    ProofError,
    TraceObjective,
    certify,
    solve_maxmin,
    verify_certificate,
)
from tests.certificates.engine import ENUMERATED, proof
from tests.strategies import information_data

PRIOR, INFORMATION = information_data(np.random.default_rng(4), 6, 2)
WEIGHTS = [1.0, 3.0]
OBJECTIVES = {
    "trace": TraceObjective(PRIOR, INFORMATION),
    "trace of an output": TraceObjective(PRIOR, INFORMATION, WEIGHTS, output=[[1.0, 0.5]]),
    "logdet": LogDetObjective(PRIOR, INFORMATION, WEIGHTS),
    "maxeig": MaxEigenvalueObjective(PRIOR, INFORMATION),
    "maxeig of an output": MaxEigenvalueObjective(PRIOR, INFORMATION, WEIGHTS, output=[[1.0, 0.5]]),
}
MUTANTS = 60


@pytest.fixture(scope="module")
def documents(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """A certificate of every kind: criteria, links between all or not, a lower end that is not proved."""
    path = tmp_path_factory.mktemp("certificates") / "c.json"
    made: dict[str, Any] = {}
    for name, objective in OBJECTIVES.items():
        for links, graph in (("complete", None), ("path", nx.path_graph(3))):
            problem = Problem(objective, np.repeat(np.arange(3), 2), graph, 1, 1, protected_robots={0})
            certify(problem, solve_maxmin(problem), path)
            made[f"{name}, {links}"] = json.loads(path.read_text(encoding="utf-8"))
    made["enumerated"] = made["trace, path"] | {"lower": ENUMERATED}
    made["with its source"] = made["trace, path"] | {"made_from": "0123456789abcdef" * 4}
    problem = Problem(OBJECTIVES["trace"], np.repeat(np.arange(3), 2), nx.path_graph(3), 1, 1, protected_robots={0})
    plan, lower = np.array(made["trace, path"]["plan"]), made["trace, path"]["claim"]["lower"]
    duals = proof("cover", problem, plan, lower * (1 - 1e-13), 1000)
    made["duals"] = made["trace, path"] | {"lower": duals}
    low = made["trace, path"]["claim"] | {"lower": 0.0}
    cover = {**duals, "conclusion": "cover", "partition": [0], "tree": ["worth"]}
    cover["duals"] = {"link": 0, "robots": [0, 0, 0], "blinded": 0}
    limits = [{"robots": [0, 2], "size": 0, "tree": ["worth"]}]
    made["limits"] = made["trace, path"] | {
        "claim": low,
        "lower": cover | {"limits": limits, "tree": [{"limit": 0}, "worth"]},
    }
    made["cover"] = made["trace, path"] | {"claim": low, "lower": cover}
    sized = proof("sizes", problem, plan, 0.0, 1000)
    sized["bounds"] = [{"duals": 0, "diagonal": [0, 0, 0]}]
    made["sizes"] = made["trace, path"] | {"claim": low, "lower": sized}
    return made


def test_every_kind_is_covered(documents: dict[str, Any], schema: jsonschema.Draft202012Validator) -> None:
    assert {document["lower"]["conclusion"] for document in documents.values()} == {
        "forced", "duals", "cover", "sizes", "enumerated",
    }  # fmt: skip
    assert any("part" in node for document in documents.values() for node in document["upper"]["tree"])
    for document in documents.values():
        schema.validate(document)


def _accepted(document: Any, path: Path) -> bool:
    path.write_text(json.dumps(document), encoding="utf-8")
    try:
        verify_certificate(path)
    except (FileFormatError, ProofError):
        return False
    return True


def test_what_the_verifier_accepts_keeps_to_the_schema(
    documents: dict[str, Any], schema: jsonschema.Draft202012Validator, tmp_path: Path
) -> None:
    rng, path = np.random.default_rng(5), tmp_path / "c.json"
    accepted = 0
    for document in documents.values():
        whole = json.dumps(document).encode()
        for _ in range(MUTANTS):
            try:
                mutant = json.loads(damaged(whole, rng))
            except ValueError:
                continue
            if mutant != document and _accepted(mutant, path):
                accepted += 1
                schema.validate(mutant)
    assert accepted >= 10


def _records(value: Any, at: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """The places of all records of a document."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [at] * isinstance(value, dict) + [place for key, item in inner for place in _records(item, (*at, key))]


def test_the_schema_is_closed_and_refuses_what_the_verifier_refuses(
    documents: dict[str, Any], schema: jsonschema.Draft202012Validator, tmp_path: Path
) -> None:
    """Each record of a file without one of its fields, with another thing there, or with a field more."""
    document = documents["trace of an output, path"]
    for place in _records(document):
        names = list(_at(document, place))
        for name in (*names, None):
            mutant = copy.deepcopy(document)
            record = _at(mutant, place)
            if name is None:
                record["more"] = 1
            elif name in ("output", "limits"):  # which may be left out
                record[name] = None
            else:
                del record[name]
            assert not schema.is_valid(mutant), (place, name)
            assert not _accepted(mutant, tmp_path / "c.json"), (place, name)


def _at(document: Any, place: tuple[Any, ...]) -> Any:
    for key in place:
        document = document[key]
    return document
