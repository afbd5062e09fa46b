"""Families of groups of any feasible sizes whose best group is weak, by annealing: attacks, no claim.

A state gives every robot a group or blinds it. Moves exchange two robots of different groups, one of them perhaps
blinded, or take a robot to another group where enough links stay uncut. Vectors of sizes are not told apart, so
annealing also finds the better vector, where exchanges (``group_exchanges.py``) start anew in each of thousands.
"""

from __future__ import annotations

from math import comb
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ratt_opt.graph.survivor_sizes import forced_group_size, sizes_of_largest
from ratt_opt.running.compiling import numba
from ratt_opt.setfunctions.criteria.compiled import team_criterion

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
    from ratt_opt.budget import Budget
    from ratt_opt.graph.threat import Threat

__all__ = ["AnnealedFamilies", "Cooling", "annealed_from"]

FIRST_MOVES, LONGER = 2_000_000, 2
"""Moves of the first start, and how many times as many each time after. At 60 robots, 40 targets a million take a third
of a second; with (0, 1454) and log-det starts of two million end at 208 to 211, of twenty million at 206 or 208."""
CHUNK = 100_000
"""Moves between two looks at the clock: some hundredths of a second, a tenth at 100 robots and 100 targets."""
HOT, COLD = 1e-2, 2e-4
"""First and last temperature, relative to the best group at the start. With a last one of 1e-3 starts of twenty million
moves end no better than those of two million."""
POWER = 30.0
"""Of the norm of the groups' values, as in ``by_prices/annealing.py``."""
NEGLIGIBLE = 0.6
"""Groups of less than this share of the best one do not count in the norm: its 30th power is below 1e-6."""
TRANSFER, OPENING = 0.25, 0.05
"""Chances that a move takes one robot to another group, and that this is an empty one."""
FURTHER_GROUPS = 8
"""Groups beyond those of the smallest vector of sizes."""
SEED = 0


class AnnealedFamilies:
    """Starts from random families, each with more moves than the one before; deterministic but for where time ends."""

    def __init__(self, team: PackedTeam, threat: Threat) -> None:
        self._team, self._threat = team, threat
        n_robots, n_blinded, alpha_c = len(team.single), threat.n_blinded, threat.alpha_c
        first = forced_group_size(n_robots, n_blinded, alpha_c)
        self._sizes = next(sizes_of_largest(n_robots, n_blinded, alpha_c, first), ()) if first else ()
        self._must = np.isin(np.arange(n_robots), list(threat.protected_robots))
        self._rng, self._moves = np.random.default_rng(SEED), FIRST_MOVES

    def start(self, budget: Budget) -> tuple[frozenset[int], ...]:
        """The best family of the next start, as far as the time goes; empty where every robot is blinded."""
        if not self._sizes or budget.is_over:
            return ()
        home = _random_family(self._sizes, self._must, self._rng)
        groups = tuple(frozenset(np.flatnonzero(home == g).tolist()) for g in range(1, len(self._sizes) + 1))
        cooling = Cooling(HOT, self._moves)
        self._moves *= LONGER
        return annealed_from(groups, self._team, self._threat, cooling, self._rng, budget)


class Cooling(NamedTuple):
    """``hot`` : first temperature, relative to the best group; ``moves`` in all."""

    hot: float
    moves: int


def annealed_from(  # noqa: PLR0917
    groups: tuple[frozenset[int], ...],
    team: PackedTeam,
    threat: Threat,
    cooling: Cooling,
    rng: np.random.Generator,
    budget: Budget,
) -> tuple[frozenset[int], ...]:
    """The best family that annealing meets, from some groups that an attack can leave; as far as the time goes."""
    n_robots = len(team.single)
    must = np.isin(np.arange(n_robots), list(threat.protected_robots))
    home, best, value = np.zeros(n_robots, dtype=np.int64), np.zeros(n_robots, dtype=np.int64), np.full(1, np.inf)
    for g, group in enumerate(groups, start=1):
        home[list(group)] = g
    criterion = team.code, team.weights, team.baseline, team.prior, team.information
    limits = threat.n_blinded, comb(n_robots, 2) - threat.alpha_c, len(groups) + FURTHER_GROUPS
    hot = cooling.hot * max(team.value(group) for group in groups)
    for done in range(0, cooling.moves, CHUNK):
        falling = hot, COLD / cooling.hot, done / cooling.moves, 1 / cooling.moves
        _anneal(criterion, (home, must), limits, falling, (best, value), rng)
        if budget.is_over:
            break
    return tuple(frozenset(np.flatnonzero(best == g).tolist()) for g in range(1, int(best.max()) + 1) if g in best)


def _random_family(sizes: tuple[int, ...], must: Any, rng: np.random.Generator) -> IntArray:
    """(N,) group of each robot, 0 for those that are blinded."""
    order = rng.permutation(len(must))
    order = np.concatenate([order[must[order]], order[~must[order]]])[: sum(sizes)]
    home = np.zeros(len(must), dtype=np.int64)
    home[rng.permutation(order)] = np.repeat(np.arange(1, len(sizes) + 1), sizes)
    return home


@numba.njit(cache=True)
def _anneal(criterion: Any, robots: Any, limits: Any, cooling: Any, found: Any, rng: Any) -> None:  # noqa: PLR0917
    """Make a chunk of moves.

    robots : home (N,), changed in place, and which cannot be blinded (N,)
    limits : blinded robots, links that stay, groups
    cooling : first temperature [unit of the value], the last over it, share of the moves done, share of one
    found : the best family (N,) so far and its value (1,), changed in place
    """
    (home, must), (best, value) = robots, found
    sums, values, sizes = _filled(criterion, home, limits[2])
    changed = np.empty((2, *sums.shape[1:]))
    energy = _norm(values, (-1, -1), (0.0, 0.0))
    if values.max() < value[0]:
        value[0], best[:] = values.max(), home
    for move in range(CHUNK):
        temperature = cooling[0] * cooling[1] ** (cooling[2] + move * cooling[3])
        i, other, target = _propose((home, must), sizes, limits, rng)
        if i < 0:
            continue
        one, two = _changed_values(criterion, (home[i], target), (i, other), sums, (sizes, changed))
        new = _norm(values, (home[i], target), (one, two))
        if new > energy and rng.random() >= np.exp((energy - new) / temperature):
            continue
        energy, source = new, home[i]
        sums[source], sums[target] = changed[0], changed[1]
        values[source], values[target] = one, two
        home[i] = target
        if other >= 0:
            home[other] = source
        else:
            sizes[source] -= 1
            sizes[target] += 1
        if values.max() < value[0]:
            value[0], best[:] = values.max(), home


@numba.njit(cache=True)
def _filled(criterion: Any, home: Any, n_groups: int) -> Any:
    """Information, values and sizes of the groups; label 0 is of the blinded robots and worth nothing."""
    code, weights, baseline, prior, information = criterion
    sums, values = np.empty((n_groups + 1, *prior.shape)), np.full(n_groups + 1, -np.inf)
    sizes = np.zeros(n_groups + 1, dtype=np.int64)
    for g in range(n_groups + 1):
        sums[g] = prior
    for i in range(len(home)):
        sums[home[i]] += information[i]
        sizes[home[i]] += 1
    for g in range(1, n_groups + 1):
        if sizes[g] > 0:
            values[g] = baseline - team_criterion(code, weights, sums[g])
    return sums, values, sizes


@numba.njit(cache=True)
def _propose(robots: Any, sizes: Any, limits: Any, rng: Any) -> Any:
    """A robot, another one that takes its place (-1: none), and the first one's new group; robot -1 for no move."""
    home, must = robots
    n_robots = len(home)
    i, j = int(rng.random() * n_robots), int(rng.random() * n_robots)
    source, target = home[i], home[j]
    if source == 0 or rng.random() >= TRANSFER:
        allowed = source != target and not (target == 0 and must[i]) and not (source == 0 and must[j])
        return (i if allowed else -1), j, target
    if rng.random() < OPENING:
        target = 1
        while target < len(sizes) and sizes[target] > 0:
            target += 1
    if target == source or not 0 < target < len(sizes):
        return -1, -1, 0
    kept, largest, n_blinded = 0, 0, limits[0]
    for g in range(1, len(sizes)):
        size = sizes[g] - int(g == source) + int(g == target)
        kept += size * (size - 1) // 2
        largest = max(largest, size)
    kept += n_blinded * largest + n_blinded * (n_blinded - 1) // 2
    return (i if kept >= limits[1] else -1), -1, target


@numba.njit(cache=True)
def _changed_values(criterion: Any, groups: Any, pair: Any, sums: Any, kept: Any) -> Any:
    """Values of both groups after a move, minus infinity of blinded or of no robots; fills their information."""
    code, weights, baseline, _, information = criterion
    (source, target), (i, other), (sizes, changed) = groups, pair, kept
    for m in range(sums.shape[1]):
        for t in range(sums.shape[2]):
            moved = information[i, m, t] - (information[other, m, t] if other >= 0 else 0.0)
            changed[0, m, t] = sums[source, m, t] - moved
            changed[1, m, t] = sums[target, m, t] + moved
    one, two = -np.inf, -np.inf
    if source > 0 and (other >= 0 or sizes[source] > 1):
        one = baseline - team_criterion(code, weights, changed[0])
    if target > 0:
        two = baseline - team_criterion(code, weights, changed[1])
    return one, two


@numba.njit(cache=True)
def _norm(values: Any, groups: Any, pair: Any) -> float:
    """Norm of the values (G + 1,), those of two groups replaced by a pair."""
    source, target = groups
    top = 0.0
    for g in range(1, len(values)):
        value = pair[0] if g == source else pair[1] if g == target else values[g]
        top = max(top, value)
    if top <= 0.0:
        return 0.0
    total = 0.0
    for g in range(1, len(values)):
        value = pair[0] if g == source else pair[1] if g == target else values[g]
        if value > NEGLIGIBLE * top:
            total += (value / top) ** POWER
    return float(top * total ** (1 / POWER))
