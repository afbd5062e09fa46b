"""Refresh the README and the guides: run each command they name and put its real output and figures in place.

Run as ``python -m analysis.readme [PAGE ...]``, for all pages or those named. A block is
``<!-- output: COMMAND -->`` (or ``<!-- output of the last N lines: COMMAND -->``) followed by a ``text`` code fence;
commands that use a ``$VARIABLE`` which is not set, or a file that such a command would have written, are left as they
are. ``<!-- table: COMMAND -->`` is followed by a Markdown table that the command prints. ``<!-- figure: FILE -->``
before an image copies ``FILE`` to the image's path.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from itertools import pairwise
from pathlib import Path

__all__ = ["main", "refreshed"]

ROOT = Path(__file__).parents[1]
OUTPUT = re.compile(r"<!-- output(?: of the last (?P<last>\d+) lines)?: (?P<command>.*?) -->\n```text\n.*?```\n", re.S)
TABLE = re.compile(r"<!-- table: (?P<command>.*?) -->\n(?:\|.*\n)*")
PAGES = (
    "docs/guides/reading_a_report.md",
    "docs/commands.md",
    "docs/researchers/evaluation.md",
    "README.md",
)
"""Pages, run in this order and in one folder: a page may show what an earlier one's commands have written."""
FIGURE = re.compile(r"<!-- figure: (?P<file>\S+) -->\n!\[.*?\]\((?P<path>\S+?)\)", re.S)


def main() -> None:
    """Rewrite the pages and the figures beside them."""
    with tempfile.TemporaryDirectory() as folder:
        for page in (ROOT / name for name in sys.argv[1:] or PAGES):
            text = refreshed(page.read_text(encoding="utf-8"), Path(folder))
            for figure in FIGURE.finditer(text):
                source = Path(folder) / os.path.expandvars(figure["file"])
                if source.exists():
                    shutil.copyfile(source, page.parent / figure["path"])
            page.write_text(text, encoding="utf-8")


def refreshed(text: str, folder: Path) -> str:
    """Return ``text`` with every output block and table replaced by what its command prints in ``folder``."""

    def replaced(block: re.Match[str]) -> str:
        if missing := _missing(block["command"], folder):
            print(f"left as it is (no {missing}): {block['command']}")
            return block[0]
        head = block[0][: block[0].index("```text\n")]
        return f"{head}```text\n{_printed(block['command'], folder, block['last'])}```\n"

    def retabled(table: re.Match[str]) -> str:
        if missing := _missing(table["command"], folder):
            print(f"left as it is (no {missing}): {table['command']}")
            return table[0]
        return f"<!-- table: {table['command']} -->\n{_printed(table['command'], folder, None)}"

    return TABLE.sub(retabled, OUTPUT.sub(replaced, text))


def _missing(command: str, folder: Path) -> str | None:
    """A variable that is not set, or an input file that no earlier command wrote."""
    words = shlex.split(os.path.expandvars(command))
    inputs = [word for before, word in pairwise(words) if word.endswith(".json") and before != "--out"]
    return next((w for w in words if "$" in w), next((w for w in inputs if not (folder / w).exists()), None))


def _printed(command: str, folder: Path, last: str | None) -> str:
    print(f"running: {command}", flush=True)
    programs = {"ratt-opt": [sys.executable, "-m", "ratt_opt"], "python": [sys.executable]}
    name, *arguments = shlex.split(os.path.expandvars(command))
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [*programs[name], *arguments], cwd=folder, env=environment, check=True, stdout=subprocess.PIPE, text=True
    )
    lines = [line.rstrip() for line in done.stdout.splitlines()]
    return "\n".join(lines[-int(last) :] if last else lines).strip("\n") + "\n"


if __name__ == "__main__":
    main()
