"""The package as a stranger imports it."""

from __future__ import annotations

import subprocess
import sys

import pytest

import ratt_opt

HEAVY = ("cvxpy", "highspy", "numba", "matplotlib", "pydantic", "flint", "scipy", "typer", "rich", "numpy")


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


INTERRUPTED_IMPORT = """
import signal, sys, time
from importlib.abc import MetaPathFinder

class Interrupts(MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name == sys.argv[1]:
            sys.meta_path.remove(self)
            signal.raise_signal(signal.SIGINT)

import ratt_opt as ro
sys.meta_path.insert(0, Interrupts())
try:
    ro.certify, ro.verify_certificate
    time.sleep(60)
except KeyboardInterrupt:
    print("answered")
assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
problem = ro.random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=0).problem()
print(ro.solve_maxmin(problem).stop.value, ro.total_curvature(problem.objective).lower >= 0)
"""


@pytest.mark.parametrize(
    "module",
    ["numpy.dtypes", "numpy.linalg", "networkx", "networkx.utils.configs", "flint.types.arb", "ratt_opt.problem"],
)
def test_an_interrupt_while_names_are_loaded_leaves_nothing_half_imported(module: str) -> None:
    """NumPy could be loaded only once per process, networkx knew half of itself: every later search failed."""
    command = [sys.executable, "-c", INTERRUPTED_IMPORT, module]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.stdout == "answered\nclosed True\n", done.stderr


def test_every_public_callable_is_documented() -> None:
    missing = [n for n in ratt_opt.__all__ if callable(v := getattr(ratt_opt, n)) and not v.__doc__]
    assert missing == []


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
