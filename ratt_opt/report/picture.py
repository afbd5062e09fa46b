"""Contents of a team's map under one plan and one attack."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.report.description import FieldOfView, describe, named
from ratt_opt.report.layout import robot_places
from ratt_opt.report.map_style import MapStyle

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray
    from ratt_opt.findings import AssessedPlan, Findings
    from ratt_opt.problem import Attack, Problem
    from ratt_opt.report.description import Description

__all__ = ["Picture", "picture_of"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Picture:
    """Lengths in metres, angles in radians; ``None`` if nothing is known.

    ``places`` : (N, 2) robots after their controls, or a layout of the graph if ``is_layout``.
    ``headings`` : (N,); ``before`` : (N, 2) robots now; ``names`` : (N,), empty if none.
    ``targets`` : (M, 2) predicted means; ``target_names`` and ``weights`` : (M,); ``prior``, ``posterior`` :
    (M, 2, 2) covariances of the positions, the latter with the best surviving group's measurements.
    ``views`` : (N,) fields of view after the controls, if a sensor is limited; ``watched`` : (N, M) whether a robot
    measures a target, if not every robot measures all.
    ``style`` : how it is drawn on paper
    ``groups`` : connected groups left by the attack; ``best`` : the one that performs best.
    """

    places: FloatArray
    is_layout: bool
    headings: FloatArray | None
    before: FloatArray | None
    names: tuple[str, ...]
    targets: FloatArray | None
    target_names: tuple[str, ...] | None
    weights: FloatArray | None
    prior: FloatArray | None
    posterior: FloatArray | None
    views: tuple[FieldOfView, ...] | None
    watched: BoolArray | None
    links: frozenset[tuple[int, int]]
    protected_robots: frozenset[int]
    protected_links: frozenset[tuple[int, int]]
    attack: Attack
    groups: tuple[frozenset[int], ...]
    best: frozenset[int]
    style: MapStyle

    @property
    def is_weighted(self) -> bool:
        """Some targets count more than others."""
        return self.weights is not None and len(self.weights) > 0 and bool(np.ptp(self.weights) > 0)

    def target_label(self, j: int) -> str:
        """Target ``j`` on the map: its number, its name if it has one, its weight if weights differ."""
        name = self.target_names[j] if self.target_names else ""
        weight = f" ×{self.weights[j]:g}" if self.weights is not None and self.is_weighted else ""
        return named(j, name, "target") + weight

    @property
    def seeing(self) -> frozenset[int]:
        """Robots of the best group that the attack leaves their sight."""
        return self.best - self.attack.sensing

    @property
    def unseen(self) -> frozenset[int]:
        """Targets that no robot of the best group measures; none if all robots measure all."""
        if self.watched is None:
            return frozenset()
        return frozenset(np.flatnonzero(~self.watched[sorted(self.seeing)].any(axis=0)).tolist())


def picture_of(
    source: object, report: Findings, view: AssessedPlan | None = None, style: MapStyle | None = None
) -> Picture:
    """Put together what :func:`draw_map` draws; ``view``: one of the report's views, by default the worst."""
    plan = report.recommended if view is None else view
    problem, known = report.problem, describe(report.problem, source)
    places = robot_places(report.problem, plan.elements, known)
    after = None if known.poses_after is None else known.poses_after[plan.elements]
    plane = None if known.targets is None or plan.posterior is None else _plane(source, plan.posterior.shape[-1])
    return Picture(
        places=places,
        is_layout=after is None and known.poses is None,
        headings=None if after is None or after.shape[1] < 3 else after[:, 2],
        before=None if known.poses is None or after is None else known.poses[:, :2],
        names=tuple(name if known.robot(i).endswith(f" {name}") else "" for i, name in enumerate(known.robot_names)),
        targets=known.targets,
        target_names=known.target_names,
        weights=known.weights,
        prior=None if plane is None else problem.information_objective.prior[plane],
        posterior=None if plane is None or plan.posterior is None else plan.posterior[plane],
        views=_views(known) if after is not None and after.shape[1] == 3 else None,
        watched=_watched(problem, plan) if after is not None and known.targets is not None else None,
        links=problem.communication.links,
        protected_robots=problem.protected_robots,
        protected_links=problem.protected_links,
        attack=plan.worst_case.attack,
        groups=plan.groups,
        best=next((group for group in plan.groups if plan.best_group and plan.best_group <= group), plan.groups[0]),
        style=style or MapStyle(),
    )


def _plane(source: object, dimension: int) -> tuple[Any, ...] | None:
    """Return the index of the covariances (M, 2, 2) of x and y within those of whole states; ``None`` if unknown.

    They are the first two coordinates in metres; a state of two numbers is a position unless its units say otherwise.
    """
    units = getattr(source, "units", None) or (("m", "m") if dimension == 2 else ())
    metres = [k for k, unit in enumerate(units) if unit == "m"][:2]
    return (slice(None), *np.ix_(metres, metres)) if len(metres) == 2 else None


def _views(known: Description) -> tuple[FieldOfView, ...] | None:
    limited = known.views is not None and any(view != FieldOfView(None, None) for view in known.views)
    return known.views if limited else None


def _watched(problem: Problem, plan: AssessedPlan) -> BoolArray | None:
    told = np.asarray(problem.information_objective.information[plan.elements].any(axis=(2, 3)))
    return None if told.all() else told
