"""Every Python block of the README and the documents runs as it stands, and gives the numbers it says it gives."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
BLOCK = re.compile(r"^```python\n(?P<code>.*?)^```$", re.MULTILINE | re.DOTALL)
RESULT = re.compile(r"^(?P<expression>[^#\s][^#\n]*?)\s+# (?P<numbers>-?[\d.]+(?:, -?[\d.]+)*)$", re.MULTILINE)
"""A line such as ``f(x), g(x)  # 0.25, 3``: what the expression gives, to the digits shown."""


def documents() -> list[Path]:
    found = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    return [path for path in found if BLOCK.search(path.read_text(encoding="utf-8"))]


@pytest.mark.parametrize("path", documents(), ids=lambda path: path.name)
def test_python_blocks_run(path: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """The blocks of one document share their names, in the order in which a reader meets them."""
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for block in BLOCK.finditer(path.read_text(encoding="utf-8")):
        exec(compile(block["code"], str(path), "exec"), names)
        for line in RESULT.finditer(block["code"]):
            given = eval(line["expression"], names)
            for number, shown in zip(
                given if isinstance(given, tuple) else (given,), line["numbers"].split(", "), strict=True
            ):
                digits = len(shown.partition(".")[2])
                assert float(number) == pytest.approx(ast.literal_eval(shown), abs=0.51 * 10**-digits), line[0]


def test_there_is_something_to_run() -> None:
    assert ROOT / "README.md" in documents()
    assert RESULT.search((ROOT / "README.md").read_text(encoding="utf-8"))
