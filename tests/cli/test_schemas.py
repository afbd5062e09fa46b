"""What programs read is what the schemas say: every output, every field."""

import inspect
import json
import re
from collections.abc import Iterator
from copy import deepcopy
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from ratt_audit import ledger
from ratt_audit.entries import all_entries
from ratt_opt import Problem, TableFunction, bound
from ratt_opt.cli import run
from ratt_opt.cli.program import ERRORS, app
from ratt_opt.report.schemas import OUTPUTS, output_schema
from tests.interrupts import interrupted_at
from tests.main_job.engine import step

VALIDATOR = jsonschema.Draft202012Validator


def _closed(schema: Any) -> Any:
    """The schema without the freedom to hold fields that it does not name, which newer versions may add."""
    if isinstance(schema, list):
        return [_closed(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    closed = {name: _closed(item) for name, item in schema.items()}
    if isinstance(schema.get("properties"), dict) and "type" in schema:
        closed["additionalProperties"] = False
    return closed


def _check(document: Any, name: str) -> None:
    VALIDATOR(_closed(output_schema(name))).validate(document)


def _printed(capsys: pytest.CaptureFixture[str], *arguments: str, code: int = 0) -> Any:
    capsys.readouterr()
    assert run([*arguments, "--json"]) == code
    return json.loads(capsys.readouterr().out)


@pytest.fixture
def information_file(tmp_path: Path) -> Path:
    path = tmp_path / "information.json"
    head = {"format": "ratt-opt information", "version": 1, "alpha_s": 1, "alpha_c": 0, "robot": [0, 0, 1]}
    path.write_text(json.dumps({**head, "prior": [[[2.0]]], "information": [[[[1.0]]], [[[2.0]]], [[[0.5]]]]}))
    return path


def _inner(schema: Any) -> Iterator[dict[str, Any]]:
    """Every schema of a named field, where it is first named: conditions name fields again."""
    if isinstance(schema, list):
        for item in schema:
            yield from _inner(item)
    elif isinstance(schema, dict):
        properties = schema.get("properties", {})
        yield from properties.values()
        for name, item in schema.items():
            if name not in {"if", "then", "else"}:
                yield from _inner(list(item.values()) if name in {"properties", "$defs"} else item)


@pytest.mark.parametrize("name", OUTPUTS)
def test_schemas_are_schemas_and_say_what_every_field_is(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    schema = output_schema(name)
    VALIDATOR.check_schema(schema)
    fields = list(_inner(schema))
    assert len(fields) >= 5
    assert all(field.get("description") or "$ref" in field for field in fields)
    assert run(["schema", name]) == 0
    assert json.loads(capsys.readouterr().out) == schema


def _takes_json(command: Any) -> bool:
    return "as_json" in inspect.signature(command).parameters


def test_the_pages_name_every_schema_and_exit_code() -> None:
    page, commands = (
        (Path(__file__).parents[2] / "docs" / name).read_text(encoding="utf-8")
        for name in ("formats.md", "commands.md")
    )
    for name in OUTPUTS:
        assert f"`ratt-opt schema {name}`" in page
        about = output_schema(name)["properties"]["format"]["const"]
        assert f'| `"{about}"` |' in page
    with_json = {str(command.callback.__name__) for command in app.registered_commands if _takes_json(command.callback)}
    assert with_json >= {"bound", "track", "verify"}
    assert all(re.search(rf"^\|[^|]*`{name}`[^|]*\| `ratt-opt schema", page, re.MULTILINE) for name in with_json)
    codes = {0, 3, 70, *ERRORS.values()}
    assert {int(code) for code in re.findall(r"^\| (\d+) \| ", commands, re.MULTILINE)} == codes


@pytest.mark.parametrize("objective", ["trace", "logdet", "maxeig"])
def test_reports_of_scenarios(
    objective: str, scenario_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = str(tmp_path / "o")
    printed = _printed(capsys, "bound", str(scenario_file), "--out", out, "--objective", objective)
    _check(printed, "report")
    assert printed == json.loads((tmp_path / "o" / "report.json").read_text())
    assert printed["certificate"]["verified"]
    _check(json.loads((tmp_path / "o" / "certificate.json").read_text()), "certificate")
    verified = _printed(capsys, "verify", f"{out}/certificate.json")
    _check(verified, "verification")
    assert verified["lower_proved"]


def test_reports_of_other_inputs(
    information_file: Path, scenario_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    """Without places or names, without a certificate, interrupted, and of a set function that is no criterion."""
    _check(_printed(capsys, "bound", str(information_file), "--out", str(tmp_path / "a")), "report")
    hurried = ["bound", str(scenario_file), "--out", str(tmp_path / "b"), "--no-certificate", "--time-limit", "0"]
    _check(_printed(capsys, *hurried), "report")
    own = bound(Problem(TableFunction([0, 1, 1, 2]), [0, 1], None, 1, 0))
    assert own.n_targets is None
    _check(own.to_dict(), "report")
    step(monkeypatch, "optimum", lambda real: interrupted_at(1, real))
    found = _printed(capsys, "bound", str(scenario_file), "--out", str(tmp_path / "c"), code=130)
    assert found["interrupted"]
    _check(found, "report")


def test_attacks_with_all_that_may_be_asked_for(
    scenario_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan = tmp_path / "plan.json"
    plan.write_text('{"controls": [0, 1, 2]}')
    command = ["attack", str(scenario_file), "--plan", str(plan)]
    _check(_printed(capsys, *command, "--explain"), "attack")
    found = _printed(capsys, *command, "--rank", "9", "--below", "1e9", "--protect", "1", "--add", "1")
    assert {"robot", "link"} <= {name for row in found["critical"] for name in row}
    assert found["breaking_budgets"]
    assert set(found["best_links"]) == {"protect", "add"}
    _check(found, "attack")


def test_a_mission(scenario_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "o"
    found = _printed(capsys, "track", str(scenario_file), "--steps", "2", "--attacker", "greedy", "--out", str(out))
    _check(found, "mission")
    assert found == json.loads((out / "mission.json").read_text())
    assert len(found["rmse"]) == 2
    command = ["track", str(scenario_file), "--steps", "2", "--attacker", "greedy", "--sensor", "bearing"]
    bearings = _printed(capsys, *command, "--out", str(tmp_path / "b"))
    assert bearings["rmse"] != found["rmse"]


def test_a_half_proved_certificate(scenario_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["bound", str(scenario_file), "--out", str(tmp_path / "o")]) == 0
    path = tmp_path / "o" / "certificate.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {"lower": {"conclusion": "enumerated"}}))
    found = _printed(capsys, "verify", str(path), code=3)
    assert not found["lower_proved"]
    _check(found, "verification")


def test_a_new_scenario(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    numbers = ["--robots", "2", "--targets", "1", "--sensing-attacks", "0", "--link-attacks", "0", "--seed", "1"]
    found = _printed(capsys, "new", *numbers, "--out", str(tmp_path / "s.json"))
    assert found["n_robots"] == 2
    _check(found, "new")


def test_the_audit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """A proof, a refutation and an enumeration, decided in full."""
    labels = {"nd_p1d1v1_7", "nd_p1d1v1_8", "nd1"}
    chosen = [entry for entry in all_entries() if entry.label in labels]
    monkeypatch.setattr(ledger, "all_entries", lambda: iter(chosen))
    found = _printed(capsys, "audit", "--quick", "--out", str(tmp_path))
    _check(found, "audit-summary")
    assert found["entries"] == len(chosen)
    document = json.loads((tmp_path / "audit.json").read_text())
    _check(document, "audit")
    assert {"proved", "refuted"} <= {entry["verdict"] for entry in document["entries"]}


def test_the_schemas_have_teeth(scenario_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A field that is missing, that is another thing or that nobody wrote down is found."""
    whole = _printed(capsys, "bound", str(scenario_file), "--out", str(tmp_path / "o"))
    for name in whole:
        for changed in (
            {field: value for field, value in whole.items() if field != name},
            whole | {name: object()},
            whole | {f"{name} too": 1},
        ):
            with pytest.raises(jsonschema.ValidationError):
                _check(changed, "report")
    inner = deepcopy(whole)
    inner["baselines"]["greedy"]["worst_case"]["links"] = [[0, 1, 2]]
    with pytest.raises(jsonschema.ValidationError):
        _check(inner, "report")
