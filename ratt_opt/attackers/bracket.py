"""The state of an exact attacker: a bracket that is valid whenever the search stops."""

from __future__ import annotations

from dataclasses import dataclass, field
from time import monotonic
from typing import TYPE_CHECKING

from ratt_opt._validation import check_integer
from ratt_opt.errors import InputError
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from ratt_opt.problem import Attack

__all__ = ["Bracket", "Budget", "OutOfBudget"]


class OutOfBudget(Exception):  # noqa: N818  (a signal within the search, never seen by a user)
    """The node or time budget is spent."""

    def __init__(self, stop: Stop) -> None:
        super().__init__(stop)
        self.stop = stop


@dataclass(slots=True)
class Budget:
    """Nodes and seconds a search may spend; ``None`` is unlimited.

    Raises
    ------
    InputError : ``max_nodes`` is not an integer >= 0 or ``time_limit`` is not a number >= 0.
    """

    max_nodes: int | None
    time_limit: float | None
    nodes: int = 0
    started: float = field(default_factory=monotonic)

    def __post_init__(self) -> None:
        if self.max_nodes is not None:
            self.max_nodes = check_integer("max_nodes", self.max_nodes, low=0)
        if self.time_limit is not None and not self.time_limit >= 0:
            raise InputError("time_limit", "must be a number of seconds >= 0", self.time_limit)

    def check_time(self) -> None:
        """Raise :class:`OutOfBudget` when the time is up."""
        if self.time_limit is not None and monotonic() - self.started >= self.time_limit:
            raise OutOfBudget(Stop.TIME)

    def nodes_left(self, at_most: int) -> int:
        """Nodes that may still be spent, at most ``at_most``; raises :class:`OutOfBudget` when none is left."""
        self.check_time()
        if self.max_nodes is None:
            return at_most
        if self.nodes >= self.max_nodes:
            raise OutOfBudget(Stop.NODES)
        return min(at_most, self.max_nodes - self.nodes)

    def spend(self, nodes: int = 1) -> None:
        """Count nodes before they are explored; raises :class:`OutOfBudget` when they are not left."""
        self.nodes_left(nodes)
        self.nodes += nodes


@dataclass(slots=True)
class Bracket:
    """``lower <= worst-case value <= upper`` at any moment; ``attack`` attains ``upper``."""

    attack: Attack
    upper: float
    lower: float

    def offer(self, attack: Attack, value: float) -> None:
        """Keep an attack of strictly smaller value."""
        if value < self.upper:
            self.attack, self.upper = attack, value

    def raise_lower(self, bound: float) -> None:
        """Keep a larger lower bound."""
        self.lower = max(self.lower, bound)
