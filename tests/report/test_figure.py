"""The figure shows the attack that the report states, and no text overlaps or is cut off."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.report.figure import plan_figure, save_figure
from ratt_opt.report.map import CUT, SURVIVING
from ratt_opt.report.picture import picture_of


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
    assert [text.get_text() for text in figure.axes[0].texts] == list("01234")


def test_posterior_is_what_the_best_group_leaves(drawn):
    report, picture, _ = drawn
    lost = sum(np.trace(p) - np.trace(q) for p, q in zip(picture.prior, picture.posterior, strict=True))
    assert lost == pytest.approx(report.recommended.worst_case.upper, rel=1e-12)


def test_bars_are_the_planners_values(drawn):
    report, _, figure = drawn
    bars = figure.axes[1]
    assert [label.get_text() for label in bars.get_yticklabels()] == [plan.name for plan in report.plans]
    assert [bar.get_width() for bar in bars.patches] == [plan.worst_case.lower for plan in report.plans]


@pytest.mark.parametrize(("n_robots", "n_targets", "seed"), [(4, 4, 14), (8, 10, 0), (30, 25, 1)])
def test_no_text_leaves_the_figure_or_covers_another(n_robots, n_targets, seed):
    scenario = ro.random_scenario(n_robots, n_targets, alpha_s=n_robots // 4, alpha_c=n_robots - 1, seed=seed)
    report = ro.bound(scenario, time_limit=1.0)
    figure = plan_figure(report, picture_of(scenario, report))
    figure.draw_without_rendering()
    texts = [figure._suptitle, figure.axes[1].title, figure.axes[1]._right_title, *figure.axes[1].texts]
    texts += [*figure.axes[1].get_yticklabels(), *figure.axes[0].get_legend().get_texts()]
    boxes = [text.get_window_extent() for text in texts if text is not None and text.get_text()]
    for box in boxes:
        assert figure.bbox.x0 <= box.x0 <= box.x1 <= figure.bbox.x1
        assert figure.bbox.y0 <= box.y0 <= box.y1 <= figure.bbox.y1
    assert not any(a.overlaps(b) for a, b in combinations(boxes, 2))


def test_a_file_is_the_same_each_time(drawn, tmp_path):
    for name in ("a", "b"):
        figure = plan_figure(*drawn[:2])
        save_figure(figure, tmp_path / f"{name}.svg")
        save_figure(figure, tmp_path / f"{name}.png")
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
