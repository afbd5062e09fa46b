"""What every criterion states of itself, and a fourth one, defined here, that states nothing but its formula."""

import copy
import pickle

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.attack.team import Team
from ratt_opt.setfunctions.criteria.registry import CRITERIA, get_criterion
from ratt_opt.setfunctions.information import InformationObjective, from_triangles, triangles
from tests.strategies import OBJECTIVES, SquaredVariances, information_data

ALL = [*CRITERIA.values(), SquaredVariances]


def draw(rng, criterion, dimension=None):
    dimension = dimension or int(rng.integers(1, 5))
    prior, information = information_data(rng, 6, int(rng.integers(1, 4)), dimension)
    return criterion(prior, information, rng.uniform(0.3, 3, len(prior)))


def random_information(rng, f):
    """A posterior information that no subset need lead to."""
    root = rng.normal(size=(f.n_targets, f.dimension, f.dimension)) * rng.choice([0.1, 1.0, 5.0])
    return f.prior_information + root @ root.swapaxes(-1, -2)


@pytest.mark.parametrize("criterion", ALL)
def test_tangents_bound_the_value_everywhere_and_touch_at_their_point(criterion):
    rng = np.random.default_rng(51)
    for _ in range(60):
        f = draw(rng, criterion)
        point = random_information(rng, f)
        others = [random_information(rng, f) for _ in range(20)] + [f.prior_information]
        targets = f.tangent_targets(point, float(f.value(point)) + rng.uniform(0, 1), 3)
        for target in targets:
            tangent = f.tangent(point, target)
            scale = 1 + abs(tangent.offset) + f.prior_magnitude
            for other in others:
                assert f.value(other) <= tangent.offset + (tangent.slope * other).sum() + 1e-9 * scale
            here = tangent.offset + (tangent.slope * point).sum()
            # What the tangent bounds, up to a constant, is cut_values: their fall from the first target's is the same.
            fall = f.cut_values(np.stack([point] * 2), [targets[0], target])
            assert here - fall[1] == pytest.approx(f.value(point) - fall[0], abs=1e-9 * scale)


@pytest.mark.parametrize("criterion", ALL)
def test_gradients_are_supergradients_and_point_upwards(criterion):
    rng = np.random.default_rng(52)
    for _ in range(60):
        f = draw(rng, criterion)
        point, other = random_information(rng, f), random_information(rng, f)
        slope = f.gradient(point)
        assert np.linalg.eigvalsh(slope).min() >= -1e-9 * np.abs(slope).max()
        scale = 1 + f.prior_magnitude + np.abs(slope * (other - point)).sum()
        assert f.value(other) <= f.value(point) + (slope * (other - point)).sum() + 1e-9 * scale


def test_parts_are_inherited_with_the_formula_they_belong_to_and_another_formula_is_refused():
    class Renamed(ro.LogDetObjective):
        """The same formula with data of its own."""

        __slots__ = ("note",)

    assert Renamed.overrides("marginal_minorant")
    assert Renamed.target_tangents is ro.LogDetObjective.target_tangents
    data = information_data(np.random.default_rng(54), 3, 2)
    for part in ("criterion", "value", "gradient"):
        for base in (*CRITERIA.values(), Renamed):

            def capped(self, posterior_information, part=part, base=base):
                found = getattr(base, part)(self, posterior_information)
                return np.minimum(found, 0.9 * getattr(base, part)(self, self.posterior_information(np.arange(3))))

            with pytest.raises(ro.InputError, match="Other must subclass InformationObjective"):
                type("Other", (base,), {part: capped})(*data)


@pytest.mark.parametrize("criterion", CRITERIA.values())
def test_a_subclass_that_counts_its_values_is_the_criterion_below_it(criterion):
    asked = []

    class Counted(criterion):
        def value(self, posterior_information):
            asked.append(len(posterior_information))
            return super().value(posterior_information)

    class Again(Counted):
        def gradient(self, posterior_information):
            return super().gradient(posterior_information)

    data, owners = information_data(np.random.default_rng(56), 6, 2), np.arange(6) // 2
    plain, counted = (ro.Problem(kind(*data), owners, None, 1, 1) for kind in (criterion, Again))
    assert asked
    assert ro.solve_maxmin(counted).lower == ro.solve_maxmin(plain).lower


def test_what_is_missing_is_refused_by_its_name():
    prior, information = information_data(np.random.default_rng(54), 3, 2)

    class Nothing(InformationObjective):
        pass

    class ValueAlone(InformationObjective):
        def value(self, posterior_information):
            size = np.linalg.slogdet(posterior_information)[1] - np.linalg.slogdet(self.prior_information)[1]
            return size.sum(axis=-1)

    with pytest.raises(ro.InputError, match=r"must define criterion\(posterior_information\).*got Nothing"):
        Nothing(prior, information)
    f = ValueAlone(prior, information)
    assert f([]) == 0
    assert f([0, 2]) == pytest.approx(ro.LogDetObjective(prior, information)([0, 2]))
    with pytest.raises(ro.InputError, match=r"must define gradient\(posterior_information\).*got ValueAlone"):
        f.tangent(f.prior_information, None)
    with pytest.raises(ro.InputError, match="objective must be trace, logdet or maxeig"):
        get_criterion("squares")


@pytest.mark.parametrize("criterion", ALL[:3])
def test_a_criterion_is_copied_pickled_and_shown(criterion):
    f = draw(np.random.default_rng(55), criterion, 2)
    for again in (copy.copy(f), copy.deepcopy(f), pickle.loads(pickle.dumps(f))):
        assert (again.table() == f.table()).all()
        with pytest.raises(ValueError, match="read-only"):
            again.information[0] = 0.0
        assert again != f
    assert repr(f) == f"{criterion.__name__}(6 elements, {f.n_targets} targets, d = 2)"
    assert repr(ro.TableFunction([0.0, 1.0])) == "TableFunction(n=1)"
    assert (f.restricted_to(np.array([4, 1])).table() == [f([]), f([4]), f([1]), f([1, 4])]).all()


@pytest.mark.parametrize("name", OBJECTIVES)
@pytest.mark.parametrize("dimension", [1, 2, 3, 4, 5, 6])
def test_criteria_in_c_are_those_of_the_definition(name, dimension):
    rng = np.random.default_rng(dimension)
    for scale in [1e-9, 1e-3, 1.0, 1e3, 1e7]:
        for weights in [None, rng.uniform(0.2, 3, 4)]:
            prior, information = information_data(rng, 5, 4, dimension)
            f = OBJECTIVES[name](prior, scale * information, weights)
            sums = f.prior_information + f.information
            packed = triangles(sums)
            assert from_triangles(packed) == pytest.approx(sums)
            ours = [Team.of(f, np.array([e])).whole_value for e in range(f.n)]
            close = (1e-7 if scale > 1e3 else 1e-9) * f.prior_magnitude
            assert ours == pytest.approx(f.singletons(), rel=1e-9, abs=close)
