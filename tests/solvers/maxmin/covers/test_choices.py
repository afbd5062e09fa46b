"""The compiled parts of the searches in depth: their definitions, empty tables, and what C may not read."""

from collections.abc import Callable
from itertools import product
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ratt_opt import InputError, MaxMinParams
from ratt_opt.setfunctions.criteria.registry import CRITERIA
from ratt_opt.setfunctions.information import InformationObjective
from ratt_opt.solvers.maxmin import marginal_tables
from ratt_opt.solvers.maxmin.covers.choices import CoverChoices
from ratt_opt.solvers.maxmin.covers.dive import CoverSums, Dive, Sums
from ratt_opt.solvers.maxmin.covers.pool import CoverPool
from ratt_opt.solvers.maxmin.covers.separation import Ways
from ratt_opt.solvers.maxmin.elements import PackedElements
from ratt_opt.solvers.maxmin.levels import Outcome
from ratt_opt.solvers.maxmin.marginal_search import dive
from ratt_opt.solvers.maxmin.params import CoverSearchParams, SeparationParams

CASES = [(kind, dimension, seed) for kind in ("trace", "logdet") for dimension in (1, 2, 3, 5) for seed in range(8)]


def random_choices(kind: str, dimension: int, seed: int) -> tuple[InformationObjective, CoverChoices, Any]:
    rng = np.random.default_rng([seed, dimension])
    robots, targets = int(rng.integers(1, 5)), int(rng.integers(1, 5))
    owner = np.sort(np.concatenate([np.arange(robots), rng.integers(0, robots, rng.integers(0, 6))]))
    rank = int(rng.integers(1, dimension + 1))
    root = rng.normal(size=(len(owner), targets, dimension, rank)) * 10.0 ** rng.uniform(-2, 2, (len(owner), 1, 1, 1))
    root *= (rng.random((len(owner), targets)) < 0.6)[..., None, None]
    prior = np.eye(dimension) * 10.0 ** rng.uniform(-1, 2, (targets, 1, 1))
    objective = CRITERIA[kind](prior, root @ np.swapaxes(root, -1, -2), rng.uniform(0.2, 5, targets))
    sees = objective.information.any(axis=(-2, -1))
    packed = PackedElements.of(objective, objective.information, sees)
    return objective, CoverChoices(packed, owner, rng.random(robots) < 0.2, int(rng.integers(1, robots + 2))), rng


def least_eigenvalue(matrix: Any) -> float:
    return float(np.linalg.eigvalsh(matrix)[..., 0].min())


def unpacked(entries: Any, dimension: int) -> Any:
    full = np.zeros((*entries.shape[:-1], dimension, dimension))
    for k, (i, j) in enumerate(zip(*np.tril_indices(dimension), strict=True)):
        full[..., i, j] = full[..., j, i] = entries[..., k]
    return full


@pytest.mark.parametrize(("kind", "dimension", "seed"), CASES)
def test_the_strongest_tell_no_less_than_any_element(kind: str, dimension: int, seed: int):
    objective, choices, rng = random_choices(kind, dimension, seed)
    strongest = unpacked(choices.strongest, dimension)
    for e, robot in enumerate(choices.owner.tolist()):
        scale = max(1.0, float(np.abs(strongest[robot]).max()))
        assert least_eigenvalue(strongest[robot] - objective.information[e]) >= -1e-12 * scale
        if np.count_nonzero(choices.owner == robot) == 1:
            assert np.allclose(strongest[robot], objective.information[e], rtol=1e-9, atol=1e-12 * scale)
    members = rng.random((3, len(choices.safe))) < 0.5
    told = objective.prior_information + np.einsum("gn,nmij->gmij", members.astype(float), strongest)
    before, after = objective.criterion(objective.prior_information), objective.criterion(told)
    scale = float(np.abs(before).max() + np.abs(after).max())
    assert np.allclose(choices.group_values(members), before - after, rtol=1e-12, atol=1e-12 * scale)


@pytest.mark.parametrize(("kind", "dimension", "seed"), CASES)
def test_lost_targets_and_kept_elements_leave_no_more_than_the_level(kind: str, dimension: int, seed: int):
    objective, choices, rng = random_choices(kind, dimension, seed)
    members = rng.random((3, len(choices.safe))) < 0.7
    inside, values = np.take(members, choices.owner, axis=1), choices.group_values(members)
    price, noise = rng.uniform(0, 2, len(choices.owner)), rng.uniform(0.8, 1.2, values.shape)
    for level in values.sum(axis=1).max() * rng.uniform(0, 1.1, 4):
        paid, kept = choices.lose(inside, price, values, level, noise)
        for g in range(3):
            gone = inside[g] & ~kept[g]
            assert paid[g] == pytest.approx(price[gone].sum())
            assert not np.any(kept[g] & ~inside[g])
            lost = choices.elements.sees[gone].any(axis=0) & ~choices.elements.sees[kept[g]].any(axis=0)
            unseen = ~choices.elements.sees[kept[g]].any(axis=0)
            assert np.all(choices.elements.sees[gone][:, lost].any(axis=1))
            assert values[g, ~unseen].sum() <= level * (1 + 1e-12)
            before = kept[g].copy()
            cost, sums = choices.keep(inside[g], price, level, kept[g])
            assert np.all(kept[g] >= before)
            assert cost == pytest.approx(price[inside[g] & ~kept[g]].sum())
            check_kept(objective, choices, kept[g], unpacked(sums, dimension), level)


def check_kept(objective: InformationObjective, choices: CoverChoices, kept: Any, sums: Any, level: float) -> None:
    """The bound is at most the level, and no choice of kept elements tells more than where it is taken."""
    bound = float((objective.criterion(objective.prior_information) - objective.criterion(sums)).sum())
    assert bound <= level * (1 + 1e-9) + 1e-9 * abs(bound) + 1e-9
    own = [[None, *np.flatnonzero(kept & (choices.owner == i)).tolist()] for i in range(len(choices.safe))]
    for chosen in product(*own):
        told = objective.prior_information + sum(objective.information[e] for e in chosen if e is not None)
        assert least_eigenvalue(sums - told) >= -1e-9 * max(1.0, float(np.abs(sums).max()))


def packed_elements(count: int, targets: int = 2, **changed: Any) -> PackedElements:
    given: dict[str, Any] = {
        "criterion": CRITERIA["logdet"].native_kernel,
        "dimension": 2,
        "weights": np.ones(targets),
        "baseline": np.zeros(targets),
        "prior": np.ones((targets, 3)) * np.array([1.0, 0.0, 1.0]),
        "information": np.ones((count, targets, 3)) * np.array([1.0, 0.0, 1.0]),
        "sees": np.ones((count, targets), np.bool_),
    }
    return PackedElements(**given | changed)


@pytest.mark.parametrize("targets", [0, 1])
@pytest.mark.parametrize(("robots", "elements"), [(0, 0), (1, 0), (1, 1), (1, 64)])
@pytest.mark.parametrize("groups", [0, 1])
def test_the_smallest_tables(robots: int, elements: int, targets: int, groups: int):
    choices = CoverChoices(
        packed_elements(elements, targets), np.zeros(elements, np.int64), np.zeros(robots, np.bool_), 1
    )
    members = np.ones((groups, robots), np.bool_)
    inside, values = np.take(members, choices.owner, axis=1), choices.group_values(members)
    paid, kept = choices.lose(inside, np.ones(elements), values, 0.5, np.ones_like(values))
    assert kept.shape == inside.shape
    for g in range(groups):
        assert paid[g] == (elements if targets and robots and elements else 0.0)
        choices.keep(inside[g], np.ones(elements), 0.5, kept[g])
    of = np.zeros((groups, groups), np.int64)
    for level in (-1.0, 0.5, 10.0):
        ways, pool, sums = (
            Ways(choices, members, inside, of, np.arange(groups)),
            CoverPool(choices, SeparationParams()),
            CoverSums(elements, CoverSearchParams()),
        )
        separation: Any = SimpleNamespace(
            choices=choices, pool=pool, ways=lambda ways=ways: ways, params=MaxMinParams()
        )
        search = Dive(separation, sums)
        expected = Outcome.PROVED if groups and level >= (np.log(4) * targets if robots and elements else 0) else None
        for _ in range(3):
            outcome = search.run(level, 100)
            assert outcome in {Outcome.PROVED, Outcome.PLAN}
            assert expected is None or outcome is expected
            if outcome is Outcome.PROVED:
                assert len(search.record.nodes) == 1
                break


@pytest.mark.parametrize("targets", [0, 1])
@pytest.mark.parametrize("sizes", [[], [1], [2]])
@pytest.mark.parametrize("attacks", [0, 1])
def test_the_smallest_dives_by_marginals(sizes: list[int], targets: int, attacks: int):
    choosers = marginal_tables.Choosers(packed_elements(sum(sizes), targets), np.array(sizes, np.int64))
    known = marginal_tables.Attacks(
        np.full(attacks, (1 << len(sizes)) - 1, np.uint64), np.zeros((attacks, attacks), np.int64), np.arange(attacks)
    )
    for level in (0.5, 10.0):
        gains, path = marginal_tables.Gains(choosers.elements, 1), marginal_tables.Path(choosers, 1)
        outcome = dive(choosers, known, gains, path, level=level, slack=0.0, nodes=50, tried=200)
        proved = bool(attacks) and (np.log(4) * targets * bool(sizes) <= level)
        assert outcome is (Outcome.PROVED if proved else Outcome.PLAN)


def other_forms(name: str, array: Any, is_written: bool) -> list[Any]:
    """Of a good array: another type, no array, other shapes, another layout, and one that may not be written."""
    forms = [array.astype(np.float32), array.tolist(), array[..., None], np.repeat(array, 2, axis=-1)[..., ::2]]
    if name not in {"of", "tried"}:  # these may be narrower
        forms.append(np.ascontiguousarray(array[..., :-1]))
    if is_written:
        locked = array.copy()
        locked.setflags(write=False)
        forms.append(locked)
    return forms


def good_calls() -> list[tuple[Callable[..., object], dict[str, Any], set[str]]]:
    """Calls that are answered, by their arrays, and which of these are written."""
    elements, owner, safe = packed_elements(3), np.array([0, 0, 1]), np.array([False, True])
    choices = CoverChoices(elements, owner, safe, 2)
    choosers = np.array([2, 1])
    members, inside = np.ones((2, 2), np.bool_), np.ones((2, 3), np.bool_)
    price, two = np.ones(3), np.ones((2, 2))
    arrays = {
        name: np.ascontiguousarray(a)
        for name, a in zip(("weights", "baseline", "prior", "information", "sees"), elements._arrays, strict=True)
    }
    return [
        (lambda **given: packed_elements(3, **given), arrays, set()),
        (lambda owner, safe: CoverChoices(elements, owner, safe, 2), {"owner": owner, "safe": safe}, set()),
        (choices.group_values, {"members": members}, set()),
        (
            lambda **given: choices.lose(level=0.5, **given),
            {"inside": inside, "price": price, "values": two, "noise": two},
            set(),
        ),
        (
            lambda **given: choices.keep(level=0.5, **given),
            {"inside": inside[0], "price": price, "kept": ~inside[0]},
            {"kept"},
        ),
        (
            lambda **given: Ways(choices, **given),
            {"members": members, "inside": inside, "of": np.array([[0, 1], [1, -1]]), "order": np.array([1, 0])},
            {"order"},
        ),
        (
            lambda **given: Sums(3, **given),
            {"terms": np.ones((2, 3)), "tried": np.array([1, 0]), "used": np.ones(2)},
            {"used"},
        ),
        (lambda sizes: marginal_tables.Choosers(elements, sizes), {"sizes": choosers}, set()),
        (
            marginal_tables.Attacks,
            {"members": np.ones(2, np.uint64), "of": np.array([[0, 1], [1, -1]]), "order": np.array([1, 0])},
            {"order"},
        ),
    ]


def test_what_c_may_not_read_is_refused():
    refused = 0
    for call, arrays, written in good_calls():
        call(**arrays)
        for name, array in arrays.items():
            for bad in other_forms(name, array, name in written):
                with pytest.raises(InputError):
                    call(**arrays | {name: bad})
                refused += 1
    assert refused > 100


def test_numbers_that_are_not_there_are_refused():
    choices = CoverChoices(packed_elements(3), np.array([0, 0, 1]), np.array([False, True]), 2)
    members, inside = np.ones((2, 2), np.bool_), np.ones((2, 3), np.bool_)
    for of, order in (([[2, 1]], [0]), ([[-2, 1]], [0]), ([[0, 1]], [1]), ([[0, 1]], [-1])):
        with pytest.raises(InputError):
            Ways(choices, members, inside, np.array(of), np.array(order))
        with pytest.raises(InputError):
            marginal_tables.Attacks(np.ones(2, np.uint64), np.array(of), np.array(order))
    for owner, enough in (([0, 0, 2], 2), ([0, 0, -1], 2), ([0, 0, 1], 0), ([0, 0, 1], 4)):
        with pytest.raises(InputError):
            CoverChoices(choices.elements, np.array(owner), choices.safe, enough)
    with pytest.raises(InputError):
        CoverChoices(packed_elements(65), np.zeros(65, np.int64), np.zeros(1, np.bool_), 1)
    with pytest.raises(InputError):
        Sums(3, np.ones((2, 3)), np.array([2]), np.ones(2))
    for sizes in ([2, 2], [3, 0], [4, -1], [1] * 65):
        with pytest.raises(InputError):
            marginal_tables.Choosers(choices.elements, np.array(sizes))
    for dimension in (0, 65):
        with pytest.raises(InputError):
            packed_elements(3, dimension=dimension)


@pytest.mark.parametrize("seed", range(10))
def test_a_full_pool_has_room_for_partitions_into_more_groups(seed: int):
    """Covers of partitions into one to four groups, in any order, are kept as they were added."""
    elements, rng, added = 6, np.random.default_rng(seed), dict[int, tuple[Any, list[Any], float]]()
    choices = CoverChoices(packed_elements(elements, 2), np.arange(elements), np.zeros(elements, np.bool_), 1)
    pool = CoverPool(choices, SeparationParams(room=2))
    for _ in range(30):
        partition = int(rng.integers(0, 4))
        left_out, level = rng.random(elements) < 0.5, float(rng.random())
        sums = [rng.random((2, 3)) for _ in range(partition + 1)]
        known, before = pool.add(partition, left_out, sums, level), len(added)
        if known == before or level < added[known][2]:
            added[known] = left_out, sums, level
    assert len(pool) == len(added) > 2
    for k, (left_out, sums, level) in added.items():
        np.testing.assert_array_equal(pool.left_out(k), left_out)
        np.testing.assert_array_equal(pool.sums[k, : len(sums)], sums)
        assert (pool.partition[k], pool.level[k]) == (len(sums) - 1, level)
