"""The max-eigenvalue criterion in the plane: every bound against every context, and the search to its end."""

from dataclasses import replace
from itertools import combinations, pairwise, product

import numpy as np
import pytest
from scipy.optimize import linprog

import ratt_opt as ro
from ratt_opt import _blocks
from ratt_opt.budget import Budget
from ratt_opt.curvatures.params import PlanarParams
from ratt_opt.curvatures.planar import ceilings as ceilings_module
from ratt_opt.curvatures.planar.ceilings import ceilings
from ratt_opt.curvatures.planar.context_search import PlanarSearch
from ratt_opt.curvatures.planar.contexts import Options, PlanarDescent, along, levels, marginals
from ratt_opt.curvatures.planar.inequalities import (
    least_enough,
    least_marginal,
    most_enough,
    most_marginal,
)
from ratt_opt.curvatures.planar.level_program import LevelProgram, Sector, own_direction
from ratt_opt.curvatures.planar.regions import MarginalSide
from tests.curvatures.engine import SEARCHED
from tests.interrupts import interrupted_at
from tests.strategies import information_data, range_bearing

FREE = Budget()
OWNERS = np.array([0, 0, 1, 1, 1, 2, 3])


def instance(rng, trial):
    """An objective over 7 elements of 4 robots: harmless, or degenerate."""
    if trial % 2:
        prior, information = range_bearing(rng, 1, 3, 7)
    else:
        prior, information = information_data(rng, 7, int(rng.integers(1, 4)), int(rng.integers(1, 3)))
    return ro.MaxEigenvalueObjective(prior, information, rng.uniform(0.5, 2, len(prior)))


def every_context(options):
    """All picks of one option an owner, (count, R)."""
    ends = np.append(options.first[1:], len(options.owners))
    return np.array(list(product(*[range(a, b) for a, b in zip(options.first, ends, strict=True)])))


def test_levels_and_marginals_are_those_of_the_matrices():
    rng = np.random.default_rng(1)
    for trial in range(40):
        f = instance(rng, trial)
        planar = f.planar_levels()
        options = Options.beside(planar, OWNERS, 0)
        for picks in every_context(options)[:: 1 + trial % 5]:
            context = options.context(picks)
            total = planar.prior + options.parts[picks].sum(axis=0)
            exact = np.linalg.eigvalsh(f.posterior_information(np.array(context, dtype=int)))[:, 0] / f.weights
            assert levels(total) * planar.scale == pytest.approx(exact, rel=1e-9)
            found = float(marginals(total, planar.parts[1])) / planar.scale
            assert found == pytest.approx(f([*context, 1]) - f(context), abs=1e-9 * f.prior_criterion)


def test_ceilings_hold_for_every_context_of_the_sector():
    rng = np.random.default_rng(2)
    inside = 0
    for trial in range(250):
        planar = instance(rng, trial).planar_levels()
        options, added = Options.beside(planar, OWNERS, 0), planar.parts[1]
        base, own_base = (planar.prior + added, planar.prior) if trial % 3 else (planar.prior, planar.prior + added)
        seen = own_base + options.parts[rng.choice(every_context(options))].sum(axis=0)
        target = int(rng.integers(planar.prior.shape[1]))
        middle = np.arctan2(-seen[2], -seen[1])[target] + rng.uniform(-0.3, 0.3)
        sector = Sector(target, float(middle), rng.uniform(0.05, 0.8))
        slope = float(rng.choice([0.0, 0.7, 1.0, 2.5]))
        allowed = rng.random(len(options.owners)) < 0.7
        allowed[options.first] |= np.bincount(options.owners, allowed) == 0
        program = LevelProgram(options, base, own_base, sector, allowed=allowed)
        if trial % 2:
            program.bound(slope + 0.5, FREE)
        found = program.bound(slope, FREE)
        other = Sector(0, rng.uniform(-4, 4), 0.3)
        direction = own_direction(np.array([other.middle]), np.array([other.half]))
        recycled = ceilings(options, base, own_base, np.array([0]), direction, [found], allowed)[0, 0]
        contexts = every_context(options)
        totals = options.parts[contexts[allowed[contexts].all(axis=1)]].sum(axis=1)
        exact = ((base + totals) * found.average).sum(axis=(1, 2))
        exact -= slope * (own_base + totals)[:, :, 0] @ direction[0]
        assert recycled == pytest.approx(exact.max(), abs=1e-9 * (1 + np.abs(totals).max()))
        free = LevelProgram(options, base, own_base, None, allowed=allowed).bound(0.0, FREE).ceiling
        for picks in every_context(options):
            parts = options.parts[picks].sum(axis=0)
            level, own, own_total = levels(base + parts).min(), levels(own_base + parts), own_base + parts
            away = np.angle(np.exp(1j * (np.arctan2(-own_total[2], -own_total[1]) - [[sector.middle], [other.middle]])))
            if allowed[picks].all():
                assert level <= free
                if abs(away[0, sector.target]) <= sector.half:
                    inside += 1
                    assert level - slope * own[sector.target] <= found.ceiling
                if abs(away[1, 0]) <= other.half:
                    assert level - slope * own[0] <= recycled
    assert inside > 500


def sector_rows(options, own_base, sector):
    """Coefficients and constants of the bound on a target's level, and of its two edges, from their definitions."""
    parts, start = options.parts[:, :, sector.target], own_base[:, sector.target]
    toward = np.array([np.cos(sector.middle), np.sin(sector.middle)])
    own = parts[:, 0] + parts[:, 1:] @ toward / np.cos(sector.half)
    angle = sector.middle + np.array([[1.0], [-1.0]]) * (np.pi / 2 - sector.half)
    sides = -np.concatenate([np.cos(angle), np.sin(angle)], axis=1)
    constant = np.append(start[0] + start[1:] @ toward / np.cos(sector.half), sides @ start[1:])
    return np.concatenate([own[None], sides @ parts[:, 1:].T]), constant


def linear_program(options, base, cuts, *, rows, constants, slope):
    """``max t - slope own - 100 (violations of the edges)`` over mixtures under some cuts."""
    count, n = len(options.first), len(options.owners)
    directions = along(cuts.angles)
    scores = np.einsum("kpc,cp->ck", options.parts[:, :, cuts.targets], directions)
    above = np.einsum("pc,cp->c", base[:, cuts.targets], directions)
    unequal = np.zeros((len(scores) + 2, n + 3))
    unequal[:-2, :n], unequal[:-2, n] = -scores, 1.0
    unequal[-2:, :n], unequal[-2:, n + 1 :] = -rows[1:], -np.eye(2)
    shares = np.zeros((count, n + 3))
    shares[options.owners, np.arange(n)] = 1.0
    solved = linprog(
        np.concatenate([slope * rows[0], [-1.0, 100.0, 100.0]]),
        A_ub=unequal,
        b_ub=np.append(above, constants[1:]),
        A_eq=shares,
        b_eq=np.ones(count),
        bounds=[(0, None)] * n + [(None, None)] + [(0, None)] * 2,
    )
    return -solved.fun - slope * constants[0]


def test_the_program_over_its_last_cuts_is_solved_and_nearly_no_cut_is_missing():
    rng = np.random.default_rng(5)
    tight = 0
    for trial in range(120):
        planar = instance(rng, trial).planar_levels()
        options, added = Options.beside(planar, OWNERS, 0), planar.parts[1]
        base, own_base = (planar.prior + added, planar.prior) if trial % 3 else (planar.prior, planar.prior + added)
        own_total = own_base + options.parts[rng.choice(every_context(options))].sum(axis=0)
        target = int(rng.integers(base.shape[1]))
        middle = np.arctan2(-own_total[2], -own_total[1])[target] + rng.uniform(-0.2, 0.2)
        sector, slope = Sector(target, float(middle), rng.uniform(0.05, 0.8)), float(rng.choice([0.7, 1.0, 2.5]))
        everything = np.ones(len(options.owners), dtype=bool)
        program = LevelProgram(options, base, own_base, sector, allowed=everything)
        first, found = program.bound(0.9, FREE), program.bound(slope, FREE)
        rows, constants = sector_rows(options, own_base, sector)
        plain = linear_program(options, base, found.cuts, rows=rows, constants=constants, slope=slope)
        size = 1 + np.abs(base).max() + np.abs(options.parts).max()
        assert found.ceiling == pytest.approx(plain, abs=1e-8 * size)
        assert np.bincount(options.owners, found.mixture) == pytest.approx(1)
        missed = found.level - levels(base + np.tensordot(found.mixture, options.parts, axes=1)).min()
        assert missed >= -1e-8 * size
        tight += missed <= 0.031 * abs(found.level - found.own) + 1e-9 * size
        # Every start leads there, and a ceiling that is low enough ends the search.
        again = LevelProgram(options, base, own_base, sector, allowed=everything, start=first.average)
        assert again.bound(slope, FREE).ceiling <= found.ceiling + 0.031 * abs(found.level - found.own) + 1e-8 * size
        early = LevelProgram(options, base, own_base, sector, allowed=everything).bound(
            slope, FREE, found.ceiling + 0.1
        )
        assert found.ceiling - 0.031 * abs(found.level - found.own) - 1e-8 * size <= early.ceiling
    assert tight > 100


def test_a_ceiling_is_enough_exactly_where_the_marginal_reaches_its_target():
    rng = np.random.default_rng(6)
    closed = 0
    for _ in range(400):
        added, target, end = rng.uniform(0.01, 0.5), rng.uniform(0.01, 1), rng.uniform(0.3, 3)
        low_slope, high_slope = rng.uniform(0.3, 1), rng.uniform(1, 6)
        least = least_enough(target, added, low_slope, end)
        most = most_enough(target, added, high_slope, end)
        for ceiling in rng.uniform(-2, 2, 20):
            numbers = np.array([[ceiling], [added]])
            low = least_marginal(*numbers, np.array([low_slope]), end)[0]
            high = most_marginal(*numbers, np.array([high_slope]), np.array([end]))[0]
            assert abs(ceiling - least) < 1e-9 or (low >= target) == (ceiling < least)
            assert abs(ceiling - most) < 1e-9 or (high <= target) == (ceiling < most)
            closed += (ceiling < least < np.inf) + (ceiling < most < np.inf)
    assert closed > 1000


def test_descents_end_where_no_change_of_one_or_two_owners_is_better():
    rng = np.random.default_rng(7)
    for trial in range(60):
        planar = instance(rng, trial).planar_levels()
        options, added, sign = Options.beside(planar, OWNERS, 0), planar.parts[1], float(1 - 2 * (trial % 2))
        contexts = every_context(options)
        values = sign * marginals(planar.prior + options.parts[contexts].sum(axis=1), added)
        found = PlanarDescent(options, planar.prior, added, sign=sign)
        start = contexts[rng.integers(len(contexts))]
        found.offer(start)
        slack = 1e-11 * np.abs(values).max()
        for changes in (1, 2):
            if changes == 2:
                found.pairs(FREE)
            assert sign * found.value == pytest.approx(values[(contexts == found.picks).all(axis=1)][0], rel=1e-12)
            assert sign * found.value <= values[(contexts == start).all(axis=1)][0] + slack
            near = (contexts != found.picks).sum(axis=1) <= changes
            assert sign * found.value <= values[near].min() + slack
        found.enumerate(np.ones(len(options.owners), dtype=bool))
        assert sign * found.value == pytest.approx(values.min(), abs=slack)


def plainly_descended(options, total, added, sign, picks, *, pairs):
    """Picks and value after one owner, or two, at a time, in the order and with the roundings of the definition."""
    ends = np.append(options.first, len(options.owners))
    own = [range(a, b) for a, b in pairwise(ends.tolist())]
    picks, value = picks.copy(), sign * float(marginals(total, added))
    changes = list(combinations(range(len(picks)), 2)) if pairs else [(i,) for i in range(len(picks))]
    while True:
        before = picks.copy()
        for owners in changes:
            now, rest = [picks[i] for i in owners], total
            for i in owners:
                rest = rest - options.parts[picks[i]]
            for chosen in product(*(own[i] for i in owners)):
                after = rest
                for k in chosen:
                    after = after + options.parts[k]
                found = sign * float(marginals(after, added))
                if found < value - 1e-12 * abs(value):
                    picks[list(owners)], value = chosen, found
            if [picks[i] for i in owners] != now:
                total = rest
                for i in owners:
                    total = total + options.parts[picks[i]]
        if pairs or np.array_equal(before, picks):
            return picks.tolist(), value


def random_options(rng, owners, targets):
    """Of so many owners beside the element's; targets fewer than C has side by side, as many, and more."""
    count = rng.integers(1, 4, owners)
    owner = np.repeat(np.arange(owners), count).astype(np.int64)
    first = np.concatenate([[0], np.cumsum(count)])[:owners].astype(np.int64)
    mean, angle = rng.gamma(0.5, 1.0, (len(owner), targets)), rng.uniform(-np.pi, np.pi, (len(owner), targets))
    share = rng.random((len(owner), targets))
    parts = np.stack([mean, mean * share * np.cos(angle), mean * share * np.sin(angle)], axis=1)
    return Options(np.arange(len(owner)), owner, first, parts)


@pytest.mark.parametrize("targets", [1, 2, 7, 8, 9, 20])
@pytest.mark.parametrize("owners", [0, 1, 2, 4])
def test_descents_are_those_of_the_definition(owners, targets):
    rng = np.random.default_rng([owners, targets])
    for trial in range(6):
        options, sign = random_options(rng, owners, targets), float(1 - 2 * (trial % 2))
        base, added = np.zeros((3, targets)), np.zeros((3, targets))
        base[0], added[0] = rng.uniform(0.2, 1, targets), rng.uniform(0, 1, targets)
        descent = PlanarDescent(options, base, added, sign=sign)
        start = options.first + rng.integers(0, np.bincount(options.owners, minlength=owners), owners)
        for budget in (None, FREE):
            descent._run(start, budget)
            total = base + options.parts[start].sum(axis=0)
            expected = plainly_descended(options, total, added, sign, start, pairs=budget is not None)
            assert (descent._picks.tolist(), descent._record.value) == expected


@pytest.mark.parametrize("shape", [(0, 1, 1), (1, 0, 1), (1, 1, 0), (3, 7, 2), (4, 20, 9)])
def test_sums_over_owners_of_their_largest_option(shape, monkeypatch):
    """In one part and in several."""
    (rows, options, places), rng = shape, np.random.default_rng(sum(shape))
    owners = np.sort(rng.integers(0, 3, options))
    levels, slopes, own = rng.normal(size=(rows, options)), rng.random(rows), rng.normal(size=(options, places))
    values = levels[:, :, None] - slopes[:, None, None] * own
    largest = [values[:, owners == one].max(axis=1) for one in np.unique(owners)]
    for terms in (10**6, 1):
        monkeypatch.setattr(_blocks, "STEPS", terms)
        sums, sizes = ceilings_module._sums_of_largest(owners, levels, slopes, own)
        assert sums == pytest.approx(sum(largest, np.zeros((rows, places))))
        assert sizes == pytest.approx(sum(map(np.abs, largest), np.zeros((rows, places))))


def test_what_c_may_not_read_is_refused():
    options = random_options(np.random.default_rng(0), 3, 2)
    base, added = np.ones((3, 2)), np.ones((3, 2))
    PlanarDescent(options, base, added, sign=1.0)
    for bad in (added.astype(np.float32), added.tolist(), np.ones((3, 4))[:, ::2], np.ones((3, 3))):
        with pytest.raises(ro.InputError):
            PlanarDescent(options, base, bad, sign=1.0)
    for bad in (options.parts[:-1].copy(), options.parts[:, ::-1], options.parts.astype(np.float32)):
        with pytest.raises(ro.InputError):
            PlanarDescent(replace(options, parts=bad), base, added, sign=1.0)
    good = {
        "owners": np.zeros(2, dtype=np.int64),
        "levels": np.ones((2, 2)),
        "slopes": np.ones(2),
        "own": np.ones((2, 3)),
    }
    ceilings_module._sums_of_largest(**good)
    for name, array in good.items():
        for bad in (array.astype(np.float32), np.repeat(array, 2, axis=-1)[..., ::2]):
            with pytest.raises(ro.InputError):
                ceilings_module._sums_of_largest(**good | {name: bad})


def test_two_inequalities_leave_no_better_pair_than_the_formulas_say():
    rng = np.random.default_rng(3)
    p = np.linspace(1e-3, 2, 4001)
    for _ in range(300):
        bound, added = rng.uniform(0.2, 2), rng.uniform(0, 0.3)
        low_slope, high_slope = rng.uniform(0.5, 1), rng.uniform(1, 4)
        ceiling = rng.uniform(-1, 0.5)
        least = least_marginal(*np.array([[ceiling], [added], [low_slope]]), bound)[0]
        q = np.maximum(p + added, (p - ceiling) / low_slope)
        seen = (1 / p - 1 / q)[p <= bound].min()
        assert least <= seen + 1e-12
        assert least == pytest.approx(seen, abs=0.02)
        most = most_marginal(*np.array([[ceiling], [added], [high_slope], [bound]]))[0]
        q = np.minimum(p + added, ceiling + high_slope * p)
        seen = np.where(q > p, 1 / p - 1 / np.maximum(q, p), 0.0)[p >= bound].max(initial=0.0)
        assert seen <= most + 1e-12


@pytest.mark.parametrize("largest", [False, True])
def test_a_search_to_its_end_finds_the_exact_marginal(largest):
    rng = np.random.default_rng(4)
    ended = 0
    for trial in range(30):
        planar = instance(rng, trial).planar_levels()
        options = Options.beside(planar, OWNERS, 0)
        everything = np.ones(len(options.owners), dtype=bool)
        highest = LevelProgram(options, planar.prior, planar.prior, None, allowed=everything).bound(0.0, FREE).ceiling
        added = planar.parts[0]
        totals = planar.prior + options.parts[every_context(options)].sum(axis=1)
        values = marginals(totals, added)
        exact = values.max() if largest else values.min()
        search = PlanarSearch(
            MarginalSide(options, planar.prior, added, largest=largest, highest=highest),
            params=PlanarParams(largest_leaf=(1, 2, 4, 8)[trial % 4]),
        )
        slack = 1e-9 * (1 + abs(exact))
        # Without leaves to enumerate the end is far away; the bounds must hold all the same.
        for _ in range(60):
            low, high = sorted([search.bound, search.attained.value])
            assert low - slack <= exact <= high + slack
            if search.exhausted:
                break
            search.refine(search.side.sign * search.attained.value, FREE)
        ended += search.exhausted
        search.attained.pairs(FREE)
        if search.exhausted:
            assert search.attained.value == pytest.approx(exact, abs=slack)
    assert ended > 8


def section_six(seed, n=10, m=15):
    problem = ro.random_scenario(n, m, alpha_s=1, alpha_c=1, seed=seed).problem("maxeig")
    return problem.objective, problem.robot


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(1, 6))])
def test_the_bracket_is_tight_on_section_six(seed):
    f, owners = section_six(seed)
    found = ro.total_curvature(f, owners, gap=0.1, time_limit=None, max_nodes=4000)
    assert found.upper < 1
    assert (1 - found.lower) / (1 - found.upper) <= 1.1 + 1e-9
    assert found.stop is ro.Stop.GAP


def test_an_interrupt_leaves_a_valid_bracket(monkeypatch):
    f, owners = section_six(3, 4, 5)
    exact = ro.total_curvature(f, owners)
    plain = LevelProgram.bound
    for call in (1, 4, 11, 41):
        monkeypatch.setattr(LevelProgram, "bound", interrupted_at(call, plain))
        found = ro.total_curvature(f, owners, gap=0.0, time_limit=None, params=SEARCHED)
        assert found.stop is ro.Stop.INTERRUPTED
        assert found.lower - 1e-9 <= exact.upper <= found.upper + 1e-9


@pytest.mark.parametrize("unit", [1e-30, 1e-3, 1e30])
def test_the_unit_of_length_does_not_matter(unit):
    f, owners = section_six(0, 4, 5)
    plain = ro.total_curvature(f, owners, gap=0.1, time_limit=None, max_nodes=600, params=SEARCHED)
    scaled = ro.MaxEigenvalueObjective(f.prior * unit**2, f.information / unit**2)
    found = ro.total_curvature(scaled, owners, gap=0.1, time_limit=None, max_nodes=600, params=SEARCHED)
    assert found.lower <= plain.upper
    assert plain.lower <= found.upper
    assert (1 - found.lower) / (1 - found.upper) <= 1.1 + 1e-6
