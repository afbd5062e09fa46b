"""What one search is about, passed as one value."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.bounds.cuts import mixed_information

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.problem import Problem
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["Choices", "Task", "with_choice"]

Choices = tuple["IntArray", ...]
"""Per robot, the elements that remain; one of each class of equal ones."""


@dataclass(frozen=True, slots=True, eq=False)
class Task:
    """A problem whose objective is an information criterion, and which elements differ.

    ``classes`` : per robot, lowest element -> all its elements with the same information: one of each is searched.
    ``choices`` : the first element of each class of each robot: all that a search has to choose from.
    ``singles`` : (E,) values of the elements alone.
    """

    problem: Problem
    objective: InformationObjective
    classes: tuple[dict[int, list[int]], ...]
    choices: Choices
    singles: FloatArray

    @classmethod
    def of(cls, problem: Problem) -> Task:
        """Group each robot's elements by equal information."""
        objective = problem.information_objective
        classes = []
        for choice in problem.choices:
            alike: dict[bytes, list[int]] = {}
            for e in choice.tolist():
                alike.setdefault(objective.information[e].tobytes(), []).append(e)
            classes.append({members[0]: members for members in alike.values()})
        choices = tuple(np.array(sorted(own), dtype=np.int64) for own in classes)
        return cls(problem, objective, tuple(classes), choices, objective.singletons())

    def members(self, robot: int, elements: IntArray) -> tuple[int, ...]:
        """All elements of one robot that are equal to one of these."""
        return tuple(sorted(e for first in elements.tolist() for e in self.classes[robot][first]))

    def mixed(self, selection: FloatArray) -> FloatArray:
        """(N, M, d, d) information of each robot under a relaxed selection (E,)."""
        return mixed_information(self.problem, selection)


def with_choice(choices: Choices, robot: int, elements: IntArray) -> Choices:
    """``choices`` with those of one robot replaced."""
    return (*choices[:robot], elements, *choices[robot + 1 :])
