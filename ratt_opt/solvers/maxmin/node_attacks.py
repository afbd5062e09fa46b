"""Attacks on all plans of a node at once: outcomes that leave few groups a chance, whatever is chosen there.

An outcome hurts a node if none, or hardly any, of its groups can be above the level. What a group can reach is no
sum over its robots, so stand-ins are attacked, each robot with

- what its elements show on average: an outcome that hurts such a team hurts most plans of the node;
- of each target what its best element for that target shows: an outcome that hurts even those closes the node.

Exchanges find such outcomes among families of groups of the sizes that an attack can leave. They are no claims: they
enter the pool, and what they prove is derived as for any other.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.size_vectors.weak_families import GroupExchanges
from ratt_opt.attack.team import Team
from ratt_opt.graph.survivor_sizes import first_non_dominated_sizes
from ratt_opt.setfunctions.information import triangles

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.budget import Budget
    from ratt_opt.graph.survivor_sizes import Sizes
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.maxmin.elements import Choices
    from ratt_opt.solvers.maxmin.outcome_pool import OutcomePool

__all__ = ["NodeAttacks"]

MOST_VECTORS = 100
"""Vectors of sizes among which promising ones are sought."""
PROMISING, OTHERS = 4, 1
"""Vectors tried at a node: those whose families were the weakest when they were tried last, and others in turn. Not
tuned: all vectors at every node would take several times as long at 30 robots."""
SHAKEN, SHAKES = 2, 6
"""Vectors whose family is shaken, and how often: a tenth of a millisecond each at 20 robots."""


class NodeAttacks:
    """Finds outcomes for nodes of one problem's search, as far as the budget lasts."""

    def __init__(self, problem: Problem, pool: OutcomePool, team: Team, budget: Budget) -> None:
        threat = problem.threat
        sizes = first_non_dominated_sizes(problem.n_robots, threat.n_blinded, threat.alpha_c)
        self._vectors = [one for one in sizes[:MOST_VECTORS] if len(one) > 1]
        self._pool, self._team, self._budget = pool, team, budget
        information = problem.information_objective.information
        self._information, self._traces = triangles(information), np.trace(information, axis1=-2, axis2=-1)
        self._must = np.zeros(problem.n_robots, dtype=np.bool_)
        self._last = dict.fromkeys(self._vectors, -np.inf)

    @classmethod
    def of(cls, problem: Problem, pool: OutcomePool, budget: Budget) -> NodeAttacks | None:
        """``None`` if robots or links differ to the adversary, all outcomes are known, or loops are not compiled."""
        if pool.complete or not problem.threat.is_symmetric:
            return None
        team = Team.of(problem.objective, np.array([choice[0] for choice in problem.choices]))
        return None if team is None else cls(problem, pool, team, budget)

    def learn(self, choices: Choices, level: float) -> bool:
        """Add an outcome under which each stand-in is below the level; whether a new one was found."""
        known = len(self._pool)
        for information in (self._best(choices), self._average(choices)):
            if not self._vectors or self._budget.is_over:
                break
            outcome, value = self._weakest(Team(self._team.objective, self._team.prior, information))
            if value < level:
                self._pool.add_outcome(outcome)
        return len(self._pool) > known

    def _average(self, choices: Choices) -> FloatArray:
        return np.array([self._information[choice].mean(axis=0) for choice in choices])

    def _best(self, choices: Choices) -> FloatArray:
        targets = np.arange(self._traces.shape[1])
        return np.array([self._information[choice[self._traces[choice].argmax(axis=0)], targets] for choice in choices])

    def _weakest(self, team: Team) -> tuple[tuple[frozenset[int], ...], float]:
        """The outcome found that leaves a team least, and what it leaves."""
        families = []
        for sizes in self._next_vectors():
            family = GroupExchanges(team, sizes, self._must)
            family.weakest(self._budget)
            families.append(family)
        for family in sorted(families, key=lambda family: family.value)[:SHAKEN]:
            family.shake(SHAKES, self._budget)
        for family in families:
            self._last[family.sizes] = family.value
        best = min(families, key=lambda family: family.value)
        return tuple(sorted(best.groups(), key=min)), best.value

    def _next_vectors(self) -> list[Sizes]:
        """The most promising vectors, all those not tried yet first; the others take turns."""
        promising = sorted(self._vectors, key=self._last.__getitem__)[:PROMISING]
        others = [sizes for sizes in self._vectors if sizes not in promising][:OTHERS]
        for sizes in others:
            self._vectors.remove(sizes)
            self._vectors.append(sizes)
        return [*promising, *others]
