"""The pages lead somewhere: every link has a target, and the distribution holds what they speak of."""

import re
import subprocess
import sys
import tarfile
from pathlib import Path

import pytest

from tests.documents import ROOT, documents

PAGES = [ROOT / "CHANGELOG.md", *documents()]
TOCTREE = re.compile(r"^```{toctree}\n(?P<entries>.*?)^```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\((?!https?:)([^)#\s]+)(?:#[^)]*)?\)")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_no_link_is_broken(page: Path) -> None:
    broken = [link for link in LINK.findall(page.read_text(encoding="utf-8")) if not (page.parent / link).exists()]
    assert broken == []


def links_of(page: Path) -> list[Path]:
    """Where the links of a page lead, and the pages that its tables of contents list."""
    text = page.read_text(encoding="utf-8")
    entries = [line for toctree in TOCTREE.finditer(text) for line in toctree["entries"].split("\n")]
    listed = [f"{entry}.md" for entry in entries if entry and not entry.startswith(":")]
    return [(page.parent / link).resolve() for link in (*LINK.findall(text), *listed)]


def test_every_document_is_reached_from_the_readme() -> None:
    seen, ahead = set(), [ROOT / "README.md"]
    while ahead:
        page = ahead.pop()
        seen.add(page.resolve())
        if page.suffix == ".md" and page.exists():
            ahead += [path for path in links_of(page) if path not in seen]
    pictures = [path.resolve() for path in (ROOT / "docs").rglob("*.png") if "gallery" not in path.parts]
    assert {path.resolve() for path in documents()} | set(pictures) <= seen


def test_the_readme_is_short() -> None:
    """About 600 words, code and tables included."""
    assert len((ROOT / "README.md").read_text(encoding="utf-8").split()) <= 660


def test_the_source_distribution_holds_docs_licence_and_builds_the_same_wheel(tmp_path: Path) -> None:
    def build(kind: str, cwd: Path) -> Path:
        code = f"import hatchling.build; print(hatchling.build.build_{kind}({str(tmp_path / cwd.name)!r}))"
        (tmp_path / cwd.name).mkdir(exist_ok=True)
        done = subprocess.run([sys.executable, "-c", code], cwd=cwd, check=True, capture_output=True, text=True)
        return tmp_path / cwd.name / done.stdout.split()[-1]

    source = build("sdist", ROOT)
    with tarfile.open(source) as archive:
        safely = {"filter": "data"} if hasattr(tarfile, "data_filter") else {}  # Python 3.11 before 3.11.4 has none
        archive.extractall(tmp_path / "unpacked", **safely)
    (unpacked,) = (tmp_path / "unpacked").iterdir()
    for name in (
        "LICENSE",
        "CITATION.cff",
        "docs/first_hour.md",
        "docs/guides/own_graph.md",
        "docs/researchers/audit.md",
        "formal/README.md",
        "tests/conftest.py",
    ):
        assert (unpacked / name).exists(), name
    here, again = build("wheel", ROOT), build("wheel", unpacked)
    assert here.name == again.name
    assert here.read_bytes() == again.read_bytes()
    information = (unpacked / "PKG-INFO").read_text(encoding="utf-8")
    assert "License-Expression: BSD-3-Clause" in information
    assert "License-File: LICENSE" in information
