"""The elements that a search chooses from: one of each class of equal ones, undominated ones, and as C reads them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.team import LARGEST_DIMENSION
from ratt_opt.bounds.cuts import mixed_information
from ratt_opt.errors import InputError
from ratt_opt.native.library import address, checked
from ratt_opt.native.loops import ElementsRecord
from ratt_opt.setfunctions.base import IMPROVEMENT
from ratt_opt.setfunctions.information import triangles
from ratt_opt.solvers.maxmin.params import or_default
from ratt_opt.solvers.undominated import dominators, undominated

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.problem import Problem
    from ratt_opt.setfunctions.information import InformationObjective
    from ratt_opt.solvers.maxmin.params import MaxMinParams
    from ratt_opt.solvers.undominated import UndominatedProblem

__all__ = ["Choices", "Elements", "ElementsRecord", "PackedElements", "Task", "padded", "with_choice"]

Choices = tuple["IntArray", ...]
"""Per robot, the elements that remain; one of each class of equal ones."""


@dataclass(frozen=True, slots=True, eq=False)
class Task:
    """A problem whose objective is an information criterion, and which elements differ.

    ``classes`` : per robot, lowest element -> all its elements with the same information: one of each is searched.
    ``choices`` : the first element of each class of each robot: all that a search has to choose from.
    ``singles`` : (E,) values of the elements alone. ``params`` : of the search
    """

    problem: Problem
    objective: InformationObjective
    classes: tuple[dict[int, list[int]], ...]
    choices: Choices
    singles: FloatArray
    params: MaxMinParams

    @classmethod
    def of(cls, problem: Problem, params: MaxMinParams | None = None) -> Task:
        """Group each robot's elements by equal information."""
        objective = problem.information_objective
        classes = []
        for choice in problem.choices:
            alike: dict[bytes, list[int]] = {}
            for e in choice.tolist():
                alike.setdefault(objective.information[e].tobytes(), []).append(e)
            classes.append({members[0]: members for members in alike.values()})
        choices = tuple(np.array(sorted(own), dtype=np.int64) for own in classes)
        return cls(problem, objective, tuple(classes), choices, objective.singletons(), or_default(params))

    def members(self, robot: int, elements: IntArray) -> tuple[int, ...]:
        """All elements of one robot that are equal to one of these."""
        return tuple(sorted(e for first in elements.tolist() for e in self.classes[robot][first]))

    def indicator(self, elements: IntArray) -> FloatArray:
        """(E,) 1 for these elements, 0 for others."""
        chosen = np.zeros(self.objective.n)
        chosen[elements] = 1.0
        return chosen

    def mixed(self, selection: FloatArray) -> FloatArray:
        """(N, M, d, d) information of each robot under a relaxed selection (E,)."""
        return mixed_information(self.problem, selection)


def with_choice(choices: Choices, robot: int, elements: IntArray) -> Choices:
    """``choices`` with those of one robot replaced."""
    return (*choices[:robot], elements, *choices[robot + 1 :])


class Elements:
    """``problem`` : over the undominated elements; ``members`` : the elements of the whole one that each dominates."""

    def __init__(self, whole: Problem) -> None:
        self.whole = whole
        self.problem: UndominatedProblem = undominated(whole)
        owner = dominators(whole, self.problem.kept)
        stands_for: list[list[int]] = [[] for _ in self.problem.kept]
        for e, k in enumerate(owner.tolist()):
            stands_for[k].append(e)
        self.stands_for = tuple(map(tuple, stands_for))

    def members(self, elements: IntArray) -> tuple[int, ...]:
        """All elements of the whole problem that these stand for."""
        return tuple(sorted(e for k in elements.tolist() for e in self.stands_for[k]))


class PackedElements:
    """Information of elements about the targets; symmetric matrices packed, T = d (d + 1) / 2 entries.

    ``criterion`` : the code of trace or log-det; ``weights``, ``baseline`` : (M,) and the weighted criterion of the
    prior information ``prior`` (M, T); ``information`` : (E, M, T); ``sees`` : (E, M) whether there is information
    ``rounding`` : of values

    Raises
    ------
    InputError : a shape or a type is another, or d > 64.
    """

    def __init__(
        self,
        criterion: int,
        dimension: int,
        *,
        weights: FloatArray,
        baseline: FloatArray,
        prior: FloatArray,
        information: FloatArray,
        sees: BoolArray,
        rounding: float = 0.0,
    ) -> None:
        if not 1 <= dimension <= LARGEST_DIMENSION:
            raise InputError("dimension", f"must be in [1, {LARGEST_DIMENSION}]", dimension)
        self.count, self.targets, entries = len(information), len(prior), dimension * (dimension + 1) // 2
        self.prior, self.sees = prior, sees
        self._arrays = weights, baseline, prior, information, sees  # the record has their addresses only
        self.record = ElementsRecord(
            elements=self.count,
            targets=self.targets,
            entries=entries,
            dimension=dimension,
            criterion=criterion,
            weights=address(checked("weights", weights, np.float64, (self.targets,))),
            baseline=address(checked("baseline", baseline, np.float64, (self.targets,))),
            prior=address(checked("prior", prior, np.float64, (self.targets, entries))),
            information=address(checked("information", information, np.float64, (self.count, self.targets, entries))),
            sees=address(checked("sees", sees, np.bool_, (self.count, self.targets))),
            relative=IMPROVEMENT.relative,
            rounding=rounding,
        )

    @classmethod
    def of(cls, objective: InformationObjective, information: FloatArray, sees: BoolArray) -> PackedElements:
        """Pack the elements of a criterion, with ``information`` (E, M, d, d)."""
        prior = objective.prior_information
        assert objective.compiled_code is not None
        return cls(
            objective.compiled_code,
            objective.dimension,
            weights=np.array(objective.weights),
            baseline=np.ascontiguousarray(objective.criterion(prior)),
            prior=triangles(prior),
            information=triangles(information),
            sees=np.ascontiguousarray(sees),
            rounding=objective.rounding,
        )


def padded(rows: Sequence[Sequence[int] | IntArray]) -> IntArray:
    """(K, S) numbers, filled up by -1, as C reads rows of different lengths."""
    full = np.full((len(rows), max(map(len, rows), default=0)), -1, dtype=np.int64)
    for row, own in zip(full, rows, strict=True):
        row[: len(own)] = own
    return full
