"""Theorem 2: RATT's evaluations never exceed the square of the number of controls."""

from __future__ import annotations

from functools import partial
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.audit.decide import Verdict
from ratt_opt.audit.entry import Counted, EnumeratedEntry
from ratt_opt.problem import Problem
from ratt_opt.setfunctions.table import TableFunction
from ratt_opt.solvers.ratt import ratt

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["count_evaluations", "running_time_entries"]

LARGEST = 4


def running_time_entries() -> Iterator[EnumeratedEntry]:
    """Yield Theorem 2 as a count of evaluations."""
    yield EnumeratedEntry(
        label="thm:ratt_run_time",
        kind="theorem",
        chain="theorems",
        statement="RATT evaluates f at most |U|^2 times, |U| the number of all controls",
        hypotheses="complete graph, every budget; the count depends on the numbers of controls and ties only",
        enumerate_cases=partial(count_evaluations, LARGEST),
    )


def count_evaluations(largest: int) -> Counted:
    """Run RATT on additive functions for every team up to ``largest`` robots with 1 to 3 controls, and count."""
    bad, count = [], 0
    for n_robots in range(1, largest + 1):
        for controls in product((1, 3), repeat=n_robots):
            owners = np.repeat(np.arange(n_robots), controls)
            total = len(owners)
            members = np.arange(1 << total)[:, None] >> np.arange(total) & 1
            function = TableFunction(members @ np.arange(1, total + 1))
            for alpha_c in range(n_robots * (n_robots - 1) // 2 + 1):
                plan = ratt(Problem(function, owners, None, 0, alpha_c))
                count += 1
                if plan.evaluations > total**2:
                    bad.append(f"controls {controls}, alpha_c = {alpha_c}: {plan.evaluations} > {total**2}")
    verdict = Verdict.REFUTED if bad else Verdict.NO_VIOLATION
    detail = f"{count} runs counted, {len(bad)} above |U|^2"
    return Counted(verdict=verdict, sizes=f"N <= {largest}, 1 or 3 controls each", detail=detail, cases=tuple(bad[:3]))
