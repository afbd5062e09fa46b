"""Maps of limited views: sectors, who measures whom, and what the attack leaves, against the geometry alone."""

import math
import re

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.report.fields import FIELD_WORDS, LOST_WORDS, WATCH_WORDS, field_of
from ratt_opt.report.figure import plan_figure
from ratt_opt.report.page.map_svg import page_maps
from ratt_opt.report.picture import picture_of

CASES = [(57, None, 3), (60, 30.0, 1), (220, 25.0, 3), (360, 20.0, 2)]


@pytest.fixture(scope="module", params=CASES, ids=str)
def drawn(request):
    view, reach, seed = request.param
    scenario = ro.limited_view_scenario(5, 6, alpha_s=1, alpha_c=3, seed=seed, view=view, reach=reach)
    report = ro.bound(scenario, time_limit=0.5)
    picture = picture_of(scenario, report)
    return view, reach, report, picture, plan_figure(report, picture)


def seen_by(picture, view, reach):
    """The pairs of robot and target that the geometry of the map allows."""
    pairs = set()
    for i, (x, y) in enumerate(picture.places):
        for j, (u, v) in enumerate(picture.targets):
            off = math.remainder(math.atan2(v - y, u - x) - picture.headings[i], 2 * math.pi)
            if abs(off) <= math.radians(view) / 2 and (reach is None or math.hypot(u - x, v - y) <= reach):
                pairs.add((i, j))
    return pairs


def segments_of(axes, style):
    from matplotlib.collections import LineCollection
    from matplotlib.colors import to_hex

    from ratt_opt.report.palette import TARGET

    lines = [c for c in axes.collections if isinstance(c, LineCollection) and to_hex(c.get_colors()[0]) == TARGET]
    dashed = {"solid": False, "broken": True}[style]
    return [s for c in lines if (c.get_linestyles()[0][1] is not None) == dashed for s in c.get_segments()]


def test_lines_join_whoever_measures_a_target_and_tell_what_the_attack_takes(drawn):
    view, reach, report, picture, figure = drawn
    attack = report.recommended.worst_case.attack
    left = {i for i in report.recommended.best_group if i not in attack.sensing}
    pairs = seen_by(picture, view, reach)
    for style, wanted in (
        ("solid", {p for p in pairs if p[0] in left}),
        ("broken", {p for p in pairs if p[0] not in left}),
    ):
        found = {tuple(np.round(s.ravel(), 9)) for s in segments_of(figure.axes[0], style)}
        assert found == {tuple(np.round(np.concatenate([picture.places[i], picture.targets[j]]), 9)) for i, j in wanted}
    assert picture.unseen == set(range(6)) - {j for i, j in pairs if i in left}
    labels = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert (WATCH_WORDS in labels) == any(i in left for i, _ in pairs)
    assert (LOST_WORDS in labels) == any(i not in left for i, _ in pairs)
    assert ("target left unseen" in labels) == bool(picture.unseen)
    assert any(label.startswith(FIELD_WORDS) for label in labels)


def test_a_sector_is_the_field_of_view_and_holds_what_is_measured(drawn):
    from matplotlib.patches import Wedge

    view, reach, _, picture, figure = drawn
    wedges = [patch for patch in figure.axes[0].get_children() if isinstance(patch, Wedge)]
    assert len(wedges) == 5
    for i, wedge in enumerate(wedges):
        assert wedge.center == pytest.approx(tuple(picture.places[i]))
        assert wedge.theta2 - wedge.theta1 == pytest.approx(view)
        assert math.remainder((wedge.theta1 + wedge.theta2) / 2 - math.degrees(picture.headings[i]), 360) == (
            pytest.approx(0, abs=1e-9)
        )
        assert reach is None or wedge.r == reach
        assert wedge.get_fill() == (view <= 180)
        low, high = figure.axes[0].transData.inverted().transform(figure.axes[0].bbox.get_points())
        ends = wedge.center + wedge.r * np.array(
            [[np.cos(a), np.sin(a)] for a in np.radians(np.linspace(wedge.theta1, wedge.theta2, 90))]
        )
        assert (ends >= low).all()
        assert (ends <= high).all()
    for i, j in seen_by(picture, view, reach):
        assert np.linalg.norm(picture.targets[j] - picture.places[i]) <= field_of(picture, i)[2]


def test_the_page_shows_the_same(drawn):
    view, reach, report, picture, _ = drawn
    worst = page_maps(report)["worst"]
    pairs = seen_by(picture, view, reach)
    assert worst.count(", left unseen") == 2 * len(picture.unseen)  # the title, and what is read aloud
    for i in range(5):
        words = ", ".join(f"T{j}" for k, j in sorted(pairs) if k == i) or "no target"
        assert re.search(rf'aria-label="robot {i}: [^"]*; measures {words}"', worst)


def test_where_everybody_sees_everything_nothing_is_added():
    scenario = ro.random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=1)
    report = ro.bound(scenario)
    picture = picture_of(scenario, report)
    labels = [text.get_text() for text in plan_figure(report, picture).axes[0].get_legend().get_texts()]
    assert not {WATCH_WORDS, LOST_WORDS, "target left unseen"} & set(labels)
    assert not any(label.startswith(FIELD_WORDS) for label in labels)
    assert "measures" not in page_maps(report)["worst"]
