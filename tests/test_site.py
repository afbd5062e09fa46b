"""The documentation site: made without a warning, with every public name; links lead somewhere, nothing is fetched."""

import importlib.util
import os
import re
import subprocess
import sys
from html.parser import HTMLParser
from urllib.parse import unquote, urlparse

import pytest

import ratt_opt as ro
from ratt_audit.appendix.printed import printed_lines
from ratt_opt.report.schemas import OUTPUTS
from tests.documents import ROOT
from tests.report.browser import opened

NEEDED = ("sphinx", "pydata_sphinx_theme", "myst_nb", "sphinx_gallery", "latex2mathml")

FORMULAS = {"audit": len(printed_lines()), "worst_case_ratios": 21}
"""Formulas on some pages."""


class References(HTMLParser):
    """What a page loads, where its links go, and the places in it that links can name."""

    def __init__(self) -> None:
        super().__init__()
        self.loaded: list[str] = []
        self.links: list[str] = []
        self.places: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        found = dict(attrs)
        self.places |= {str(found[name]) for name in ("id", "name") if found.get(name)}
        if tag in {"script", "img", "iframe"} and found.get("src"):
            self.loaded.append(str(found["src"]))
        if tag == "link" and found.get("href") and found.get("rel") in {"stylesheet", "preload", "icon"}:
            self.loaded.append(str(found["href"]))
        if tag == "a" and found.get("href"):
            self.links.append(str(found["href"]))


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory):
    """Every page of the site by its path, read."""
    missing = [name for name in NEEDED if importlib.util.find_spec(name) is None]
    if missing:
        problem = f"the extra docs is not installed: no {', '.join(missing)}"
        (pytest.fail if os.environ.get("REQUIRE_SITE") else pytest.skip)(problem)
    out = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-d", str(out / ".trees"), "-b", "html"]
    environment = os.environ | {"PYTHONPATH": str(ROOT), "MPLBACKEND": "Agg"}
    done = subprocess.run(
        [*command, "docs", str(out)], cwd=ROOT, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    pages = {}
    for path in out.rglob("*.html"):
        if "_static" not in path.parts:
            pages[path] = References()
            pages[path].feed(path.read_text(encoding="utf-8"))
    return pages


def test_nothing_is_fetched_from_elsewhere(site):
    assert len(site) > 40
    loaded = [address for page in site.values() for address in page.loaded]
    assert [address for address in loaded if urlparse(address).netloc] == []


def test_every_link_inside_leads_to_a_place_that_is_there(site):
    broken = []
    for path, page in site.items():
        for address in (*page.loaded, *page.links):
            parts = urlparse(address)
            if parts.netloc or parts.scheme in {"mailto", "data"}:
                continue
            goal = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            known = site[goal].places if goal in site else set()
            if not goal.exists() or (goal in site and parts.fragment and unquote(parts.fragment) not in known):
                broken.append((path.name, address))
    assert broken == []


def test_the_interface_pages_list_every_name_by_topic(site):
    places = {place for path, page in site.items() if path.parent.name == "api" for place in page.places}
    assert {f"ratt_opt.{name}" for names in ro.TOPICS.values() for name in names} <= places


def test_every_format_has_a_page(site):
    pages = {path.stem for path in site if path.parent.name == "schemas"}
    assert {"scenario", "information", *OUTPUTS} <= pages


def test_every_example_and_notebook_is_a_page_with_a_picture(site):
    (root,) = {path.parent for path in site if path.name == "genindex.html"}
    examples = [root / "gallery" / f"{path.stem}.html" for path in (ROOT / "docs" / "examples").glob("*.py")]
    notebooks = [root / "notebooks" / f"{path.stem}.html" for path in (ROOT / "notebooks").glob("*.ipynb")]
    assert len(examples) >= 8
    assert set(notebooks) <= set(site)
    for page in examples:
        assert any("sphx_glr" in address for address in site[page].loaded), page.name


def test_formulas_are_typeset(site):
    texts = [(path, path.read_text(encoding="utf-8")) for path in site]
    typeset = {name: sum(t.count("<math") for path, t in texts if path.stem == name) for name in FORMULAS}
    assert typeset == FORMULAS
    code = re.compile(r"<pre>.*?</pre>", re.DOTALL)  # programs may write formulas for figures
    assert not [path for path, text in texts if "$\\" in code.sub("", text)]


PHONE = {"width": 390, "height": 844, "deviceScaleFactor": 1, "mobile": True}
OVERLAPS = """
const inside = [...document.querySelectorAll('.bd-header a, .bd-header button')]
    .map(e => e.getBoundingClientRect()).filter(r => r.width && r.height);
const touching = inside.flatMap((a, i) => inside.slice(i + 1).filter(b =>
    a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1)
    .filter(b => !(a.left <= b.left && a.right >= b.right) && !(b.left <= a.left && b.right >= a.right)));
return [document.documentElement.scrollWidth, touching.length, inside.length];
"""


@pytest.mark.parametrize(
    "page", ["index", "first_hour", "researchers/benchmarks", "guides/reading_a_report", "commands"]
)
def test_on_a_phone_nothing_overlaps_and_no_page_is_wider_than_the_screen(site, page, tmp_path) -> None:
    (root,) = {path.parent for path in site if path.name == "genindex.html"}
    with opened(root / f"{page}.html", tmp_path) as browser:
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", PHONE)
        browser.refresh()
        width, touching, inside = browser.execute_script(OVERLAPS)
    assert width == PHONE["width"]
    assert inside >= 3
    assert touching == 0


def test_the_home_has_installation_one_picture_and_one_example(site) -> None:
    (home,) = {path for path in site if path.name == "index.html" and (path.parent / "genindex.html").exists()}
    text = home.read_text(encoding="utf-8")
    assert [text.count(f"<h2>{title}") for title in ("Install", "One example", "Where to go")] == [1, 1, 1]
    assert sum("demo.png" in address for address in site[home].loaded) == 1
    for storey in ("first_hour", "contributors/index", "researchers/index"):
        assert f"{storey}.html" in site[home].links
