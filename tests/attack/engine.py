"""The attack engine as tests know it: searches by name, the ways that large teams go, and watched stages.

What a search answers is asked here, or of ``worst_case_attack``. This file alone names the engine's modules; so do,
beside an inner part, the tests that compare its loops with the definition.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

import ratt_opt as ro
from ratt_opt import AttackParams
from ratt_opt.attack import exact, survey
from ratt_opt.attack import params as parameters
from ratt_opt.attack.annealing import Starts
from ratt_opt.attack.protection import best_links, criticality
from ratt_opt.attack.size_vectors.size_vector_search import SizeVectorSearch, search_size_vectors
from ratt_opt.attack.size_vectors.weak_families import GroupExchanges
from ratt_opt.attack.stages.all_sets import AllSets
from ratt_opt.attack.stages.annealed_values import annealed_attacks
from ratt_opt.attack.stages.branch_and_bound import AttackTree
from ratt_opt.attack.stages.every_attack import enumerate_by_values
from ratt_opt.attack.staging import without_stages
from ratt_opt.attack.task import AttackBracket, AttackMemory, AttackTask, PlanValues
from ratt_opt.attack.team import Links, Team
from ratt_opt.attack.thresholds.dual_prices import ThresholdDecision
from ratt_opt.attack.thresholds.listed_columns import ListedSearch
from ratt_opt.attack.thresholds.pricing import PricingProblem
from ratt_opt.attack.thresholds.threshold_search import ThresholdSearch
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.graph.group_list import groups_of
from ratt_opt.setfunctions.metered import Metered

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    import pytest

    from ratt_opt import Attack, Problem, Stop
    from tests.ways import Way

__all__ = [
    "COMMAND",
    "FAMILIES",
    "LARGE",
    "NO_LISTS",
    "NO_TABLES",
    "WAYS",
    "AttackMemory",
    "Search",
    "annealed_value",
    "exchanges_near",
    "first_attack",
    "open_nodes",
    "searched",
    "share_of_attacks",
    "size_vectors",
    "watch",
    "without_stages",
]


class Once:
    """A bound or a heuristic with the face of a search: it narrows the bracket of its task once."""

    def __init__(self, task: AttackTask, narrow: Callable[[AttackTask], Stop | None]) -> None:
        self.task, self._narrow = task, narrow

    def run(self) -> Stop | None:
        return self._narrow(self.task)


class Sized(SizeVectorSearch):
    """The search by size vectors with its schedule."""

    def run(self) -> Stop:
        return search_size_vectors(self)


def _packed(task: AttackTask) -> Team | None:
    return Team.of(task.problem.objective, task.values.plan, task.params)


def _priced(task: AttackTask) -> ThresholdSearch:
    plan = PricingProblem.of(task.problem.objective, task.values.plan, task.problem.threat, task.params)
    return ThresholdSearch(task, plan, ThresholdDecision(plan))


def _by_list(task: AttackTask) -> ListedSearch:
    groups = groups_of(task.problem.threat)
    assert groups.has_listed(100_000, Budget())
    return ListedSearch(task, _packed(task), groups)


def _annealed_then_priced(task: AttackTask) -> Stop:
    search = _priced(task)
    search.anneal(4)
    return search.run()


SEARCHES = {
    "all sets": AllSets,
    "size vectors": lambda task: Sized(task, _packed(task)),
    "dual prices": _priced,
    "listed columns": _by_list,
    "branch and bound": AttackTree,
    "annealed attacks and dual prices": lambda task: Once(task, _annealed_then_priced),
    "every attack": lambda task: Once(task, enumerate_by_values),
    "annealed values": lambda task: Once(task, annealed_attacks),
}
"""By the names of their stages; each alone, on any team that its theory is about."""


@dataclass
class Search:
    """A search of the attacks on one plan, whole or in pieces, from the bracket that a first attack gives.

    ``first`` : no attack by default
    """

    name: str
    problem: Problem
    plan: object
    first: Attack | None = None

    def __post_init__(self) -> None:
        self.values, attack = PlanValues(self.problem, self.plan), ro.Attack() if self.first is None else self.first
        self.bracket = AttackBracket(attack, self.problem.team_value(self.values.plan, attack), 0.0)
        self._search = None

    def meter(self, budget: Budget, known: dict | None) -> None:
        """Count the values that are asked for in a budget; those ``known`` cost nothing."""
        self.values.objective = Metered(self.problem.objective, budget, known)

    def run(self, budget: Budget) -> Stop | None:
        """Begin, or go on, within a budget; why it stopped."""
        task = AttackTask(self.problem, self.values, self.bracket, budget, params=parameters.DEFAULT)
        try:
            if self._search is None:
                self._search = SEARCHES[self.name](task)
            self._search.task = task
            return self._search.run()
        except OutOfBudget as out:
            return out.stop


def searched(name: str, problem: Problem, plan: object, first: Attack | None = None, **limits):
    """The bracket that a search ends with, the nodes it took, and why it stopped."""
    search, budget = Search(name, problem, plan, first), Budget(**limits)
    stop = search.run(budget)
    return search.bracket, budget.nodes, stop


NO_LISTS = {
    (AttackParams, "set_search.whole"): ((10**9, 0),),
    (AttackParams, "set_search.fewest"): 1,
    (AttackParams, "set_search.most"): 1,
}
"""Hardly any search in depth of sets of one size, so that bounds and branches decide."""
FAMILIES = {(AttackParams, "largest_groups.few"): 0}
"""All families of a vector of sizes are searched at once."""
NO_TABLES = {
    (AttackParams, "all_sets.valued"): 0,
    (AttackParams, "all_sets.enumerated"): 0,
}
"""Sets of robots are too many to be looked at."""
LARGE = NO_TABLES | {(AttackParams, "criterion.small"): 0}
"""Small teams are attacked as large ones are."""
COMMAND = {
    "attack_survey": survey,
    "criticality_ranking": criticality,
    "breaking_budgets": criticality,
    "links_to_protect": best_links,
    "links_to_add": best_links,
}
"""What the command ``attack`` asks for, in this order, and where it is."""
WAYS = {
    "listed columns": {},
    "dual prices": {(AttackParams, "listed.most"): 0, (AttackParams, "listed.brief"): 0},
    "dense": {(AttackParams, "criterion.dense"): 0.0},
    "no lists": NO_LISTS | {(AttackParams, "size_vectors.alike"): 0.0},
    "families": FAMILIES,
}
"""Which stages decide, where it is not what the team is like that says so."""


def size_vectors(most: int) -> Way:
    """Vectors of sizes that are searched."""
    return {(AttackParams, "size_vectors.most_vectors"): most}


def open_nodes(most: int) -> Way:
    """Nodes of branch and bound that are kept by their bounds."""
    return {(AttackParams, "branching.most_open"): most}


def share_of_attacks(share: float) -> Way:
    """Share of the time that the first attacks have where links are chosen."""
    return {(AttackParams, "protection.links"): share}


def first_attack(monkeypatch: pytest.MonkeyPatch, instead: Callable) -> None:
    """Let ``instead(real)`` find the attack that a search begins with."""
    monkeypatch.setattr(exact, "bounded_rational_attack", instead(exact.bounded_rational_attack))


def exchanges_near(monkeypatch: pytest.MonkeyPatch, instead: Callable) -> None:
    """Let ``instead`` exchange robots of known groups."""
    monkeypatch.setattr(GroupExchanges, "near", instead)


def watch(monkeypatch: pytest.MonkeyPatch, name: str, called: Callable) -> None:
    """Let ``called(search, run)`` run the stages of a name; ``run(search)`` is what they are otherwise."""
    for table in ("CRITERION_STAGES", "VALUE_STAGES"):
        monkeypatch.setattr(exact, table, _watched(getattr(exact, table), name, called))


def _watched(table: Sequence, name: str, called: Callable) -> list:
    def one(stage):
        if stage.name != name:
            return stage
        watched = copy(stage)
        watched.run = lambda search: called(search, stage.run)
        return watched

    return [one(stage) for stage in table]


def annealed_value(problem: Problem, plan: object, seed: int) -> float:
    """What one annealed attack leaves, from a start that the engine does not make."""
    team = Team.of(problem.objective, np.asarray(plan))
    return Starts(team, Links.of(problem.threat), problem.threat, team.params.annealing, seed=seed).next(Budget()).value


def add_stage(monkeypatch: pytest.MonkeyPatch, stage: object, after: str) -> None:
    """List a stage of a criterion's schedule after the stage of a name."""
    names = [listed.name for listed in exact.CRITERION_STAGES]
    at = names.index(after) + 1
    monkeypatch.setattr(exact, "CRITERION_STAGES", (*exact.CRITERION_STAGES[:at], stage, *exact.CRITERION_STAGES[at:]))
