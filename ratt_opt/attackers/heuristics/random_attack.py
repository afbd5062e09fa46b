"""The attacker that knows nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import check_integer
from ratt_opt.attackers.heuristics.partial_attack import heuristic_result
from ratt_opt.attackers.task import PlanValues
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ratt_opt.attackers.task import AttackResult
    from ratt_opt.problem import Problem

__all__ = ["random_attack"]


def random_attack(problem: Problem, elements: ArrayLike, *, seed: int) -> AttackResult:
    """Spend both budgets on uniformly random unprotected robots and links.

    Raises
    ------
    InputError : ``seed`` is not an integer >= 0, an element is not its robot's, or ``elements`` has the wrong shape.
    """
    rng = np.random.default_rng(check_integer("seed", seed, low=0))
    values = PlanValues(problem, elements)
    robots = sorted(set(range(problem.n_robots)) - problem.protected_robots)
    links = sorted(problem.communication.links - problem.protected_links)
    blinded = rng.permutation(len(robots))[: problem.alpha_s]
    cut = rng.permutation(len(links))[: problem.alpha_c]
    attack = Attack(frozenset(robots[i] for i in blinded), frozenset(links[i] for i in cut))
    return heuristic_result(problem, values, attack)
