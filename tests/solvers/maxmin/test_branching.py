"""What a robot's mixture costs in the tight cuts, against its definition, and divisions of elements."""

import numpy as np
import pytest

from ratt_opt import Problem, TraceObjective, network_scenario, solve_maxmin
from ratt_opt.solvers.maxmin.mixtures import divide_by_scores, rounding_losses
from tests.strategies import information_data


def mixture(rng: np.random.Generator) -> tuple[list[np.ndarray], np.ndarray, np.ndarray]:
    """Choices of robots with ragged elements, weights that sum to one for each, and scores."""
    counts = rng.integers(1, 5, 4)
    choices = np.split(np.arange(counts.sum()), np.cumsum(counts)[:-1])
    selection = np.zeros(counts.sum())
    for choice in choices:
        own = rng.random(len(choice)) * (rng.random(len(choice)) < 0.7)
        own[0] += 0.1
        selection[choice] = own / own.sum()
    return choices, selection, rng.normal(size=(counts.sum(), int(rng.integers(1, 4))))


@pytest.mark.parametrize("seed", range(30))
def test_the_loss_is_what_some_cut_loses_whichever_element_is_taken(seed: int) -> None:
    choices, selection, scores = mixture(np.random.default_rng([11, seed]))
    losses = rounding_losses(choices, selection, scores)
    for choice, loss in zip(choices, losses, strict=True):
        mixed = [e for e in choice.tolist() if selection[e] > 0]
        falls = []
        for e in mixed:
            rounded = selection.copy()
            rounded[choice] = 0.0
            rounded[e] = 1.0
            falls.append(max((selection @ scores) - (rounded @ scores)))
        assert loss == pytest.approx(min(falls) if len(mixed) > 1 else 0.0, abs=1e-12)


def test_nothing_is_lost_without_cuts() -> None:
    choices, selection, _ = mixture(np.random.default_rng(0))
    assert not rounding_losses(choices, selection, np.zeros((len(selection), 0))).any()


@pytest.mark.parametrize("seed", range(30))
def test_a_division_separates_the_two_heaviest_elements_and_keeps_the_alike_together(seed: int) -> None:
    rng = np.random.default_rng([12, seed])
    choice = rng.permutation(12)[: rng.integers(2, 8)]
    selection = np.zeros(12)
    selection[choice[:2]] = 0.6, 0.4
    scores = rng.normal(size=(12, 3))
    scores[choice[-1]] = scores[choice[0]]  # one more like the heaviest, unless it is the second
    parts = divide_by_scores(choice, selection, scores, np.array([1.0, 2.0, 0.0]))
    assert sorted(np.concatenate(parts).tolist()) == sorted(choice.tolist())
    assert choice[0] in parts[0]
    assert choice[1] in parts[1]
    assert len(choice) == 2 or choice[-1] in parts[0]


def test_a_node_that_the_last_plan_closes_is_not_divided() -> None:
    """Plans improve on the way to a division; then a node may be bounded below them, and have nothing to divide."""
    graph = network_scenario("hubs", 10, 1, alpha_s=0, alpha_c=0, seed=0).problem().graph
    prior, information = information_data(np.random.default_rng([10, 0]), 60, 10, 3)
    problem = Problem(TraceObjective(prior, 0.1 * information), np.repeat(np.arange(10), 6), graph, 3, 7)
    found = solve_maxmin(problem, max_nodes=5)
    assert 0 < found.lower <= found.upper
