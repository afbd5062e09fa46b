"""Before a release: the built wheel on every supported Python, and with the oldest dependencies that it states.

``python -m analysis.pythons`` builds the wheel, and for each Python makes an environment, installs the wheel with the
newest dependencies, and runs a sample of the tests (``--tests`` for others) outside the source tree; then once more on
the oldest Python with every dependency at its lower bound, which must resolve together. A Python that is not on the
machine is named, and is a failure unless ``--available`` says that it may be missing. ``--only`` runs some of them.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import monotonic

__all__ = ["Environment", "environments", "find_python", "lower_bounds", "main"]

ROOT = Path(__file__).parents[1]
PYTHONS = ("3.11", "3.12", "3.13")
SAMPLE = (
    "tests/test_package.py", "tests/test_problem.py", "tests/test_rounding.py", "tests/cli", "tests/certificates",
    "tests/scenario", "tests/setfunctions", "tests/solvers/test_ratt.py", "tests/attack/test_exact.py",
)  # fmt: skip
"""Tests that touch the dependencies: compiled loops, solvers, exact arithmetic, files, figures, the command line."""
COPIED = ("tests", "analysis", "docs", "README.md", "pyproject.toml")
"""Files that the tests need besides the installed wheel."""


@dataclass(frozen=True, slots=True)
class Environment:
    """One Python, and whether dependencies are at their lower bounds."""

    python: str
    oldest: bool

    @property
    def name(self) -> str:
        """Name of the environment, as in ``--only``."""
        return f"{self.python}-oldest" if self.oldest else self.python


def environments() -> tuple[Environment, ...]:
    """Return every environment that a release is tested in."""
    return (*(Environment(version, oldest=False) for version in PYTHONS), Environment(PYTHONS[0], oldest=True))


def find_python(version: str, given: Iterable[str] = ()) -> str | None:
    """Return an interpreter of this version: one of ``given``, on the path, or one that pyenv or uv keeps."""
    home = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv"))
    kept = sorted((home / "versions").glob(f"{version}.*/bin/python{version}"))
    kept += sorted((Path.home() / ".local/share/uv/python").glob(f"cpython-{version}.*/bin/python{version}"))
    for candidate in (*given, shutil.which(f"python{version}"), *map(str, kept)):
        if candidate is None:
            continue
        try:
            said = subprocess.run([candidate, "--version"], capture_output=True, text=True, check=False).stdout
        except OSError:
            continue
        if said.startswith(f"Python {version}."):
            return candidate
    return None


def lower_bounds(project: Path = ROOT / "pyproject.toml") -> list[str]:
    """Return the requirements of the wheel and its test extra, each pinned to the lower bound that it states."""
    stated = tomllib.loads(project.read_text(encoding="utf-8"))["project"]
    extras = stated["optional-dependencies"]
    own = re.compile(rf"{stated['name']}\[(?P<extras>[\w,-]+)\]$")
    wanted, pins = [*stated["dependencies"], *extras["test"]], []
    while wanted:
        requirement = wanted.pop(0)
        if extra := own.match(requirement):
            wanted += [one for name in extra["extras"].split(",") for one in extras[name]]
        else:
            name, bound = requirement.split(">=")
            pins.append(f"{name}=={bound}")
    return pins


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the environments and return the exit code: 1 if one fails or, without ``--available``, is missing."""
    options = _parse(arguments)
    rows: list[tuple[str, str, str]] = []
    with tempfile.TemporaryDirectory(prefix="ratt-opt-pythons-") as folder:
        place = Path(folder)
        for name in COPIED:
            copy = shutil.copytree if (ROOT / name).is_dir() else shutil.copyfile
            copy(ROOT / name, place / name)
        wheel = _build(place / "wheel")
        for environment in environments():
            if options.only and environment.name not in options.only:
                continue
            python = find_python(environment.python, options.python)
            if python is None:
                how = (
                    f"apt install python{environment.python}-venv, pyenv install or uv python install, or --python PATH"
                )
                rows.append((environment.name, "missing", f"to get it: {how}"))
            else:
                rows.append((environment.name, *_tried(environment, python, wheel, place, options.tests)))
            print(f"{rows[-1][0]:12} {rows[-1][1]:8} {rows[-1][2]}", flush=True)
    return int(any(result == "failed" or (result == "missing" and not options.available) for _, result, _ in rows))


def _parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--available", action="store_true", help="a Python that is not on the machine may be missing")
    names = [environment.name for environment in environments()]
    parser.add_argument("--only", nargs="+", choices=names, help="run these environments only")
    parser.add_argument("--python", nargs="+", default=[], metavar="PATH", help="interpreters to look at first")
    parser.add_argument("--tests", nargs="+", default=list(SAMPLE), help="what to run (default: a sample)")
    return parser.parse_args(arguments)


def _build(folder: Path) -> Path:
    _run([sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", folder, ROOT], ROOT)
    (wheel,) = folder.glob("*.whl")
    return wheel


def _tried(environment: Environment, python: str, wheel: Path, place: Path, tests: list[str]) -> tuple[str, str]:
    """Install and test; ``passed`` or ``failed``, and in words what was seen."""
    began, home = monotonic(), place / environment.name
    inside = home / "bin" / "python"
    try:
        _run([python, "-m", "venv", home], place)
        bounds = lower_bounds() if environment.oldest else []
        _run([inside, "-m", "pip", "install", "--quiet", f"{wheel}[test]", *bounds], place)
        versions = _run([inside, "-m", "pip", "list", "--format", "freeze"], place)
        said = _run([inside, "-m", "pytest", "-p", "no:cacheprovider", *tests], place)
    except subprocess.CalledProcessError as error:
        lines = (error.stdout + error.stderr).strip().splitlines()
        print("\n".join(lines[-60:]), file=sys.stderr)
        return "failed", lines[-1] if lines else f"exit code {error.returncode}"
    shown = re.findall(r"^(?:numpy|scipy|highspy|python-flint)==.*$", versions, re.MULTILINE)
    return "passed", f"{said.strip().splitlines()[-1]}; {', '.join(shown)}; {monotonic() - began:.0f} s in all"


def _run(command: Sequence[object], folder: Path) -> str:
    """Run a program of the environment without the source tree in its sight; raises CalledProcessError."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    words = [str(word) for word in command]
    return subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True, check=True).stdout


if __name__ == "__main__":
    sys.exit(main())
