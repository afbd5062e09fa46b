"""A lower bound on the largest group of seeing robots, by a linear program over links with tree inequalities.

Let ``x[e]`` say that link e is cut and ``b[v]`` that robot v is blinded. For a tree of links with root r, the group of
r keeps every robot v of the tree that sees and whose path to r is whole:

    sum over v of (1 - b[v] - sum of x[e] on the path from r to v)  <=  seeing robots in the group of r.

The program asks for the x and b within the budgets that make the largest left side least; its inequalities come from
shortest-path trees. What it says is not taken: for any multipliers ``y >= 0`` of the inequalities an attack leaves a
group of at least their mean left side, which is least where the attack takes the links and the robots of the largest
coefficients. That is computed in integers.

Source: spreading metrics; Even, Naor, Rao and Schieber, Journal of the ACM 47 (2000), here for cuts within a budget.
"""

from __future__ import annotations

from math import ceil
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from ratt_opt.highs import LinearProgram, rows_of

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.graph.threat import Threat

__all__ = ["TREES", "TreeProgram", "forced_size"]

TREES = "tree inequalities of a linear program, recomputed from their multipliers"

SCALE = 2.0**24
"""Multipliers become integers in these units: the sums below stay under 2^63."""
TOWARDS_PROGRAM = 0.2
"""Where trees are looked for: this far from the best point that keeps all inequalities to the program's. Measured at 50
to 200 robots: 30 to 45 rounds; at the program's own point (1) more than 100, and at 200 robots no bound in a minute."""
SLACK, SHORT = 1e-4, 1e-7
"""Trees that the program's point violates by less are not added; every link has at least this length."""
MOST_ROUNDS = 150


def forced_size(threat: Threat, budget: Budget, enough: int) -> int:
    """A number of seeing robots that every attack leaves in some group; looks no further than ``enough``."""
    program, proved = TreeProgram(threat), 0
    for _ in range(MOST_ROUNDS):
        if (
            proved >= min(enough, ceil(program.needed - SLACK))
            or budget.stop() is not None
            or not program.refine(budget)
        ):
            break
        proved = max(proved, program.proved)
    return proved


class TreeProgram:
    """The program with the inequalities found so far: columns are links, robots, and the largest group."""

    def __init__(self, threat: Threat) -> None:
        self.threat = threat
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
        self.program = LinearProgram(cost, 0.0, np.append(one * self.free, float(self.n_robots)), rows=rows)
        self.trees: list[IntArray] = []  # coefficients of links and robots, and the number of robots
        self.point, self.size = 0.0 * one, 0.0
        self.inside = self._evenly()
        self.needed = float(self._needed(self.inside)[0].sum(axis=1).max())
        self.multipliers: FloatArray = np.zeros(0)

    def _evenly(self) -> FloatArray:
        """Both budgets spread over all that can be attacked."""
        parts = np.split(self.free.astype(np.float64), [self.n_links])
        return np.concatenate(
            [part * min(b / max(part.sum(), 1.0), 1.0) for part, b in zip(parts, self.budgets, strict=True)]
        )

    def _needed(self, point: FloatArray) -> tuple[FloatArray, FloatArray, IntArray]:
        """What each robot's group keeps of every robot at ``point``; lengths and last steps of shortest paths."""
        length, blind = np.maximum(point[: self.n_links], 0.0) + SHORT, point[self.n_links :]
        sides = (np.concatenate([self.ends[:, 0], self.ends[:, 1]]), np.concatenate([self.ends[:, 1], self.ends[:, 0]]))
        graph = csr_array((np.concatenate([length, length]), sides), shape=(self.n_robots, self.n_robots))
        distance, before = dijkstra(graph, return_predecessors=True, limit=1.0)
        kept = np.maximum(1.0 - blind - distance, 0.0)
        return kept, np.asarray(distance), np.asarray(before, dtype=np.int64)

    def refine(self, budget: Budget) -> bool:
        """Add trees and solve again; whether anything was learnt."""
        step = TOWARDS_PROGRAM
        fresh: list[IntArray] = []
        while not fresh and step <= 1.0 and not budget.is_over:
            at = step * self.point + (1 - step) * self.inside
            kept, distance, before = self._needed(at)
            if kept.sum(axis=1).max() < self.needed:
                self.inside, self.needed = at, float(kept.sum(axis=1).max())
            trees = [self._tree(root, *found) for root, found in enumerate(zip(kept, distance, before, strict=True))]
            fresh = [tree for tree in trees if tree[-1] - tree[:-1] @ self.point > self.size + SLACK]
            step = 1.0 if step < 1.0 < 2 * step else 2 * step
        if not fresh:
            return False
        self.trees += fresh
        rows = []
        for tree in fresh:
            (columns,) = np.nonzero(tree[:-1])
            rows.append(([*columns.tolist(), len(tree) - 1], [*tree[columns].astype(float).tolist(), 1.0]))
        self.program.add_rows(rows_of(rows, [float(tree[-1]) for tree in fresh]))
        claim = self.program.solve(budget.seconds_left)
        if len(claim.x) != self.n_links + self.n_robots + 1 or len(claim.duals) != len(self.trees) + 2:
            return False
        self.point, self.size = claim.x[:-1], float(claim.x[-1])
        self.multipliers = claim.duals[2:]
        return True

    def _tree(self, root: int, kept: FloatArray, distance: FloatArray, before: IntArray) -> IntArray:
        """Of the robots that the group of ``root`` keeps: coefficients of links and robots, and their number."""
        within = (kept > 0).astype(np.int64)
        behind, near = within.tolist(), np.flatnonzero(np.isfinite(distance))
        tree = np.concatenate([np.zeros(self.n_links, dtype=np.int64), within, within.sum(keepdims=True)])
        for robot in near[np.argsort(-distance[near], kind="stable")].tolist():
            if robot != root and behind[robot]:
                last = before[robot]
                tree[self.place[robot, last]] = behind[robot]
                behind[last] += behind[robot]
        return tree

    @property
    def proved(self) -> int:
        """From the last multipliers, in integers: no attack keeps every group below this many seeing robots."""
        weights = np.rint(np.maximum(self.multipliers, 0.0) * SCALE).astype(np.int64)
        used = np.flatnonzero(weights)
        if not len(used):
            return 0
        total = weights[used] @ np.array([self.trees[k] for k in used])
        hit = [np.sort(part)[::-1] for part in np.split(np.where(self.free, total[:-1], 0), [self.n_links])]
        least = int(total[-1]) - sum(int(part[:b].sum()) for part, b in zip(hit, self.budgets, strict=True))
        return -(-least // int(weights[used].sum()))
