"""Elements that an attack can afford to leave, compiled.

Notation: the robots of one group may choose among kept elements only. What such a choice tells about a target is, in
the Loewner order, at most the prior's information plus, robot by robot, an upper bound ``raised`` of the matrices of
its kept elements. The values of these sums bound what the group is worth.

Targets are lost first: nothing is kept that sees them, until the others are worth no more than the level. Then elements
come back one by one, as long as the level is not exceeded.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ratt_opt.running.compiling import numba
from ratt_opt.solvers.maxmin.covers.loops.team import raised, value_of

__all__ = ["keep", "lose_all"]

NO_PRICE = 1e-3
"""Added to every price: among free elements those that cost least of the level come first."""


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
def lose_all(sees: Any, inside: Any, price: Any, values: Any, level: float, noise: Any, out: Any) -> Any:  # noqa: PLR0917
    """:func:`lose` for many groups: (G, E), (G, M) -> (G,) prices; ``out`` (G, E) is set."""
    paid = np.empty(len(inside))
    for g in range(len(inside)):
        paid[g] = lose(sees, inside[g], price, values[g], level, noise[g], out[g])
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
