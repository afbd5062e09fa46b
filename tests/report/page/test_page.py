"""``report.html`` in a real browser: it loads without a fault, its toggles work, its numbers are the report's."""

import json
import re
from html.parser import HTMLParser

import pytest

import ratt_opt as ro
from tests.report.browser import opened

LARGEST_PAGE = 3_000_000


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    folder = tmp_path_factory.mktemp("page")
    scenario = ro.random_scenario(5, 3, alpha_s=1, alpha_c=4, seed=3).replace(protected_robots=(0,))
    report = ro.bound(scenario, certificate=folder / "certificate.json")
    report.save(folder)
    return report, folder


@pytest.fixture(scope="module")
def browser(saved, tmp_path_factory):
    with opened(saved[1] / "report.html", tmp_path_factory.mktemp("profile")) as page:
        yield page


def test_it_loads_without_an_error_and_fetches_nothing(browser):
    assert browser.get_log("browser") == []
    assert browser.execute_script("return performance.getEntriesByType('resource').length") == 0
    assert browser.find_element("tag name", "h1").text


def test_the_toggles_show_one_map_each(browser, saved):
    """Worst, next worst, none: by mouse, and by the keyboard's arrow."""
    keys = [name.replace(" ", "-") for name in saved[0].views]
    assert keys == ["worst", "next-worst", "none"]
    for key in keys:
        browser.find_element("id", f"show-{key}").click()
        shown = [
            view.get_attribute("id") for view in browser.find_elements("class name", "view") if view.is_displayed()
        ]
        assert shown == [f"view-{key}"]
    browser.find_element("id", "show-worst").click()
    browser.switch_to.active_element.send_keys("\ue015")  # arrow down
    assert browser.find_element("id", "view-next-worst").is_displayed()
    browser.find_element("id", "show-worst").click()


def test_each_map_shows_its_attack(browser, saved):
    for name, view in saved[0].views.items():
        key, attack = name.replace(" ", "-"), view.worst_case.attack
        drawn = browser.find_element("css selector", f"#view-{key} .map")
        roles = [mark.get_attribute("aria-label") for mark in drawn.find_elements("css selector", "g[tabindex]")]
        assert sum("blinded" in role for role in roles) == len(attack.sensing)
        assert sum(role.startswith("robot ") for role in roles) == 5
        assert sum("protected" in role for role in roles) == 1


def test_pointing_and_tabbing_tell_who_it_is(browser):
    mark = browser.find_element("css selector", "#view-worst g[tabindex]")
    browser.execute_script("arguments[0].focus()", mark)
    assert browser.find_element("id", "hint").text == mark.get_attribute("aria-label")


def test_the_numbers_equal_the_archive_s(browser, saved):
    document = json.loads((saved[1] / "report.json").read_text())
    plans = {"ratt": document["ratt"], "maxmin": document["optimum"], **document["baselines"]}
    rows = browser.find_elements("css selector", "section[aria-labelledby=planners] tbody tr")
    shown = {}
    for row in rows:
        cell = row.find_element("css selector", "td[data-lower]")
        name = row.find_element("tag name", "th").text.split()[0]
        shown[name] = [float(cell.get_attribute(f"data-{end}")) for end in ("lower", "upper")]
    assert shown == {name: [plan["worst_case"]["lower"], plan["worst_case"]["upper"]] for name, plan in plans.items()}
    text = browser.find_element("tag name", "body").text
    for name in (*document["guarantees"], *document["inapplicable"]):
        assert name in text
    assert "verified, both ends proved" in text
    assert "ratt-opt verify certificate.json" in text


def test_text_keeps_its_contrast_in_light_and_dark(browser):
    """At least 4.5 to 1, as WCAG 2.2 asks for text of this size."""
    for scheme in ("light", "dark"):
        features = [{"name": "prefers-color-scheme", "value": scheme}]
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": features})
        front, back = browser.execute_script(
            "const s = getComputedStyle(document.body); return [s.color, s.backgroundColor]"
        )
        high, low = sorted((luminance(front), luminance(back)), reverse=True)
        assert (high + 0.05) / (low + 0.05) >= 4.5
        assert (luminance(back) < 0.1) == (scheme == "dark")
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})


def luminance(colour):
    linear = [
        c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4
        for c in (int(x) / 255 for x in re.findall(r"\d+", colour)[:3])
    ]
    return sum(weight * c for weight, c in zip((0.2126, 0.7152, 0.0722), linear, strict=True))


class Structure(HTMLParser):
    """Headings, labelled controls, and whatever would be fetched."""

    def __init__(self):
        super().__init__()
        self.tags, self.fetched = [], []

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        self.fetched += [value for name, value in attrs if name in {"src", "href"} and not value.startswith("#")]


def structure_of(page):
    found = Structure()
    found.feed(page)
    return found


@pytest.mark.parametrize("n_robots", [5, 30])
def test_it_is_one_file_of_bounded_size(n_robots):
    from ratt_opt.report.page.map_svg import page_maps
    from ratt_opt.report.page.page import report_page

    scenario = ro.random_scenario(n_robots, n_robots, alpha_s=n_robots // 3, alpha_c=2 * n_robots, seed=0)
    report = ro.bound(scenario, time_limit=2)
    page = report_page(report, page_maps(report))
    assert len(page.encode()) < LARGEST_PAGE
    found = structure_of(page)
    assert found.fetched == []
    assert re.search(r"url\((?!#)", page) is None
    assert "@import" not in page
    assert [tag for tag, _ in found.tags if tag in {"h1", "h2"}][:1] == ["h1"]
    assert ("html", {"lang": "en"}) in found.tags


def test_names_from_files_are_text_not_markup(saved):
    from dataclasses import replace

    from ratt_opt.report.page.map_svg import page_maps
    from ratt_opt.report.page.page import report_page

    scenario = ro.random_scenario(2, 1, alpha_s=0, alpha_c=0, seed=0)
    nasty = "<script>alert(1)</script>"
    robots = tuple(robot.replace(name=nasty) for robot in scenario.robots)
    report = ro.bound(scenario.replace(robots=robots))
    page = report_page(report, page_maps(report))
    assert nasty not in page
    assert "&lt;script&gt;" in page
    assert report_page(replace(saved[0], source=None)).count("<figure") == 3
