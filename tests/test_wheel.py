"""What users install: the built wheel, in an environment of its own, outside the source tree."""

import json
import os
import re
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
EVERY_NAME = """
import pathlib, sys, ratt_opt
home = pathlib.Path(ratt_opt.__file__).parent
assert home.is_relative_to(sys.prefix), home
assert (home / "py.typed").exists() and (home / "__init__.pyi").exists()
print(ratt_opt.__version__, *(name for name in ratt_opt.__all__ if getattr(ratt_opt, name) is None))
"""


def run(*command: object, cwd: Path) -> str:
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    done = subprocess.run([*map(str, command)], cwd=cwd, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The ``bin`` folder of a fresh environment with the wheel; its dependencies are those of this environment."""
    folder = tmp_path_factory.mktemp("wheel")
    build = f"import hatchling.build; print(hatchling.build.build_wheel({str(folder)!r}))"
    wheel = folder / run(sys.executable, "-c", build, cwd=ROOT).split()[-1]
    run(sys.executable, "-m", "venv", "--without-pip", folder / "venv", cwd=folder)
    python = folder / "venv" / "bin" / "python"
    run(sys.executable, "-m", "pip", "--python", python, "install", "--no-index", "--no-deps", wheel, cwd=folder)
    packages = run(python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))", cwd=folder).strip()
    (Path(packages) / "dependencies.pth").write_text(sysconfig.get_path("purelib") + "\n", encoding="utf-8")
    return python.parent


def test_every_public_name_loads_from_the_wheel(installed: Path, tmp_path: Path) -> None:
    import ratt_opt

    assert run(installed / "python", "-c", EVERY_NAME, cwd=tmp_path).split() == [ratt_opt.__version__]


def test_the_readmes_first_command_runs_from_the_wheel(installed: Path, tmp_path: Path) -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    block = re.search(r"<!-- set-up: demo -->\n```bash\n(.*)\n```", readme)
    assert block is not None
    program, *arguments = block[1].rpartition("&& ")[2].split()
    assert program == ".venv/bin/ratt-opt"
    printed = run(installed / "ratt-opt", *arguments, cwd=tmp_path)
    assert "verified, both ends proved" in printed
    report = json.loads((tmp_path / "demo" / "report.json").read_text(encoding="utf-8"))
    assert report["optimum"]["lower"] <= report["optimum"]["upper"]
