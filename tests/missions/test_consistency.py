"""Consistency of the filter's covariance over one step of the paper's largest case, for each linearisation."""

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.missions.players.attack_models import RenewedAttacks
from ratt_opt.missions.sensing import group_pieces, simulated_readings
from ratt_opt.missions.world import World

DRAWS, TEAMS = 25, 4


def error_over_trace(linearisation: str) -> float:
    """Mean squared error over mean trace after RATT's plan, a bounded-rational attack and the best group's update."""
    errors, traces = [], []
    for seed in range(TEAMS):
        scenario = ro.random_scenario(30, 25, alpha_s=10, alpha_c=108, seed=seed)
        world = World(scenario, ro.MissionModel(linearisation=linearisation), 1)
        first, offered = world.motion.initial(scenario), world.sequences(scenario.poses)
        threatened = RenewedAttacks().threatened(0, ro.Attack(), scenario)
        problem = world.problem(world.criterion(first, offered, 0.0), offered.owner, scenario.poses, threatened)
        plan = ro.ratt(problem).elements
        group = problem.best_group(plan, ro.bounded_rational_attack(problem, plan).attack)
        poses, predicted = offered.poses[plan, 0], first.predicted(world.motion, world.period, 0.0)
        rng, root = np.random.default_rng([3, seed]), np.linalg.cholesky(predicted.covariance)
        for _ in range(DRAWS):
            truth = predicted.mean + (root @ rng.standard_normal((*predicted.mean.shape, 1)))[..., 0]
            luck = rng.standard_normal((len(poses), *truth.shape))
            readings = dict(enumerate(simulated_readings(world, poses, truth, luck)))
            pieces, _ = group_pieces(world, predicted, dict(enumerate(poses)), readings, group)
            belief = predicted.updated(pieces.information.sum(axis=0), pieces.vector.sum(axis=0))
            errors.append(((belief.mean - truth) ** 2).sum(axis=1).mean())
            traces.append(belief.trace / len(truth))
    return float(np.mean(errors) / np.mean(traces))


@pytest.mark.parametrize(
    ("linearisation", "least", "most"),
    [("first order", 1.2, np.inf), ("second order", 0.9, 1.2), ("iterated", 0.9, 1.15)],
)
def test_the_second_order_term_tells_the_error(linearisation: str, least: float, most: float) -> None:
    """Sixteen robots pooled: the textbook filter is overconfident, the others are not."""
    assert least < error_over_trace(linearisation) < most
