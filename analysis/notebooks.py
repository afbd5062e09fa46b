"""Run every notebook from an installation alone: ``python -m analysis.notebooks [--check] [--wheel FILE] [NAME ...]``.

The wheel, by default one of this folder, is installed into a fresh environment with the dependencies of the running
one. Each notebook runs there in an empty folder. Without ``--check`` the outputs are written back into the files. With
it the files stay as they are, and each output must agree with what is stored. A notebook that raises fails. So does one
without a last table of claims and computed verdicts.
"""

import argparse
import json
import math
import os
import re
import sys
import tempfile
from collections.abc import Iterator, Sequence
from copy import copy
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis.fresh import installed
from ratt_opt.report.verdicts import HEAD

__all__ = ["Agreement", "differences", "main", "outputs"]

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "notebooks"
KERNEL = "installation"
COLOUR = re.compile(r"\x1b\[[0-9;]*m")
NUMBER = re.compile(r"[+-]?\d+(?:\.\d+)?(?:e[+-]?\d+)?")


@dataclass(frozen=True, slots=True, kw_only=True)
class Agreement:
    """Limits of a run, and how far numbers may differ from those that are stored.

    ``relative`` : share of a number; libraries of other versions and other processors round otherwise.
    ``seconds`` : of one cell at most.
    """

    relative: float = 1e-5
    seconds: int = 300


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the notebooks named on the command line, or all; return 1 if one is at fault."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("names", nargs="*", help="file names without .ipynb; all by default")
    parser.add_argument("--check", action="store_true", help="compare the outputs with those that are stored")
    parser.add_argument("--wheel", type=Path, default=ROOT, help="what to install (default: this folder)")
    options = parser.parse_args(arguments)
    files = [FOLDER / f"{name}.ipynb" for name in options.names] or sorted(FOLDER.glob("*.ipynb"))
    failures = 0
    with tempfile.TemporaryDirectory(prefix="ratt-opt-notebooks-") as folder:
        _offer_kernel(installed(options.wheel, Path(folder, "environment"), offline=True) / "python", Path(folder))
        for number, file in enumerate(files):
            empty = Path(folder, f"notebook{number}")
            empty.mkdir()
            before = _processor_seconds()
            faults = run(file, empty, write=not options.check, limits=Agreement())
            failures += bool(faults)
            print(f"{file.name}: {'; '.join(faults) or 'ok'} ({_processor_seconds() - before:.1f} s)", flush=True)
    return int(failures > 0)


def _offer_kernel(python: Path, folder: Path) -> None:
    """Let notebooks find a kernel that runs ``python`` and sees nothing of this folder."""
    home = folder / "jupyter" / "kernels" / KERNEL
    home.mkdir(parents=True)
    argv = [str(python), "-m", "ipykernel_launcher", "--log-level=ERROR", "-f", "{connection_file}"]
    spec = {"argv": argv, "display_name": KERNEL, "language": "python"}
    (home / "kernel.json").write_text(json.dumps(spec), encoding="utf-8")
    os.environ["JUPYTER_PATH"] = str(folder / "jupyter")
    os.environ.pop("PYTHONPATH", None)


def _processor_seconds() -> float:
    """Processor seconds of the processes that have ended."""
    times = os.times()
    return times.children_user + times.children_system


def run(file: Path, folder: Path, *, write: bool, limits: Agreement) -> list[str]:
    """Execute one notebook in ``folder`` and return what is wrong with it."""
    import nbformat
    from nbclient import NotebookClient

    notebook = nbformat.read(file, as_version=4)  # type: ignore[no-untyped-call]
    stored = list(outputs(notebook))
    resources = {"metadata": {"path": str(folder)}}
    try:
        NotebookClient(notebook, timeout=limits.seconds, kernel_name=KERNEL, resources=resources).execute()
    except Exception as error:  # noqa: BLE001  (whatever a notebook raises is its fault to report)
        return [COLOUR.sub("", str(error)).strip().splitlines()[-1]]
    found = list(outputs(notebook))
    faults = [] if _ends_with_verdicts(found) else ["it does not end with a table of claims and verdicts"]
    if write:
        _keep(notebook, file)
    else:
        faults += differences(stored, found, limits)
    return faults


def outputs(notebook: Any) -> Iterator[tuple[int, str, str]]:
    """Yield what the cells show, as (cell, kind, text): joined streams, text, and pictures without their bytes."""
    for number, cell in enumerate(notebook["cells"]):
        for output in _joined(cell.get("outputs", [])):
            if output["output_type"] == "stream":
                yield number, output["name"], _whole(output["text"])
            for kind, text in sorted(output.get("data", {}).items()):
                yield number, kind, "" if kind.startswith("image/") else _whole(text)


def _whole(text: str | list[str]) -> str:
    """Join the lines of a text; files keep them as a list."""
    return text if isinstance(text, str) else "".join(text)


def _joined(shown: Sequence[Any]) -> list[Any]:
    """Outputs with one stream where a slow machine has several, and without progress, which is on standard error."""
    whole: list[Any] = []
    for output in shown:
        if output.get("name") == "stderr":
            continue
        last = whole[-1] if whole else {}
        if output["output_type"] == "stream" == last.get("output_type") and output["name"] == last["name"]:
            last["text"] = _whole(last["text"]) + _whole(output["text"])
        else:
            whole.append(copy(output))
    return whole


def _keep(notebook: Any, file: Path) -> None:
    """Write the outputs, without what differs from run to run."""
    import nbformat

    for cell in notebook.cells:
        cell.metadata.pop("execution", None)
        if cell.cell_type == "code":
            cell.outputs = _joined(cell.outputs)
    notebook.metadata["language_info"] = {"name": "python"}  # its version is that of this machine
    nbformat.write(notebook, file)  # type: ignore[no-untyped-call]


def differences(
    stored: Sequence[tuple[int, str, str]], found: Sequence[tuple[int, str, str]], limits: Agreement
) -> list[str]:
    """Say in which cells a run shows something else than what is stored."""
    kinds = [[(cell, kind) for cell, kind, _ in shown] for shown in (stored, found)]
    if kinds[0] != kinds[1]:
        cells = sorted({cell for cell, _ in set(kinds[0]) ^ set(kinds[1])})
        return [f"stored and new outputs differ in kind (cells {cells})"]
    pairs = zip(stored, found, strict=True)
    return [
        f"cell {cell} shows {_first_difference(old, new)}"
        for (cell, _, old), (_, _, new) in pairs
        if not _agree(old, new, limits.relative)
    ]


def _agree(old: str, new: str, relative: float) -> bool:
    """Compare words exactly and numbers within ``relative``."""
    words = [NUMBER.sub("#", text).split() for text in (old, new)]
    numbers = [[float(number) for number in NUMBER.findall(text)] for text in (old, new)]
    if words[0] != words[1]:
        return False
    return all(math.isclose(a, b, rel_tol=relative) for a, b in zip(*numbers, strict=True))


def _first_difference(old: str, new: str) -> str:
    pairs = zip(old.splitlines(), new.splitlines(), strict=False)
    was, now = next(((a, b) for a, b in pairs if a.split() != b.split()), (old, new))
    return f"{now!r} where {was!r} is stored"


def _ends_with_verdicts(found: Sequence[tuple[int, str, str]]) -> bool:
    """Tell whether the last thing that a notebook shows is a table of claims and verdicts."""
    last = [text for cell, _, text in found if cell == found[-1][0]]
    return any(text.startswith(f"| {' | '.join(HEAD)} |") for text in last)


if __name__ == "__main__":
    sys.exit(main())
