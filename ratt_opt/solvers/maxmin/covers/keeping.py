"""Elements that an attack can afford to leave, compiled.

Notation: the robots of one group may choose among kept elements only. What such a choice tells about a target is, in
the Loewner order, at most the prior's information plus, robot by robot, an upper bound ``raised`` of the matrices of
its kept elements. The values of these sums bound what the group is worth.

Targets are lost first: nothing is kept that sees them, until the others are worth no more than the level. Then elements
come back one by one, as long as the level is not exceeded.

Symmetric matrices are packed by rows of the lower triangle; T = d (d + 1) / 2.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ratt_opt.compiling import numba
from ratt_opt.setfunctions.criteria.trace import TraceObjective

__all__ = ["Team", "group_values", "keep", "lose_all", "raised", "strongest_of", "value_of"]

PLANAR = 3
TRACE = TraceObjective.compiled_code
SWEEPS = 8
"""Of Jacobi's rotations; what is left of other entries is rounding."""
NO_PRICE = 1e-3
"""Added to every price: among free elements those that cost least of the level come first."""


class Team(NamedTuple):
    """The data of a problem over E elements.

    ``code`` : the criterion's; ``weights``, ``baseline`` (M,) : of targets; ``prior`` (M, T), ``information`` (E, M, T)
    ``sees`` (E, M) : where there is information; ``owner``, ``bit``, ``element`` : as :class:`Places` has them
    ``count`` (N,) : what a robot counts in a cover; ``safe`` (N,) : whether it cannot be blinded
    """

    code: Any
    weights: Any
    baseline: Any
    prior: Any
    information: Any
    sees: Any
    owner: Any
    bit: Any
    element: Any
    count: Any
    safe: Any
    enough: Any


@numba.njit(cache=True)
def raised(first: Any, second: Any, out: Any) -> None:
    """``out = A + (B - A)_+``, no smaller than either of two packed matrices."""
    if len(first) != PLANAR:
        _raised_of_any_dimension(first, second, out)
        return
    a, b, c = second[0] - first[0], second[1] - first[1], second[2] - first[2]
    middle, half = (a + c) / 2, np.sqrt((a - c) ** 2 / 4 + b * b)
    if middle >= half:
        share, low = 1.0, 0.0
    elif middle <= -half:
        share, low = 0.0, 0.0
    else:
        share, low = (middle + half) / (2 * half), middle - half  # times the projector (X - low) / (high - low)
    x, y, z = first[0] + share * (a - low), first[1] + share * b, first[2] + share * (c - low)
    out[0], out[1], out[2] = x, y, z


@numba.njit(cache=True)
def _raised_of_any_dimension(first: Any, second: Any, out: Any) -> None:
    d = 1
    while d * (d + 1) // 2 < len(first):
        d += 1
    matrix, axes = np.empty((d, d)), np.zeros((d, d))
    for i in range(d):
        axes[i, i] = 1.0
        for j in range(i + 1):
            k = i * (i + 1) // 2 + j
            matrix[i, j] = matrix[j, i] = second[k] - first[k]
    for _ in range(SWEEPS):
        for p in range(d - 1):
            for q in range(p + 1, d):
                _rotate(matrix, axes, p, q)
    for i in range(d):
        for j in range(i + 1):
            k = i * (i + 1) // 2 + j
            more = 0.0
            for m in range(d):
                more += max(matrix[m, m], 0.0) * axes[i, m] * axes[j, m]
            out[k] = first[k] + more


@numba.njit(cache=True)
def _rotate(matrix: Any, axes: Any, p: int, q: int) -> None:
    """Jacobi's rotation: the entry (p, q) becomes 0."""
    if matrix[p, q] == 0.0:
        return
    angle = 0.5 * np.arctan2(2 * matrix[p, q], matrix[q, q] - matrix[p, p])
    cosine, sine = np.cos(angle), np.sin(angle)
    for k in range(len(matrix)):
        x, y = matrix[k, p], matrix[k, q]
        matrix[k, p], matrix[k, q] = cosine * x - sine * y, sine * x + cosine * y
    for k in range(len(matrix)):
        x, y = matrix[p, k], matrix[q, k]
        matrix[p, k], matrix[q, k] = cosine * x - sine * y, sine * x + cosine * y
        x, y = axes[k, p], axes[k, q]
        axes[k, p], axes[k, q] = cosine * x - sine * y, sine * x + cosine * y


@numba.njit(cache=True)
def strongest_of(team: Any) -> Any:
    """(N, M, T) no smaller than what any element of the robot tells about the target."""
    bound = np.zeros((len(team.count), team.prior.shape[0], team.prior.shape[1]))
    for e in range(len(team.information)):
        for j in range(team.prior.shape[0]):
            if team.sees[e, j]:
                raised(bound[team.owner[e], j], team.information[e, j], bound[team.owner[e], j])
    return bound


@numba.njit(cache=True)
def value_of(team: Any, j: int, matrix: Any) -> float:
    """What is gained about a target (trace or log-det) where its posterior information is a packed matrix."""
    if len(matrix) == PLANAR:
        a, c = matrix[0], matrix[2]
        determinant = a * c - matrix[1] * matrix[1]
        trace = (a + c) / determinant
    else:
        determinant, trace = _of_any_dimension(matrix)
    return float(team.baseline[j] - team.weights[j] * (trace if team.code == TRACE else -np.log(determinant)))


@numba.njit(cache=True)
def _of_any_dimension(packed: Any) -> Any:
    """The determinant of a packed matrix and the trace of its inverse, by its Cholesky factor."""
    d = 1
    while d * (d + 1) // 2 < len(packed):
        d += 1
    factor, inverse = packed.copy(), np.zeros(len(packed))
    determinant, trace = 1.0, 0.0
    for i in range(d):
        row = i * (i + 1) // 2
        for j in range(i + 1):
            other = j * (j + 1) // 2
            for k in range(j):
                factor[row + j] -= factor[row + k] * factor[other + k]
            factor[row + j] = np.sqrt(factor[row + j]) if i == j else factor[row + j] / factor[other + j]
        determinant *= factor[row + i] * factor[row + i]
        inverse[row + i] = 1.0 / factor[row + i]
        for j in range(i):
            for k in range(j, i):
                inverse[row + j] -= factor[row + k] * inverse[k * (k + 1) // 2 + j]
            inverse[row + j] /= factor[row + i]
        for j in range(i + 1):
            trace += inverse[row + j] * inverse[row + j]
    return determinant, trace


@numba.njit(cache=True)
def _costs(sees: Any, price: Any, kept: Any) -> Any:
    """(M,) the price of all kept elements that see each target."""
    costs = np.zeros(sees.shape[1])
    for e in range(len(kept)):
        if kept[e]:
            for j in range(len(costs)):
                if sees[e, j]:
                    costs[j] += price[e]
    return costs


@numba.njit(cache=True)
def lose(sees: Any, inside: Any, price: Any, values: Any, level: float, noise: Any, out: Any) -> float:  # noqa: PLR0917
    """Lose targets until the rest is worth at most ``level``; the price of all elements that see a lost one.

    ``inside`` : (E,) elements of the group; ``values`` : (M,) what the group can be worth for each target
    ``noise`` : (M,) factors of the order in which targets are lost
    ``out`` : (E,) set to whether the element is of the group and sees no lost target
    """
    left, paid = 0.0, 0.0
    for e in range(len(out)):
        out[e] = inside[e]
    for j in range(len(values)):
        left += values[j]
    costs = _costs(sees, price, out)
    lost = np.zeros(len(values), np.bool_)
    while left > level:
        best, most = -1, -1.0
        for j in range(len(values)):
            if not lost[j] and values[j] > 0:
                gain = min(values[j], left - level) / (max(costs[j], 0.0) + NO_PRICE) * noise[j]
                if gain > most:
                    best, most = j, gain
        if best < 0:
            return np.inf
        lost[best] = True
        left -= values[best]
        for e in range(len(out)):
            if out[e] and sees[e, best]:
                out[e] = False
                paid += price[e]
                for j in range(len(values)):
                    if sees[e, j]:
                        costs[j] -= price[e]
    return paid


@numba.njit(cache=True)
def keep(team: Any, inside: Any, price: Any, level: float, kept: Any, sums: Any) -> float:  # noqa: PLR0917
    """Keep further elements of a group while its bound stays at most ``level``; the price of what is not kept.

    ``kept`` : (E,) elements kept so far, whose bound is at most the level; more are set
    ``sums`` : (M, T) set to the posterior information at which the bound is taken
    """
    bound, values = _bound_kept(team, kept, sums)
    worth, paid = 0.0, 0.0
    for j in range(len(values)):
        worth += values[j]
    order = np.full(len(kept), np.inf)
    more, after = np.zeros(team.prior.shape), np.zeros(len(values))
    for e in range(len(kept)):
        if inside[e] and not kept[e]:
            rise = _rise(team, e, bound[team.owner[e]], sums, values, more, after)
            order[e] = (max(rise, 0.0) + 1e-9) / (price[e] + NO_PRICE)
    for _ in range(len(kept)):
        e = _first_left(order)
        if order[e] == np.inf:
            return paid
        order[e] = np.inf
        rise = _rise(team, e, bound[team.owner[e]], sums, values, more, after)
        if worth + rise > level:
            paid += price[e]
        else:
            kept[e] = True
            worth += rise
            _take(team.sees[e], more, after, bound[team.owner[e]], sums, values)
    return paid


@numba.njit(cache=True)
def _bound_kept(team: Any, kept: Any, sums: Any) -> Any:
    """Upper bounds (N, M, T) of what kept elements tell, and the targets' values; ``sums`` : set to what all tell."""
    bound, values = np.zeros((len(team.count), len(team.prior), team.prior.shape[1])), np.zeros(len(team.prior))
    for e in range(len(kept)):
        for j in range(len(values)):
            if kept[e] and team.sees[e, j]:
                own = bound[team.owner[e], j]
                raised(own, team.information[e, j], own)
    for j in range(len(values)):
        for k in range(sums.shape[1]):
            sums[j, k] = team.prior[j, k]
            for i in range(len(bound)):
                sums[j, k] += bound[i, j, k]
        values[j] = value_of(team, j, sums[j])
    return bound, values


@numba.njit(cache=True)
def _take(sees: Any, more: Any, after: Any, own: Any, sums: Any, values: Any) -> None:  # noqa: PLR0917
    """Add an element whose matrices and values :func:`_rise` found."""
    for j in range(len(values)):
        if sees[j]:
            values[j] = after[j]
            for k in range(sums.shape[1]):
                sums[j, k] += more[j, k] - own[j, k]
                own[j, k] = more[j, k]


@numba.njit(cache=True)
def _first_left(order: Any) -> int:
    best = 0
    for e in range(len(order)):
        if order[e] < order[best]:
            best = e
    return best


@numba.njit(cache=True)
def _rise(team: Any, e: int, own: Any, sums: Any, values: Any, more: Any, after: Any) -> float:  # noqa: PLR0917
    """How much the bound rises with one more element of a robot; ``more``, ``after`` : set to its matrices, values."""
    rise, matrix = 0.0, np.empty(sums.shape[1])
    for j in range(len(values)):
        if team.sees[e, j]:
            raised(own[j], team.information[e, j], more[j])
            for k in range(len(matrix)):
                matrix[k] = sums[j, k] + more[j, k] - own[j, k]
            after[j] = value_of(team, j, matrix)
            rise += after[j] - values[j]
    return rise


@numba.njit(cache=True)
def lose_all(sees: Any, inside: Any, price: Any, values: Any, level: float, noise: Any, out: Any) -> Any:  # noqa: PLR0917
    """:func:`lose` for many groups: (G, E), (G, M) -> (G,) prices; ``out`` (G, E) is set."""
    paid = np.empty(len(inside))
    for g in range(len(inside)):
        paid[g] = lose(sees, inside[g], price, values[g], level, noise[g], out[g])
    return paid


@numba.njit(cache=True)
def group_values(team: Any, strongest: Any, robots: Any) -> Any:
    """(G, M) what groups can be worth for each target; ``strongest`` (N, M, T), ``robots`` (G, N) members."""
    values, matrix = np.empty((len(robots), len(team.prior))), np.empty(team.prior.shape[1])
    for g in range(len(robots)):
        for j in range(len(team.prior)):
            for k in range(len(matrix)):
                matrix[k] = team.prior[j, k]
                for i in range(len(strongest)):
                    if robots[g, i]:
                        matrix[k] += strongest[i, j, k]
            values[g, j] = value_of(team, j, matrix)
    return values
