"""The one budget of a search: deadline, nodes, values of a set function, interrupt; and why a search stopped."""

from __future__ import annotations

from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, is_dataclass, replace
from enum import Enum
from functools import wraps
from math import inf, isinf
from numbers import Real
from time import monotonic
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

from ratt_opt._validation import check_integer
from ratt_opt.errors import InputError
from ratt_opt.running.interrupted_searches import InterruptNote, current_note, is_noting, noting_interrupts

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["Budget", "OutOfBudget", "Stop", "interruptible", "undisturbed", "uninterrupted"]

P = ParamSpec("P")
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


class OutOfBudget(Exception):  # noqa: N818  (a signal within a search, never seen by a user)
    """The budget is spent; ``stop`` says which part of it."""

    def __init__(self, stop: Stop) -> None:
        super().__init__(stop)
        self.stop = stop


@dataclass(slots=True)
class Budget:
    """Seconds, nodes and evaluations that a search may spend, and whether the user interrupted it.

    Seconds are those of the clock (``time.monotonic``), as a team waits for an answer, here and in every ``time_limit``
    of the library. A busy machine gets less done in them.

    A search passes its budget down and asks it in every loop that can be long. Inner searches get a
    :meth:`part` of it. Code that catches a ``KeyboardInterrupt`` to keep a bracket calls :meth:`interrupt`, so
    that every search around it stops too instead of taking the inner result for a finished one.

    Parameters
    ----------
    time_limit : seconds from now; ``None`` is unlimited, 0 is spent at once
    max_nodes : nodes; ``None`` is unlimited
    max_evaluations : values of a set function, here and in all parts; ``None`` is unlimited. Counted, and kept, if
        values are computed through :class:`ratt_opt.setfunctions.metered.Metered`

    Raises
    ------
    InputError : ``max_nodes`` or ``max_evaluations`` is not an integer >= 0, or ``time_limit`` is not a number >= 0.
    """

    time_limit: float | None = None
    max_nodes: int | None = None
    max_evaluations: int | None = None
    nodes: int = field(default=0, init=False)
    evaluations: int = field(default=0, init=False)
    started: float = field(default_factory=monotonic, init=False)
    _interrupt: InterruptNote = field(default_factory=current_note, init=False, repr=False)
    _outer: Budget | None = field(default=None, init=False, repr=False)

    def __post_init__(self) -> None:
        if self.max_nodes is not None:
            self.max_nodes = check_integer("max_nodes", self.max_nodes, low=0)
        if self.max_evaluations is not None:
            self.max_evaluations = check_integer("max_evaluations", self.max_evaluations, low=0)
        given = self.time_limit
        if given is not None and (isinstance(given, bool) or not isinstance(given, Real) or not given >= 0):
            raise InputError("time_limit", "must be a number of seconds >= 0", given)

    @classmethod
    def inside(
        cls,
        outer: Budget | None,
        time_limit: float | None = None,
        max_nodes: int | None = None,
        max_evaluations: int | None = None,
    ) -> Budget:
        """Return a budget with these limits, within the seconds, evaluations and interrupts of ``outer`` if given.

        Raises
        ------
        InputError : as for a budget of its own.
        """
        inner = cls(time_limit, max_nodes, max_evaluations)
        if outer is not None:
            inner._interrupt, inner._outer = outer._interrupt, outer
            if outer.time_limit is not None:
                left = outer.seconds_left
                inner.time_limit = left if time_limit is None else min(time_limit, left)
        return inner

    @classmethod
    def apart(cls, time_limit: float) -> Budget:
        """A few seconds to finish with, which an interrupt that was noted before does not end."""
        own = cls(time_limit)
        own._interrupt = InterruptNote()
        return own

    @property
    def elapsed(self) -> float:
        """Seconds since the budget was made."""
        return monotonic() - self.started

    @property
    def seconds_left(self) -> float:
        """Seconds that may still be spent, at least 0; infinite without a limit."""
        return inf if self.time_limit is None else max(self.time_limit - self.elapsed, 0.0)

    def stop(self) -> Stop | None:
        """Return the reason to stop now, if there is one."""
        if self._interrupt.happened:
            return Stop.INTERRUPTED
        if self.time_limit is not None and self.elapsed >= self.time_limit:
            return Stop.TIME
        if self.evaluations_left == 0:
            return Stop.EVALUATIONS
        if self.max_nodes is not None and self.nodes >= self.max_nodes:
            return Stop.NODES
        return None

    @property
    def is_interrupted(self) -> bool:
        """True if the user interrupted: nothing is begun any more, however short it is."""
        return self._interrupt.happened

    @property
    def is_over(self) -> bool:
        """True if the time is up, no evaluation is left or the user interrupted; nodes do not count."""
        return self.stop() not in {None, Stop.NODES}

    def check(self) -> None:
        """Raise :class:`OutOfBudget` when :attr:`is_over`."""
        if (stop := self.stop()) not in {None, Stop.NODES}:
            assert stop is not None
            raise OutOfBudget(stop)

    @property
    def evaluations_left(self) -> float:
        """Values of a set function that may still be asked for; infinite without a limit."""
        own = inf if self.max_evaluations is None else max(self.max_evaluations - self.evaluations, 0)
        return own if self._outer is None else min(own, self._outer.evaluations_left)

    def evaluate(self, count: int) -> None:
        """Count values of a set function, here and in every budget around this one."""
        self.evaluations += count
        if self._outer is not None:
            self._outer.evaluate(count)

    def nodes_left(self, at_most: int) -> int:
        """Nodes that may still be spent, at most ``at_most``; raises :class:`OutOfBudget` when none is left."""
        if (stop := self.stop()) is not None:
            raise OutOfBudget(stop)
        return at_most if self.max_nodes is None else min(at_most, self.max_nodes - self.nodes)

    def spend(self, nodes: int = 1) -> None:
        """Count nodes before they are explored; raises :class:`OutOfBudget` when none is left."""
        self.nodes_left(nodes)
        self.nodes += nodes

    def part(self, share: float = 1.0, *, max_nodes: int | None = None, at_least: float = 0.0) -> Budget:
        """A budget of its own nodes with ``share`` of the seconds and evaluations left (at least ``at_least`` seconds).

        An interrupt of either is an interrupt of both.
        """
        seconds = None if self.time_limit is None else max(share * self.seconds_left, at_least)
        evaluations = None if isinf(self.evaluations_left) else int(share * self.evaluations_left)
        return Budget.inside(self, seconds, max_nodes, evaluations)

    def beyond(self, seconds: float) -> Budget:
        """A budget with some more seconds, for what is worth an overrun; values and interrupts count as here."""
        longer = Budget.inside(self)
        if self.time_limit is not None:
            longer.time_limit = self.seconds_left + seconds
        return longer

    def keep_to(self, other: Budget) -> None:
        """Have as many seconds left as another budget: no overrun from now on."""
        self.time_limit = None if other.time_limit is None else self.elapsed + other.seconds_left

    @contextmanager
    def stage(self, share: float = 1.0, *, max_nodes: int | None = None) -> Iterator[Budget]:
        """A part whose nodes count here too, and whose end is only the end of what is done ``with`` it.

        ``share`` : of the seconds, evaluations and nodes left; ``max_nodes`` : no more nodes than these

        Raises
        ------
        OutOfBudget : nothing is left before it; afterwards if the time is up here too or the user interrupted.
        """
        most = inf if max_nodes is None else max_nodes
        if self.max_nodes is not None:
            most = min(most, int(share * self.nodes_left(self.max_nodes)))
        part = self.part(share, max_nodes=None if isinf(most) else int(most))
        try:
            with suppress(OutOfBudget):
                yield part
        finally:
            self.nodes += part.nodes
        self.check()

    def interrupt(self) -> Stop:
        """Note that the user interrupted; returns the reason to stop with."""
        self._interrupt.happened = True
        return Stop.INTERRUPTED


def interruptible(search: Callable[P, T]) -> Callable[P, T]:
    """Let a public search return its bracket with ``INTERRUPTED`` whenever the user interrupts it.

    The one rule for searches whose result says why they stopped. A first Ctrl-C is noted, and loops meet the note in
    their budgets. If it is raised and nothing keeps a bracket, the search is begun anew with the note: it returns
    what is known at once. A search that was interrupted says so, also if it closed its bracket. A further
    Ctrl-C raises ``KeyboardInterrupt``.
    """

    @wraps(search)
    def guarded(*given: P.args, **named: P.kwargs) -> T:
        if is_noting():
            return _noted(search, current_note(), *given, **named)
        budget = named.get("budget")
        note = budget._interrupt if isinstance(budget, Budget) else InterruptNote()
        note.begun_anew = False
        with noting_interrupts(note, _noted.__code__):
            found = _noted(search, note, *given, **named)
        return _as_interrupted(found) if note.happened else found

    return guarded


def _noted(search: Callable[P, T], note: InterruptNote, *given: P.args, **named: P.kwargs) -> T:
    try:
        return search(*given, **named)
    except KeyboardInterrupt:
        if note.begun_anew:
            raise
        note.happened = note.begun_anew = True
        return search(*given, **named)


def _as_interrupted(found: Any) -> Any:
    """A result, or several by name, that says that the user interrupted; one that does not say why it stopped as is."""
    if isinstance(found, dict):
        return {name: _as_interrupted(one) for name, one in found.items()}
    if not isinstance(getattr(found, "stop", None), Stop):
        return found
    if is_dataclass(found) and not isinstance(found, type):
        return replace(found, stop=Stop.INTERRUPTED)
    found.stop = Stop.INTERRUPTED
    return found


def undisturbed(budget: Budget, finish: Callable[[], T]) -> T:
    """Run a short last step to its end; an interrupt in it is noted and the step repeated."""
    try:
        return finish()
    except KeyboardInterrupt:
        budget.interrupt()
        return finish()


def uninterrupted(found: T) -> T:
    """Return the result of a search, or raise ``KeyboardInterrupt`` if the user interrupted it.

    For callers that keep no bracket of their own: to them it would pass for what a whole search finds.
    """
    if getattr(found, "stop", None) is Stop.INTERRUPTED:
        raise KeyboardInterrupt
    return found
