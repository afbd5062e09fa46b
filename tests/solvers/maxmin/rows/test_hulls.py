"""Inequalities of hulls against every set of a target's elements, and against the concave envelope itself."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from scipy.optimize import linprog

from ratt_opt import LogDetObjective, MaxMinParams, Problem, TraceObjective, limited_view_scenario, solve_maxmin
from ratt_opt.solvers.maxmin.elements import Task
from ratt_opt.solvers.maxmin.params import RowParams
from ratt_opt.solvers.maxmin.rows.base_sets import first_of_each_class, semidefinite
from ratt_opt.solvers.maxmin.rows.hulls import TargetHull, hulls_of
from ratt_opt.solvers.maxmin.rows.separation import RowSeparation

ROBOTS, CONTROLS, TARGETS = 4, 3, 2


def drawn_team(rng: np.random.Generator, kind: type[TraceObjective] | type[LogDetObjective], d: int) -> Task:
    """Elements that see targets well, badly, in one direction or not at all; some are equal."""
    n = ROBOTS * CONTROLS
    roots = rng.normal(size=(n, TARGETS, d, d)) * 10.0 ** rng.uniform(-2, 2, size=(n, TARGETS, 1, 1))
    roots[rng.random((n, TARGETS)) < 0.4, 1:] = 0.0
    roots[rng.random((n, TARGETS)) < 0.2] = 0.0
    if rng.random() < 0.3:
        roots[1] = roots[0]
    information = np.einsum("ejki,ejkl->ejil", roots, roots)
    spread = rng.normal(size=(TARGETS, d, d))
    prior = spread @ np.swapaxes(spread, 1, 2) + 0.05 * np.eye(d)
    objective = kind(prior, information, rng.uniform(0.1, 3, TARGETS))
    return Task.of(Problem(objective, np.repeat(np.arange(ROBOTS), CONTROLS).tolist(), None, 1, 0))


def drawn_hulls(task: Task) -> list[TargetHull | None]:
    """The hulls as a search has them."""
    information = semidefinite(task.objective.information)
    return hulls_of(task, RowParams(), information, first_of_each_class(task))


def sets_of(hull: TargetHull, task: Task) -> np.ndarray:
    """(K, k) all sets of at most one of the hull's elements of each robot."""
    owners = task.problem.robot[hull.elements]
    options = [[None, *np.flatnonzero(owners == i).tolist()] for i in np.unique(owners)]
    sets = np.zeros((int(np.prod([len(o) for o in options])), len(owners)), dtype=bool)
    for row, chosen in zip(sets, product(*options), strict=True):
        row[[e for e in chosen if e is not None]] = True
    return sets


def values_of(task: Task, target: int, elements: np.ndarray, sets: np.ndarray) -> np.ndarray:
    """(K,) by the criterion."""
    one = task.objective.of_target(target)
    added = np.tensordot(sets.astype(float), one.information[elements], axes=1)
    return np.asarray(one.target_values(one.prior_information + added)[:, 0])


@pytest.mark.parametrize("kind", [TraceObjective, LogDetObjective])
@pytest.mark.parametrize("seed", range(25))
def test_hold_for_every_set_and_are_nearly_the_envelope(seed: int, kind: type) -> None:
    rng = np.random.default_rng([71, seed])
    task = drawn_team(rng, kind, 1 + seed % 2)
    for target, hull in enumerate(drawn_hulls(task)):
        if hull is None:
            continue
        sets = sets_of(hull, task)
        values = values_of(task, target, hull.elements, sets)
        for _ in range(3):
            selection = np.where(rng.random(task.objective.n) < 0.6, rng.random(task.objective.n), 0.0)
            for choice in task.problem.choices:
                selection[choice] /= max(selection[choice].sum(), 1.0)
            share = selection[hull.elements]
            found = hull.inequality(share, np.inf)
            if found is None:
                assert not ((share > 1e-3) & (share < 1 - 1e-3)).any()
                continue
            constant, scores = found
            assert (constant + sets @ scores >= values).all()
            least = linprog(
                np.append(1.0, share),
                A_ub=-np.column_stack([np.ones(len(sets)), sets]),
                b_ub=-values,
                bounds=[(None, None), *[(0, None)] * len(share)],
            )
            allowed = 1e-4 * values.max() + 2e-3 * scores.sum()  # of weights that count as none
            assert least.fun - 1e-7 * values.max() <= constant + scores @ share <= least.fun + allowed


@pytest.mark.parametrize("kind", [TraceObjective, LogDetObjective])
@pytest.mark.parametrize("seed", range(40))
def test_the_largest_excess_is_that_of_all_sets(seed: int, kind: type) -> None:
    rng = np.random.default_rng([72, seed])
    task = drawn_team(rng, kind, 1 + seed % (3 if kind is LogDetObjective else 2))
    for target, hull in enumerate(drawn_hulls(task)):
        if hull is None:
            continue
        sets = sets_of(hull, task)
        values = values_of(task, target, hull.elements, sets)
        prices = values.max() * rng.random(len(hull.elements)) * rng.choice([0.05, 0.3, 1.0])
        tolerance = 1e-6 * values.max()
        worth = (values - sets @ prices).max()
        found, chosen = hull.seers.largest_excess(prices, 0.0, tolerance, 10**6)
        assert worth <= found <= worth + 1.1 * tolerance + 1e-9 * values.max()
        best = np.isin(np.arange(len(prices)), chosen)
        assert values_of(task, target, hull.elements, best[None])[0] - prices[best].sum() >= worth - 1.1 * tolerance


def test_a_search_that_is_cut_off_claims_nothing() -> None:
    task = drawn_team(np.random.default_rng(5), LogDetObjective, 2)
    hull = drawn_hulls(task)[0]
    assert hull is not None
    assert hull.seers.largest_excess(np.zeros(len(hull.elements)), 0.0, 0.0, 1)[0] == np.inf


def test_a_trace_in_space_has_no_hulls() -> None:
    assert drawn_hulls(drawn_team(np.random.default_rng(6), TraceObjective, 3)) == [None] * TARGETS


def test_a_trace_of_outputs_has_none() -> None:
    task = drawn_team(np.random.default_rng(7), TraceObjective, 2)
    f = task.objective
    part = TraceObjective(f.prior, f.information, output=np.ones((1, 2)))
    assert drawn_hulls(Task.of(replace(task.problem, objective=part))) == [None] * TARGETS


@pytest.mark.parametrize(("least", "rounds"), [(0.0, 2), (1e9, 1)])
def test_rounds_end_at_the_root_that_take_off_too_little(least, rounds, monkeypatch):
    problem = limited_view_scenario(6, 6, alpha_s=2, alpha_c=0, seed=0, view=57).problem("logdet")
    params = replace(MaxMinParams(), rows=RowParams(seen=0.0, hull_least=least, hulls_at_root=2))
    asked = []
    monkeypatch.setattr(RowSeparation, "sharpen", sharpen_and_note(asked))
    found = solve_maxmin(problem, params=params, max_nodes=1)
    assert len(asked) == rounds
    assert found.lower <= found.upper


def sharpen_and_note(asked: list[int]):
    """Build the rounds as they are, which are noted."""
    plain = RowSeparation.sharpen

    def sharpen(self, relaxed, groups, open_value):
        asked.append(len(groups))
        return plain(self, relaxed, groups, open_value)

    return sharpen
