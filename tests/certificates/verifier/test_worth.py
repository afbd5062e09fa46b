"""What sets of robots are worth, against the criteria themselves: never more, and no less."""

import numpy as np
import pytest
from flint import fmpq

from ratt_opt import MaxEigenvalueObjective, Problem, ProofError, TraceObjective, random_scenario
from ratt_opt.certificates.verifier.worth import Worth
from tests.certificates.engine import statement
from tests.strategies import OBJECTIVES, information_data


def is_worth(about, value, inside, others=(), count=0):
    worth = Worth(about, fmpq(*float(value).as_integer_ratio()))
    try:
        worth.require(worth.of(inside), others, count)
    except ProofError:
        return False
    return True


def check_sets(problem, plan):
    """Sets of robots with 0 to 3 of others are worth their value or average, and no more."""
    objective, about = problem.information_objective, statement(problem, plan)
    inside, others = [0, 3], [1, 2, 4, 5]
    base = objective.posterior_information(np.array([plan[i] for i in inside]))
    for count in range(4) if objective.verifier_averages else (0, 1):
        more = others if count else []
        posteriors = [base + count * objective.information[plan[i]] for i in more] or [base]
        values = sorted(float(objective.value(one)) for one in posteriors)
        value = float(np.mean(values[: count or 1]))
        assert is_worth(about, value * (1 - 1e-12), inside, more, count)
        assert not is_worth(about, value * (1 + 1e-12), inside, more, count)


@pytest.mark.parametrize("kind", OBJECTIVES)
@pytest.mark.parametrize("seed", range(8))
def test_a_set_is_worth_its_value_and_no_more(kind, seed):
    rng = np.random.default_rng([4, seed])
    scenario = random_scenario(6, 4, alpha_s=1, alpha_c=2, seed=seed)
    weights = [float(w) for w in rng.choice([1.0, 0.3, 2.5], len(scenario.targets))]
    targets = [target.replace(weight=w) for target, w in zip(scenario.targets, weights, strict=True)]
    problem = scenario.replace(targets=tuple(targets)).problem(kind)
    check_sets(problem, [int(rng.choice(own)) for own in problem.choices])


@pytest.mark.parametrize("dimension", [1, 2, 3, 4])
@pytest.mark.parametrize("kind", [*OBJECTIVES, "trace of a part", "maxeig of a part"])
def test_states_of_any_dimension(kind, dimension):
    rng = np.random.default_rng([5, dimension])
    data = information_data(rng, 6, 2, dimension)
    name, *part = kind.split(" of a part")
    output = {"output": rng.normal(size=(1 + dimension // 3, dimension))} if part else {}
    check_sets(Problem(OBJECTIVES[name](*data, **output), range(6), None, 1, 2), list(range(6)))


def test_values_are_exact():
    """A claim of the very value, which no rounding could show, is one; so is 0 of nobody."""
    objective = TraceObjective(np.array([[[1.0]]]), np.ones((3, 1, 1, 1)))
    about = statement(Problem(objective, range(3), None, 0, 0), range(3))
    assert is_worth(about, 0.5, [0])
    assert is_worth(about, 0.75, [0, 1, 2])
    assert is_worth(about, 0.0, [])
    assert not is_worth(about, np.nextafter(0.75, 1.0), [0, 1, 2])


@pytest.mark.parametrize("dimension", [2, 3])
def test_what_rounding_left_below_zero_is_taken_off(dimension):
    """A robot that is not known to sense may do so; of the worst axis it tells a little less than nothing."""
    ones = np.ones(dimension - 1)
    information = np.array([np.diag([0.5, *ones]), np.diag([-5e-10, *ones])])[:, None]
    objective = MaxEigenvalueObjective(np.eye(dimension)[None], information)
    about = statement(Problem(objective, range(2), None, 0, 0), range(2))
    known, both = objective([0]), objective([0, 1])
    assert both < known - 1e-10
    assert not is_worth(about, 0.0, [])
    assert not is_worth(about, (known + both) / 2, [0])
    assert is_worth(about, both - 4 * (known - both), [0])
