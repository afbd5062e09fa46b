"""Environments of their own, for what is built and installed: with pip's dependencies, or offline."""

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

__all__ = ["installed", "run_alone"]


def installed(what: Path, home: Path, *, offline: bool) -> Path:
    """Install a wheel, a source distribution or a project into a fresh environment; return the folder of its programs.

    Offline, the environment sees the dependencies, and the build backend, of the running one.

    Raises
    ------
    CalledProcessError : it cannot be installed.
    """
    python = home / "bin" / "python"
    if offline:
        run_alone([sys.executable, "-m", "venv", "--without-pip", home])
        packages = Path(run_alone([python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))"]).strip())
        (packages / "dependencies.pth").write_text("\n".join(_site_packages()) + "\n", encoding="utf-8")
        without = ["--no-index", "--no-deps", "--no-build-isolation", "--ignore-installed"]
        pip = [sys.executable, "-m", "pip", "--python", python, "install", *without]
    else:
        run_alone([sys.executable, "-m", "venv", home])
        pip = [python, "-m", "pip", "install"]
    run_alone([*pip, "--quiet", "--disable-pip-version-check", what.resolve()])
    return home / "bin"


def _site_packages() -> list[str]:
    """Folders from which the running environment imports what is installed, also those that it borrows."""
    return [folder for folder in sys.path if Path(folder).name == "site-packages"]


def run_alone(command: Sequence[object], folder: Path | None = None) -> str:
    """Run a program without the source tree in its sight; return what it prints.

    Raises
    ------
    CalledProcessError : it fails.
    """
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    words = [str(word) for word in command]
    return subprocess.run(words, cwd=folder, env=environment, check=True, capture_output=True, text=True).stdout
