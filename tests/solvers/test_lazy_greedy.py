"""Gains that C evaluates, and what bounds later ones, against the values of the objective; and what C may not read."""

import numpy as np
import pytest

from ratt_opt import InputError
from ratt_opt.budget import Budget
from ratt_opt.solvers.lazy_greedy import LazyGreedy, LazyGreedyParams
from tests.strategies import OBJECTIVES, information_data


def random_objective(name, seed):
    """Targets fewer than the lanes of C, as many, and more; weights alike or not."""
    rng = np.random.default_rng(seed)
    count, targets = [(1, 1), (12, 1), (20, 5), (15, 8), (15, 9), (12, 17)][seed % 6]
    prior, information = information_data(rng, count, targets)
    weights = [None, rng.uniform(0.2, 3, targets)][seed // 6 % 2]
    return OBJECTIVES[name](prior, information * 10.0 ** rng.integers(-2, 3, (count, 1, 1, 1)), weights)


@pytest.mark.parametrize("name", OBJECTIVES)
@pytest.mark.parametrize("seed", range(12))
def test_gains_are_marginals_and_never_exceed_earlier_bounds(name, seed):
    """All candidates at once, and one after the other."""
    f = random_objective(name, seed)
    is_open, chosen = np.ones(f.n, dtype=np.bool_), []
    params = LazyGreedyParams(at_once=[10**6, 1][seed % 2], first=[8, 8, 1, 1][seed % 4])
    greedy, scale = LazyGreedy(f, is_open, params), f.prior_magnitude
    while is_open.any():
        marginals = np.array([f([*chosen, e]) - f(chosen) if is_open[e] else -np.inf for e in range(f.n)])
        assert np.all(marginals[is_open] <= greedy._bounds[is_open] + 1e-11 * scale)
        pick = greedy.choose(Budget())
        known = np.isfinite(greedy._gains)
        assert known[pick]
        assert not known[~is_open].any()
        assert greedy._gains[known] == pytest.approx(marginals[known], rel=1e-9, abs=1e-12 * scale)
        assert marginals[pick] == pytest.approx(marginals[is_open].max(), rel=1e-9, abs=1e-12 * scale)
        near = is_open & (marginals >= marginals[is_open].max() - 1e-13 * scale)
        assert known[near].all()
        is_open[pick] = False
        chosen.append(pick)
    assert sorted(chosen) == list(range(f.n))


def test_bounds_spare_most_evaluations():
    rng = np.random.default_rng(3)
    for name in ("trace", "logdet"):
        f = OBJECTIVES[name](*information_data(rng, 200, 5))
        is_open, evaluated = np.ones(200, dtype=np.bool_), []
        greedy = LazyGreedy(f, is_open, LazyGreedyParams())
        for _ in range(10):
            is_open[greedy.choose(Budget())] = False
            evaluated.append(int(np.isfinite(greedy._gains).sum()))
        assert evaluated[0] == 200
        assert sum(evaluated[1:]) < 9 * 100


def test_nothing_is_chosen_when_the_budget_is_over():
    f = OBJECTIVES["trace"](*information_data(np.random.default_rng(0), 20, 2))
    greedy = LazyGreedy(f, np.ones(20, dtype=np.bool_), LazyGreedyParams())
    assert greedy.choose(Budget(0)) is None
    assert greedy.choose(Budget()) == int(np.argmax(f.singletons()))


def test_what_c_may_not_read_is_refused():
    f = OBJECTIVES["trace"](*information_data(np.random.default_rng(0), 6, 2))
    good = np.ones(6, dtype=np.bool_)
    LazyGreedy(f, good, LazyGreedyParams())
    for bad in (good.astype(np.int64), good.tolist(), good[:5], good[:, None], np.ones(12, dtype=np.bool_)[::2]):
        with pytest.raises(InputError):
            LazyGreedy(f, bad, LazyGreedyParams())
