"""Time that a question of the audit may take: the budget of the run, asked if programs are solved.

A context variable, as questions are answered once and remembered, whatever the time there was.
"""

from __future__ import annotations

from contextlib import contextmanager
from contextvars import ContextVar
from typing import TYPE_CHECKING

from ratt_opt.budget import Budget

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["paced", "program_seconds"]

SECONDS = 60.0
"""Longest that one linear program may take: it stops a runaway only, as the chains' programs take 0.1 s at most."""

_CURRENT: ContextVar[Budget | None] = ContextVar("ratt_opt_audit_budget", default=None)


@contextmanager
def paced(budget: Budget) -> Iterator[None]:
    """Questions inside the block raise ``OutOfBudget`` once it is spent."""
    token = _CURRENT.set(budget)
    try:
        yield
    finally:
        _CURRENT.reset(token)


def program_seconds() -> float:
    """Seconds that the next program may take; raises ``OutOfBudget`` if none are left."""
    budget = _CURRENT.get() or Budget()
    budget.check()
    return min(SECONDS, budget.seconds_left)
