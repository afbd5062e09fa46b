"""The bound report as a strict JSON document (``report.json``)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ratt_opt._validation import IntArray
    from ratt_opt.attackers.breaking_budgets import BreakingBudget
    from ratt_opt.attackers.criticality import Criticality
    from ratt_opt.attackers.result import AttackResult
    from ratt_opt.certificates.write import Certification
    from ratt_opt.curvatures.curvature import Curvature
    from ratt_opt.main_job import BoundReport, PlanAssessment

__all__ = ["FORMAT", "VERSION", "attack_document", "report_document"]

FORMAT = "ratt-opt report"
VERSION = 1
"""Raised when a field changes its meaning or disappears; new fields alone do not raise it."""


def report_document(report: BoundReport) -> dict[str, Any]:
    """Return the report as JSON-ready values: full precision, unknown numbers as ``None``."""
    problem = report.problem
    document: dict[str, Any] = {
        "format": FORMAT,
        "version": VERSION,
        "n_robots": problem.n_robots,
        "n_targets": report.n_targets,
        "objective": report.objective,
        "alpha_s": problem.alpha_s,
        "alpha_c": problem.alpha_c,
        "n_max": report.n_max,
        "alpha_cs": report.alpha_cs,
        "ratt": _assessment(report.ratt),
        "recommended": {"planner": report.recommended.name, **_assessment(report.recommended)},
        "optimum": {
            "lower": _number(report.optimum.lower),
            "upper": _number(report.upper),
            "posterior_gap": report.optimum.posterior_gap,
            "stop": report.optimum.stop.value,
            **_assessment(report.best),
        },
        "certificate": _certificate(report.certificate),
        "certified_ratio": _number(report.certified_ratio),
        "guarantees": {name: _number(float(value)) for name, value in report.guarantees.items()},
        "baselines": {plan.name: {"worst_case": _worst_case(plan.worst_case)} for plan in report.baselines},
        "seconds": {name: _number(value) for name, value in report.seconds.items()},
    }
    for name in ("curvature", "total_curvature"):
        bracket = getattr(report, name)
        document[name] = None if bracket is None else _curvature(bracket)
    return document


def attack_document(
    objective: str,
    elements: IntArray,
    results: Mapping[str, AttackResult],
    critical: Sequence[Criticality] = (),
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


def _budget(row: BreakingBudget) -> dict[str, Any]:
    return {
        "alpha_s": row.alpha_s,
        "alpha_c": row.alpha_c,
        "value": row.value,
        "sensing": sorted(row.attack.sensing),
        "links": [list(link) for link in sorted(row.attack.links)],
        "proved": row.is_proved,
    }


def _assessment(plan: PlanAssessment) -> dict[str, Any]:
    return {
        "elements": plan.elements.tolist(),
        "controls": list(plan.controls),
        "bait": list(plan.bait),
        "worst_case": _worst_case(plan.worst_case),
    }


def _worst_case(result: AttackResult) -> dict[str, Any]:
    return {
        "lower": _number(result.lower),
        "upper": _number(result.upper),
        "sensing": sorted(result.attack.sensing),
        "links": [list(link) for link in sorted(result.attack.links)],
        "stop": result.stop.value,
    }


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


def _curvature(bracket: Curvature) -> dict[str, Any]:
    return {"lower": _number(bracket.lower), "upper": _number(bracket.upper), "domain": bracket.domain}


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None
