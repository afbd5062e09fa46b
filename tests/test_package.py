"""The package as a stranger imports it."""

import subprocess
import sys

import pytest

import ratt_opt
from tests.extremes import undocumented

HEAVY = ("cvxpy", "highspy", "matplotlib", "pydantic", "flint", "scipy", "typer", "rich", "numpy")


def test_every_public_name_loads() -> None:
    for name in ratt_opt.__all__:
        assert getattr(ratt_opt, name) is not None
    assert set(ratt_opt.__all__) <= set(dir(ratt_opt))


def test_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no_such_name"):
        _ = ratt_opt.no_such_name


def test_import_loads_nothing_heavy() -> None:
    code = f"import sys, ratt_opt; print([m for m in {HEAVY!r} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_every_public_callable_is_documented() -> None:
    missing = [n for n in ratt_opt.__all__ if callable(v := getattr(ratt_opt, n)) and not v.__doc__]
    assert missing == []


def test_classes_of_parameters_are_frozen_and_explain_every_field() -> None:
    """Those within others, too; what bundles settings of other kinds explains itself in its text."""
    names = [name for name in ratt_opt.__all__ if name.endswith(("Params", "Limits", "Shape"))]
    assert len(names) > 10
    for name in names:
        kind = getattr(ratt_opt, name)
        assert kind.__dataclass_params__.frozen
        assert not undocumented(kind())


def test_every_name_has_one_topic() -> None:
    listed = [name for names in ratt_opt.TOPICS.values() for name in names]
    assert len(listed) == len(set(listed))
    assert ["__version__", *listed] == ratt_opt.__all__
    assert sorted(ratt_opt.__all__) == dir(ratt_opt)
    assert all(names for names in ratt_opt.TOPICS.values())


def test_the_house_has_every_room_once() -> None:
    from analysis.architecture import ROOT, rooms

    if not (ROOT / "ratt_opt").is_dir():
        pytest.skip("an installed package is tested: its source is not here")
    names = [room.name for room in rooms()]
    assert len(names) == len(set(names))
    folders = {path.name for path in (ROOT / "ratt_opt").iterdir() if (path / "__init__.py").exists()}
    assert folders <= set(names)
