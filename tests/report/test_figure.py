"""The figure shows the attack that the report states, and no text overlaps or is cut off."""

from dataclasses import fields
from itertools import combinations

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.report.figure import plan_figure, save_figure
from ratt_opt.report.page.map_svg import page_maps
from ratt_opt.report.palette import CUT, SURVIVING
from ratt_opt.report.picture import picture_of
from ratt_opt.report.spots import BESIDE, SPOTS
from ratt_opt.report.tables import report_tables


@pytest.fixture(scope="module")
def drawn():
    scenario = ro.random_scenario(5, 4, alpha_s=1, alpha_c=4, seed=3)
    report = ro.bound(scenario)
    picture = picture_of(scenario, report)
    return report, picture, plan_figure(report, picture)


def colours_of(axes):
    """Number of drawn link segments of each colour."""
    from matplotlib.collections import LineCollection
    from matplotlib.colors import to_hex

    links = [c for c in axes.collections if isinstance(c, LineCollection)]
    return {to_hex(c.get_colors()[0]): len(c.get_segments()) for c in links}


def test_links_groups_and_blinded_robots_are_the_worst_attack_s(drawn):
    report, picture, figure = drawn
    attack = report.recommended.worst_case.attack
    assert picture.attack == attack
    kept = picture.links - attack.links
    shown = colours_of(figure.axes[0])
    assert shown.get(CUT, 0) == len(attack.links)
    assert shown.get(SURVIVING, 0) == sum({i, j} <= picture.best for i, j in kept)
    labels = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert "blinded robot" in labels
    written = [text.get_text() for text in figure.axes[0].texts]
    assert written == [*"01234", *(f"T{j}" for j in range(4))]
    assert labels[-1] == "heading"


def test_posterior_is_what_the_best_group_leaves(drawn):
    report, picture, _ = drawn
    lost = sum(np.trace(p) - np.trace(q) for p, q in zip(picture.prior, picture.posterior, strict=True))
    assert lost == pytest.approx(report.recommended.worst_case.upper, rel=1e-12)


def whisker_of(axes, row):
    """The ends of the whisker of one bar, or ``None``."""
    for container in axes.containers:
        if hasattr(container, "has_xerr"):
            for segments in container[2]:
                (x0, y), (x1, _) = segments.get_segments()[0]
                if y == row:
                    return x0, x1
    return None


def test_files_are_drawn_in_the_layout_in_which_words_were_placed(drawn, tmp_path, monkeypatch):
    """To lay it out again for each file, and to make a renderer for each word, took a quarter of a save."""
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    executed = []
    layout = ConstrainedLayoutEngine.execute
    monkeypatch.setattr(ConstrainedLayoutEngine, "execute", lambda self, fig: executed.append(1) or layout(self, fig))
    report, picture, _ = drawn
    figure = plan_figure(report, picture)
    placed = [axes.get_position().bounds for axes in figure.axes]
    for name in ("plan.png", "plan.svg"):
        save_figure(figure, tmp_path / name)
    assert len(executed) == 1
    assert [axes.get_position().bounds for axes in figure.axes] == placed


@pytest.mark.parametrize(("alpha_s", "seconds"), [(1, 60.0), (10, 60.0), (5, 1e-3)])
def test_bars_are_what_is_decided_and_whiskers_what_is_not(alpha_s, seconds):
    """Close values are drawn as what misses to the bound, far ones as what is kept; 10 of 10 blinded keep nothing."""
    scenario = ro.random_scenario(10, 5, alpha_s=alpha_s, alpha_c=20 if seconds < 1 else 0, seed=2)
    report = ro.bound(scenario, time_limit=seconds)
    bars = plan_figure(report, picture_of(scenario, report)).axes[1]
    assert [label.get_text() for label in bars.get_yticklabels()] == [plan.planner for plan in report.plans]
    missing = "shortfall" in bars.get_xlabel()
    assert missing == (0 < 0.5 * report.upper <= min(plan.worst_case.lower for plan in report.plans))
    undecided = 0
    for row, (plan, bar) in enumerate(zip(report.plans, bars.patches, strict=True)):
        low, high = plan.worst_case.lower, plan.worst_case.upper
        if missing:
            low, high = report.upper - high, report.upper - low
        assert bar.get_width() == pytest.approx(max(low, 0), abs=1e-12)
        whisker = whisker_of(bars, row)
        if high - low > 1e-9 * report.upper:
            undecided += 1
            assert whisker == pytest.approx((max(low, 0), max(high, 0)), abs=1e-9)
        else:
            assert whisker is None
    assert (undecided > 0) == (seconds < 1)


@pytest.mark.parametrize("seed", [2, 3])
def test_numbers_of_bars_cross_neither_the_line_nor_the_edges(seed):
    """Far values (2) and close ones (3), where the line is on the left; planners with the longest names."""
    scenario = ro.limited_view_scenario(5, 5, alpha_s=1, alpha_c=3, seed=seed, view=60)
    scenario = scenario if seed == 2 else ro.random_scenario(5, 4, alpha_s=1, alpha_c=4, seed=seed)
    own = {f"{'W' * 60}{k}": lambda problem: [choices[0] for choices in problem.choices] for k in range(2)}
    for planners in ({}, own):
        report = ro.bound(scenario, time_limit=0.5, planners=planners)
        figure = plan_figure(report, picture_of(scenario, report))
        figure.draw_without_rendering()
        left, bars = figure.axes
        numbers = [text.get_window_extent() for text in bars.texts]
        (line,) = (line.get_window_extent() for line in bars.lines if line.get_linestyle() == "--")
        names = [label.get_window_extent() for label in bars.get_yticklabels()]
        assert len(names) == len(numbers) == len(report.plans)
        assert all(box.x0 > line.x1 or box.x1 < line.x0 for box in numbers)
        assert not any(a.overlaps(b) for a, b in combinations(numbers, 2))
        assert all(figure.bbox.x0 < box.x0 < box.x1 < figure.bbox.x1 - 4 for box in [*numbers, *names])
        assert all(bars.bbox.y0 < box.y0 < box.y1 < bars.bbox.y1 for box in numbers)
        assert min(box.x0 for box in names) > left.get_window_extent().x1
        longest = max(high for plan in report.plans for high in [plan.worst_case.upper])
        assert bars.get_xlim()[1] <= 1.1 * max(longest, report.upper)


def test_a_model_free_file_s_names_places_weights_and_protections_are_shown():
    rng = np.random.default_rng(0)
    plain = {
        "format": "ratt-opt information", "version": 1, "alpha_s": 1, "alpha_c": 1, "robot": [0, 0, 1, 2],
        "prior": [[[2.0, 0.0], [0.0, 1.0]]] * 2,
        "information": [[[[x, 0.0], [0.0, y]] for x, y in rng.random((2, 2))] for _ in range(4)],
        "links": [[0, 1], [1, 2]], "protected_robots": [2], "protected_links": [[0, 1]], "weights": [1.0, 2.5],
    }  # fmt: skip
    known = {
        "robot_names": ["ada", "bob", "cy"], "target_names": ["fox", "hare"],
        "robot_positions": [[0.0, 0.0], [5.0, 1.0], [9.0, 3.0]], "target_positions": [[2.0, 4.0], [7.0, 5.0]],
    }  # fmt: skip
    given = ro.InformationInput(**plain, **known)
    report = ro.bound(given)
    axes = report.plot().axes[0]
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert {"protected robot", "protected link", "95 % after, best group"} <= set(labels)
    assert {"ada", "bob", "cy", "T0 fox ×1", "T1 hare ×2.5"} <= {text.get_text() for text in axes.texts}
    assert report.to_dict()["robot_names"] == known["robot_names"]
    assert "0 ada" in list(list(report_tables(report))[1].columns[0].cells)
    assert "target T0 fox, weight 1" in page_maps(report)["worst"]
    unplaced = ro.bound(ro.InformationInput(**plain)).plot().axes[0]
    assert "layout" in unplaced.get_xlabel()
    with pytest.raises(ro.InputError, match="robot_names must have 3 entries"):
        ro.InformationInput(**plain, robot_names=["ada"])


def test_from_twenty_robots_on_only_what_matters_is_drawn():
    scenario = ro.random_scenario(24, 4, alpha_s=4, alpha_c=40, seed=1).replace(communication_range=40.0)
    report = ro.bound(scenario, time_limit=5)
    picture = picture_of(scenario, report)
    axes = plan_figure(report, picture).axes[0]
    numbered = {int(t.get_text()) for t in axes.texts if t.get_text().isdigit()}
    assert picture.best | picture.attack.sensing <= numbered
    whole = report.plot(ro.MapStyle(many_robots=25)).axes[0]
    assert set(map(str, range(24))) <= {t.get_text() for t in whole.texts}
    rest = 24 - len(numbered)
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert (f"density of the other {rest} robots" in labels) == (rest > 0)
    assert "link of another group" not in labels


def test_every_robot_and_link_of_a_network_is_drawn():
    scenario = ro.network_scenario("disk-6", 24, 4, alpha_s=3, alpha_c=8, seed=1)
    report = ro.bound(scenario, time_limit=5)
    axes = plan_figure(report, picture_of(scenario, report)).axes[0]
    assert {int(t.get_text()) for t in axes.texts if t.get_text().isdigit()} == set(range(24))
    assert sum(colours_of(axes).values()) == len(scenario.links) == 72


@pytest.mark.parametrize("name", [one.name for one in fields(ro.MapStyle)])
def test_a_map_is_drawn_with_every_number_at_its_ends(drawn, name):
    report, _, figure = drawn
    for value in (0, 1000):
        axes = report.plot(ro.MapStyle(**{name: value})).axes[0]
        assert [t.get_text() for t in axes.texts if t.get_text()] == [
            t.get_text() for t in figure.axes[0].texts if t.get_text()
        ]
    with pytest.raises(ro.InputError, match=rf"style\.{name} must be at least 0; got -1"):
        ro.MapStyle(**{name: -1})


@pytest.mark.parametrize(
    ("n_robots", "n_targets", "seed", "reach"),
    [(4, 4, 14, None), (8, 10, 0, None), (30, 25, 1, None), (6, 6, 0, 40.0), (20, 20, 0, 30.0)],
)
def test_no_text_leaves_the_figure_or_covers_another(n_robots, n_targets, seed, reach):
    """Everybody sees everything, or sectors of such a reach."""
    team = ro.limited_view_scenario if reach else ro.random_scenario
    more = {"alpha_c": n_robots // 2, "reach": reach, "communication_range": 45} if reach else {"alpha_c": n_robots - 1}
    scenario = team(n_robots, n_targets, alpha_s=n_robots // 4, seed=seed, **more)
    report = ro.bound(scenario, time_limit=1.0)
    figure = plan_figure(report, picture_of(scenario, report))
    figure.draw_without_rendering()
    left, bars = figure.axes
    texts = [figure._suptitle, bars.title, bars._right_title, bars.xaxis.label, *bars.texts]
    texts += [*bars.get_yticklabels(), *left.get_legend().get_texts()]
    boxes = [text.get_window_extent() for text in texts if text is not None and text.get_text()]
    for box in boxes:
        assert figure.bbox.x0 <= box.x0 <= box.x1 <= figure.bbox.x1
        assert figure.bbox.y0 <= box.y0 <= box.y1 <= figure.bbox.y1
    assert not any(a.overlaps(b) for a, b in combinations(boxes, 2))


def test_names_cover_neither_each_other_nor_what_they_name():
    """Five robots two steps apart among six targets, all with long names."""
    grid = [[float(x), float(y)] for y in (0, 12, 24, 36) for x in (0, 30, 60)]
    given = ro.InformationInput(
        prior=[[[2.0]]] * 6, information=[[[[1.0 + e]]] * 6 for e in range(5)], robot=range(5), alpha_s=1, alpha_c=0,
        robot_names=[f"robot number {i}" for i in range(5)], target_names=[f"landmark number {j}" for j in range(6)],
        robot_positions=grid[:5], target_positions=grid[5:11],
    )  # fmt: skip
    figure = ro.bound(given).plot()
    figure.draw_without_rendering()
    words = [text for text in figure.axes[0].texts if "number" in text.get_text()]
    assert len(words) == 11
    assert not any(a.get_window_extent().overlaps(b.get_window_extent()) for a, b in combinations(words, 2))
    places = figure.axes[0].transData.transform(grid[:11])
    assert not any(word.get_window_extent().contains(*place) for word in words for place in places)


def test_names_that_cannot_stand_beside_their_place_have_a_line_to_it():
    """Eleven places so close that words cannot all stand beside them: those farther out are joined to their place."""
    spots = [*([float(x), float(y)] for y in range(3) for x in range(4) if x + y < 5), [60.0, 60.0]]
    given = ro.InformationInput(
        prior=[[[2.0]]] * 6, information=[[[[1.0 + e]]] * 6 for e in range(6)], robot=range(6), alpha_s=1, alpha_c=0,
        robot_names=[f"robot number {i}" for i in range(6)], target_names=[f"landmark number {j}" for j in range(6)],
        robot_positions=spots[:6], target_positions=spots[6:],
    )  # fmt: skip
    axes = ro.bound(given).plot().axes[0]
    joined = [text.xy for text in axes.texts if getattr(text, "arrow_patch", None) is not None]
    beside = {spot[:2] for spot in SPOTS[:BESIDE]}
    far = [text.xy for text in axes.texts if "number" in text.get_text() and text.get_position() not in beside]
    assert len(far) > 2
    assert np.array_equal(joined, far)


def test_a_file_is_the_same_each_time(drawn, tmp_path):
    for name in ("a", "b"):
        figure = plan_figure(*drawn[:2])
        save_figure(figure, tmp_path / f"{name}.svg")
        save_figure(figure, tmp_path / f"{name}.png")
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
