"""Inequalities of single targets against every set of the elements that touch one, and rows against groups."""

import numpy as np
import pytest

from ratt_opt import LogDetObjective, Problem, TraceObjective
from ratt_opt.solvers.maxmin.elements import Task
from ratt_opt.solvers.maxmin.params import RowParams
from ratt_opt.solvers.maxmin.rows.base_sets import base_set_inequalities
from ratt_opt.solvers.maxmin.rows.inequalities import tangents
from ratt_opt.solvers.maxmin.rows.pool import InequalityPool
from tests.solvers.maxmin.proofs import target_value

ELEMENTS = 8
ALL_SETS = (np.arange(2**ELEMENTS)[:, None] >> np.arange(ELEMENTS) & 1).astype(bool)


def drawn_task(rng: np.random.Generator, elements: int = ELEMENTS) -> Task:
    """A team of some elements, of dimension one to three, that see targets well, badly or not at all."""
    robots, targets, d = int(rng.integers(1, 1 + elements // 2)), int(rng.integers(1, 4)), int(rng.integers(1, 4))
    owner = np.sort(np.concatenate([np.arange(robots), rng.integers(0, robots, elements - robots)]))
    roots = rng.normal(size=(elements, targets, d, d)) * 10.0 ** rng.uniform(-3, 3, size=(elements, targets, 1, 1))
    roots[rng.random((elements, targets)) < 0.4, 1:] = 0.0  # one direction
    roots[rng.random((elements, targets)) < 0.3] = 0.0
    information = np.einsum("ejki,ejkl->ejil", roots, roots)
    spread = rng.normal(size=(targets, d, d))
    prior = spread @ np.swapaxes(spread, 1, 2) + 0.05 * np.eye(d)
    weights = rng.uniform(0.1, 3, targets)
    kind = int(rng.integers(3))
    if kind == 0:
        objective = LogDetObjective(prior, information, weights)
    elif kind == 1:
        objective = TraceObjective(prior, information, weights)
    else:
        output = rng.normal(size=(int(rng.integers(1, d + 1)), d))
        objective = TraceObjective(prior, information, weights, output=output)
    alpha_s = int(rng.integers(0, robots))
    return Task.of(Problem(objective, owner.tolist(), None, alpha_s, 0))


def values_of_all_sets(task: Task) -> np.ndarray:
    """(2^E, M) by the criterion of each set of elements."""
    objective = task.objective
    added = np.tensordot(ALL_SETS.astype(float), objective.information, axes=1)
    return objective.target_values(objective.prior_information + added)


@pytest.mark.parametrize("seed", range(150))
def test_hold_for_every_set(seed: int) -> None:
    rng = np.random.default_rng([64, seed])
    task = drawn_task(rng)
    objective, values = task.objective, values_of_all_sets(task)
    every = np.arange(objective.n_targets)
    points = [objective.posterior_mixture(10.0 ** rng.uniform(-2, 1) * rng.random(ELEMENTS)) for _ in range(4)]
    parts = [*base_set_inequalities(task, RowParams()), *(tangents(objective, point, every) for point in points)]
    # Sets of more than one element of a robot are no plan's: the errors of values are bounded for those alone.
    rounding = 16 * objective.rounding
    for part in parts:
        claimed = part.constants + ALL_SETS @ part.scores
        assert (claimed >= values[:, part.targets] - rounding).all()


@pytest.mark.parametrize("seed", range(40))
def test_base_sets_are_exact_at_themselves_and_tangents_where_they_touch(seed: int) -> None:
    rng = np.random.default_rng([65, seed])
    task = drawn_task(rng)
    objective, values = task.objective, values_of_all_sets(task)
    scale = np.abs(values).max() + objective.rounding
    for part in base_set_inequalities(task, RowParams()):
        claimed = part.constants + ALL_SETS @ part.scores
        assert ((claimed - values[:, part.targets]).min(axis=0) <= 1e-6 * scale).all()  # semidefinite: a little more
    share = rng.random(ELEMENTS)
    point = objective.posterior_mixture(share)
    touching = tangents(objective, point, np.arange(objective.n_targets))
    exact = [target_value(objective, j, point[j]) for j in range(objective.n_targets)]
    assert touching.constants + share @ touching.scores == pytest.approx(exact, abs=1e-6 * scale)


@pytest.mark.parametrize("seed", range(40))
def test_rows_bound_groups_and_survive_forgetting(seed: int) -> None:
    rng = np.random.default_rng([66, seed])
    task = drawn_task(rng)
    objective, robots = task.objective, task.problem.n_robots
    pool = InequalityPool.of(task, RowParams(most=40))
    for _ in range(12):
        share = np.where(rng.random(ELEMENTS) < 0.5, rng.random(ELEMENTS), 0.0)
        pool.add([tangents(objective, objective.posterior_mixture(share), np.arange(objective.n_targets))])
        group = tuple(np.flatnonzero(rng.random(robots) < 0.7).tolist())
        row = pool.row(group, share)
        inside = np.isin(task.problem.robot, group)
        plans = ALL_SETS[(ALL_SETS & ~inside).sum(axis=1) == 0]
        values = objective.evaluate(plans)
        assert (row.constant + plans @ row.scores >= values - 16 * objective.rounding).all()
        bound = pool.target_bounds(np.isin(np.arange(robots), group)[None].astype(float), pool.by_robot(share)).sum()
        assert row.constant + row.scores @ share == pytest.approx(bound, rel=1e-9, abs=1e-12 * (1 + row.scores.max()))
        assert {part.target for part in row.parts} == set(range(objective.n_targets))
