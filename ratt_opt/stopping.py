"""Why a computation stopped: a separate question from how good its answer is."""

from __future__ import annotations

from enum import Enum
from typing import TypeVar

__all__ = ["Stop", "uninterrupted"]

T = TypeVar("T")


class Stop(Enum):
    """Reason for returning. The bracket ``[lower, upper]`` says how good the answer is."""

    CLOSED = "closed"
    """Bounds met within rounding."""
    EXHAUSTED = "exhausted"
    """Every case was evaluated."""
    GAP = "gap"
    """The requested gap was reached."""
    TIME = "time"
    """The time limit was reached."""
    NODES = "nodes"
    """The node limit was reached."""
    EVALUATIONS = "evaluations"
    """The limit on values of a set function was reached."""
    INTERRUPTED = "interrupted"
    """The user interrupted; the bracket so far is valid."""
    HEURISTIC = "heuristic"
    """A heuristic ran to its end; no optimality is claimed."""


def uninterrupted(found: T) -> T:
    """What a search found; ``KeyboardInterrupt`` where the user interrupted it.

    For callers that keep no bracket of their own: to them it would pass for what a whole search finds.
    """
    if getattr(found, "stop", None) is Stop.INTERRUPTED:
        raise KeyboardInterrupt
    return found
