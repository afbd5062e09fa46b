"""Result of the main job: every plan with its worst case, the bracket, the guarantees, the proof.

``main_job/result.py`` adds how that is saved and shown.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Self

import numpy as np

from ratt_opt.certificates.certification import CutsCertification

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attack.task import AttackResult
    from ratt_opt.bounds.guarantees import Guarantee
    from ratt_opt.certificates.certification import Certification
    from ratt_opt.curvatures.curvature import Curvature
    from ratt_opt.graph.largest_group.counting import LargestGroup
    from ratt_opt.problem import Problem
    from ratt_opt.setfunctions.base import SetFunction
    from ratt_opt.solvers.result import MaxMinResult

__all__ = ["AssessedPlan", "Findings", "value_unit"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class AssessedPlan:
    """One planner's plan and its worst case: the fields of a :class:`ratt_opt.PlanAssessment`, which see."""

    planner: str
    elements: IntArray
    controls: tuple[int, ...]
    bait: tuple[int, ...]
    worst_case: AttackResult
    evaluations: int
    groups: tuple[frozenset[int], ...]
    best_group: frozenset[int]
    posterior: FloatArray | None

    def role(self, robot: int) -> str:
        """Return the role of a robot under the attack: ``blinded``, ``sees`` (in the best group) or ``cut off``."""
        if robot in self.worst_case.attack.sensing:
            return "blinded"
        return "sees" if robot in self.best_group else "cut off"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Findings:
    """All that the main job found: the fields of a :class:`ratt_opt.BoundReport`, which see."""

    problem: Problem
    alpha_cs: int
    n_max_upper: int | None = None
    largest_group: LargestGroup | None = None
    ratt: AssessedPlan
    baselines: tuple[AssessedPlan, ...]
    optimum: MaxMinResult
    best: AssessedPlan
    curvature: Curvature | None
    total_curvature: Curvature | None
    guarantees: Mapping[str, Guarantee]
    inapplicable: Mapping[str, str]
    omitted: Mapping[str, str] = field(default_factory=dict)
    certificate: Certification
    cuts_certificate: CutsCertification = field(default_factory=CutsCertification)
    seconds: Mapping[str, float]
    created: str = ""
    source: object = None
    views: Mapping[str, AssessedPlan] = field(default_factory=dict)
    seeds: Mapping[str, int] = field(default_factory=dict)
    interrupted: bool = False
    remarks: tuple[str, ...] = ()

    @property
    def objective(self) -> str:
        """Name of the criterion, or the class of a set function that has none."""
        f = self.problem.objective
        return getattr(f, "name", "") or type(f).__name__

    @property
    def unit(self) -> str:
        """Unit of the objective; of a state that is not a position in words; empty if none is stated."""
        return value_unit(self.problem.objective, getattr(self.source, "units", None))

    @property
    def n_targets(self) -> int | None:
        """Number of targets M; ``None`` for set functions that are no criterion of information matrices."""
        return getattr(self.problem.objective, "n_targets", None)

    @property
    def n_max(self) -> int:
        """Size of the largest group that link attacks are taken to leave, ``N - alpha_cs``: on networks a bound."""
        return self.problem.n_robots - self.alpha_cs

    @property
    def plans(self) -> tuple[AssessedPlan, ...]:
        """RATT's, the best one found, and the baselines'."""
        return (self.ratt, self.best, *self.baselines)

    @property
    def recommended(self) -> AssessedPlan:
        """The plan with the best proved worst case; RATT's among equals. ``views`` are of this one."""
        if "worst" in self.views:
            return next(plan for plan in self.plans if plan.planner == self.views["worst"].planner)
        return max(self.plans, key=lambda plan: plan.worst_case.lower)

    @property
    def upper(self) -> float:
        """Proved upper bound on the worst-case value of every plan."""
        return float(max(self.optimum.upper, *(plan.worst_case.lower for plan in self.plans)))

    def share(self, plan: AssessedPlan) -> float:
        """Proved worst-case value of a plan as a share of the best possible; 1 if both are 0."""
        return float(plan.worst_case.lower) / self.upper if self.upper > 0 else 1.0

    @property
    def certified_ratio(self) -> float:
        """RATT's proved worst-case value over the optimum's upper bound; 1 when both are 0."""
        return self.share(self.ratt)

    @property
    def guaranteed_share(self) -> float:
        """The largest share of the optimum that was guaranteed before planning; 0 if nothing was."""
        return max((float(guarantee) for guarantee in self.guarantees.values()), default=0.0)

    def with_certificate(self, certification: Certification) -> Self:
        """The report with its certificate: none of its ends goes beyond what that states."""
        if certification.certificate is None:
            return replace(self, certificate=certification)
        stated = certification.certificate.verified

        def supported(plan: AssessedPlan) -> AssessedPlan:
            """The plan's lower end, no higher than that of the best plan."""
            worst = plan.worst_case
            return replace(plan, worst_case=replace(worst, lower=min(worst.lower, stated.lower)))

        return replace(
            self,
            certificate=certification,
            optimum=self.optimum.within(self.problem, stated.lower, stated.upper),
            ratt=supported(self.ratt),
            best=supported(self.best),
            baselines=tuple(map(supported, self.baselines)),
            views={name: supported(view) for name, view in self.views.items()},
        )


def value_unit(f: SetFunction, units: Sequence[str] | None = None) -> str:
    """The unit of a set function's values, empty if it states none.

    Traces and largest eigenvalues are squares of what they sum: m\N{SUPERSCRIPT TWO} of positions. Of a state that
    mixes units, or that nobody gave units, no unit is claimed.

    ``units`` : (d,) of the state's coordinates, if they are known
    """
    stated: str = getattr(f, "unit", "")
    if stated != "m\N{SUPERSCRIPT TWO}":
        return stated
    if units is None:
        is_position = getattr(f, "dimension", 2) == 2  # in the plane, unless its source says otherwise
        return stated if is_position else "units of the state, squared"
    output = getattr(f, "output", None)
    counts = range(len(units)) if output is None else np.unique(np.nonzero(output)[-1]).tolist()
    squares = list(dict.fromkeys(_square(units[k]) for k in counts))
    return squares[0] if len(squares) == 1 else f"mixed: {', '.join(squares)}"


def _square(unit: str) -> str:
    return f"{unit}\N{SUPERSCRIPT TWO}" if unit.isalpha() else f"({unit})\N{SUPERSCRIPT TWO}"
