"""Ways that a search is sent: limits inside the package, for as long as a test runs.

A way is a table ``{(module, name): value}``, or ``{(AttackParams, "family.name"): value}`` of attacks, ``MaxMinParams``
of best plans, that are not given other parameters; each family has its own in its ``engine.py``.
"""

from dataclasses import replace
from typing import Any

import pytest

from ratt_opt import AttackParams, MaxMinParams
from ratt_opt.attack import params as of_attacks
from ratt_opt.solvers.maxmin import params as of_plans

__all__ = ["Way", "go", "with_params"]

Way = dict[tuple[Any, str], Any]
DEFAULTS: dict[Any, Any] = {AttackParams: of_attacks, MaxMinParams: of_plans}
"""Modules that have the parameters of searches that are not given any."""


def go(monkeypatch: pytest.MonkeyPatch, *ways: Way) -> None:
    """Let searches go these ways until the test ends."""
    for way in ways:
        for (module, name), value in way.items():
            if module in DEFAULTS:
                family = DEFAULTS[module]
                monkeypatch.setattr(family, "DEFAULT", with_params(family.DEFAULT, {(module, name): value}))
            else:
                monkeypatch.setattr(module, name, value)


def with_params(params: Any, way: Way) -> Any:
    """Parameters with the values of a way."""
    for (_, place), value in way.items():
        family, name = place.split(".")
        params = replace(params, **{family: replace(getattr(params, family), **{name: value})})
    return params
