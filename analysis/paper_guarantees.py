"""Guarantees of RATT at the paper's budgets, old bounds beside new: ``python -m analysis.paper_guarantees``.

Prints a Markdown table: one scenario of the paper's kind (seed 0) a budget, shares of the optimum known before any
search for it, rounded down. ``g`` is the largest group of unblinded robots that an attack can be held to.
"""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from ratt_opt import all_guarantees, curvature, instance_bound, random_scenario, ratt, total_curvature
from ratt_opt._rounding import down
from ratt_opt.bounds.group_size import achievable_group_size

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt import Problem

__all__ = ["BUDGETS", "row", "table"]

BUDGETS = (
    (4, 4, 1, 3),
    (4, 4, 1, 4),
    (4, 4, 2, 3),
    (4, 4, 2, 4),
    (10, 15, 3, 11),
    (10, 15, 5, 15),
    (10, 15, 6, 22),
    (20, 20, 6, 47),
    (20, 20, 10, 63),
    (20, 20, 13, 95),
    (30, 25, 10, 108),
    (30, 25, 15, 145),
    (30, 25, 20, 217),
)
"""N, M, alpha_s, alpha_c: Section VI."""
BOUNDS = ("Theorem 1", "pattern-free", "now")
HEAD = ("robots", "blinded, cut", "g", *(f"{kind}: {bound}" for kind in ("log-det", "trace") for bound in BOUNDS))
SECONDS = 8.0


def row(budget: tuple[int, int, int, int]) -> tuple[str, ...]:
    """One line of the table."""
    n, m, alpha_s, alpha_c = budget
    scenario = random_scenario(n, m, alpha_s=alpha_s, alpha_c=alpha_c, seed=0)
    size = achievable_group_size(scenario.problem("trace"))
    shares = [share for kind in ("logdet", "trace") for share in _shares(scenario.problem(kind))]
    return (str(n), f"{alpha_s}, {alpha_c}", str(size), *(down(float(share), 2) for share in shares))


def _shares(problem: Problem) -> Iterator[float]:
    """Theorem 1, the pattern-free bound, and the largest of all guarantees and this plan's own."""
    submodular = problem.information_objective.is_submodular
    bracket = (curvature if submodular else total_curvature)(
        problem.objective, problem.robot, gap=0.05, time_limit=SECONDS
    )
    plan = ratt(problem)
    assert plan.alpha_cs is not None
    name, k, c = ("k", bracket, None) if submodular else ("c", None, bracket)
    found = all_guarantees(problem, plan.alpha_cs, k=k, c=c)
    yield found[f"Theorem 1 ({name})"]
    yield found[f"pattern-free ({name})"]
    yield max(*found.values(), instance_bound(problem, plan.elements, k=k, c=c, time_limit=SECONDS))


def table(budgets: tuple[tuple[int, int, int, int], ...] = BUDGETS) -> str:
    """The table as Markdown."""
    lines = [HEAD, ("---",) * len(HEAD), *map(row, budgets)]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="four robots only")
    print(table(tuple(b for b in BUDGETS if b[0] == 4) if parser.parse_args().quick else BUDGETS))


if __name__ == "__main__":
    main()
