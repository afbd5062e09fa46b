"""Remarks of the report: on the input and the parameters, and on what is left out, with reasons."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._params import changed
from ratt_opt._values import counted
from ratt_opt.budget import Stop
from ratt_opt.main_job.params import QUICK
from ratt_opt.setfunctions.information import InformationObjective

if TYPE_CHECKING:
    from collections.abc import Collection

    from ratt_opt.curvatures.curvature import Curvature
    from ratt_opt.main_job.job_params import JobParams
    from ratt_opt.main_job.result import PlanAssessment
    from ratt_opt.problem import Problem

__all__ = ["omitted_curvatures", "omitted_parts", "remarks_on_data", "remarks_on_params"]


def omitted_parts(baselines: tuple[PlanAssessment, ...], guarantees: str, planners: Collection[str]) -> dict[str, str]:
    """Collect the parts that the report leaves out, with reasons."""
    planned = {plan.planner for plan in baselines}
    omitted = {name: "interrupted" for name in planners if name not in planned}
    if all(plan.planner != "nonrobust_optimum" for plan in baselines):
        omitted["nonrobust_optimum"] = "the best plan without attack was not found and proved in its share of the time"
    if guarantees == "none":
        omitted["guarantees"] = "not asked for"
    return omitted


def omitted_curvatures(guarantees: str, *, k: Curvature | None, c: Curvature | None) -> dict[str, str]:
    """Each of the two curvatures that is ``None``, and why; and whether the other could be narrower."""
    found = k or c
    if guarantees == "none":
        return dict.fromkeys(("curvature", "total_curvature"), "guarantees were not asked for")
    if found is None:
        why = "the criterion falls, or breaks what it states of itself, by more than rounding"
        return dict.fromkeys(("curvature", "total_curvature"), why)
    if k is None:
        omitted = {"curvature": "it is for submodular criteria; total_curvature is given instead"}
    else:
        omitted = {"total_curvature": "the criterion is submodular; curvature is given instead"}
    if guarantees == "quick" and found.stop is Stop.TIME:
        omitted["a narrower curvature"] = f"guarantees are quick: {QUICK.seconds:g} s at most"
    return omitted


def remarks_on_params(params: JobParams) -> tuple[str, ...]:
    """Name the parameters that are not as by default."""
    told = ", ".join(f"{place} = {value}" for place, value in changed(params).items())
    return (f"parameters that are not as by default: {told}",) if told else ()


def remarks_on_data(problem: Problem) -> tuple[str, ...]:
    """Collect remarks on the input: elements and robots without information, and matrices that were mended."""
    f = problem.objective
    if not isinstance(f, InformationObjective):
        return ()
    found = []
    silent = np.all(f.information == 0, axis=(1, 2, 3))
    if silent.any():
        robots = [i for i, own in enumerate(problem.choices) if silent[own].all()]
        none = f"; none of robot {', '.join(map(str, robots))} tells anything: check its sensor" if robots else ""
        if silent.all():
            none = ": no sensor sees any target, so every plan is worth 0"
        found.append(f"{silent.sum()} of {counted(f.n, 'element')} tell nothing about any target{none}")
    if f.repaired:
        mended = f"negative eigenvalues of {f.repaired} of the {f.n * f.n_targets} information matrices were set to 0"
        found.append(f"{mended}: all values are those of the matrices without them")
    return tuple(found)
