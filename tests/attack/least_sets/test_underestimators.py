"""The underestimator's parts: outer polytopes hold every set, and the ascent reaches the linear program's optimum."""

from itertools import combinations

import numpy as np
import pytest
from scipy.optimize import approx_fprime, linprog

from ratt_opt.attack.least_sets.outer_polytopes import outer_polytopes
from ratt_opt.attack.least_sets.sets_of_size import SetFamily
from ratt_opt.attack.least_sets.smoothed_dual import Multipliers
from ratt_opt.attack.least_sets.underestimator import _program, affine_underestimator
from ratt_opt.attack.team import Team
from ratt_opt.budget import Budget
from tests.strategies import OBJECTIVES, range_bearing


def sensor_family(name, seed, n_robots=9, n_targets=4, size=None):
    rng = np.random.default_rng(seed)
    team = Team.of(OBJECTIVES[name](*range_bearing(rng, n_robots, n_targets, 1)), np.arange(n_robots))
    size = int(rng.integers(2, n_robots - 2)) if size is None else size
    return team, SetFamily.of(team, np.arange(n_robots), size)


def dual_program(family, n_heavy):
    points = outer_polytopes(family, n_heavy)
    assert points.sound.all()
    return _program(family, points)


def optimum(program):
    """The least value of shares of points and fractions of robots that agree on light information and heavy robots."""
    n_points, n_robots, n_heavy = len(program.values), len(program.information), program.heavy.shape[1]
    target = np.repeat(np.arange(len(program.heavy)), np.diff(program.first))
    rows, right = [], []
    for j, robots in enumerate(program.heavy):
        mine = target == j
        rows.append(np.concatenate([mine, np.zeros(n_robots)]))
        right.append(1.0)
        for t in range(3):
            scale = np.abs(program.information[:, j, t]).max() + 1e-300
            column = np.where(mine, program.light[:, t], 0.0)
            rows.append(np.concatenate([column, -program.information[:, j, t]]) / scale)
            right.append(0.0)
        for q in range(n_heavy):
            held = np.where(mine, program.patterns[program.pattern, q], 0.0)
            rows.append(np.concatenate([held, -(np.arange(n_robots) == robots[q]).astype(float)]))
            right.append(0.0)
    rows.append(np.concatenate([np.zeros(n_points), np.ones(n_robots)]))
    right.append(program.size)
    costs = np.concatenate([program.values, np.zeros(n_robots)])
    bounds = [(0, None)] * n_points + [(0, 1)] * n_robots
    found = linprog(costs, A_eq=np.array(rows), b_eq=right, bounds=bounds)
    assert found.status == 0
    return found.fun


@pytest.mark.parametrize("name", ["trace", "logdet"])
@pytest.mark.parametrize("seed", range(8))
def test_outer_polytopes_hold_every_set(name, seed):
    team, family = sensor_family(name, seed)
    rng = np.random.default_rng(seed)
    points = outer_polytopes(family, 2)
    functionals = rng.normal(size=(40, 3)) / np.abs(team.information).max(axis=(0, 1))
    for chosen in combinations(range(9), family.size):
        for j, robots in enumerate(points.heavy):
            pattern = sum(2**q for q, robot in enumerate(robots) if robot in chosen)
            light = team.information[[i for i in chosen if i not in robots], j].sum(axis=0)
            mine = slice(points.first[j], points.first[j + 1])
            vertices = points.light[mine][points.pattern[mine] == pattern]
            assert ((vertices @ functionals.T).min(axis=0) <= functionals @ light + 1e-9).all()


@pytest.mark.parametrize("name", ["trace", "logdet"])
@pytest.mark.parametrize("seed", range(6))
def test_the_smoothed_bound_is_smooth_and_near(name, seed):
    _, family = sensor_family(name, seed)
    program = dual_program(family, 2)
    rng = np.random.default_rng(seed)
    n_targets, n_robots = len(program.heavy), len(program.information)
    scale = 1 / np.abs(program.information).max()

    def evaluate(point, temperature):
        shaped = point.reshape(n_targets, 5)
        gradient, fraction = np.zeros((n_targets, 5)), np.zeros(n_robots)
        multipliers = Multipliers(scale * shaped[:, :3], shaped[:, 3:].copy())
        bound, value = program.smoothed(multipliers, temperature, gradient, fraction)
        gradient[:, :3] *= scale
        return bound, value, gradient.ravel(), fraction

    point = rng.normal(size=n_targets * 5)
    bound, _, gradient, fraction = evaluate(point, 0.3)
    assert fraction.sum() == pytest.approx(program.size)
    assert gradient == pytest.approx(approx_fprime(point, lambda x: evaluate(x, 0.3)[1], 1e-6), abs=2e-5)
    multipliers = Multipliers(scale * point.reshape(n_targets, 5)[:, :3], point.reshape(n_targets, 5)[:, 3:])
    assert bound == pytest.approx(program.bound(multipliers, program.rest(multipliers)))
    most = np.log(np.diff(program.first)).sum() + n_robots * np.log(2)
    for temperature in (1.0, 1e-2, 1e-4):
        assert bound - temperature * most - 1e-9 <= evaluate(point, temperature)[1] <= bound + 1e-9


@pytest.mark.parametrize("name", ["trace", "logdet"])
@pytest.mark.parametrize("seed", range(10))
def test_the_ascent_comes_near_the_linear_program(name, seed):
    """And never passes it; a warm start loses nothing."""
    _, family = sensor_family(name, seed)
    program = dual_program(family, 2)
    best = optimum(program)
    start = Multipliers(np.zeros((len(program.heavy), 3)), np.zeros(program.heavy.shape))
    first = program.bound(start, program.rest(start))
    reached, fraction = program.ascend(start, best, cold=True)
    bound = program.bound(reached, program.rest(reached))
    assert first <= bound <= best + 1e-7 * abs(best)
    assert best - bound <= 0.05 * (best - first)
    assert fraction.sum() == pytest.approx(program.size)
    again, _ = program.ascend(reached, best, cold=False)
    assert program.bound(again, program.rest(again)) >= bound


class LooksLeft(Budget):
    """Over once it has been asked so many times."""

    __slots__ = ("looks",)

    @property
    def is_over(self) -> bool:
        self.looks -= 1
        return self.looks < 0


@pytest.mark.parametrize("seed", range(5))
def test_an_ascent_ends_with_its_budget_and_keeps_what_it_has(seed):
    """On a thousand robots it took two seconds in which no limit was looked at."""
    _, family = sensor_family("logdet", seed)
    program = dual_program(family, 2)
    start = Multipliers(np.zeros((len(program.heavy), 3)), np.zeros(program.heavy.shape))
    best, bounds = optimum(program), []
    for looks in (0, 2, 5, 1_000):
        budget = LooksLeft()
        budget.looks = looks
        reached, _ = program.ascend(start, best, cold=True, budget=budget)
        assert looks == 1_000 or -2 <= budget.looks < 0  # one more look between two temperatures
        bounds.append(program.bound(reached, program.rest(reached)))
    assert bounds[0] == program.bound(start, program.rest(start))
    assert bounds == sorted(bounds)
    assert bounds[0] < bounds[1] < bounds[3]


@pytest.mark.parametrize("name", ["trace", "logdet"])
@pytest.mark.parametrize("seed", range(6))
def test_a_restricted_minorant_and_its_child_hold_below_every_set_left(name, seed):
    team, family = sensor_family(name, seed, size=4)
    parent = affine_underestimator(family, 2, np.inf)
    robot = int(np.argmax(parent.tension))
    it = np.arange(9) == robot
    others = np.flatnonzero(~it)
    for inside in (True, False):
        smaller = SetFamily.of(team, others, 4 - inside, [robot] if inside else [])
        restricted = parent.restricted(~it, it if inside else np.zeros_like(it))
        child = affine_underestimator(smaller, 3, np.inf, restricted)
        for chosen in combinations(range(8), 4 - inside):
            value = team.value([*others[list(chosen)], robot][: 4 if inside else -1])
            for underestimator in (restricted, child):
                assert underestimator.constant + underestimator.scores[list(chosen)].sum() <= value + 1e-9
