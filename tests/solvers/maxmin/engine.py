"""The search for best plans as tests know it: the ways that large teams go, and proofs by what they rest on.

What a search answers is asked of ``solve_maxmin``. This file alone names the engine's modules; so do, beside an inner
part, the tests that compare it with the definition.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt import Attack, MaxMinParams, Stop
from ratt_opt.solvers import exhaustive, ratt
from ratt_opt.solvers.maxmin import adversary, solve
from ratt_opt.solvers.maxmin.covers.cover_search import CoversStage
from ratt_opt.solvers.maxmin.marginal_search import MarginalGainsStage
from ratt_opt.solvers.maxmin.proof import MarginalLeaf
from ratt_opt.solvers.maxmin.restarts import ConcaveTreesStage, RestartedSearch
from ratt_opt.solvers.maxmin.stages import schedule

if TYPE_CHECKING:
    import pytest

    from ratt_opt import MaxMinResult
    from ratt_opt.solvers.maxmin.known import Known
    from tests.ways import Way

__all__ = [
    "BLIND",
    "COVERS_ALONE",
    "EXCHANGED",
    "LISTED",
    "MARGINALS_ALONE",
    "NO_GROUPS",
    "NO_PLANS_LISTED",
    "SMALL_TREES",
    "TRACE_INTERRUPTED",
    "TREES_SOON",
    "UNLISTED",
    "by_marginals",
    "covers",
    "exact_attacks",
    "link_attacks",
    "marginals",
    "open_nodes",
    "trees_begun",
]

NO_PLANS_LISTED: Way = {(exhaustive, "LARGEST_SEARCH"): 0, (MaxMinParams, "few_plans.plans"): 0}
"""Plans are searched, however few they are."""


def _interrupted(*_: object) -> None:
    raise KeyboardInterrupt


TRACE_INTERRUPTED: Way = {(solve, "_solve_as_trace"): _interrupted}
"""The search of coverage as a trace is interrupted as it begins."""
UNLISTED: Way = {(MaxMinParams, "outcomes.robots"): 0}
"""Outcomes are not listed beforehand, as for large teams."""
LISTED: Way = {(MaxMinParams, "outcomes.robots"): 12}
EXCHANGED: Way = {(MaxMinParams, "adversary.small"): 0}
"""Known outcomes are exchanged, as for large teams."""
BLIND: Way = EXCHANGED | {(adversary.Adversary, "_quick_attack"): lambda *_: Attack()}
"""Quick attacks see nothing: only exact ones tell good plans from bad."""
NO_GROUPS: Way = {(MaxMinParams, "small_groups.largest"): 0}
"""Nothing is known of small groups beforehand."""
TREES_SOON: Way = {(MaxMinParams, "restarts.first"): 1, (MaxMinParams, "restarts.nearly"): 0.0}
"""Further trees come soon, as where searches of large teams are long."""
SMALL_TREES: Way = TREES_SOON | {(MaxMinParams, "restarts.later"): 2}


class _RootStage(ConcaveTreesStage):
    """Trees whose root has a bound and which never go on."""

    def begin(self, known: Known) -> RestartedSearch:
        """Begin a search that spends no node."""
        search = RestartedSearch(known)
        search.run = lambda _: Stop.NODES  # type: ignore[method-assign]
        return search


_HOWEVER_MUCH_ROBOTS_SEE: Way = {(MaxMinParams, "depth.unseen"): 0.0}
COVERS_ALONE: Way = _HOWEVER_MUCH_ROBOTS_SEE | {(schedule, "BOUND_STAGES"): (_RootStage(), CoversStage())}
MARGINALS_ALONE: Way = _HOWEVER_MUCH_ROBOTS_SEE | {(schedule, "BOUND_STAGES"): (_RootStage(), MarginalGainsStage())}
"""No other search raises or lowers an upper end, however much robots see."""


def covers(**limits: int) -> Way:
    """Limits of the search by covers: ``covers`` kept, ``recorded`` nodes of a dive."""
    return {(MaxMinParams, f"covers.{name}"): value for name, value in limits.items()}


def marginals(**limits: int) -> Way:
    """Limits of the search by marginal gains."""
    return {(MaxMinParams, f"marginals.{name}"): value for name, value in limits.items()}


def open_nodes(most: int) -> Way:
    """Nodes of a search by values that are kept by their bounds."""
    return {(MaxMinParams, "value_turns.most_open"): most}


def by_marginals(found: MaxMinResult) -> bool:
    """Whether a proof rests on marginal gains."""
    return found.proof is not None and any(isinstance(node, MarginalLeaf) for node in found.proof.tree)


def trees_begun(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The number of nodes at which each further tree begins from now on."""
    begun: list[int] = []

    def begin_next(search: RestartedSearch, plain=RestartedSearch._begin_next) -> None:
        begun.append(search.first.incumbent.budget.nodes)
        plain(search)

    monkeypatch.setattr(RestartedSearch, "_begin_next", begin_next)
    return begun


def link_attacks(asked: object) -> Way:
    """Let a function of the test's own say how many blinded robots the links that may be cut are worth."""
    return {(ratt, "equivalent_sensing_attacks"): asked}


def exact_attacks(attack: object) -> Way:
    """Let plans be attacked by a function of the test's own instead of the exact attack."""
    return {(adversary, "worst_case_attack_unrounded"): attack}
