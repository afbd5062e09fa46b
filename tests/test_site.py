"""The documentation site: made without a warning, with every public name, and nothing fetched from elsewhere."""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys
from collections import Counter
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlparse

import pytest

import ratt_opt as ro

ROOT = Path(__file__).parents[1]
NEEDED = ("sphinx", "pydata_sphinx_theme", "myst_nb")


def test_the_interface_page_lists_every_name_once_by_topic() -> None:
    page = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
    listed = Counter(re.findall(r"^(?:\.\. auto\w+:: ratt_opt\.|`)(\w+)", page, re.MULTILINE))
    assert listed == Counter(set(ro.__all__) - {"__version__"})


class References(HTMLParser):
    """What a page loads, and where its links go."""

    def __init__(self) -> None:
        super().__init__()
        self.loaded: list[str] = []
        self.links: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        found = dict(attrs)
        if tag in {"script", "img"} and found.get("src"):
            self.loaded.append(str(found["src"]))
        if tag == "link" and found.get("href") and found.get("rel") in {"stylesheet", "preload", "icon"}:
            self.loaded.append(str(found["href"]))
        if tag == "a" and found.get("href"):
            self.links.append(str(found["href"]))


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    missing = [name for name in NEEDED if importlib.util.find_spec(name) is None]
    if missing:
        pytest.skip(f"the extra docs is not installed: no {', '.join(missing)}")
    out = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html", "docs", str(out)]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return out


def test_no_page_fetches_or_leads_astray(site: Path) -> None:
    pages = [site / f"{path.stem}.html" for path in (ROOT / "docs").glob("*.md")]
    for page in pages:
        found = References()
        found.feed(page.read_text(encoding="utf-8"))
        assert [x for x in found.loaded if urlparse(x).netloc] == []
        inside = [urlparse(x).path for x in (*found.loaded, *found.links) if not urlparse(x).netloc]
        assert [x for x in inside if x and not (page.parent / unquote(x)).exists()] == []
