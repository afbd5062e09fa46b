"""The results of the main job as plain data: strict JSON, full precision, unknown numbers ``None``."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from ratt_opt._version import CITATION, __version__
from ratt_opt.report.description import describe
from ratt_opt.scenario.problem_record import ProblemRecord

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ratt_opt._validation import IntArray
    from ratt_opt.attack.protection.best_links import BestLinks
    from ratt_opt.attack.protection.criticality import BreakingBudget, Criticality
    from ratt_opt.attack.protection.robot_choice import BestRobots
    from ratt_opt.attack.task import AttackResult
    from ratt_opt.certificates.certification import Certification
    from ratt_opt.curvatures.curvature import Curvature
    from ratt_opt.findings import AssessedPlan, Findings

__all__ = ["FORMAT", "VERSION", "attack_document", "plan_document", "report_document"]

FORMAT = "ratt-opt report"
VERSION = 1
"""Raised when a field changes its meaning or disappears; new fields alone do not raise it. Readers accept every
version up to their own, and take a field that an older file lacks as unknown."""


def report_document(report: Findings) -> dict[str, Any]:
    """Return what ``report.json`` holds: everything that the tables and figures show, and the input they are about."""
    problem = report.problem
    return {
        "format": FORMAT,
        "version": VERSION,
        "software": f"ratt-opt {__version__}",
        "citation": CITATION,
        "created": report.created,
        "seeds": dict(report.seeds),
        "input": _input(report.source),
        **_cast(report),
        "n_robots": problem.n_robots,
        "n_targets": report.n_targets,
        "n_links": len(problem.communication.links),
        "objective": report.objective,
        "unit": report.unit,
        "alpha_s": problem.alpha_s,
        "alpha_c": problem.alpha_c,
        "at_most": problem.at_most,
        "n_max": report.n_max,
        "n_max_upper": report.n_max_upper,
        "n_max_proof": _n_max_proof(report),
        "alpha_cs": report.alpha_cs,
        "ratt": _shared(report, report.ratt),
        "recommended": {"planner": report.recommended.planner, **_shared(report, report.recommended)},
        "optimum": {**_bracket(report), **_shared(report, report.best)},
        "interrupted": report.interrupted,
        "certificate": _certificate(report.certificate),
        "certified_ratio": _number(report.certified_ratio),
        "guarantees": {name: _number(float(value)) for name, value in report.guarantees.items()},
        "hypotheses": {name: list(value.hypotheses) for name, value in report.guarantees.items()},
        "proofs": {name: value.proof for name, value in report.guarantees.items()},
        "inapplicable": dict(report.inapplicable),
        "omitted": dict(report.omitted),
        "remarks": list(report.remarks),
        "guaranteed_share": report.guaranteed_share,
        "baselines": {plan.planner: _shared(report, plan) for plan in report.baselines},
        "views": {name: plan_document(view) for name, view in report.views.items()},
        "seconds": {name: _number(value) for name, value in report.seconds.items()},
        "curvature": _curvature(report.curvature),
        "total_curvature": _curvature(report.total_curvature),
    }


def attack_document(
    objective: str,
    elements: IntArray,
    results: Mapping[str, AttackResult],
    critical: Sequence[Criticality] | None = None,
    budgets: Sequence[BreakingBudget] | None = None,
    *,
    best_links: Mapping[str, BestLinks] | None = None,
    best_robots: BestRobots | None = None,
    params: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """Return the attacks on one plan as JSON-ready values, and what to protect or add, if wanted.

    ``best_links`` : by what is done with them, "protect" and "add"; ``best_robots`` : to protect
    ``params`` : of the exact attack that are not as by default; then also which stages ran, and what each did
    """
    document = {
        "format": "ratt-opt attack",
        "version": VERSION,
        "objective": objective,
        "elements": elements.tolist(),
        "attacks": {name: result.to_dict() for name, result in results.items()},
    }
    if params is not None:
        document["params"] = dict(params)
        document["stages"] = [row.to_dict() for row in results["worst"].stages]
    if critical:
        document["critical"] = [_critical(row) for row in critical]
    if budgets is not None:
        document["breaking_budgets"] = [_budget(row) for row in budgets]
    if best_robots:
        document["best_robots"] = best_robots.to_dict()
    if best_links:
        document["best_links"] = {name: found.to_dict() for name, found in best_links.items()}
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


def plan_document(plan: AssessedPlan) -> dict[str, Any]:
    """Return one plan and its worst case as JSON-ready values."""
    return {
        "elements": plan.elements.tolist(),
        "controls": list(plan.controls),
        "bait": list(plan.bait),
        "worst_case": plan.worst_case.to_dict(),
        "evaluations": plan.evaluations,
        "groups": [sorted(group) for group in plan.groups],
        "best_group": sorted(plan.best_group),
        "posterior": None if plan.posterior is None else plan.posterior.tolist(),
    }


def _bracket(report: Findings) -> dict[str, Any]:
    """The ends of the optimum, and why the search for it stopped."""
    optimum = report.optimum
    return {
        "lower": _number(optimum.lower),
        "upper": _number(report.upper),
        "posterior_gap": None if optimum.posterior_gap is None else float(optimum.posterior_gap),
        "stop": optimum.stop.value,
    }


def _shared(report: Findings, plan: AssessedPlan) -> dict[str, Any]:
    """A plan with what it keeps as a share of the best possible."""
    return {**plan_document(plan), "share": _number(report.share(plan))}


def _input(source: object) -> dict[str, Any] | None:
    """The contents of the input file and the SHA-256 of their canonical JSON; ``None`` if a problem was given."""
    if not isinstance(source, ProblemRecord):
        return None
    return {"sha256": source.digest, "document": source.storable.model_dump(mode="json")}


def _cast(report: Findings) -> dict[str, Any]:
    """Meaning of the indices: robots, targets, elements, links."""
    problem, known = report.problem, describe(report.problem, report.source)
    return {
        "robot_names": list(known.robot_names),
        "target_names": None if known.target_names is None else list(known.target_names),
        "weights": None if known.weights is None else known.weights.tolist(),
        "owners": problem.robot.tolist(),
        "labels": None if known.labels is None else list(known.labels),
        "control_values": None if known.controls is None else known.controls.tolist(),
        "links": [list(link) for link in sorted(problem.communication.links)],
        "protected_robots": sorted(problem.protected_robots),
        "protected_links": [list(link) for link in sorted(problem.protected_links)],
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


def _n_max_proof(report: Findings) -> dict[str, Any] | None:
    """The reason for the smallest largest group, the cut that leaves it, and its certificate."""
    found, proof = report.largest_group, report.cuts_certificate
    if found is None:
        return None
    certificate: dict[str, Any] = {"file": None, "verified": False, "reason": proof.why_not}
    if proof.path is not None and proof.verified is not None:
        proved = proof.verified
        certificate = {"file": proof.path.name, "verified": True, "proof": proved.proof}
        certificate |= {"size": proved.size, "least_links": proved.lower, "network_hash": proved.network_hash}
    cut = [list(link) for link in sorted(found.cut)]
    return {"method": found.method, "reason": found.reason, "cut": cut, "certificate": certificate}


def _curvature(bracket: Curvature | None) -> dict[str, Any] | None:
    if bracket is None:
        return None
    ends = {"lower": _number(bracket.lower), "upper": _number(bracket.upper)}
    return {**ends, "domain": bracket.domain, "stop": bracket.stop.value}


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
