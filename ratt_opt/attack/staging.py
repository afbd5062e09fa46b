"""Searches as tables of stages: what is asked, when it applies, what share of the budget it has, and what it did."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Generic, Protocol, TypeVar

from ratt_opt.attack.task import StageRecord
from ratt_opt.budget import Stop

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from ratt_opt.attack.task import AttackTask

__all__ = ["Stage", "recorded", "run_stages", "without_stages"]


class Staged(Protocol):
    """A search that is made of stages; while a stage has a share of the budget, ``task`` has that share."""

    task: AttackTask


S = TypeVar("S", bound=Staged)


def _always(search: Staged) -> bool:  # noqa: ARG001  (the shape of a condition)
    """Always."""
    return True


@dataclass(frozen=True, slots=True)
class Stage(Generic[S]):
    """A row of a schedule.

    ``run`` : what is done; if it returns why it stopped and has no share, the schedule ends with that
    ``applies`` : when; its docstring says it
    ``share`` : of the seconds, evaluations and nodes left; ``None`` for all of them. ``max_nodes`` : no more than these
    """

    name: str
    run: Callable[[S], Stop | None]
    applies: Callable[[S], bool] = _always
    share: float | None = None
    max_nodes: int | None = None


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
        stop = None
        with recorded(task, stage.name), _share(stage, search):
            stop = stage.run(search)
        if stage.share is not None:
            stop = None  # that was the end of the share
        if stop is None and task.bracket.is_closed:
            stop = Stop.CLOSED
        if stop is None and task.budget.is_interrupted:
            stop = Stop.INTERRUPTED
        if stop is not None:
            return stop
    return None


@contextmanager
def _share(stage: Stage[S], search: S) -> Iterator[None]:
    """Give the search the stage's share of the budget; that it ends is the end of the stage only."""
    if stage.share is None and stage.max_nodes is None:
        yield
        return
    whole = search.task
    share = 1.0 if stage.share is None else stage.share
    with whole.budget.stage(share, max_nodes=stage.max_nodes) as part:
        search.task = replace(whole, budget=part)
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
