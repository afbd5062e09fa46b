"""A study with functions of its own, for tests of the engine; worker processes import it by name."""

import numpy as np

import ratt_opt as ro
from ratt_opt.studies.cases import Case, Seeds
from ratt_opt.studies.study import Study

__all__ = ["STUDY", "boldest", "cover", "first_robot"]


class Cells(ro.SetFunction):
    """How many cells are seen by a set of elements, each of which sees some."""

    def __init__(self, sees: np.ndarray) -> None:
        self.sees = sees

    @property
    def n(self) -> int:
        return len(self.sees)

    def evaluate(self, membership):
        return (membership @ self.sees.astype(int) > 0).sum(axis=-1).astype(float)


def cover(case: Case, seeds: Seeds) -> ro.Problem:
    """Two views a robot, each of three random cells of a dozen."""
    rng = np.random.default_rng(seeds.scenario)
    sees = np.array([np.isin(np.arange(12), rng.choice(12, 3, replace=False)) for _ in range(2 * case.n_robots)])
    return ro.Problem(Cells(sees), np.repeat(np.arange(case.n_robots), 2), None, case.alpha_s, case.alpha_c)


def boldest(problem: ro.Problem):
    """Every robot's element of the largest value alone."""
    values = problem.objective.singletons()
    return [int(own[np.argmax(values[own])]) for own in problem.choices]


def first_robot(problem: ro.Problem, plan):  # noqa: ARG001
    """Blind robot 0."""
    return ro.Attack(frozenset({0}), frozenset())


STUDY = Study(
    name="own",
    cases=(Case(n_robots=4, n_targets=1, alpha_s=1, alpha_c=0),),
    planners=("ratt", boldest),
    attackers=("worst", first_robot),
    metrics=("value", "proved"),
    quantities=("optimum",),
    problem=cover,
)
