"""Reports show what they say: words that do not overlap, phones, scale, ellipses of tracks, axes, intervals."""

import re
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.missions.drawing.figures import mission_figure
from ratt_opt.report.page.map_svg import page_maps
from ratt_opt.report.picture import picture_of
from ratt_opt.report.spots import best_spot
from tests.report.browser import opened

QUICK = {"guarantees": "none", "time_limit": 10}


def crowded(seed: int) -> ro.Scenario:
    """Long names and weights in a square of 100 m."""
    drawn = ro.random_scenario(9, 9, alpha_s=2, alpha_c=5, seed=seed)
    robots = tuple(robot.replace(name=f"Demosthenes-{i}") for i, robot in enumerate(drawn.robots))
    targets = tuple(t.replace(name=f"Leviathan {j}0", weight=1.0 + j % 2) for j, t in enumerate(drawn.targets))
    return drawn.replace(robots=robots, targets=targets)


@pytest.fixture(scope="module")
def reports() -> list[ro.BoundReport]:
    return [ro.bound(crowded(seed), **QUICK) for seed in range(3)]


def overlap(a, b) -> float:
    """The area that two boxes share."""
    width, height = min(a[2], b[2]) - max(a[0], b[0]), min(a[3], b[3]) - max(a[1], b[1])
    return width * height if width > 0 and height > 0 else 0.0


def test_words_of_a_figure_do_not_overlap(reports) -> None:
    for report in reports:
        figure = report.plot()
        figure.draw_without_rendering()
        axes = figure.axes[0]
        words = [text.get_window_extent() for text in axes.texts if len(text.get_text()) > 3]
        boxes = [(box.x0, box.y0, box.x1, box.y1) for box in words]
        assert len(boxes) == 18
        assert all(overlap(a, b) <= 0.02 * (a[2] - a[0]) * (a[3] - a[1]) for a, b in combinations(boxes, 2))


def test_the_best_spot_is_the_first_that_covers_nothing() -> None:
    taken, inside = [(0.0, 0.0, 2.0, 2.0)], (0.0, 0.0, 10.0, 10.0)
    boxes = [(1.0, 1.0, 3.0, 3.0), (-1.0, 4.0, 1.0, 6.0), (4.0, 4.0, 5.0, 5.0), (6.0, 6.0, 7.0, 7.0)]
    assert best_spot(boxes, taken, inside) == (2, 0.0)
    assert best_spot(boxes[:2], taken, inside) == (0, 1.0)


def test_the_marks_of_a_page_lie_on_what_is_drawn(reports) -> None:
    """Each robot and target has a mark of the page's own, whose centre is that of the drawn disc or star."""
    for report in reports:
        for name, svg in page_maps(report).items():
            marks = np.array(re.findall(r'<circle cx="([-\d.]+)" cy="([-\d.]+)"', svg), dtype=float)
            drawn = np.array(re.findall(r'<use xlink:href="[^"]*" x="([-\d.]+)" y="([-\d.]+)"', svg), dtype=float)
            assert len(marks) == 18
            assert (np.linalg.norm(marks[:, None] - drawn[None], axis=2).min(axis=1) < 0.1).all()
            key = name.replace(" ", "-")
            names = re.findall(r'(?:\bid="|href="#|url\(#)([^")]*)', svg)
            assert all(one.startswith(f"{key}-") for one in names)  # another map's clips vanish while it is hidden


def test_a_phone_shows_the_whole_report(tmp_path, reports) -> None:
    reports[0].save(tmp_path, certificate=False)
    with opened(tmp_path / "report.html", tmp_path / "profile") as browser:
        metrics = {"width": 390, "height": 800, "deviceScaleFactor": 2, "mobile": True}
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
        assert browser.execute_script("return document.documentElement.scrollWidth") <= 390
        sizes = browser.execute_script(
            "return [...document.querySelectorAll('td, th, p, figcaption')]"
            ".filter(e => e.getClientRects().length && e.textContent.trim())"
            ".map(e => parseFloat(getComputedStyle(e).fontSize))"
        )
        drawn = browser.execute_script("return document.querySelector('svg.map').getBoundingClientRect().width")
        unit = drawn / browser.execute_script("return document.querySelector('svg.map').viewBox.baseVal.width")
        assert min(*sizes, 7 * unit) >= 10  # words of the map have 7 points
        wide = browser.execute_script(
            "return [...document.querySelectorAll('td, th, p, div.wide')]"
            ".filter(e => e.getClientRects().length).map(e => e.getBoundingClientRect().right)"
        )
        assert max(wide) <= 390


TRACK = {
    "prior": [np.diag([4.0, 1.0, 9.0, 2.0]).tolist()],
    "information": [[np.diag([1.0, 0.0, 0.5, 0.0]).tolist()], [np.diag([0.2, 0.0, 2.0, 0.0]).tolist()]],
    "robot": [0, 1],
    "alpha_s": 0,
    "alpha_c": 0,
    "robot_positions": [[0.0, 0.0], [5.0, 5.0]],
    "target_positions": [[2.0, 3.0]],
}


def test_tracks_of_four_coordinates_have_ellipses_of_their_positions() -> None:
    report = ro.bound(ro.InformationInput(**TRACK, units=("m", "m/s", "m", "m/s")), **QUICK)
    picture = picture_of(report.source, report)
    np.testing.assert_allclose(picture.prior, [np.diag([4.0, 9.0])])
    np.testing.assert_allclose(picture.posterior, [np.diag([1 / (0.25 + 1.2), 1 / (1 / 9 + 2.5)])])
    assert "root of the trace left after measuring" in page_maps(report)["worst"]
    unknown = ro.bound(ro.InformationInput(**TRACK), **QUICK)
    assert picture_of(unknown.source, unknown).posterior is None  # which coordinates are positions is not told


@pytest.fixture(scope="module")
def missions() -> list[ro.Mission]:
    scenario = ro.random_scenario(4, 2, alpha_s=1, alpha_c=1, seed=2)
    return [ro.run_mission(scenario, steps=6, seed=seed) for seed in range(2)]


def test_missions_show_consistency_on_a_logarithmic_axis_and_intervals_from_zero(missions) -> None:
    wild = [replace(missions[0], steps=missions[k].steps) for k in (0, 1)]
    figure = mission_figure(wild)
    above, below = figure.axes
    assert below.get_yscale() == "log"
    ends = [path.vertices[:, 1] for axes in (above, below) for c in axes.collections for path in c.get_paths()]
    assert ends
    assert min(end.min() for end in ends) >= 0  # of two seeds Student's t alone would go far below


def test_the_player_has_axes_and_the_action_fills_its_frame(tmp_path, missions) -> None:
    path = missions[0].animate(tmp_path / "player.html")
    script = (
        "const c = document.getElementById('map');"
        "const at = p => [X(p[0]), Y(p[1])];"
        "const all = data.frames.flatMap(f => [...f.robots, ...f.targets, ...f.estimates].map(at));"
        "return [c.clientWidth, c.clientHeight, Math.min(...all.map(p => p[0])), Math.max(...all.map(p => p[0])),"
        " Math.min(...all.map(p => p[1])), Math.max(...all.map(p => p[1])), ticks(x0, x1, 600)]"
    )
    with opened(path, tmp_path / "profile") as browser:
        for width in (390, 1000):
            metrics = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 500}
            browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
            browser.execute_script("window.dispatchEvent(new Event('resize'))")
            wide, high, left, right, top, bottom, ticks = browser.execute_script(script)
            assert wide <= width
            assert 0 < left < right < wide
            assert 0 < top < bottom < high
            # Margins of 6 % and the axes' numbers are all that is empty along the side that decides the scale.
            assert max((right - left) / (wide - 52), (bottom - top) / (high - 42)) > 0.85
            assert (bottom - top) / (high - 42) > 0.75
            assert len(ticks) >= 3
