"""Proofs that every attack leaves a group worth a threshold: cases over blinded robots and groups, robot by robot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.certificates.plan_sets import COVERING, NotClosedError
from ratt_opt.certificates.verifier.work import tell, tick

if TYPE_CHECKING:
    from ratt_opt.certificates.plan_sets import PlanSets

__all__ = ["AttackTree"]


@dataclass(frozen=True, slots=True)
class _Case:
    """Robots blinded and seeing so far, and mutually separated parts, each with its seeing robots' information."""

    blind: frozenset[int] = frozenset()
    see: frozenset[int] = frozenset()
    parts: tuple[frozenset[int], ...] = ()


class AttackTree:
    """Decide blinded or not, then the group, robot by robot; place blinded relays only where a case stays open."""

    def __init__(self, sets: PlanSets, max_nodes: int) -> None:
        self.sets, self.max_nodes = sets, max_nodes
        self.threat = sets.problem.threat
        self.order = sets.order()
        n = sets.problem.n_robots
        self.linked = np.zeros((n, n), dtype=np.int64)
        self.protected = np.zeros((n, n), dtype=np.bool_)
        for i, j in self.threat.graph.links:
            self.linked[i, j] = self.linked[j, i] = 1
        for i, j in self.threat.protected_links:
            self.protected[i, j] = self.protected[j, i] = True
        self.worth: dict[frozenset[int], bool] = {}

    def run(self) -> list[int]:
        """Return the tree, or raise ``NotClosedError``."""
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
                raise NotClosedError
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
            raise NotClosedError
        i = (waiting or relays)[0]
        tree.append(2 * i + 1)
        stack.append(_Case(case.blind, case.see, (*case.parts, frozenset({i}))))
        for p in reversed(range(len(case.parts))):
            joined = (*case.parts[:p], case.parts[p] | {i}, *case.parts[p + 1 :])
            stack.append(_Case(case.blind, case.see, joined))

    def _enough(self, robots: frozenset[int]) -> bool:
        if robots not in self.worth:
            posterior = self.sets.start()
            for i in sorted(robots):
                posterior = self.sets.extend(posterior, i)
            self.worth[robots] = self.sets.enough(posterior)
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
