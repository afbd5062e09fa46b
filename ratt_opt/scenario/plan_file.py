"""A user's own plan, from JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt._validation import IntArray, check_integer
from ratt_opt.errors import FileFormatError, InputError
from ratt_opt.scenario.files import read_json

if TYPE_CHECKING:
    from pathlib import Path

    from ratt_opt.problem import Problem

__all__ = ["load_plan"]


def load_plan(path: str | Path, problem: Problem) -> IntArray:
    """Read a plan: ``{"elements": [...]}`` with flat element indices, or ``{"controls": [...]}`` with the
    position of each robot's choice among its own controls. Other fields are ignored, so that parts of a
    report (its ``ratt``, ``recommended`` or ``optimum``) can be used as they are; a whole ``report.json`` stands for
    its recommended plan.

    Raises
    ------
    FileFormatError : not strict JSON, neither field, or a choice that its robot does not have.
    """
    document = read_json(path)
    if isinstance(document, dict) and document.get("format") == "ratt-opt report":
        document = document.get("recommended")
    if not isinstance(document, dict) or not ({"elements", "controls"} & document.keys()):
        raise FileFormatError(str(path), 'must be an object with "elements" or "controls"', type(document).__name__)
    try:
        if "elements" in document:
            return problem.check_plan(_list("elements", document["elements"], problem.n_robots))
        controls = _list("controls", document["controls"], problem.n_robots)
        chosen = [
            own[check_integer(f"controls[{i}]", k, low=0, high=len(own) - 1)]
            for i, (own, k) in enumerate(zip(problem.choices, controls, strict=True))
        ]
    except InputError as error:
        raise FileFormatError(f"{path}: {error.argument}", error.rule, error.value) from None
    return np.array(chosen)


def _list(name: str, value: object, length: int) -> list[Any]:
    if not isinstance(value, list) or len(value) != length:
        raise InputError(name, f"must be a list of {length} integers, one per robot", value)
    if any(isinstance(item, (list, dict)) for item in value):
        raise InputError(name, f"must be a list of {length} integers, one per robot", value)
    return value
