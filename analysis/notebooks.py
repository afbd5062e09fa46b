"""Execute every notebook: ``python -m analysis.notebooks [--check] [NAME ...]``.

Without ``--check`` the outputs are written back into the files. With it the files stay as
they are and the run fails when a notebook raises, defines a function or was never executed.
"""

from __future__ import annotations

import argparse
import ast
import sys
import time
from pathlib import Path

import nbformat
from nbclient import NotebookClient

FOLDER = Path(__file__).resolve().parent.parent / "notebooks"
TIME_LIMIT = 180
"""Seconds that one cell may take."""


def main(arguments: list[str] | None = None) -> int:
    """Run the notebooks named on the command line, or all; return the number that failed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help="file names without .ipynb; all by default")
    parser.add_argument("--check", action="store_true", help="do not write the outputs back")
    options = parser.parse_args(arguments)
    files = [FOLDER / f"{name}.ipynb" for name in options.names] or sorted(FOLDER.glob("*.ipynb"))
    failures = 0
    for file in files:
        began = time.monotonic()
        faults = run(file, write=not options.check)
        failures += bool(faults)
        print(f"{file.name}: {'; '.join(faults) or 'ok'} ({time.monotonic() - began:.1f} s)", flush=True)
    return failures


def run(file: Path, *, write: bool) -> list[str]:
    """Execute one notebook and return what is wrong with it."""
    notebook = nbformat.read(file, as_version=4)  # type: ignore[no-untyped-call]
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    faults = [f"cell {k} defines a function or class" for k, cell in enumerate(cells) if _defines(cell.source)]
    if not write and any(cell.execution_count is None for cell in cells):
        faults.append("its outputs are not committed")
    try:
        NotebookClient(notebook, timeout=TIME_LIMIT, resources={"metadata": {"path": str(FOLDER.parent)}}).execute()
    except Exception as error:  # noqa: BLE001  (whatever a notebook raises is its fault to report)
        return [*faults, str(error).strip().splitlines()[-1]]
    if write:
        nbformat.write(notebook, file)  # type: ignore[no-untyped-call]
    return faults


def _defines(source: str) -> bool:
    plain = "\n".join(line for line in source.splitlines() if not line.startswith(("%", "!")))
    kinds = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
    return any(isinstance(node, kinds) for node in ast.walk(ast.parse(plain)))


if __name__ == "__main__":
    sys.exit(min(main(), 1))
