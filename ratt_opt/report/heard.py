"""Picture of a plan by messages: who heard whom before choosing, and which robots planned together."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.report.layout import robot_places
from ratt_opt.report.map import label_places
from ratt_opt.report.palette import BLINDED, CUT, INK, LOST, SURVIVING, TARGET
from ratt_opt.running.interrupts import imported_whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ratt_opt.decentralised.links import LinkLosses
    from ratt_opt.decentralised.plan import DecentralisedPlan
    from ratt_opt.graph.communication import Link
    from ratt_opt.problem import Problem
    from ratt_opt.report.description import Description

__all__ = ["heard_figure"]


def heard_figure(
    problem: Problem, plan: DecentralisedPlan, known: Description, links: LinkLosses | None = None
) -> Figure:
    """Return the figure: the network with bait, components and lost links; beside it the table of who heard whom.

    ``links`` : the wider a link, the more its loss while planning costs; if none costs anything, delays the decision
    """
    figure: Figure = imported_whole("matplotlib.figure").Figure(figsize=(13, 6.8), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.1, 1))
    losses = () if links is None else links.losses
    kind = "cost" if any(loss.cost > 0 for loss in losses) else "delay"
    weights = {loss.link: max(getattr(loss, kind), 0.0) for loss in losses}
    most = max(weights.values(), default=0.0)
    told = f"link (widest: its loss while planning {'costs' if kind == 'cost' else 'delays by'} {most:.3g}"
    label = f"{told}{' s' * (kind == 'delay')})" if most > 0 else "link"
    widths = {link: 1 + 4 * weight / (most or 1.0) for link, weight in weights.items()}
    _draw_network(left, problem, plan, known, (widths, label))
    _draw_table(right, problem, plan)
    parts, share = len(plan.components), plan.guarantee.value
    kept = f"at least {share:.3g} of the optimum after any attack" if share > 0 else "its curvature proves no share"
    figure.suptitle(
        f"Planned by messages: {plan.rounds} rounds, {plan.messages} messages, {plan.bytes} bytes, "
        f"{plan.decision_time:.2f} s of the radios.\n"
        f"{parts} component{'s' * (parts > 1)}; {kept}.",
        fontsize=11.5,
    )
    return figure


def _draw_network(
    axes: Axes, problem: Problem, plan: DecentralisedPlan, known: Description, drawn: tuple[dict[Link, float], str]
) -> None:
    places = robot_places(problem, plan.elements, known)
    home = {i: group for group in plan.components for i in group}
    lost = {tuple(sorted(who)) for _, kind, who in plan.faults_met if kind == "cut"}
    links = sorted(problem.communication.links)
    widths, told = drawn
    for kind, colour, style, label in (
        (False, SURVIVING, "solid", told),
        (True, CUT, (0, (4, 3)), "link lost while planning"),
    ):
        chosen = [(i, j) for i, j in links if ((i, j) in lost or home[i] != home[j]) is kind]
        for n, (i, j) in enumerate(chosen):
            ends, wide = places[[i, j]].T, widths.get((i, j), 1.0)
            axes.plot(*ends, color=colour, linestyle=style, lw=wide, zorder=1, label=label if n == 0 else None)
    gone = {kind: {who[0] for _, met, who in plan.faults_met if met == kind} for kind in ("blinded", "crashed")}
    greedy = [i for i in range(problem.n_robots) if i not in plan.bait]
    for robots, colour, marker, label in (
        (greedy, INK, "o", "robot that chose beside others"),
        (plan.bait, TARGET, "s", "bait"),
        (sorted(gone["blinded"]), BLINDED, "x", "blinded"),
        (sorted(gone["crashed"]), LOST, "D", "crashed"),
    ):
        if len(robots):
            x, y = places[list(robots)].T
            axes.scatter(x, y, c=colour, marker=marker, s=46, zorder=3, label=label)
    for i, place in enumerate(places):
        axes.annotate(str(i), place, xytext=(5, 5), textcoords="offset points", fontsize=8)
    label_places(axes, is_layout=known.poses_after is None and known.poses is None)


def _draw_table(axes: Axes, problem: Problem, plan: DecentralisedPlan, most_named: int = 30) -> None:
    """Draw the table; the numbers of at most ``most_named`` robots stand beside it."""
    n = problem.n_robots
    order = sorted(range(n), key=lambda i: (i not in plan.bait, len(plan.heard[i]), i))
    place = {robot: k for k, robot in enumerate(order)}
    dots = [(place[j], place[i]) for i in range(n) for j in plan.heard[i]]
    if dots:
        x, y = np.array(dots).T
        axes.scatter(x, y, c=SURVIVING, marker="s", s=min(60, 5000 / n**1.4))
    axes.set_xlim(-0.7, n - 0.3)
    axes.set_ylim(n - 0.3, -0.7)
    if n <= most_named:
        axes.set_xticks(range(n), list(map(str, order)))
        axes.set_yticks(range(n), list(map(str, order)))
    axes.set_xlabel("robot whose choice was heard")
    axes.set_ylabel("robot that chose (bait first, then in turn)")
    axes.set_title("who had heard whom when choosing", fontsize=10.5)
    axes.set_aspect("equal")
