"""Plans next to the best one: a few robots take other elements at random, then the plan is climbed from.

Iterated local search (Lourenço, Martin and Stützle 2003). Known outcomes and quick attacks flatter plans, the best of
many most of all: a plan that seems to be the best is attacked exactly at once, and what that teaches counts for the
next.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.maxmin.plans.candidates import climb

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.solvers.maxmin.plans.incumbent import Incumbent

__all__ = ["Kicks", "kicked"]

SEED = 0
FEWEST, MOST = 2, 4
"""Robots that take another element. Not tuned."""
FIRST = 100
"""Nodes before the first kick: most searches end before. With 20, best plans of 20 robots took a fifth longer."""
KICK_NODES, ATTACK_NODES, PROOF_NODES = 2, 8, 25
"""Nodes until the next kick, and how many more for each quick and each exact attack on the way. A kick takes as long as
a node; at (2, 350) of 30 robots, at which exact attacks took a second each, a kick at every node left time for 200
nodes a minute."""
PATIENCE = 16
"""Kicks in vain after which the next ones wait for one node more. Without, kicks took 40 % of the time at (0, 156) of
20 robots; there the best plan is found at once."""
PROOF_SHARE, PROOF_LIMIT = 0.01, 100_000
"""Share of the time left, and nodes, of an exact attack: at 20 robots one takes some hundredths of a second."""
ROUNDS = 20
"""Of climbing and attacking after which a plan is left as it is."""


def kicked(plan: IntArray, robots: int, choices: tuple[IntArray, ...], rng: np.random.Generator) -> IntArray:
    """The plan, but that many robots, or all of them, choose at random."""
    changed = plan.copy()
    for i in rng.choice(len(plan), min(robots, len(plan)), replace=False).tolist():
        changed[i] = rng.choice(choices[i])
    return changed


class Kicks:
    """Kicks the best plan of a search, as far as the budget lasts; deterministic."""

    def __init__(self, incumbent: Incumbent) -> None:
        self._incumbent = incumbent
        self._rng = np.random.default_rng(SEED)
        self._next, self._in_vain = FIRST, 0
        self._is_symmetric = incumbent.problem.threat.is_symmetric

    def are_due(self, nodes: int) -> bool:
        """Whether enough nodes were searched for the next kick.

        Never if all outcomes are known, nor if robots or links differ to the adversary: not measured there.
        """
        return nodes >= self._next and not self._incumbent.pool.complete and self._is_symmetric

    def kick(self) -> None:
        """Climb from a plan next to the best one; a better one that is found becomes a candidate.

        Raises ``OutOfBudget`` : the user interrupted an attack; what it had proved counts.
        """
        candidates = self._incumbent.candidates
        self._in_vain += 1
        self._next = self._incumbent.budget.nodes + KICK_NODES + self._in_vain // PATIENCE
        most = int(self._rng.integers(FEWEST, MOST + 1))
        plan = self._climbed(kicked(candidates.best, most, self._incumbent.problem.choices, self._rng))
        if candidates.is_better(plan) and candidates.meet(plan):
            candidates.add(plan)
            self._in_vain = 0

    def _climbed(self, plan: IntArray) -> IntArray:
        """Climb and attack in turns, while the plan seems better than the best one and attacks teach."""
        incumbent, pool, budget = self._incumbent, self._incumbent.pool, self._incumbent.budget
        for _ in range(ROUNDS):
            plan, known = climb(incumbent.problem, pool, plan, budget), len(pool)
            if budget.is_over or not incumbent.candidates.is_better(plan):
                break
            self._next += ATTACK_NODES
            if not incumbent.adversary.learn(plan):
                self._next += PROOF_NODES
                incumbent.proved.attack(plan, budget.part(PROOF_SHARE, max_nodes=PROOF_LIMIT))
            if len(pool) == known:
                break
        return plan
