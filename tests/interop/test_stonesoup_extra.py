"""Without the extra an import says which is missing; the core never imports Stone Soup; the plug-in is found."""

import subprocess
import sys

import pytest


def run(code: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)


def test_an_import_without_stone_soup_names_the_extra() -> None:
    done = run("import sys; sys.modules['stonesoup'] = None; import ratt_opt.interop.stonesoup")
    assert done.returncode == 1
    last = done.stderr.strip().splitlines()[-1]
    assert last == (
        "ImportError: ratt_opt.interop.stonesoup needs Stone Soup 1.9.1 or newer: pip install 'ratt-opt[stonesoup]'"
    )


def test_the_core_never_imports_stone_soup() -> None:
    code = "import sys, ratt_opt; [getattr(ratt_opt, name) for name in ratt_opt.__all__]; import ratt_opt.cli.program"
    done = run(code + "; print([name for name in sys.modules if name.partition('.')[0] == 'stonesoup'])")
    assert done.stdout.strip() == "[]", done.stderr


def test_stone_soup_finds_the_plug_in() -> None:
    pytest.importorskip("stonesoup", reason="Stone Soup is not installed: pip install ratt-opt[stonesoup]")
    done = run(
        "import warnings; warnings.simplefilter('error'); import stonesoup.plugins; "
        "from stonesoup.plugins.ratt_opt import RobustSensorManager as Found; "
        "from ratt_opt.interop.stonesoup import RobustSensorManager; assert Found is RobustSensorManager"
    )
    assert done.returncode == 0, done.stderr
