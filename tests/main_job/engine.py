"""The steps of the main job as tests know them; what the job answers is asked of ``bound`` or the command."""

from collections.abc import Callable
from typing import Any

import pytest

from ratt_opt.main_job import bound
from ratt_opt.report import write
from ratt_opt.solvers import ratt

__all__ = ["SEARCHES", "step"]

STEPS = {
    "planning": (bound, "bait_and_greedy"),
    "attacks": (bound, "assess"),
    "optimum": (bound, "solve_maxmin"),
    "curvature": (bound, "total_curvature"),
    "guarantees": (bound, "all_guarantees"),
    "drawing": (write, "plan_figure"),
    "link attacks": (ratt, "bound_soon"),
}
SEARCHES = ["attacks", "optimum", "curvature", "guarantees"]


def step(monkeypatch: pytest.MonkeyPatch, name: str, instead: Callable[[Any], Any]) -> None:
    """Let ``instead(real)`` do a step."""
    module, function = STEPS[name]
    monkeypatch.setattr(module, function, instead(getattr(module, function)))
