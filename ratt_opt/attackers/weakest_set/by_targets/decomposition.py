"""An affine minorant of the value of sets of robots of one size, target by target.

Every target chooses a set of its own, at shares of robots that make the choices agree (``target_choices.py``). What
the choices are worth at least is proved afterwards (``slope_cells.py``), whatever the shares, so nothing depends on how
they were found. The minorants of ``minorant.py`` are those whose shares are linear in the information but for a few
heavy robots of each target.

Where only sets with ``lacking(R) < 0`` are asked for, ``value(R) > value(R) + multiplier lacking(R)`` for any
multiplier >= 0.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.attackers.weakest_set.by_targets.slope_cells import least_choice
from ratt_opt.attackers.weakest_set.by_targets.slope_meshes import Meshes
from ratt_opt.attackers.weakest_set.by_targets.target_choices import Ascent, Family, ascend, choose, room
from ratt_opt.attackers.weakest_set.outer_polytopes import target_values
from ratt_opt.running.compiling import numba

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray
    from ratt_opt.attackers.weakest_set.packed_team import SetFamily
    from ratt_opt.budget import Budget

__all__ = ["Decomposition", "decomposed"]

SPREAD = 10.0 ** np.array([-2.5, -2.0, -1.5, -1.0, -0.5])
"""Information of all robots, beside the mean of a set, whose slopes local choices begin with."""
FIRST_STEPS, STEPS = 100, 50
"""Steps of an ascent from nothing, and from the shares of a larger family or of the last ascent."""
FIRST_ROUNDS, ROUNDS = 4, 1
"""Ascents, each followed by a proof, from nothing and from the shares of a larger family."""
MISSED, PROGRESS = 0.02, 0.1
"""What local choices miss at first, relative to the goal; share of what is lacking for which it is worth to go on."""
AIM, LEAST_AIM = 0.1, 1e-4
"""What the first steps of an ascent aim at: a share of what is lacking, and at least, relative to the goal."""
TOLERANCE, LOST = 1e-3, 0.5
"""What proofs of all targets together may lose, relative to the goal, and of what the goal is exceeded by."""
CORNERS = 1_500
"""Corners of the cells of one target, at most: a millisecond."""


@dataclass(frozen=True, slots=True)
class Decomposition:
    """``value(R) >= constant + sum of scores over R`` for every set of the family.

    Of a family of which something is lacking that holds for the sets that belong to it, and for any of them with
    ``multiplier`` times what they lack on the left.

    ``scores`` : (F,); ``shares`` : (M, F) of each target; ``slopes`` : (M, K, 3) of its best choices known;
    ``fraction`` : (F,) how much of each robot is in the choices; ``tension`` : (F,) each robot's share of what
    concavity hides there
    """

    constant: float
    scores: FloatArray
    shares: FloatArray
    slopes: FloatArray
    fraction: FloatArray
    tension: FloatArray
    multiplier: float

    def bound(self, size: int) -> float:
        """No set of ``size`` robots is worth less."""
        return self.constant + float(np.partition(self.scores, size - 1)[:size].sum())

    def restricted(self, free: BoolArray, chosen: BoolArray) -> Decomposition:
        """The minorant of the sets that hold the ``chosen`` robots and else only ``free`` ones (masks (F,))."""
        return replace(
            self,
            constant=self.constant + float(self.scores[chosen].sum()),
            scores=self.scores[free],
            shares=self.shares[:, free],
            fraction=self.fraction[free],
            tension=self.tension[free],
        )


def decomposed(
    family: SetFamily,
    goal: float,
    budget: Budget,
    parent: Decomposition | None = None,
    meshes: Meshes | None = None,
) -> Decomposition:
    """Best found minorant; ``family`` : 0 < size < F; ``goal`` : no better bound is needed, finite.

    ``parent`` : a minorant of a larger family, or of this one where other things were lacking

    Raises
    ------
    OutOfBudget : the time is up.
    """
    compiled, ascent = _compiled(family), _start(family, parent)
    meshes = Meshes.of(len(family.start)) if meshes is None else meshes
    steps, rounds, missed = (FIRST_STEPS, FIRST_ROUNDS, MISSED * abs(goal)) if parent is None else (STEPS, ROUNDS, 0.0)
    best, lost, fine = None, 0.0, TOLERANCE * abs(goal)
    for _ in range(rounds):
        reached = _reached(compiled, ascent)
        aim = max(AIM * (goal - reached), LEAST_AIM * abs(goal))
        reached = ascend(compiled, ascent, steps, goal + max(lost, fine) + fine, aim)
        budget.check()
        tolerance = max(LOST * (reached - goal), LOST * missed, fine)
        found, met = _proved(family, compiled, ascent, tolerance / len(family.start), meshes)
        missed, bound = reached - met, found.bound(family.size)
        lost, before = reached - bound, -np.inf if best is None else best.bound(family.size)
        best = found if bound > before else best
        if max(bound, before) >= goal or (bound <= before + PROGRESS * (goal - before) and missed < fine):
            break
        budget.check()
    assert best is not None
    return best


def _compiled(family: SetFamily) -> Family:
    team, n_robots = family.team, len(family.information)
    return Family(
        team.code,
        team.weights,
        team.prior,
        np.ascontiguousarray(family.start),
        np.ascontiguousarray(family.information.transpose(1, 2, 0)),
        np.zeros(n_robots) if family.lacking is None else np.ascontiguousarray(family.lacking),
        family.size,
    )


def _start(family: SetFamily, parent: Decomposition | None) -> Ascent:
    """The parent's shares and slopes, or the gradient where every robot has the same share, and others'."""
    fraction = np.full(len(family.information), family.size / len(family.information))
    if parent is not None:
        return Ascent(parent.shares.copy(), np.array([parent.multiplier]), parent.slopes.copy(), fraction)
    mean = family.start + np.einsum("f,fmt->mt", fraction, family.information)
    total = family.information.sum(axis=0)
    slopes = np.stack([_gradient(family, m) for m in (mean, *(family.start + s * total for s in SPREAD))], axis=1)
    shares = np.einsum("fmt,mt->mf", family.information, slopes[:, 0])
    multiplier = 0.0
    if family.lacking is not None and family.lacking.any():
        multiplier = float(np.std(shares.sum(axis=0)) / np.sqrt((family.lacking**2).mean()))
    return Ascent(np.ascontiguousarray(shares), np.array([multiplier]), np.ascontiguousarray(slopes), fraction)


def _gradient(family: SetFamily, matrices: FloatArray) -> FloatArray:
    """(M, 3) derivative of each target's value in (a, b, c) at information matrices (M, 3)."""
    team = family.team
    gradient = team.objective.planar_gradient(matrices[:, 0], matrices[:, 1], matrices[:, 2])
    return np.asarray(team.weights[:, None] * gradient)


def _reached(compiled: Family, ascent: Ascent) -> float:
    """What local choices say now."""
    return float(ascend(compiled, ascent, 1, -np.inf, 1.0))


def _proved(
    family: SetFamily, compiled: Family, ascent: Ascent, tolerance: float, meshes: Meshes
) -> tuple[Decomposition, float]:
    """The minorant of these shares, and what it would be by the best choices met.

    A target of which nothing is proved has no shares, and is worth what is chosen.
    """
    constants, shares = np.empty(len(family.start)), ascent.shares.copy()
    search: Any = _prove_all
    met = search(compiled, ascent, (tolerance, CORNERS), meshes, constants)
    without = target_values(family, family.start)
    unsound = ~np.isfinite(constants)
    constants[unsound], shares[unsound] = without[unsound], 0.0
    multiplier, fraction = float(ascent.multiplier[0]), ascent.fraction.copy()
    mean = family.start + np.einsum("f,fmt->mt", fraction, family.information)
    hidden = np.maximum(target_values(family, mean) - constants - shares @ fraction, 0.0)
    trace = family.information[..., 0] + family.information[..., 2]
    part = np.minimum(trace / np.maximum((mean[:, 0] + mean[:, 2])[None], 1e-300), 1.0)  # of a target's information
    scores = shares.sum(axis=0) + multiplier * compiled.lacking
    minorant = Decomposition(
        constant=float(constants.sum()),
        scores=scores,
        shares=shares,
        slopes=ascent.slopes.copy(),
        fraction=fraction,
        tension=np.asarray(part @ np.where(np.isfinite(hidden), hidden, 0.0)),
        multiplier=multiplier,
    )
    return minorant, float(met) + float(np.partition(scores, family.size - 1)[: family.size].sum())


@numba.njit(cache=True)
def _prove_all(family: Any, ascent: Any, effort: Any, meshes: Any, constants: Any) -> float:
    """What each target's choices are worth at least, and the sum of the least ones met.

    Those found here replace the worst slopes that are known.
    """
    total = 0.0
    work = room(len(family.lacking))
    for j in range(len(constants)):
        values = np.empty(ascent.slopes.shape[1])
        for k in range(len(values)):
            _, values[k] = choose(family, j, ascent.shares[j], ascent.slopes[j, k], work)
        slopes = ascent.slopes[j, values.argmin()].copy()
        constants[j], best = least_choice(family, j, ascent.shares[j], slopes, effort, meshes)
        total += best
        if best < values.min():
            ascent.slopes[j, _superfluous(values)] = slopes
    return total


@numba.njit(cache=True)
def _superfluous(values: Any) -> int:
    """One of two choices that are alike, or the worst one."""
    order = np.argsort(values)
    for k in range(1, len(values)):
        if values[order[k]] == values[order[k - 1]]:
            return int(order[k])
    return int(order[-1])
