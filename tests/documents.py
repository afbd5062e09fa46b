"""The pages that people write: README and docs, without what the site is made of besides."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

__all__ = ["ROOT", "Block", "blocks", "documents"]

ROOT = Path(__file__).parents[1]
MADE = ("api", "gallery", "notebooks", "schemas")
"""Folders of docs that building the site writes."""
BLOCK = re.compile(
    r"(?:^<!-- (?P<mark>[^>]*?) -->\n)?^```(?P<language>\w+)\n(?P<code>.*?)^```$", re.MULTILINE | re.DOTALL
)


@dataclass(frozen=True, slots=True)
class Block:
    """A fenced block with its language, and the words of the comment above it, such as ``file: NAME``."""

    language: str
    code: str
    mark: str


def documents() -> list[Path]:
    """Every page that somebody writes."""
    pages = (ROOT / "docs").rglob("*.md")
    written = [page for page in sorted(pages) if page.relative_to(ROOT / "docs").parts[0] not in MADE]
    return [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *written]


def blocks(page: Path) -> Iterator[Block]:
    """The fenced blocks of a page with a language, in order; directives of the site have none."""
    for found in BLOCK.finditer(page.read_text(encoding="utf-8")):
        yield Block(found["language"], found["code"], " ".join((found["mark"] or "").split()))
