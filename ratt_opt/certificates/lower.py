"""Proofs that a plan keeps a value under every attack: covers of all attacks by cases.

Built in floating point, decided by the verifier in exact arithmetic. Robots are taken strongest
first, so that the cases in which strong robots see close early.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.attackers.weakest_set.planar_team import PlanarTeam
from ratt_opt.certificates.verifier.work import tell, tick
from ratt_opt.errors import UndecidedError
from ratt_opt.graph.survivor_sizes import forced_group_size

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.problem import Problem
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["ENUMERATED", "lower_proof"]

LARGEST_PLAIN = 12
"""Robots up to which a cover is found sooner than compiled code is loaded."""
LARGEST_TREE = 200_000
"""Most nodes of a tree."""
MOST_CRITERIA = 60_000_000
"""Most criteria of single targets looked at; the verifier looks at half of them, a microsecond or two each."""
NODES_TIMES_PAIRS = 20_000_000
"""Most nodes of an attack tree, times pairs of robots."""
ENUMERATED: dict[str, Any] = {"kind": "enumerated"}
"""Says that the outcomes were enumerated in floating point: not a proof."""
COVERING = "covering all attacks"
"""What is told while a cover is built."""


class _NotClosedError(Exception):
    """The proof is too large, or one of its cases is worth less than the threshold."""


def lower_proof(problem: Problem, elements: IntArray, threshold: float, *, max_nodes: int = LARGEST_TREE) -> Any:
    """Return the record of a proof that the plan keeps ``threshold`` under every attack.

    Parameters
    ----------
    elements : (N,) the plan
    threshold : the value to prove [unit of the objective], a little below the plan's worst case
    max_nodes : node limit of each tree that is tried

    Returns
    -------
    A ``forced_size`` proof where the complete graph allows one, else an ``attack_tree``, else ``ENUMERATED``.
    """
    if problem.communication.is_complete:
        size = forced_group_size(problem.n_robots, problem.alpha_s, problem.alpha_c)
        tree = _attempt(partial(_forced_size_tree, _Cases(problem, elements, threshold), size, max_nodes))
        if tree is not None:
            return {"kind": "forced_size", "size": size, "tree": tree}
    fewer = min(max_nodes, NODES_TIMES_PAIRS // problem.n_robots**2)
    tree = _attempt(_AttackTree(_Cases(problem, elements, threshold), fewer).run)
    return ENUMERATED if tree is None else {"kind": "attack_tree", "tree": tree}


def _attempt(search: Callable[[], list[int] | None]) -> list[int] | None:
    try:
        return search()
    except (_NotClosedError, UndecidedError):
        return None


def _forced_size_tree(cases: _Cases, size: int, max_nodes: int) -> list[int] | None:
    """Compiled for larger teams, where the criterion and its targets have compiled loops."""
    team = PlanarTeam.of(cases.objective, cases.elements)
    if team is None or cases.problem.n_robots <= LARGEST_PLAIN:
        return _ForcedSize(cases, size, max_nodes).run()
    from ratt_opt.certificates.forced_size import forced_size_tree  # compiles

    return forced_size_tree(team, size, cases.threshold, max_nodes)


@dataclass(slots=True)
class _Cases:
    """The plan's robots, strongest first, and whether a set of them is worth the threshold.

    ``looked_at`` : criteria of single targets so far
    """

    problem: Problem
    elements: IntArray
    threshold: float
    looked_at: int = 0

    @property
    def objective(self) -> InformationObjective:
        return self.problem.information_objective

    def order(self) -> list[int]:
        return [int(i) for i in np.argsort(-self.objective.singletons()[self.elements], kind="stable")]

    def start(self) -> FloatArray:
        return self.objective.prior_information

    def extend(self, posterior: FloatArray, robot: int) -> FloatArray:
        return np.asarray(posterior + self.objective.information[self.elements[robot]])

    def enough(self, posterior: FloatArray) -> bool:
        self._count(1)
        return float(self.objective.value(posterior)) >= self.threshold

    def completions_enough(self, posteriors: FloatArray, missing: int) -> bool:
        """Whether the ``missing`` smallest values are worth it on average (see the verifier's leaf -3)."""
        self._count(len(posteriors))
        values = np.sort(self.objective.value(posteriors))
        worth = values[:missing].mean() if self.objective.verifier_averages else values[0]
        return bool(worth >= self.threshold)

    def _count(self, sets: int) -> None:
        tick()
        self.looked_at += sets * self.objective.n_targets
        if self.looked_at > MOST_CRITERIA:
            raise _NotClosedError


class _ForcedSize:
    """Include or exclude robots until the included are worth the threshold or too many are out."""

    def __init__(self, cases: _Cases, size: int, max_nodes: int) -> None:
        self.cases, self.size, self.max_nodes = cases, size, max_nodes

    def run(self) -> list[int]:
        order = self.cases.order()[::-1]
        own = self.cases.objective.information[self.cases.elements[order]]
        tree: list[int] = []
        stack = [(self.cases.start(), 0, 0)]
        while stack:
            tell(COVERING, len(tree))
            posterior, depth, out = stack.pop()
            if out > len(order) - self.size:
                tree.append(-2)
            elif self.cases.enough(posterior):
                tree.append(-1)
            elif (missing := self.size - depth + out) == 0 or len(tree) > self.max_nodes:
                raise _NotClosedError
            elif self.cases.completions_enough(posterior + missing * own[depth:], missing):
                tree.append(-3)
            else:
                tree.append(order[depth])
                stack.append((posterior, depth + 1, out + 1))
                stack.append((self.cases.extend(posterior, order[depth]), depth + 1, out))
        return tree


@dataclass(frozen=True, slots=True)
class _Case:
    """Robots blinded and seeing so far, and mutually separated parts, each with its seeing robots' information."""

    blind: frozenset[int] = frozenset()
    see: frozenset[int] = frozenset()
    parts: tuple[frozenset[int], ...] = ()


class _AttackTree:
    """Decide blinded or not, then the group, robot by robot; place blinded relays only where a case stays open."""

    def __init__(self, cases: _Cases, max_nodes: int) -> None:
        self.cases, self.max_nodes = cases, max_nodes
        self.threat = cases.problem.threat
        self.order = cases.order()
        n = cases.problem.n_robots
        self.linked = np.zeros((n, n), dtype=np.int64)
        self.protected = np.zeros((n, n), dtype=np.bool_)
        for i, j in self.threat.graph.links:
            self.linked[i, j] = self.linked[j, i] = 1
        for i, j in self.threat.protected_links:
            self.protected[i, j] = self.protected[j, i] = True
        self.worth: dict[frozenset[int], bool] = {}

    def run(self) -> list[int]:
        tree: list[int] = []
        stack = [_Case()]
        while stack:
            tick()
            tell(COVERING, len(tree))
            case = stack.pop()
            if self._infeasible(case):
                tree.append(-1)
                continue
            closed = next((p for p, part in enumerate(case.parts) if self._enough(part & case.see)), None)
            if closed is not None:
                tree.append(-2 - closed)
            elif len(tree) > self.max_nodes:
                raise _NotClosedError
            else:
                self._branch(case, tree, stack)
        return tree

    def _branch(self, case: _Case, tree: list[int], stack: list[_Case]) -> None:
        placed = frozenset[int]().union(*case.parts)
        waiting = [i for i in self.order if i in case.see - placed]
        fresh = [i for i in self.order if i not in case.blind | case.see]
        relays = [i for i in self.order if i not in placed]
        if not waiting and fresh:
            i = fresh[0]
            tree.append(2 * i)
            stack.append(_Case(case.blind, case.see | {i}, case.parts))
            stack.append(_Case(case.blind | {i}, case.see, case.parts))
            return
        if not relays:
            raise _NotClosedError
        i = (waiting or relays)[0]
        tree.append(2 * i + 1)
        stack.append(_Case(case.blind, case.see, (*case.parts, frozenset({i}))))
        for p in reversed(range(len(case.parts))):
            joined = (*case.parts[:p], case.parts[p] | {i}, *case.parts[p + 1 :])
            stack.append(_Case(case.blind, case.see, joined))

    def _enough(self, robots: frozenset[int]) -> bool:
        if robots not in self.worth:
            posterior = self.cases.start()
            for i in sorted(robots):
                posterior = self.cases.extend(posterior, i)
            self.worth[robots] = self.cases.enough(posterior)
        return self.worth[robots]

    def _infeasible(self, case: _Case) -> bool:
        """Whether the case is beyond the budgets; a robot in no part loses all links but those to one part."""
        if len(case.blind) > self.threat.alpha_s or case.blind & self.threat.protected_robots:
            return True
        if len(case.parts) < 2:
            return False
        member = np.zeros((len(case.parts), len(self.linked)), dtype=np.int64)
        for p, part in enumerate(case.parts):
            member[p, list(part)] = 1
        free = member.sum(axis=0) == 0
        between = np.triu(member @ self.linked @ member.T, 1).sum()
        counts = (member @ self.linked)[:, free]
        protected = np.triu(member @ self.protected @ member.T, 1).any()
        return bool(protected or between + (counts.sum(axis=0) - counts.max(axis=0)).sum() > self.threat.alpha_c)
