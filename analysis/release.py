"""Check what a release uploads: ``python -m analysis.release --out dist``.

It builds the source distribution and the wheel, builds the wheel once more from the unpacked source distribution, and
compares them byte by byte. It runs ``twine check --strict`` on both. Then it installs each of them without a network in
a fresh environment whose dependencies are those of the running one, and plans a small team there. ``--no-twine`` leaves
out the check of twine, for a machine that has none.
"""

import argparse
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from analysis.fresh import installed, run_alone

__all__ = ["build", "install_and_plan", "main", "unpacked"]

ROOT = Path(__file__).parents[1]
PLAN = (
    "import ratt_opt as ro; scenario = ro.random_scenario(3, 2, alpha_s=1, alpha_c=0, seed=0); "
    "print(ro.__version__, ro.__file__, ro.ratt(scenario.problem()).elements)"
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Build, compare, check and install; return 1 and say why when something is wrong."""
    options = _parse(arguments)
    options.out.mkdir(parents=True, exist_ok=True)
    try:
        with tempfile.TemporaryDirectory(prefix="ratt-opt-release-") as folder:
            place = Path(folder)
            source, wheel = build("sdist", ROOT, options.out), build("wheel", ROOT, options.out)
            print(
                f"built: {source.name} ({source.stat().st_size:,} bytes), {wheel.name} ({wheel.stat().st_size:,} bytes)"
            )
            again = build("wheel", unpacked(source, place), place / "again")
            if again.read_bytes() != wheel.read_bytes():
                print("the wheel from the source distribution differs from the wheel from this folder", file=sys.stderr)
                return 1
            print("same wheel from the source distribution")
            if options.twine:
                run_alone([sys.executable, "-m", "twine", "check", "--strict", source, wheel], place)
                print("twine check: passed")
            for built in (wheel, source):
                print(f"installed without a network from {built.name}: {install_and_plan(built, place)}")
    except subprocess.CalledProcessError as error:
        print(f"{' '.join(map(str, error.cmd))}\n{error.stdout}{error.stderr}", file=sys.stderr)
        return 1
    return 0


def build(kind: str, project: Path, out: Path) -> Path:
    """Build ``"sdist"`` or ``"wheel"`` of a project into ``out`` and return the file."""
    out.mkdir(parents=True, exist_ok=True)
    code = f"import hatchling.build; print(hatchling.build.build_{kind}({str(out.resolve())!r}))"
    return out / run_alone([sys.executable, "-c", code], project).split()[-1]


def unpacked(source: Path, place: Path) -> Path:
    """Unpack a source distribution under ``place`` and return its only folder."""
    with tarfile.open(source) as archive:
        safe: dict[str, Any] = {"filter": "data"} if hasattr(tarfile, "data_filter") else {}  # since Python 3.11.4
        archive.extractall(place / "unpacked", **safe)
    (folder,) = (place / "unpacked").iterdir()
    return folder


def install_and_plan(built: Path, place: Path) -> str:
    """Install a wheel or source distribution into a fresh environment, offline; return what a plan prints there."""
    home = place / f"with-{built.suffix.strip('.')}"
    python = installed(built, home, offline=True) / "python"
    printed = run_alone([python, "-c", PLAN], place).strip()
    if str(home.resolve()) not in printed:
        raise subprocess.CalledProcessError(1, [str(python), "-c", PLAN], printed, "another copy was imported")
    return printed.replace(f"{home.resolve()}/", "")


def _parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--out", type=Path, default=Path("dist"), help="folder for the two files (default: dist)")
    parser.add_argument("--no-twine", dest="twine", action="store_false", help="leave out twine check")
    return parser.parse_args(arguments)


if __name__ == "__main__":
    sys.exit(main())
