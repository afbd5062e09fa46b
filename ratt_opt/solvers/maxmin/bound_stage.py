"""Stages of the search for the upper end: objects with a name, a condition, a share, and the search they begin."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Protocol

if TYPE_CHECKING:
    from ratt_opt.budget import Stop
    from ratt_opt.solvers.maxmin.known import Known
    from ratt_opt.solvers.maxmin.proof import UpperProof
    from ratt_opt.solvers.maxmin.time_slices import Turn

__all__ = ["BoundSearch", "BoundStage", "TurnShare"]


@dataclass(frozen=True, slots=True, kw_only=True)
class TurnShare:
    """Nodes of a stage's turn as factors of a slice, which grows from turn to turn.

    ``first`` : of the first turns; ``most`` : after a turn that lowered the upper end
    ``in_vain`` : the factor is multiplied by it after each other turn
    ``at_first`` : nodes of the first turn of all, whatever the slice
    """

    first: float = 1.0
    most: float = 1.0
    in_vain: float = 1.0
    at_first: int | None = None


class BoundSearch(Protocol):
    """A search for the upper end that goes on where it was; it may be interrupted at any point."""

    @property
    def upper(self) -> float:
        """Proved upper bound on the optimum; infinite before the first one."""

    def proof(self) -> UpperProof:
        """The proof of ``upper``."""

    def run(self, turn: Turn) -> Stop:
        """Lower ``upper``; ``NODES`` if the turn is over, ``GAP`` if the bracket is closed."""


class BoundStage(ABC):
    """One row of the schedule; ``known`` : the problem (``known.task``), outcomes, the best plan, cuts.

    ``kind`` : of the stages of one kind, only the first that applies runs; its name if it is empty
    """

    name: ClassVar[str]
    kind: ClassVar[str] = ""

    def applies(self, known: Known) -> bool:  # noqa: ARG002  (the shape of a condition)
        """Always."""
        return True

    def share(self, known: Known) -> TurnShare:  # noqa: ARG002  (the shape of a share)
        """Return the factors of its turns: by default all nodes of the slice."""
        return TurnShare()

    @abstractmethod
    def begin(self, known: Known) -> BoundSearch:
        """Return its search, which no turn was given yet."""
