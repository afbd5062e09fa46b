"""Relaxed plans: every robot mixes its elements."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.problem import Problem

__all__ = ["mixed_information", "uniform_selection"]


def uniform_selection(problem: Problem) -> FloatArray:
    """(E,) every robot mixes its elements equally."""
    selection = np.empty(problem.objective.n)
    for choice in problem.choices:
        selection[choice] = 1 / len(choice)
    return selection


def mixed_information(problem: Problem, selection: FloatArray) -> FloatArray:
    """(N, M, d, d) information of each robot under weights (E,) of the elements of an information criterion."""
    information = problem.information_objective.information
    chosen = np.flatnonzero(selection)
    owner = np.zeros((problem.n_robots, len(chosen)))
    owner[problem.robot[chosen], np.arange(len(chosen))] = selection[chosen]
    flat = owner @ information[chosen].reshape(len(chosen), -1)
    return np.asarray(flat.reshape(-1, *information.shape[1:]))
