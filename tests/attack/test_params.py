"""Extreme parameters of attacks: brackets hold, limits are kept; what nothing could go on with is refused."""

from collections.abc import Callable
from dataclasses import fields, replace
from functools import cache
from typing import Any

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from analysis.faults.moments import Square
from ratt_opt import AttackParams
from ratt_opt.attack.params import AT_LEAST_ONE
from tests.oracles import brute_force_worst_case
from tests.strategies import OBJECTIVES
from tests.watchdog import ends_within

TEMPERATURES = ("hot", "warm", "cold")


@cache
def problem(kind: str) -> ro.Problem:
    rng = np.random.default_rng(13)
    n_robots = 6
    h = rng.normal(size=(n_robots, 2, 1, 3 if kind == "spatial" else 2))
    info = np.swapaxes(h, -1, -2) @ h
    objective = OBJECTIVES["logdet"](np.stack([np.eye(info.shape[-1])] * 2), info)
    if kind == "values":
        objective = Square(rng.random(n_robots))
    graph = nx.cycle_graph(n_robots) if kind in {"network", "values"} else nx.complete_graph(n_robots)
    return ro.Problem(objective, np.arange(n_robots), graph, 2, 3)


@cache
def truth(kind: str) -> float:
    return brute_force_worst_case(problem(kind), np.arange(problem(kind).n_robots))


def least(value: Any, place: str) -> Any:
    if isinstance(value, tuple):
        return value
    if place.startswith("value_annealing.") and place.endswith(TEMPERATURES):
        return 1e-9
    return type(value)(1 if place in AT_LEAST_ONE else 0)


def large(value: Any, _place: str) -> Any:
    return value if isinstance(value, tuple) else type(value)(20 * value + 1)


def extreme(family: str, of: Callable[[Any, str], Any]) -> AttackParams:
    """Parameters whose ``family`` is extreme, and with which small teams are no special case."""
    plain = AttackParams()
    plain = replace(plain, criterion=replace(plain.criterion, small=0))
    own = getattr(plain, family)
    changes = {one.name: of(getattr(own, one.name), f"{family}.{one.name}") for one in fields(own)}
    return replace(plain, **{family: replace(own, **changes)})


@pytest.mark.parametrize("of", [least, large])
@pytest.mark.parametrize("family", [one.name for one in fields(AttackParams)])
def test_brackets_hold_and_limits_are_kept_at_extremes(family, of):
    params = extreme(family, of)
    for kind in ("network", "complete", "spatial", "values"):
        with ends_within(4):
            found = ro.worst_case_attack(problem(kind), np.arange(6), params=params, time_limit=0.1)
        slack = 1e-9 * (1 + abs(truth(kind)))
        assert found.lower <= truth(kind) + slack
        assert found.upper >= truth(kind) - slack


@pytest.mark.parametrize("place", [*AT_LEAST_ONE, *(f"value_annealing.{name}" for name in TEMPERATURES)])
def test_what_no_attack_could_go_on_with_is_refused(place):
    family, name = place.split(".")
    own = getattr(AttackParams(), family)
    with pytest.raises(ro.InputError, match=rf"params.{place} must be .*; got 0"):
        AttackParams(**{family: replace(own, **{name: 0})})
