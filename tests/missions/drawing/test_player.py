"""``player.html`` in a real browser: it loads without a fault, steps, plays, and shows the mission's numbers."""

import re
from itertools import pairwise

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.missions.drawing.frames import MOST_LINKS, frames_of, limits
from tests.report.browser import opened


@pytest.fixture(scope="module")
def mission():
    scenario = ro.random_scenario(5, 3, alpha_s=1, alpha_c=4, seed=3)
    return ro.run_mission(scenario, steps=4, attacks="persistent", sharing="all surviving")


@pytest.fixture(scope="module")
def browser(mission, tmp_path_factory):
    path = mission.animate(tmp_path_factory.mktemp("player") / "player.html")
    with opened(path, tmp_path_factory.mktemp("profile")) as page:
        yield page


def show(browser, step: int) -> np.ndarray:
    """(height, width, 4) pixels of the map after the slider was moved."""
    script = (
        "const s = document.getElementById('step'); s.value = arguments[0]; s.dispatchEvent(new Event('input'));"
        "const c = document.getElementById('map');"
        "return [c.height, c.width, Array.from(c.getContext('2d').getImageData(0, 0, c.width, c.height).data)]"
    )
    height, width, pixels = browser.execute_script(script, step)
    return np.array(pixels, dtype=np.uint8).reshape(height, width, 4)


def test_it_loads_without_an_error_and_fetches_nothing(browser) -> None:
    assert browser.get_log("browser") == []
    assert browser.execute_script("return performance.getEntriesByType('resource').length") == 0
    assert "5 robots, 3 targets" in browser.find_element("tag name", "h1").text


def test_every_step_shows_its_numbers_and_another_map(browser, mission) -> None:
    maps = []
    for k, step in enumerate(mission.steps):
        maps.append(show(browser, k))
        text = browser.find_element("id", "text").text
        assert text.startswith(f"Step {k + 1} of 4: RMSE ")
        assert float(text.split("RMSE ")[1].split()[0]) == pytest.approx(mission.rmse[k], rel=6e-3)
        shown = re.search(r"(\d+) robots? blinded, (\d+) links? cut", text)
        assert [int(n) for n in shown.groups()] == [len(step.attack.sensing), len(step.attack.links)]
    drawn = [int((picture[..., 3] > 0).sum()) for picture in maps]
    assert min(drawn) > 1000
    assert all((a != b).any() for a, b in pairwise(maps))


def test_cut_links_are_counted_whole_where_too_many_are_drawn() -> None:
    def cut_most(problem, _elements):
        return ro.Attack(links=sorted(problem.communication.links)[:95])

    scenario = ro.random_scenario(15, 1, alpha_s=0, alpha_c=95, seed=0)
    (frame,) = frames_of(ro.run_mission(scenario, steps=1, attacker=cut_most))
    assert (frame["n_cut"], len(frame["cut"])) == (95, MOST_LINKS)


def test_robots_are_where_the_mission_had_them(browser, mission) -> None:
    """A mark of the role's colour around every robot that sees, next to its heading's line."""
    colours = browser.execute_script("return data.colours")
    picture = show(browser, 3)
    step = mission.steps[3]
    for i, (x, y, heading) in enumerate(step.poses):
        colour = [int(colours[step.role(i)][k : k + 2], 16) for k in (1, 3, 5)]
        column, row = browser.execute_script("return [X(arguments[0]), Y(arguments[1])]", float(x), float(y))
        column, row = column - 5 * np.cos(heading), row + 5 * np.sin(heading)
        near = picture[int(row) - 4 : int(row) + 5, int(column) - 4 : int(column) + 5, :3].reshape(-1, 3).astype(int)
        assert np.abs(near - colour).sum(axis=1).min() < 12, step.role(i)


def test_it_plays_and_pauses(browser) -> None:
    show(browser, 0)
    button = browser.find_element("id", "play")
    button.click()
    assert button.text == "Pause"
    browser.implicitly_wait(0)
    from selenium.webdriver.support.ui import WebDriverWait

    WebDriverWait(browser, 10).until(lambda page: not page.find_element("id", "text").text.startswith("Step 1 "))
    button.click()
    assert button.text == "Play"


@pytest.mark.parametrize("view", [60, 360])
def test_fields_of_view_are_inside_the_picture_and_wide_ones_are_rims(view: int, tmp_path) -> None:
    team = ro.limited_view_scenario(4, 3, alpha_s=1, alpha_c=2, seed=2, view=view, reach=20)
    flown = ro.run_mission(team, steps=2)
    frames = frames_of(flown)
    x0, x1, y0, y1 = limits(frames)
    for frame in frames:
        assert frame["fields"] == [[pytest.approx(np.radians(view)), 20.0]] * 4
        for x, y, _ in frame["robots"]:
            assert x0 <= x - 20
            assert x + 20 <= x1
            assert y0 <= y - 20
            assert y + 20 <= y1
    fills = []
    with opened(flown.animate(tmp_path / "player.html"), tmp_path / "profile") as page:
        pixels = show(page, 0)
        fills.append(float(((pixels[..., 3] > 0) & (pixels[..., 2] > pixels[..., 0])).mean()))  # bluish
    assert (fills[0] > 0.03) is (view == 60), fills


def test_without_limits_there_are_no_fields(mission) -> None:
    assert all(frame["fields"] == [] for frame in frames_of(mission))
