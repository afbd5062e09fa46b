"""A lower bound on the heaviest group of unblinded robots, by a linear program over links with tree inequalities.

Let ``x[e]`` say that link e is cut, ``b[v]`` that robot v is blinded, and ``a[v] >= 0`` be weights, 1 for the number of
robots. For a tree of links with root r, the group of r keeps every robot v of the tree that sees and whose path to r is
whole:

    sum over v of a[v] (1 - b[v] - sum of x[e] on the path from r to v)  <=  weight of the unblinded robots of r's
    group.

The program asks for the x and b within the budgets that make the largest left side least; its inequalities come from
shortest-path trees. What it says is not taken: for any multipliers ``y >= 0`` of the inequalities an attack leaves a
group of at least their mean left side, which is least if the attack takes the links and the robots of the largest
coefficients. That is computed in integers, so weights are integers too.

Source: spreading metrics; Even, Naor, Rao and Schieber, Journal of the ACM 47 (2000), here for cuts within a budget.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import ceil
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.graph.params import TreeParams
from ratt_opt.highs import LinearProgram, rows_of

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.graph.threat import Threat

__all__ = ["TREES", "Tree", "TreeProgram", "forced_size", "forced_size_soon", "forced_weight"]

TREES = "tree inequalities of a linear program, recomputed from their multipliers"

SCALE = 2.0**24
"""Multipliers become integers in these units: the sums below stay under 2^63."""
DEFAULT = TreeParams()
"""Parameters of programs that are not given any."""


def forced_size(threat: Threat, budget: Budget, enough: int, params: TreeParams = DEFAULT) -> int:
    """A number of unblinded robots that every attack leaves in some group; looks no further than ``enough``.

    What was found out about the last few threats is kept, and gone on with.
    """
    return _size_program(threat, params).run(budget, enough)


@lru_cache(maxsize=8)
def _size_program(threat: Threat, params: TreeParams) -> TreeProgram:
    return TreeProgram(threat, np.ones(threat.graph.n_robots, dtype=np.int64), params)


def forced_size_soon(threat: Threat, budget: Budget, params: TreeParams = DEFAULT) -> int:
    """:func:`forced_size` as far as a fixed amount of work gets: the same in every call."""
    links, n_robots = len(threat.graph.links), threat.graph.n_robots
    if links == 0 or links * n_robots > params.largest_soon or budget.is_over:
        return 0
    program = TreeProgram(threat, np.ones(n_robots, dtype=np.int64), params)
    return program.run(budget, n_robots, most_trees=params.soon // links)


def forced_weight(threat: Threat, weights: IntArray, budget: Budget, enough: int, params: TreeParams = DEFAULT) -> int:
    """A weight that every attack leaves to the unblinded robots of some group; looks no further than ``enough``.

    ``weights`` : (N,) of the robots, in [0, 2^20], not all 0
    """
    return TreeProgram(threat, weights, params).run(budget, enough)


@dataclass(frozen=True, slots=True)
class Tree:
    """An inequality: ``values`` of its links and robots (``columns``) off ``weight``, that of its robots."""

    columns: IntArray
    values: IntArray
    weight: int


class TreeProgram:
    """The program with the inequalities found so far: columns are links, robots, and the heaviest group.

    Weights are integers in trees and multiples of the largest in the program.
    """

    def __init__(self, threat: Threat, weights: IntArray, params: TreeParams = DEFAULT) -> None:
        self.weights, self.unit, self.params = weights, float(weights.max()), params
        self.links = sorted(threat.graph.links)
        self.n_robots, self.n_links = threat.graph.n_robots, len(self.links)
        self.ends = np.array(self.links, dtype=np.int64).reshape(-1, 2)
        self.place = np.full((self.n_robots, self.n_robots), -1, dtype=np.int64)
        self.place[self.ends[:, 0], self.ends[:, 1]] = self.place[self.ends[:, 1], self.ends[:, 0]] = range(
            self.n_links
        )
        free_links = [link not in threat.protected_links for link in self.links]
        free_robots = [i not in threat.protected_robots for i in range(self.n_robots)]
        self.free = np.array(free_links + free_robots, dtype=np.bool_)
        self.budgets = (threat.alpha_c, threat.alpha_s)
        one = np.ones(self.n_links + self.n_robots)
        columns = (range(self.n_links), range(self.n_links, self.n_links + self.n_robots))
        rows = rows_of([(list(c), [-1.0] * len(c)) for c in columns], [-float(b) for b in self.budgets])
        cost = np.append(0.0 * one, 1.0)
        self.program = LinearProgram(cost, 0.0, np.append(one * self.free, weights.sum() / self.unit), rows=rows)
        self.trees: list[Tree] = []
        self.point, self.size = 0.0 * one, 0.0
        self.inside = self._evenly()
        self.needed = float(self._needed(self.inside)[0].sum(axis=1).max())
        self.multipliers: FloatArray = np.zeros(0)
        self.best, self.is_done = 0, False

    def run(self, budget: Budget, enough: int, most_trees: int | None = None) -> int:
        """Add trees until ``enough`` is proved or nothing more can be; the weight proved so far."""
        most = self.params.most_trees if most_trees is None else most_trees
        while not (self.is_done or self.best >= min(enough, self.reachable) or budget.stop() is not None):
            refined = self.refine(budget)
            self.is_done = not budget.is_over and (not refined or len(self.trees) > most)
            self.best = max(self.best, self.proved)
        return self.best

    def _evenly(self) -> FloatArray:
        """Spread both budgets evenly over all that can be attacked."""
        parts = np.split(self.free.astype(np.float64), [self.n_links])
        return np.concatenate(
            [part * min(b / max(part.sum(), 1.0), 1.0) for part, b in zip(parts, self.budgets, strict=True)]
        )

    def _needed(self, point: FloatArray) -> tuple[FloatArray, FloatArray, IntArray]:
        """Find the weight that each robot's group keeps of every robot at ``point``.

        Also return lengths and last steps of shortest paths.
        """
        from scipy.sparse import csr_array  # a quarter of a second
        from scipy.sparse.csgraph import dijkstra

        short = 1e-7  # least length of a link: shortest paths then have few links
        length, blind = np.maximum(point[: self.n_links], 0.0) + short, point[self.n_links :]
        sides = (np.concatenate([self.ends[:, 0], self.ends[:, 1]]), np.concatenate([self.ends[:, 1], self.ends[:, 0]]))
        graph = csr_array((np.concatenate([length, length]), sides), shape=(self.n_robots, self.n_robots))
        distance, before = dijkstra(graph, return_predecessors=True, limit=1.0)
        kept = np.maximum(1.0 - blind - distance, 0.0) * (self.weights / self.unit)
        return kept, np.asarray(distance), np.asarray(before, dtype=np.int64)

    def refine(self, budget: Budget) -> bool:
        """Add trees and solve again; whether anything was learnt."""
        step = self.params.towards_program
        fresh: list[Tree] = []
        while not fresh and step <= 1.0 and not budget.is_over:
            at = step * self.point + (1 - step) * self.inside
            kept, distance, before = self._needed(at)
            if kept.sum(axis=1).max() < self.needed:
                self.inside, self.needed = at, float(kept.sum(axis=1).max())
            trees = [self._tree(root, *found) for root, found in enumerate(zip(kept, distance, before, strict=True))]
            least = (self.size + self.params.slack) * self.unit
            fresh = [t for t in trees if t.weight - t.values @ self.point[t.columns] > least]
            step = 1.0 if step < 1.0 < 2 * step else 2 * step
        if not fresh:
            return False
        self.trees += fresh
        last = self.n_links + self.n_robots
        rows = [([*t.columns.tolist(), last], [*(t.values / self.unit).tolist(), 1.0]) for t in fresh]
        self.program.add_rows(rows_of(rows, [t.weight / self.unit for t in fresh]))
        claim = self.program.solve(budget.seconds_left)
        if len(claim.x) != self.n_links + self.n_robots + 1 or len(claim.duals) != len(self.trees) + 2:
            return False
        self.point, self.size = claim.x[:-1], float(claim.x[-1])
        self.multipliers = claim.duals[2:]
        return True

    def _tree(self, root: int, kept: FloatArray, distance: FloatArray, before: IntArray) -> Tree:
        """The shortest paths from ``root`` to the robots that its group keeps."""
        within = np.where(kept > 0, self.weights, 0)
        behind, near = within.tolist(), np.flatnonzero(np.isfinite(distance))
        links: list[tuple[int, int]] = []
        for robot in near[np.argsort(-distance[near], kind="stable")].tolist():
            if robot != root and behind[robot]:
                last = before[robot]
                links.append((self.place[robot, last], behind[robot]))
                behind[last] += behind[robot]
        columns, values = np.array(links, dtype=np.int64).reshape(-1, 2).T
        (robots,) = np.nonzero(within)
        everything = np.concatenate([columns, self.n_links + robots]), np.concatenate([values, within[robots]])
        return Tree(*everything, int(within.sum()))

    @property
    def reachable(self) -> int:
        """No weight above this can be proved: the best point known has no more in any group."""
        return ceil((self.needed - self.params.slack) * self.unit)

    @property
    def proved(self) -> int:
        """Least weight of robots that are not blinded in some group after any attack.

        Proved from the last multipliers, in integers.
        """
        weights = np.rint(np.maximum(self.multipliers, 0.0) * SCALE).astype(np.int64)
        used = [(int(weights[k]), self.trees[k]) for k in np.flatnonzero(weights).tolist()]
        if not used:
            return 0
        total = np.zeros(self.n_links + self.n_robots, dtype=np.int64)
        for weight, tree in used:
            total[tree.columns] += weight * tree.values
        hit = [np.sort(part)[::-1] for part in np.split(np.where(self.free, total, 0), [self.n_links])]
        least = sum(weight * tree.weight for weight, tree in used)
        least -= sum(int(part[:b].sum()) for part, b in zip(hit, self.budgets, strict=True))
        return -(-least // sum(weight for weight, _ in used))
