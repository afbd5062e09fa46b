"""Searches as tables of stages: what is asked, when it applies, what share of the budget it has, and what it did."""

from __future__ import annotations

from abc import ABC, abstractmethod
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar, Generic, Protocol, TypeVar

from ratt_opt.attack.task import StageRecord
from ratt_opt.budget import Stop
from ratt_opt.search.branch_and_bound import divide_nodes

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from ratt_opt.attack.params import AttackParams
    from ratt_opt.attack.task import AttackTask, Resumable
    from ratt_opt.search.open_nodes import OpenNode, OpenNodes

__all__ = ["WHOLE", "AttackNodes", "Share", "Stage", "go_on", "recorded", "run_stages", "without_stages"]


class Staged(Protocol):
    """A search that is made of stages; while a stage has a share of the budget, ``task`` has that share."""

    task: AttackTask


S = TypeVar("S", bound=Staged)
N = TypeVar("N", bound="OpenNode")
B = TypeVar("B")


@dataclass(frozen=True, slots=True, kw_only=True)
class Share:
    """Part of the remaining budget that a stage may spend; its end is the end of the stage only.

    ``part`` : of the seconds, evaluations and nodes left; ``None`` for all of them. ``max_nodes`` : no more than these
    """

    part: float | None = None
    max_nodes: int | None = None


WHOLE = Share()
"""Whole remaining budget: the schedule ends with what such a stage returns, if it says why it stopped."""


class Stage(ABC, Generic[S]):
    """One row of a schedule; ``attack`` is the state of one attack, its task within the stage's share.

    ``name`` : in results and in ``--explain``. The docstrings of ``run`` and ``applies`` are what the tables show.
    """

    name: ClassVar[str]

    def applies(self, attack: S) -> bool:  # noqa: ARG002  (the shape of a condition)
        """Always."""
        return True

    def share(self, params: AttackParams) -> Share:  # noqa: ARG002  (the shape of a share)
        """Return the part of the remaining budget that the stage may spend; all of it by default."""
        return WHOLE

    @abstractmethod
    def run(self, attack: S) -> Stop | None:
        """Narrow the bracket; if there is no share, why the whole attack stops, or ``None`` to go on."""


LEFT_OUT: set[str] = set()
"""Names of stages that do not run, for ablations."""


@contextmanager
def without_stages(*names: str) -> Iterator[None]:
    """Leave stages out of every attack begun inside (for tests and ablations; brackets stay valid)."""
    added = set(names) - LEFT_OUT
    LEFT_OUT.update(added)
    try:
        yield
    finally:
        LEFT_OUT.difference_update(added)


def run_stages(stages: Sequence[Stage[S]], search: S) -> Stop | None:
    """Run the stages that apply until the bracket is closed or one ends the search; ``None`` if none does.

    Raises
    ------
    OutOfBudget : the whole budget is spent; the bracket is valid.
    """
    task = search.task
    for stage in stages:
        if stage.name in LEFT_OUT or not stage.applies(search):
            continue
        stop, share = None, stage.share(task.params)
        with recorded(task, stage.name), _within(share, search):
            stop = stage.run(search)
        if share.part is not None:
            stop = None  # that was the end of the share
        if stop is None and task.bracket.is_closed:
            stop = Stop.CLOSED
        if stop is None and task.budget.is_interrupted:
            stop = Stop.INTERRUPTED
        if stop is not None:
            return stop
    return None


@contextmanager
def _within(share: Share, search: Staged) -> Iterator[None]:
    """Give the search a share of the budget."""
    if share == WHOLE:
        yield
        return
    whole, part = search.task, 1.0 if share.part is None else share.part
    with whole.budget.stage(part, max_nodes=share.max_nodes) as budget:
        search.task = replace(whole, budget=budget)
        try:
            yield
        finally:
            search.task = whole


@contextmanager
def recorded(task: AttackTask, name: str) -> Iterator[None]:
    """Note what is done inside, unless stages of its own note it."""
    bracket, budget, before = task.bracket, task.budget, len(task.records)
    lower, upper, nodes, began = bracket.lower, bracket.upper, budget.nodes, budget.elapsed
    try:
        yield
    finally:
        if len(task.records) == before:
            task.records.append(
                StageRecord(
                    name=name,
                    seconds=budget.elapsed - began,
                    nodes=budget.nodes - nodes,
                    lower_before=lower,
                    lower=bracket.lower,
                    upper_before=upper,
                    upper=bracket.upper,
                )
            )


class AttackNodes(ABC, Generic[N, B]):
    """Branch and bound over attacks, resumable; the task's bracket, whose lower end rises, is valid whenever it stops.

    A tree has open ``nodes``, its ``explore`` bounds one of interest, and its ``branch`` divides it.
    """

    task: AttackTask
    nodes: OpenNodes[N]

    def run(self) -> Stop:
        """Divide nodes until none is below the goal of the bracket.

        Raises
        ------
        OutOfBudget : time, nodes or evaluations are spent.
        InputError : the function falls, or is not submodular though it says so.
        """
        return divide_nodes(self.nodes, self) or Stop.CLOSED

    def stop(self) -> Stop | None:
        """Raise the lower end to the least bound; stop once the bracket is closed."""
        bracket = self.task.bracket
        bracket.raise_lower(min(bracket.goal, self.nodes.bound))
        return Stop.CLOSED if bracket.is_closed else None

    def bound(self, node: N) -> B | None:
        """Explore a node below the goal."""
        if node.bound >= self.task.bracket.goal:
            return None
        self.task.budget.spend()
        return self.explore(node)

    @abstractmethod
    def explore(self, node: N) -> B | None:
        """Bound a node and offer its attacks; ``None`` if it holds none of interest."""

    @abstractmethod
    def branch(self, bounded: B) -> Iterable[N]:
        """Return the children of a node."""


def go_on(task: AttackTask, search: Resumable) -> Stop:
    """Run a search, begun or new, that the memory keeps for a later call."""
    search.task, task.memory.search = task, search
    return search.run()
