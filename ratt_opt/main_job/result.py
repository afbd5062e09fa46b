"""What the main job found: every plan with its worst case, the bracket, the guarantees, the proof."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attackers.criticality import BreakingBudget, Criticality
    from ratt_opt.attackers.task import AttackResult
    from ratt_opt.bounds.guarantees import Guarantee
    from ratt_opt.certificates.write import Certification
    from ratt_opt.curvatures.curvature import Curvature
    from ratt_opt.problem import Attack, Problem
    from ratt_opt.solvers.result import MaxMinResult

__all__ = ["FORMAT", "VERSION", "BoundReport", "PlanAssessment", "attack_document"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class PlanAssessment:
    """One planner's plan and its worst case; equal to another that says the same.

    ``elements`` : (N,) flat element indices; ``controls`` : their positions among each robot's own elements; ``bait`` :
    RATT's bait robots, empty for other planners. ``groups`` : the connected groups that the worst attack leaves;
    ``best_group`` : the robots that still see in the one whose value is the team's; ``posterior`` : (M, d, d)
    covariances they leave, ``None`` for set functions that are no criterion of information matrices.
    """

    name: str
    elements: IntArray
    controls: tuple[int, ...]
    bait: tuple[int, ...]
    worst_case: AttackResult
    evaluations: int
    groups: tuple[frozenset[int], ...]
    best_group: frozenset[int]
    posterior: FloatArray | None

    def to_dict(self) -> dict[str, Any]:
        """The plan as plain data, as ``report.json`` has it."""
        return {
            "elements": self.elements.tolist(),
            "controls": list(self.controls),
            "bait": list(self.bait),
            "worst_case": _worst_case(self.worst_case),
            "evaluations": self.evaluations,
            "groups": [sorted(group) for group in self.groups],
            "best_group": sorted(self.best_group),
            "posterior": None if self.posterior is None else self.posterior.tolist(),
        }

    def __repr__(self) -> str:
        return f"PlanAssessment({self.name}, keeps {self.worst_case.lower:.8g} to {self.worst_case.upper:.8g})"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, PlanAssessment):
            return NotImplemented
        return (self.name, self.to_dict()) == (other.name, other.to_dict())

    def __hash__(self) -> int:
        return hash((self.name, self.controls))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class BoundReport:
    """What to do now, the worst that can follow, and how far that is from the best possible.

    Claims, all in floating point unless a certificate says more: each plan's worst case lies in its bracket;
    ``optimum.lower <= Phi* <= optimum.upper``; RATT's plan keeps at least ``certified_ratio`` of ``Phi*``. ``best`` is
    the plan the search for the optimum found. ``curvature`` is given for submodular criteria (log-det),
    ``total_curvature`` for the others. ``inapplicable`` : the guarantees that do not apply here, and why.
    ``certificate`` : the verified proof file of ``optimum``, or why there is none. ``seconds`` : wall time of each
    step.

    Two reports are equal when they say the same, whatever time it took.
    """

    problem: Problem
    alpha_cs: int
    ratt: PlanAssessment
    baselines: tuple[PlanAssessment, ...]
    optimum: MaxMinResult
    best: PlanAssessment
    curvature: Curvature | None
    total_curvature: Curvature | None
    guarantees: Mapping[str, Guarantee]
    inapplicable: Mapping[str, str]
    certificate: Certification
    seconds: Mapping[str, float]

    @property
    def objective(self) -> str:
        """Name of the criterion, or the class of a set function that has none."""
        f = self.problem.objective
        return getattr(f, "name", "") or type(f).__name__

    @property
    def unit(self) -> str:
        """Unit of the objective; empty where none is stated."""
        return getattr(self.problem.objective, "unit", "")

    @property
    def n_targets(self) -> int | None:
        """Number of targets M; ``None`` for set functions that are no criterion of information matrices."""
        return getattr(self.problem.objective, "n_targets", None)

    @property
    def n_max(self) -> int:
        """Size of the largest group that link attacks are taken to leave: ``N - alpha_cs``."""
        return self.problem.n_robots - self.alpha_cs

    @property
    def plans(self) -> tuple[PlanAssessment, ...]:
        """RATT's, the best one found, and the baselines'."""
        return (self.ratt, self.best, *self.baselines)

    @property
    def recommended(self) -> PlanAssessment:
        """The plan with the best proved worst case; RATT's among equals."""
        return max(self.plans, key=lambda plan: plan.worst_case.lower)

    @property
    def upper(self) -> float:
        """Proved upper bound on what any plan can keep."""
        return float(max(self.optimum.upper, *(plan.worst_case.lower for plan in self.plans)))

    def share(self, plan: PlanAssessment) -> float:
        """What a plan keeps at least, as a share of the best possible; 1 when both are 0."""
        return float(plan.worst_case.lower) / self.upper if self.upper > 0 else 1.0

    @property
    def certified_ratio(self) -> float:
        """RATT's proved worst-case value over the optimum's upper bound; 1 when both are 0."""
        return self.share(self.ratt)

    @property
    def guaranteed_share(self) -> float:
        """The largest share of the optimum that was guaranteed before planning; 0 where nothing was."""
        return max((float(guarantee) for guarantee in self.guarantees.values()), default=0.0)

    def to_dict(self) -> dict[str, Any]:
        """The report as plain data: all that tables and figures show but the scenario; unknown numbers are ``None``."""
        problem, optimum = self.problem, self.optimum
        return {
            "format": FORMAT,
            "version": VERSION,
            "n_robots": problem.n_robots,
            "n_targets": self.n_targets,
            "n_links": len(problem.communication.links),
            "objective": self.objective,
            "unit": self.unit,
            "alpha_s": problem.alpha_s,
            "alpha_c": problem.alpha_c,
            "n_max": self.n_max,
            "alpha_cs": self.alpha_cs,
            "ratt": _shared(self, self.ratt),
            "recommended": {"planner": self.recommended.name, **_shared(self, self.recommended)},
            "optimum": {
                "lower": _number(optimum.lower),
                "upper": _number(self.upper),
                "posterior_gap": None if optimum.posterior_gap is None else float(optimum.posterior_gap),
                "stop": optimum.stop.value,
                **_shared(self, self.best),
            },
            "certificate": _certificate(self.certificate),
            "certified_ratio": _number(self.certified_ratio),
            "guarantees": {name: _number(float(value)) for name, value in self.guarantees.items()},
            "hypotheses": {name: list(value.hypotheses) for name, value in self.guarantees.items()},
            "inapplicable": dict(self.inapplicable),
            "guaranteed_share": self.guaranteed_share,
            "baselines": {plan.name: _shared(self, plan) for plan in self.baselines},
            "seconds": {name: _number(value) for name, value in self.seconds.items()},
            "curvature": _curvature(self.curvature),
            "total_curvature": _curvature(self.total_curvature),
        }

    def __repr__(self) -> str:
        best = f"the best plan keeps {self.optimum.lower:.8g} to {self.upper:.8g}"
        return f"BoundReport({self.objective}, {self.problem.n_robots} robots, {best}, {self.recommended!r})"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, BoundReport):
            return NotImplemented
        return self.to_dict() | {"seconds": None} == other.to_dict() | {"seconds": None}

    __hash__ = None  # type: ignore[assignment]  # equal reports may hold different, unhashable mappings


FORMAT = "ratt-opt report"
VERSION = 1
"""Raised when a field changes its meaning or disappears; new fields alone do not raise it."""


def attack_document(
    objective: str,
    elements: IntArray,
    results: Mapping[str, AttackResult],
    critical: Sequence[Criticality] | None = None,
    budgets: Sequence[BreakingBudget] | None = None,
) -> dict[str, Any]:
    """Return the attacks on one plan as JSON-ready values, and what to protect where that was asked for."""
    document = {
        "format": "ratt-opt attack",
        "version": VERSION,
        "objective": objective,
        "elements": elements.tolist(),
        "attacks": {name: _worst_case(result) for name, result in results.items()},
    }
    if critical:
        document["critical"] = [_critical(row) for row in critical]
    if budgets is not None:
        document["breaking_budgets"] = [_budget(row) for row in budgets]
    return document


def _critical(row: Criticality) -> dict[str, Any]:
    target = {"robot": row.target} if isinstance(row.target, int) else {"link": list(row.target)}
    return {**target, "loss": row.loss, "gain_lower": row.gain_lower, "gain_upper": row.gain_upper}


def _attack(attack: Attack) -> dict[str, Any]:
    return {"sensing": sorted(attack.sensing), "links": [list(link) for link in sorted(attack.links)]}


def _budget(row: BreakingBudget) -> dict[str, Any]:
    budgets = {"alpha_s": row.alpha_s, "alpha_c": row.alpha_c}
    return {**budgets, "value": row.value, **_attack(row.attack), "proved": row.is_proved}


def _shared(report: BoundReport, plan: PlanAssessment) -> dict[str, Any]:
    """A plan with what it keeps as a share of the best possible."""
    return {**plan.to_dict(), "share": _number(report.share(plan))}


def _worst_case(result: AttackResult) -> dict[str, Any]:
    bracket = {"lower": _number(result.lower), "upper": _number(result.upper)}
    return {**bracket, **_attack(result.attack), "stop": result.stop.value}


def _certificate(given: Certification) -> dict[str, Any]:
    """The verifier's verdict, or why there is none."""
    proof = given.certificate
    if proof is None:
        return {"file": None, "verified": False, "reason": given.why_not}
    found = proof.verified
    return {
        "file": proof.path.name,
        "verified": True,
        "claim": {"lower": found.lower, "upper": found.upper},
        "lower_proved": found.lower_proved,
        "lower_method": found.lower_method,
        "arithmetic": found.arithmetic,
        "problem_hash": found.problem_hash,
        "bytes": proof.size,
    }


def _curvature(bracket: Curvature | None) -> dict[str, Any] | None:
    if bracket is None:
        return None
    return {"lower": _number(bracket.lower), "upper": _number(bracket.upper), "domain": bracket.domain}


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
