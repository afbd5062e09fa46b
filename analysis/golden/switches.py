"""Parts of the engine that can be left out to see what each is worth; brackets stay true without any of them."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import Any
from unittest.mock import patch

from analysis.schedule import TABLES
from ratt_opt.attack import params as parameters
from ratt_opt.attack.params.least_sets import SetSearchParams
from ratt_opt.attack.staging import without_stages
from ratt_opt.attack.thresholds.dual_prices import ThresholdDecision
from ratt_opt.attack.thresholds.threshold_search import Answer, Threshold
from ratt_opt.solvers.maxmin import params as plan_parameters
from ratt_opt.solvers.maxmin.adversary import Adversary, PlanIndependentAttacks
from ratt_opt.solvers.maxmin.frontier import Backjumps
from ratt_opt.solvers.maxmin.params import DivisionParams, LevelParams
from ratt_opt.solvers.maxmin.restarts import RestartedSearch
from ratt_opt.solvers.maxmin.small_groups import SmallGroups
from ratt_opt.solvers.maxmin.stages.schedule import BOUND_STAGES, PLAN_STAGES
from ratt_opt.solvers.maxmin.winners import GroupProofs

__all__ = ["ATTACK_SWITCHES", "PLAN_SWITCHES", "without"]

NEEDED = {"concave trees", "thresholds", "nobody left", "single robots", "size vectors"}
"""Stages without which nothing is left to compare."""
Patches = tuple[tuple[Any, str, Any], ...]


def _gives(value: Any) -> Any:
    return lambda *_, **__: value


def _attacked(**params: Any) -> Patches:
    return ((parameters, "DEFAULT", parameters.AttackParams(**params)),)


def _planned(**params: Any) -> Patches:
    return ((plan_parameters, "DEFAULT", plan_parameters.MaxMinParams(**params)),)


STAGE_NAMES = dict.fromkeys(
    stage.name for kind in ("criterion", "sizes") for stage in TABLES[kind] if stage.name not in NEEDED
)
BOUNDS: dict[str, Patches] = {
    "pricing: annealed": ((ThresholdDecision, "_cheap", _gives([])),),
    "enumerated columns": ((ThresholdDecision, "_cover", _gives(Answer(verdict=Threshold.OPEN))),),
    "outer polytopes of several robots": _attacked(set_search=SetSearchParams(heavy=((10**9, 1),))),
    "search of sets in depth": _attacked(set_search=SetSearchParams(whole=((10**9, 0),), fewest=1, most=1)),
}
"""Patches that switch off one part of the attack each."""
PLAN_STAGE_NAMES = [*(stage.name for stage in BOUND_STAGES), *(stage.name for stage in PLAN_STAGES)]
PLAN_SWITCHES: dict[str, Patches] = {
    **{name: () for name in PLAN_STAGE_NAMES if name not in NEEDED},
    "backjumps": ((Backjumps, "follow", _gives(None)),),
    "groups closed for all plans": ((GroupProofs, "find", _gives(None)),),
    "small groups": ((SmallGroups, "narrow", lambda _search, node, _level: node),),
    "exchanges next to known outcomes": ((Adversary, "_learn_near", _gives(False)),),
    "lasting attacks": ((PlanIndependentAttacks, "of", lambda _problem, attack: attack),),
    "dividing by what cuts lose": _planned(division=DivisionParams(flat=float("inf"))),
    "levels above the best plan": _planned(levels=LevelParams(shares=(0.0,))),
    "further trees": ((RestartedSearch, "_is_given_up", _gives(False)),),
}
"""Patches that switch off one part of the search for best plans each; stages are left out by their names."""
ATTACK_SWITCHES = [*STAGE_NAMES, *BOUNDS]
"""Names of what can be left out of attacks: stages, then bounds."""


@contextmanager
def without(name: str) -> Iterator[None]:
    """Leave one part out; any other name leaves out nothing."""
    with ExitStack() as stack:
        stack.enter_context(without_stages(name))
        for owner, attribute, value in (BOUNDS | PLAN_SWITCHES).get(name, ()):
            stack.enter_context(patch.object(owner, attribute, value))
        yield
