"""Compiled loops over contexts and cuts, imported if a search needs them; the plain versions are in the tests."""

from __future__ import annotations

from typing import Any

import numpy as np

from ratt_opt.running.compiling import numba

__all__ = ["MARGIN", "ceiling", "descend", "descend_pairs", "raise_ceilings", "violated"]

MARGIN = 1e-12
"""Safety margin for rounding of a ceiling, relative to the sum of the absolute terms."""
# Levels are finite (checked on entry), so comparisons may assume it; no operation is reordered.
_FINITE = {"nnan", "ninf", "nsz"}
_IMPROVED = 1e-12
"""Relative improvements below this are none: rounding must not make two contexts take turns."""


@numba.njit(cache=True, fastmath=_FINITE)
def _marginal(rest: Any, part: Any, added: Any) -> float:
    """``1/P - 1/Q`` of ``rest + part`` without and with ``added``, all (3, M)."""
    before = after = np.inf
    for j in range(rest.shape[1]):
        mean, even, odd = rest[0, j] + part[0, j], rest[1, j] + part[1, j], rest[2, j] + part[2, j]
        before = min(before, mean - np.sqrt(even * even + odd * odd))
        mean, even, odd = mean + added[0, j], even + added[1, j], odd + added[2, j]
        after = min(after, mean - np.sqrt(even * even + odd * odd))
    return (after - before) / (before * after)


@numba.njit(cache=True)
def _add(total: Any, part: Any, times: float, out: Any) -> None:
    """Write ``total + times part``."""
    for p in range(total.shape[0]):
        for j in range(total.shape[1]):
            out[p, j] = total[p, j] + times * part[p, j]


@numba.njit(cache=True)
def descend(parts: Any, ends: Any, total: Any, added: Any, sign: float, picks: Any) -> None:  # noqa: PLR0917
    """Change one owner at a time until none improves the marginal times ``sign``.

    ``total`` (3, M) and ``picks`` (R,) are changed; ``ends`` (R + 1,) delimit the options of each owner.
    """
    rest = np.zeros_like(total)
    value = sign * _marginal(total, rest, added)
    improved = True
    while improved:
        improved = False
        for i in range(len(picks)):
            now = picks[i]
            _add(total, parts[now], -1.0, rest)
            for k in range(ends[i], ends[i + 1]):
                found = sign * _marginal(rest, parts[k], added)
                if found < value - _IMPROVED * abs(value):
                    picks[i], value = k, found
            if picks[i] != now:
                improved = True
                _add(rest, parts[picks[i]], 1.0, total)


@numba.njit(cache=True)
def descend_pairs(parts: Any, ends: Any, total: Any, added: Any, sign: float, picks: Any) -> None:  # noqa: PLR0917
    """Like :func:`descend`, with two owners at a time, and over all pairs once."""
    rest, one = np.zeros_like(total), np.zeros_like(total)
    value = sign * _marginal(total, rest, added)
    for i in range(len(picks)):
        for j in range(i + 1, len(picks)):
            a, b = picks[i], picks[j]
            _add(total, parts[a], -1.0, rest)
            _add(rest, parts[b], -1.0, rest)
            for k in range(ends[i], ends[i + 1]):
                _add(rest, parts[k], 1.0, one)
                for m in range(ends[j], ends[j + 1]):
                    found = sign * _marginal(one, parts[m], added)
                    if found < value - _IMPROVED * abs(value):
                        picks[i], picks[j], value = k, m, found
            if picks[i] != a or picks[j] != b:
                _add(rest, parts[picks[i]], 1.0, one)
                _add(one, parts[picks[j]], 1.0, total)


@numba.njit(cache=True, fastmath=_FINITE)
def raise_ceilings(  # noqa: PLR0917
    parts: Any, owners: Any, levels: Any, slopes: Any, target: Any, direction: Any
) -> Any:
    """(2, B, S) sums over owners of the largest ``levels - slope own`` of their options, and of its absolute value.

    parts : (K, 3, M); owners : (K,) ascending; levels : (B, K); slopes : (B,); target : (S,); direction : (S, 3)
    """
    count, width = len(levels), len(target)
    own = np.empty((len(parts), width))
    for k in range(len(parts)):
        for s in range(width):
            j = target[s]
            own[k, s] = (
                parts[k, 0, j] * direction[s, 0] + parts[k, 1, j] * direction[s, 1] + parts[k, 2, j] * direction[s, 2]
            )
    sums = np.zeros((2, count, width))
    best = np.empty(width)
    for b in range(count):
        slope = slopes[b]
        for k in range(len(parts)):
            level = levels[b, k]
            if k == 0 or owners[k] != owners[k - 1]:
                best[:] = -np.inf
            for s in range(width):
                best[s] = max(best[s], level - slope * own[k, s])
            if k + 1 == len(parts) or owners[k + 1] != owners[k]:
                for s in range(width):
                    sums[0, b, s] += best[s]
                    sums[1, b, s] += abs(best[s])
    return sums


@numba.njit(cache=True)
def ceiling(scores: Any, constants: Any, weights: Any, owners: Any) -> float:
    """Largest weighted sum of forms ``constants + scores . z`` over all contexts: each owner's best option.

    scores : (F, n); constants, weights : (F,); owners : (n,) ascending
    """
    n = len(owners)
    combined = np.zeros(n)
    total, size = 0.0, 0.0
    for c, weight in enumerate(weights):
        if weight != 0.0:
            total += weight * constants[c]
            size += abs(weight * constants[c])
            for k in range(n):
                combined[k] += weight * scores[c, k]
    best = -np.inf
    for k in range(n):
        best = max(best, combined[k])
        if k + 1 == n or owners[k + 1] != owners[k]:
            total += best
            size += abs(best)
            best = -np.inf
    return float(total + MARGIN * size)


@numba.njit(cache=True)
def violated(parts: Any, base: Any, z: Any, limit: float, most: int) -> Any:
    """Targets of the mixture ``z`` (n,) whose level is below a limit, weakest first, and their weakest angles."""
    total = base.copy()
    for k, share in enumerate(z):
        if share != 0.0:
            for p in range(3):
                for j in range(total.shape[1]):
                    total[p, j] += share * parts[k, p, j]
    level = total[0] - np.hypot(total[1], total[2])
    targets = np.argsort(level)[:most]
    targets = targets[level[targets] < limit]
    return targets, np.arctan2(-total[2][targets], -total[1][targets])
