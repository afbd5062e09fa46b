"""Many control sequences: a beam of good ones to plan with, and a bracket of the optimum over all of them.

The beam grows step by step: of all sequences so far each robot keeps those worth most alone. The bracket is a column
generation around the exact search. The search over some elements proves an upper bound by a tree of cuts, each of which
is linear in every element's information. A plan with elements that were left out is sent, if the tree splits
the elements of their robot, to any child; so each leaf bounds it as soon as its maxima run over what was left out too.
Elements that attain a maximum above the bound join the search, until the bracket is as narrow as wanted.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import FloatArray, IntArray, check_integer, readonly
from ratt_opt.budget import Budget, Stop
from ratt_opt.errors import InputError
from ratt_opt.missions.ahead.horizon import Sequences, extended
from ratt_opt.solvers.maxmin.proof import ElementBranch, Leaf, UpperProof, WinnerBranch
from ratt_opt.solvers.maxmin.solve import check_limits, solve_in_coordinates
from ratt_opt.solvers.maxmin.stages.schedule import TREES_ALONE
from ratt_opt.solvers.result import MaxMinResult

if TYPE_CHECKING:
    from ratt_opt.missions.belief import Belief
    from ratt_opt.missions.world import World
    from ratt_opt.problem import Problem
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["beam_sequences", "best_alone", "solve_by_columns"]


def beam_sequences(world: World, belief: Belief, poses: FloatArray, time: float) -> Sequences:
    """Grow the ``beam`` sequences of each robot with the largest individual values, step by step."""
    scenario, width = world.scenario, check_integer("beam", world.model.beam, low=1)
    level = replace(world, horizon=1).sequences(poses)
    for h in range(1, world.horizon + 1):
        ahead = replace(world, horizon=h)
        alone = ahead.criterion(belief, level, time).singletons()
        level = level.only(best_alone(alone, level.owner, width))
        if h < world.horizon:
            level = extended(scenario, level, world.move)
    return level


def best_alone(values: FloatArray, owner: IntArray, width: int) -> IntArray:
    """The ``width`` elements of largest value of each robot, ascending; of equal ones the first."""
    kept = [
        (own := np.flatnonzero(owner == i))[np.argsort(-values[own], kind="stable")[:width]] for i in np.unique(owner)
    ]
    return readonly(np.sort(np.concatenate(kept)))


def solve_by_columns(
    problem: Problem,
    start: IntArray,
    *,
    gap: float = 0.01,
    time_limit: float | None = None,
    inner_share: float = 0.5,
) -> MaxMinResult:
    """Bracket the optimum over all elements, searching only among those that matter.

    Parameters
    ----------
    problem : of an information criterion; relies on it being non-decreasing
    start : elements to begin with, at least one of each robot
    gap, time_limit : as for :func:`solve_maxmin`
    inner_share : of the gap, in [0, 1], for the search over some elements; the rest is for the elements left out

    Returns
    -------
    MaxMinResult : elements of ``problem``; without a proof record, ``nodes`` of all searches

    Raises
    ------
    InputError : a limit is negative, or the objective is no information criterion.
    """
    check_limits(gap, time_limit)
    if not 0 <= inner_share <= 1:
        raise InputError("inner_share", "must be in [0, 1]", inner_share)
    budget, kept = Budget(time_limit), np.unique(start)
    objective = problem.information_objective
    upper, nodes, evaluations = np.inf, 0, 0
    while True:
        part = replace(problem, objective=objective.restricted_to(kept), robot=problem.robot[kept])
        within = Budget.inside(budget, time_limit and budget.seconds_left)
        # Covers and inequalities of base sets have no prices.
        found = solve_in_coordinates(part, within, inner_share * gap, stages=TREES_ALONE, by_rows=False)
        nodes, evaluations = nodes + found.nodes, evaluations + found.evaluations
        fresh: IntArray = np.zeros(0, dtype=np.int64)
        if found.proof is not None:
            bound, fresh = _priced(problem, kept, found.proof)
            upper = min(upper, bound)
        stop = _stopped(found, upper, gap, budget, fresh)
        if stop is not None:
            break
        kept = np.union1d(kept, fresh)
    if not np.isfinite(upper):
        upper = problem.objective(range(problem.objective.n))  # by monotonicity
    result = MaxMinResult(
        elements=readonly(kept[found.elements]),
        lower=found.lower,
        upper=max(float(upper), found.lower),
        stop=stop,
        evaluations=evaluations,
        nodes=nodes,
        worst_case=found.worst_case,
    )
    return result.widen_by_rounding(problem)


def _stopped(found: MaxMinResult, upper: float, gap: float, budget: Budget, fresh: IntArray) -> Stop | None:
    if found.stop is Stop.INTERRUPTED or (over := budget.stop()) is not None:
        return found.stop if found.stop is Stop.INTERRUPTED else over
    if upper - found.lower <= gap * abs(upper):
        return Stop.GAP
    return None if len(fresh) else found.stop


@dataclass(frozen=True, slots=True, eq=False)
class _Cuts:
    """Every cut as ``constant`` (K,) plus ``scores`` (K, E) of the robots in ``groups`` (K, N)."""

    constant: FloatArray
    scores: FloatArray
    groups: FloatArray

    @classmethod
    def of(cls, objective: InformationObjective, n_robots: int, proof: UpperProof) -> _Cuts:
        tangents = [objective.tangent(cut.point, cut.target) for cut in proof.cuts]
        slopes = np.array([tangent.slope.ravel() for tangent in tangents])
        flat = objective.information.reshape(objective.n, -1)
        constant = np.array([tangent.offset for tangent in tangents]) + slopes @ objective.prior_information.ravel()
        groups = np.array([[float(i in cut.group) for i in range(n_robots)] for cut in proof.cuts])
        return cls(constant, slopes @ flat.T, groups)


def _priced(problem: Problem, kept: IntArray, proof: UpperProof) -> tuple[float, IntArray]:
    """The bound of the worst leaf over all elements, and elements left out that exceed every kept one there."""
    objective, robots = problem.information_objective, problem.n_robots
    cuts = _Cuts.of(objective, robots, proof)
    out = np.ones(objective.n, dtype=np.bool_)
    out[kept] = False
    worst, fresh = -np.inf, set[int]()
    for leaf, left in _leaves(problem, kept, proof):
        weights = np.array(leaf.weights) / sum(leaf.weights)
        chosen = list(leaf.cuts)
        total = float(weights @ cuts.constant[chosen])
        for i in range(robots):
            score = (weights * cuts.groups[chosen, i]) @ cuts.scores[chosen]
            inside = float(score[left[i]].max())
            others = np.flatnonzero(out & (problem.robot == i))
            best = int(others[np.argmax(score[others])]) if len(others) else -1
            if best >= 0 and score[best] > inside:
                fresh.add(best)
                inside = float(score[best])
            total += inside
        worst = max(worst, total)
    return worst + 16 * objective.rounding, np.array(sorted(fresh), dtype=np.int64)


def _leaves(problem: Problem, kept: IntArray, proof: UpperProof) -> list[tuple[Leaf, list[IntArray]]]:
    """The proof's leaves, each with the elements (of the whole problem) that remain of every robot."""
    owner = problem.robot[kept]
    stack = [[np.flatnonzero(owner == i) for i in range(problem.n_robots)]]
    leaves = []
    for node in proof.tree:
        left = stack.pop()
        if isinstance(node, Leaf):
            leaves.append((node, [kept[part] for part in left]))
        elif isinstance(node, WinnerBranch):
            stack.extend([left] * len(node.parts))
        else:
            assert isinstance(node, ElementBranch)
            below = [[*left[: node.robot], np.array(part), *left[node.robot + 1 :]] for part in node.parts]
            stack.extend(reversed(below))
    return leaves
