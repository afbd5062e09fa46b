"""Plain annealing of attacks on one plan: what the exact attacker must never be worse than, given the same seconds."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any, NamedTuple

import numba
import numpy as np

from ratt_opt.attack.team import Links
from ratt_opt.problem import Attack
from ratt_opt.setfunctions.criteria.compiled import team_criterion
from ratt_opt.setfunctions.information import InformationObjective, triangles

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.problem import Problem

__all__ = ["plain_annealing"]

HOT, COLD, MOVES = 0.02, 0.0002, 200_000
"""Temperatures relative to the team's value, and moves of one cooling of plain annealing."""


class _Team(NamedTuple):
    """``prior`` : (M, T), ``information`` : (N, M, T) packed matrices; ``baseline`` : the criterion without a robot."""

    code: int
    weights: Any
    prior: Any
    information: Any
    baseline: float


@numba.njit(cache=True)
def _value(team: Any, group: Any, blind: Any, sums: Any) -> float:
    """Value of those of ``group`` (N,) that are not ``blind`` (N,); ``sums`` (M, T) is spare."""
    sums[:] = team.prior
    for i in range(len(group)):
        if group[i] and not blind[i]:
            sums += team.information[i]
    return float(team.baseline - team_criterion(team.code, team.weights, sums))


@numba.njit(cache=True)
def _cool(team: Any, links: Any, group: Any, blind: Any, budget: int, heat: Any, rng: Any) -> float:  # noqa: PLR0917
    """One cooling of plain annealing: the largest group's value, links within ``budget``; best state in place."""
    n_robots, sums = len(group), np.empty_like(team.prior)
    best, best_group, best_blind = np.inf, group.copy(), blind.copy()
    values, cut = np.zeros(n_robots), 0
    for g in range(n_robots):
        values[g] = _value(team, group == g, blind, sums)
    energy = values.max()
    for move in range(MOVES):
        i, j = int(rng.random() * n_robots), int(rng.random() * n_robots)
        home, target, change, blinds = group[i], group[j], 0, rng.random() < 0.5
        if blinds and (blind[i] or not blind[j] or links.seeing[i]):
            continue
        if blinds:
            blind[i], blind[j] = True, False
        else:
            if rng.random() < 0.1:  # a group of its own
                target = int(rng.random() * n_robots)
            for a in range(links.start[i], links.start[i + 1]):
                other = group[links.robot[a]]
                change += (other == home) * 1 - (other == target) * 1
            if target == home or cut + change > budget:
                continue
            group[i] = target
        old = values[home], values[target]
        values[home] = _value(team, group == home, blind, sums)
        values[target] = _value(team, group == target, blind, sums)
        after, temperature = values.max(), heat[0] * (heat[1] / heat[0]) ** (move / MOVES)
        if after <= energy or rng.random() < np.exp((energy - after) / temperature):
            energy, cut = after, cut + change
            if energy < best:
                best, best_group[:], best_blind[:] = energy, group, blind
            continue
        values[home], values[target] = old
        if blinds:
            blind[i], blind[j] = False, True
        else:
            group[i] = home
    group[:], blind[:] = best_group, best_blind
    return float(best)


def plain_annealing(problem: Problem, plan: IntArray, seconds: float, seed: int) -> float:
    """Worst value that annealing from the whole team finds, cooled again and again for that many seconds."""
    objective = problem.objective
    if not isinstance(objective, InformationObjective) or objective.compiled_code is None:
        raise TypeError("the criterion has no compiled loops")
    prior, information = triangles(objective.prior_information), triangles(objective.information[plan])
    baseline = float(objective.combine(objective.criterion(objective.prior_information)))
    team = _Team(objective.compiled_code, np.array(objective.weights), prior, information, baseline)
    links, rng = Links.of(problem.threat), np.random.default_rng(seed)
    n_robots, whole, best = problem.n_robots, problem.objective(plan), np.inf
    heat, ends = np.array([HOT, COLD]) * whole, time.monotonic() + seconds
    while time.monotonic() < ends:
        group, blind = np.zeros(n_robots, dtype=np.int64), np.zeros(n_robots, dtype=np.bool_)
        blind[rng.permutation(np.flatnonzero(~links.seeing))[: problem.threat.n_blinded]] = True
        _cool(team, links, group, blind, problem.alpha_c, heat, rng)
        cut = frozenset((i, j) for i, j in problem.communication.links if group[i] != group[j])
        best = min(best, problem.team_value(plan, Attack(frozenset(np.flatnonzero(blind).tolist()), cut)))
    return best
