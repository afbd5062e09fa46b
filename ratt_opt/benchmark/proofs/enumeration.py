"""Small problems by definition: every plan against every raw attack. It shares nothing with the searches.

Values of sets are compared, never added, so the result is exact for a function whose values are.
"""

from __future__ import annotations

from itertools import combinations, product
from math import comb, prod
from typing import TYPE_CHECKING

from ratt_opt.errors import UndecidedError

if TYPE_CHECKING:
    from ratt_opt.problem import Problem

__all__ = ["best_worst_case", "cases_of"]


def best_worst_case(problem: Problem, most_cases: int = 3_000_000, most_attacks: int = 400_000) -> float:
    """The largest worst case of any plan.

    ``most_cases`` : plans times families of groups that are compared; ``most_attacks`` : attacks that are looked at.
    Larger problems take more than minutes.

    Raises
    ------
    UndecidedError : there are too many attacks or plans.
    """
    families = _families(problem, most_attacks)
    plans = prod(len(choice) for choice in problem.choices)
    if plans * len(families) > most_cases:
        raise UndecidedError(f"too many cases to enumerate: {plans} plans, {len(families)} families of groups")
    known: dict[tuple[int, ...], float] = {}

    def worth(elements: tuple[int, ...]) -> float:
        if elements not in known:
            known[elements] = problem.objective(elements)
        return known[elements]

    best = -float("inf")
    for plan in product(*(choice.tolist() for choice in problem.choices)):
        worst = float("inf")
        for family in families:
            worst = min(worst, max(worth(tuple(sorted(plan[i] for i in group))) for group in family))
            if worst <= best:
                break
        best = max(best, worst)
    return best


def cases_of(problem: Problem) -> int:
    """Number of raw attacks within the budgets."""
    robots = problem.n_robots - len(problem.protected_robots)
    links = len(problem.communication.links - problem.protected_links)
    blinded = sum(comb(robots, k) for k in range(min(problem.alpha_s, robots) + 1))
    return blinded * sum(comb(links, k) for k in range(min(problem.alpha_c, links) + 1))


def _families(problem: Problem, most_attacks: int) -> list[tuple[tuple[int, ...], ...]]:
    """Families of groups that attacks leave, each once: robots that still see."""
    if cases_of(problem) > most_attacks:
        raise UndecidedError(f"too many attacks to enumerate: {cases_of(problem)}")
    robots = [i for i in range(problem.n_robots) if i not in problem.protected_robots]
    links = sorted(problem.communication.links - problem.protected_links)
    found: set[tuple[tuple[int, ...], ...]] = set()
    for k in range(problem.alpha_c + 1):
        for cut in combinations(links, k):
            groups = _groups(problem.n_robots, problem.communication.links - set(cut))
            for b in range(problem.alpha_s + 1):
                for blind in combinations(robots, b):
                    left = (tuple(i for i in group if i not in blind) for group in groups)
                    found.add(tuple(sorted(set(left))))
    return sorted(found)


def _groups(n: int, links: frozenset[tuple[int, int]]) -> list[list[int]]:
    """Connected robots, by union of links."""
    lowest = list(range(n))
    for i, j in links:
        low, high = sorted((lowest[i], lowest[j]))
        lowest = [low if one == high else one for one in lowest]
    return [[i for i in range(n) if lowest[i] == low] for low in sorted(set(lowest))]
