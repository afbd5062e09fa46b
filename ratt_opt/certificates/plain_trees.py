"""Trees for criteria that the compiled loops do not have, such as those of an output of the state: small teams.

Without dual prices: every group that an attack may leave is listed, with how many of its robots are blinded at least.
"""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.certificates.plan_sets import COVERING, NotClosedError
from ratt_opt.certificates.verifier.work import tell, tick

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import FloatArray
    from ratt_opt.certificates.plan_sets import PlanSets

__all__ = ["LARGEST_TEAM", "PlainTrees"]

LARGEST_TEAM = 12
"""Robots whose groups are listed one by one."""


class PlainTrees:
    """Trees of one plan and threshold; ``listed`` : masks of groups, and how many of each are blinded at least."""

    def __init__(self, sets: PlanSets, max_nodes: int) -> None:
        self.sets, self.threat, self.max_nodes = sets, sets.problem.threat, max_nodes
        self.own = sets.objective.information[sets.elements]
        self.tree: list[Any] = []
        self.listed: list[tuple[int, int]] = []

    def over_sets(self, size: int) -> list[Any]:
        """Any ``size`` robots are worth the threshold, the weakest first.

        Raises
        ------
        NotClosedError : some are not, or the tree is too large.
        """
        self.tree = []
        singles = self.sets.objective.singletons()[self.sets.elements]
        self._sets(self.sets.start(), np.argsort(singles, kind="stable").tolist(), size)
        return self.tree

    def over_groups(self) -> list[Any]:
        """Every group is listed, closed, or beyond the budgets; raises ``NotClosedError`` if the tree is too large."""
        self.tree, self.listed = [], []
        self._groups([], [])
        return self.tree

    def _write(self, node: object) -> None:
        tick()
        tell(COVERING, len(self.tree))
        if len(self.tree) > self.max_nodes:
            raise NotClosedError
        self.tree.append(node)

    def _sets(self, posterior: FloatArray, rest: Sequence[int], size: int) -> None:
        """Any ``size`` of ``rest`` bring a set to the threshold."""
        if len(rest) < size:
            self._write("budget")
        elif size == 0:
            if not self.sets.enough(posterior):
                raise NotClosedError
            self._write("worth")
        elif self.sets.average_enough(self.sets.values(posterior + size * self.own[list(rest)]), size):
            self._write("copies")
        else:
            self._write({"sense": rest[0]})
            self._sets(self.sets.extend(posterior, rest[0]), rest[1:], size - 1)
            self._sets(posterior, rest[1:], size)

    def _groups(self, inside: list[int], outside: list[int]) -> None:
        robot = len(inside) + len(outside)
        if not self._may_be_left(inside, outside):
            self._write("budget")
        elif robot < len(self.own):
            self._write({"inside": robot})
            self._groups([*inside, robot], outside)
            self._groups(inside, [*outside, robot])
        elif inside:
            self._decided(inside)
        else:
            self._write("listed")  # nobody is a group

    def _may_be_left(self, inside: list[int], outside: list[int]) -> bool:
        leaving = {(min(i, j), max(i, j)) for i in inside for j in outside} & self.threat.graph.links
        return len(leaving) <= self.threat.alpha_c and not leaving & self.threat.protected_links

    def _decided(self, inside: list[int]) -> None:
        """One group: show that it is worth the threshold, or list it."""
        safe = [i for i in inside if i in self.threat.protected_robots]
        free, posterior = [i for i in inside if i not in safe], self.sets.start()
        for i in safe:
            posterior = self.sets.extend(posterior, i)
        most = min(self.threat.n_blinded, len(free))
        blinded = next((b for b in range(most + 1) if self._some_are_below(posterior, free, len(free) - b)), None)
        if blinded is None:
            self._sets(posterior, free, len(free) - most)
            return
        if blinded:
            self._write({"blinded": blinded})
            self._sets(posterior, free, len(free) - blinded + 1)
        self._write("listed")
        self.listed.append((sum(1 << i for i in inside), blinded))

    def _some_are_below(self, posterior: FloatArray, robots: list[int], size: int) -> bool:
        chosen = [list(part) for part in combinations(robots, size)]
        posteriors = np.array([posterior + self.own[part].sum(axis=0) for part in chosen])
        return bool((self.sets.values(posteriors) < self.sets.threshold).any())
