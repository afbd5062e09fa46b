"""A hundred thousand inequalities of single targets against every set of up to twelve elements that touch one."""

import numpy as np
import pytest

from ratt_opt import Coverage, FacilityLocation, Part, SumFunction
from ratt_opt.solvers.maxmin.elements import Task
from ratt_opt.solvers.maxmin.params import RowParams
from ratt_opt.solvers.maxmin.rows.base_sets import base_set_inequalities, first_of_each_class, semidefinite
from ratt_opt.solvers.maxmin.rows.hulls import hulls_of
from ratt_opt.solvers.maxmin.rows.inequalities import tangents
from tests.solvers.maxmin.rows.test_inequalities import drawn_task

pytestmark = pytest.mark.slow

ELEMENTS, ASKED = 12, 100_000
ALL_SETS = (np.arange(2**ELEMENTS)[:, None] >> np.arange(ELEMENTS) & 1).astype(bool)


def inequalities_of(task: Task, rng: np.random.Generator) -> list[tuple[int, float, np.ndarray, bool]]:
    """(target, constant, scores, whether it is for plans' sets only) of tangents, base sets and hulls."""
    objective, every = task.objective, np.arange(task.objective.n_targets)
    points = [objective.posterior_mixture(10.0 ** rng.uniform(-2, 1) * rng.random(ELEMENTS)) for _ in range(8)]
    parts = [*base_set_inequalities(task, RowParams()), *(tangents(objective, point, every) for point in points)]
    found = [
        (int(part.targets[k]), float(part.constants[k]), part.scores[:, k], False)
        for part in parts
        for k in range(len(part.targets))
    ]
    first = first_of_each_class(task)
    for j, hull in enumerate(hulls_of(task, RowParams(), semidefinite(objective.information), first)):
        for _ in range(4 if hull is not None else 0):
            share = rng.random(ELEMENTS) * (rng.random(ELEMENTS) < 0.6)
            for choice in task.problem.choices:
                share[choice] /= max(share[choice].sum(), 1.0)
            inequality = hull.inequality(share[hull.elements], np.inf)
            if inequality is not None:
                scores = np.zeros(ELEMENTS)
                scores[hull.elements] = inequality[1]
                found.append((j, inequality[0], scores[first], True))
    return found


def test_a_hundred_thousand_of_criteria_hold_for_every_set() -> None:
    rng, checked, hulls = np.random.default_rng(91), 0, 0
    while checked < ASKED:
        task = drawn_task(rng, ELEMENTS)
        objective, problem = task.objective, task.problem
        added = np.tensordot(ALL_SETS.astype(float), objective.information, axes=1)
        values = objective.target_values(objective.prior_information + added)
        owners = np.zeros((ELEMENTS, problem.n_robots))
        owners[np.arange(ELEMENTS), problem.robot] = 1.0
        of_plans = (ALL_SETS @ owners <= 1).all(axis=1)
        rounding = 16 * objective.rounding
        for target, constant, scores, for_plans in inequalities_of(task, rng):
            sets = of_plans if for_plans else slice(None)
            claimed = constant + ALL_SETS[sets] @ scores
            assert (claimed >= values[sets, target] - rounding).all()
            checked, hulls = checked + 1, hulls + for_plans
    assert hulls >= 1_000


@pytest.mark.parametrize("kind", ["table", "coverage", "facilities"])
def test_overestimators_of_parts_hold_for_every_set(kind: str) -> None:
    rng = np.random.default_rng([92, len(kind)])
    for _ in range(1_500):
        k = int(rng.integers(1, 11))
        if kind == "coverage":
            f: SumFunction = Coverage(rng.random((k, 3)) < 0.5, rng.uniform(0, 2, 3))
        elif kind == "facilities":
            f = FacilityLocation(rng.random((k, 3)) * (rng.random((k, 3)) < 0.7))
        else:
            masks, k = np.arange(2 ** min(k, 8)), min(k, 8)
            steps = rng.random(2**k)
            table = np.array([max(steps[s] for s in masks if s & m == s) for m in masks])  # it does not decrease
            f = SumFunction(k, [Part(range(k), table - table[0])])
        for part in range(f.n_parts):
            touching = f.touching(part)
            sets = (np.arange(2 ** len(touching))[:, None] >> np.arange(len(touching)) & 1).astype(bool)
            values = f.part_values(part, sets)
            for _ in range(3):
                bound = f.overestimator(part, rng.random(len(touching)))
                assert (bound.constant + sets @ bound.gains >= values - 1e-12 * (1 + abs(values).max())).all()
