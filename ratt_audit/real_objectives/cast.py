"""Cast a real instance in the roles of a claim: RATT's choices, the compared optimum, and their values.

A claim speaks of named elements. On an instance of the planning problem the names get elements:
the baits and greedy robots are those of RATT run with as many baits, ``o(.)`` belongs to an exact
optimum against as many blinded robots, and ``h(.)`` is a robot's individually best element.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import islice, permutations
from typing import TYPE_CHECKING, Any

import flint
import numpy as np

from ratt_audit.appendix.roles import optimum, own_best
from ratt_opt.budget import uninterrupted
from ratt_opt.errors import InputError
from ratt_opt.problem import Problem
from ratt_opt.setfunctions.criteria.logdet import LogDetObjective
from ratt_opt.setfunctions.criteria.trace import TraceObjective
from ratt_opt.solvers.exhaustive import exhaustive_optimum
from ratt_opt.solvers.ratt import bait_and_greedy
from ratt_opt.worst_ratio.rationals import rational

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from ratt_audit.appendix.roles import Team
    from ratt_audit.engine.claim import Claim, Ground, Linear
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.setfunctions.base import SetFunction

__all__ = ["Cast", "ExactCriterion", "Stage", "is_castable"]

MOST_ROBOTS = 4
"""Largest team whose optimum is enumerated: 12 controls each make 20,736 plans, and a robot more twelve times that."""
MOST_ORDERS = 24
"""Baits are alike in the claims: up to this many ways to name them are tried, all of them for four baits."""


@dataclass(frozen=True, slots=True)
class Cast:
    """``elements[i]`` plays the ``i``-th name of the ground set; ``value`` gives f of a set of elements."""

    ground: Ground
    elements: tuple[int, ...]
    value: Callable[[frozenset[int]], Any]

    def of(self, mask: int) -> Any:
        """Value of a set of names."""
        return self.value(frozenset(self.elements[e] for e in self.ground.members(mask)))

    def evaluate(self, expression: Linear, kept: Any) -> Any:
        """Value of a linear expression at ``1 - curvature = kept``; equal values are collected first and cancel."""
        collected: dict[int, tuple[Any, Any]] = {}
        for key, polynomial in expression.terms.items():
            assert isinstance(key, int)
            value = self.of(key)
            powers = (_as(kept, c) * kept**j for j, c in enumerate(polynomial.coefficients) if c)
            before = collected.get(id(value), (0, value))[0]
            collected[id(value)] = (sum(powers, before), value)
        return sum((share * value for share, value in collected.values() if share != 0), kept * 0)

    def scale(self, expression: Linear) -> float:
        """Largest value in the expression, to judge a violation by."""
        return max((float(self.of(key)) for key in expression.terms if isinstance(key, int)), default=0.0)

    def kept(self, *, submodular: bool) -> Any:
        """``1 - curvature`` over the sets in play with one element per robot: the strongest form of a claim."""
        sets = [mask for mask in range(1 << self.ground.n) if self.ground.is_feasible(mask)]
        least: Any = None
        for x in range(self.ground.n):
            bases = (mask for mask in sets if not mask >> x & 1 and self.ground.is_feasible(mask | 1 << x))
            marginals = [self.of(mask | 1 << x) - self.of(mask) for mask in bases]
            largest = self.of(1 << x) if submodular else max(marginals)
            if largest > 0:
                share = min(marginals) / largest
                least = share if least is None or share < least else least
        return 1.0 if least is None else least


def _as(like: Any, number: Any) -> Any:
    """A rational in the arithmetic of ``like``."""
    return float(number) if isinstance(like, float) else rational(number)


def is_castable(claim: Claim, team: Team | None) -> bool:
    """Tell whether the claim speaks of roles and function values only, for a team small enough."""
    if team is None or claim.auxiliaries:
        return False
    return len(team.robots) <= MOST_ROBOTS or len(team.without_optimum) == len(team.robots)


class Stage:
    """An instance (complete graph; its own budgets play no part) with the values and optima already computed."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.single = problem.objective.singletons()
        self._values: dict[frozenset[int], float] = {}
        self._optima: dict[int, IntArray] = {}

    def value(self, elements: frozenset[int]) -> float:
        """Value of a set of elements, in floating point."""
        if elements not in self._values:
            self._values[elements] = float(self.problem.objective(elements))
        return self._values[elements]

    def optimum(self, alpha_s: int) -> IntArray:
        """(N,) elements of an exact optimum against ``alpha_s`` blinded robots."""
        if alpha_s not in self._optima:
            against = Problem(self.problem.objective, self.problem.robot, None, alpha_s, 0)
            self._optima[alpha_s] = uninterrupted(exhaustive_optimum(against)).elements
        return self._optima[alpha_s]

    def casts(self, team: Team) -> Iterator[Cast]:
        """Yield the instance in the team's roles, once for each way to name the baits."""
        problem = self.problem
        plan = bait_and_greedy(problem, len(team.bait))
        bait = sorted(plan.bait, key=lambda robot: (-float(self.single[plan.elements[robot]]), robot))
        greedy = _greedy_order(problem, plan.elements, [i for i in range(problem.n_robots) if i not in plan.bait])
        compared = None
        if len(team.without_optimum) < len(team.robots):
            compared = self.optimum(len(team.bait) if team.greedy else 0)
        for named in islice(permutations(bait), MOST_ORDERS):
            players: dict[str, int] = {}
            for name, robot in zip(team.robots, (*named, *greedy), strict=True):
                choices = problem.choices[robot]
                players[name] = int(plan.elements[robot])
                players[own_best(name)] = int(choices[np.argmax(self.single[choices])])
                if compared is not None:
                    players[optimum(name)] = int(compared[robot])
            yield Cast(team.ground, tuple(players[name] for name in team.ground.names), self.value)


def _greedy_order(problem: Problem, elements: IntArray, robots: list[int]) -> list[int]:
    """The order in which greedy picked ``robots``: a pick is the best of all elements, hence of those picked later."""
    order: list[int] = []
    left = list(robots)
    while left:
        values = problem.objective.extensions(elements[np.array(order, dtype=np.int64)], elements[left])
        order.append(left.pop(int(np.argmax(values))))
    return order


class ExactCriterion:
    """Values of one objective by the definition, on its float64 data read as exact rationals.

    The trace criterion comes out as ``fmpq``; log-det as an ``arb`` ball that contains the true value (a comparison of
    balls is true only when it is certain). Equal values are the same object. Any other objective raises ``InputError``.
    """

    def __init__(self, objective: SetFunction) -> None:
        if not isinstance(objective, TraceObjective | LogDetObjective):
            raise InputError("objective", "must be the trace or the log-det criterion", type(objective).__name__)
        self._trace = isinstance(objective, TraceObjective)
        self._priors = [_rational(prior) for prior in objective.prior]
        self._inverses = [prior.inv() for prior in self._priors]
        self._weights = [flint.fmpq(*float(w).as_integer_ratio()) for w in objective.weights]
        self._information = objective.information
        self._known: dict[frozenset[int], Any] = {}
        self._logarithms: dict[tuple[flint.fmpq, ...], flint.arb] = {}

    def __call__(self, elements: Iterable[int]) -> Any:
        """Value of a set of elements."""
        key = frozenset(elements)
        if key not in self._known:
            self._known[key] = self._trace_value(key) if self._trace else self._logdet_value(key)
        return self._known[key]

    def _posterior(self, j: int, elements: frozenset[int]) -> flint.fmpq_mat:
        posterior = self._inverses[j]
        for e in sorted(elements):
            posterior = posterior + _rational(self._information[e, j])
        return posterior

    def _trace_value(self, elements: frozenset[int]) -> flint.fmpq:
        gains = (
            weight * (_trace(prior) - _trace(self._posterior(j, elements).inv()))
            for j, (weight, prior) in enumerate(zip(self._weights, self._priors, strict=True))
        )
        return sum(gains, flint.fmpq(0))

    def _logdet_value(self, elements: frozenset[int]) -> flint.arb:
        ratios = tuple(self._posterior(j, elements).det() * prior.det() for j, prior in enumerate(self._priors))
        if ratios not in self._logarithms:
            logs = (weight * flint.arb(r).log() for weight, r in zip(self._weights, ratios, strict=True))
            self._logarithms[ratios] = sum(logs, flint.arb(0))
        return self._logarithms[ratios]


def _rational(matrix: FloatArray) -> flint.fmpq_mat:
    return flint.fmpq_mat([[flint.fmpq(*float(value).as_integer_ratio()) for value in row] for row in matrix])


def _trace(matrix: flint.fmpq_mat) -> Any:
    return sum((matrix[i, i] for i in range(matrix.nrows())), flint.fmpq(0))
