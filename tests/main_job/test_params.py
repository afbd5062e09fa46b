"""Parameters of the main job: read from TOML, used by every part, and never the reason of a false claim."""

import json
from contextlib import suppress
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import pytest

import ratt_opt as ro
from ratt_opt import JobParams
from ratt_opt.cli import run
from tests.cli.refusal import refused
from tests.extremes import places, undocumented, value_at, with_one
from tests.main_job.engine import SEARCHES, step

CLASSES = [getattr(ro, name) for name in dir(ro) if name.endswith(("Params", "Limits"))]
TOML = """
[search.first_plans]
beyond = 0.0
[attack.annealing]
moves = 7
[curvatures]
contexts = 7
[bounds]
listed_robots = 3
[certificate.verifier]
entries = 3
"""


def other(value: Any) -> Any:
    """A value of the same kind that is not the same."""
    if value is None:
        return 7
    if isinstance(value, tuple):
        return tuple(map(other, value))
    return value if isinstance(value, (bool, str)) else type(value)(1.5 * value + 1)


def tables(params: Any, place: str = "") -> str:
    """All numbers as TOML."""
    inner = [one.name for one in fields(params) if is_dataclass(getattr(params, one.name))]
    own = [f"[{place}]"] if place else []
    for one in fields(params):
        if one.name not in inner:
            value = getattr(params, one.name)
            own.append(f"{one.name} = {str(value).replace('(', '[').replace(')', ']').replace(',]', ']')}")
    parts = [tables(getattr(params, name), f"{place}.{name}".strip(".")) for name in inner]
    return "\n".join([*own, *parts])


@pytest.fixture
def scenario_file(tmp_path: Path) -> Path:
    path = tmp_path / "scenario.json"
    ro.save_scenario(ro.random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=5), path)
    return path


@pytest.mark.parametrize("kind", CLASSES)
def test_every_class_of_parameters_is_read_from_toml(kind: type, tmp_path: Path) -> None:
    changed = default = kind()
    for place in places(default):
        with suppress(ro.InputError):  # it must stay in its range
            changed = with_one(changed, place, other(value_at(default, place)))
    (tmp_path / "params.toml").write_text(tables(changed), encoding="utf-8")
    assert ro.read_params(tmp_path / "params.toml", default) == changed != default


def test_every_parameter_is_documented() -> None:
    assert undocumented(JobParams()) == []


def test_a_file_changes_parameters_of_every_part(
    scenario_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Each part gets its own, the report names all, and the bracket still holds."""
    (tmp_path / "params.toml").write_text(TOML, encoding="utf-8")
    used: dict[str, Any] = {}

    def seen(name: str) -> Any:
        def around(real: Any) -> Any:
            def called(*given: Any, **named: Any) -> Any:
                used[name] = named["params"]
                return real(*given, **named)

            return called

        return around

    for name in SEARCHES:
        step(monkeypatch, name, seen(name))
    out, path = tmp_path / "out", tmp_path / "params.toml"
    assert run(["bound", str(scenario_file), "--out", str(out), "--params", str(path), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    params = ro.read_params(tmp_path / "params.toml", JobParams())
    assert used == {
        "attacks": params.attack,
        "optimum": params.search,
        "curvature": params.curvatures,
        "guarantees": params.bounds,
    }
    assert "size of lists must be at most 3" in json.dumps(report)
    told = "search.first_plans.beyond = 0.0, attack.annealing.moves = 7, curvatures.contexts = 7"
    assert any(told in remark for remark in report["remarks"])
    best = ro.exhaustive_optimum(ro.load_scenario(scenario_file).problem()).lower
    assert report["optimum"]["lower"] <= best * (1 + 1e-9) <= report["optimum"]["upper"] * (1 + 1e-8)


@pytest.mark.parametrize(
    ("text", "rule"),
    [
        ("[first_plans]\nbeyond = 0.0\n", "params must name some of search, attack, curvatures, bounds, certificate"),
        ("[search]\nfirst_plans = 3\n", "params.search.first_plans must be a table"),
        ("[certificate.points]\nprecision = 2\n", "params.points.precision must be at least 53"),
        ("[bounds]\ntolerance = -1.0\n", "params.bounds.tolerance must be at least 0 and finite"),
        ("bounds = ", "params must be a file of TOML"),
    ],
)
def test_a_wrong_file_is_refused_in_one_line(
    text: str, rule: str, scenario_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "params.toml").write_text(text, encoding="utf-8")
    out = tmp_path / "out"
    refused(["bound", str(scenario_file), "--out", str(out), "--params", str(tmp_path / "params.toml")], capsys, rule)
    assert not out.exists()


def test_parameters_of_one_search_are_no_parameters_of_the_job() -> None:
    with pytest.raises(ro.InputError, match=r"params must be JobParams, such as JobParams\(search=...\)"):
        ro.bound(ro.random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=0), params=ro.MaxMinParams())  # type: ignore[arg-type]
