"""Submodularity ratio and generalised curvature of Bian et al. 2017: exact, or as a bracket.

With ``rho(W | S) = f(S + W) - f(S)``, and all sets within the domain:

    ratio gamma:    the largest number with  sum_{w in W} rho(w | S) >= gamma rho(W | S)      for all disjoint S, W
    curvature alpha: the smallest number with  rho(i | B) >= (1 - alpha) rho(i | A)           for all A in B, i not in B

A pair whose right side is 0 restricts neither (the function is non-decreasing), so it is left out, by definition.
``gamma = 1`` exactly for submodular functions, ``alpha = 0`` exactly for supermodular ones; a function that never
gains has ``gamma = 1`` and ``alpha = 0``.

Gains are differences of computed values. Each quotient is moved outward by what that may have rounded; a gain within
rounding may be nothing at all, so it decides no attained end, and leaves the other one open. What theory says, or the
function of itself, is not contradicted by rounding: ``gamma`` is 1 of a submodular function.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import check_integer
from ratt_opt.budget import Budget, OutOfBudget, Stop, interruptible
from ratt_opt.curvatures.curvature import curvature_over
from ratt_opt.curvatures.domains import Domain, domain_of, over_subsets, values_over
from ratt_opt.curvatures.marginals import Context, each_marginal, elements_at, enumerate_marginals
from ratt_opt.curvatures.params import DEFAULT, CurvatureParams
from ratt_opt.curvatures.rounded_quotients import complement_above, complement_below, quotient_above, quotient_below
from ratt_opt.errors import InputError
from ratt_opt.running.progress import Step
from ratt_opt.setfunctions.base import finite_values
from ratt_opt.setfunctions.lattice import smallest_gain_ratio
from ratt_opt.setfunctions.rounding_errors import UNIT

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import ArrayLike

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.curvatures.curvature import Curvature
    from ratt_opt.setfunctions.base import SetFunction

__all__ = ["GeneralisedCurvature", "SubmodularityRatio", "generalised_curvature", "submodularity_ratio"]

RATIO_ROUNDING = 128 * UNIT
"""Relative error of a quotient of a sum of up to 24 differences, and a difference, of exact numbers: a term is rounded
at most 25 times, and moved by the noise in each; the quotient a few times more. That is less than half of this."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SubmodularityRatio:
    """Claim: ``lower <= gamma <= upper`` over ``domain``; ``base`` and ``added`` (S and W) attain ``upper``."""

    lower: float
    upper: float
    domain: str
    base: Context
    added: Context
    how: str
    stop: Stop


@dataclass(frozen=True, slots=True, kw_only=True)
class GeneralisedCurvature:
    """Claim: ``lower <= alpha <= upper`` over ``domain``; ``element`` on ``small``, in ``large``, attains ``lower``."""

    lower: float
    upper: float
    domain: str
    element: int | None
    small: Context
    large: Context
    how: str
    stop: Stop


@interruptible
@Step("submodularity ratio")
def submodularity_ratio(
    f: SetFunction,
    owners: ArrayLike | None = None,
    *,
    plan: ArrayLike | None = None,
    seed: int = 0,
    time_limit: float | None = DEFAULT.seconds,
    max_evaluations: int | None = None,
    budget: Budget | None = None,
    params: CurvatureParams = DEFAULT,
) -> SubmodularityRatio:
    """Bracket the submodularity ratio ``gamma`` of a non-decreasing function.

    Exact by all nested pairs up to 1.5e8 of them (17 elements; 4 robots with 12 controls over ``"feasible"``). Beyond,
    but with an enumerable domain: ``rho(W | S) <= sum of the largest later marginals``, so ``gamma`` is at least the
    smallest ``rho(w | S)`` over the largest ``rho(w | T)``, ``T`` containing ``S``. Beyond that, for information
    criteria: 1 if theory proves submodularity (log-det), else at least ``1 - total curvature``. The upper end is
    attained, by a seeded search.

    Arguments and errors are those of :func:`ratt_opt.total_curvature`; ``seed`` : of the search beyond enumeration.
    A spent limit, or an interrupt, ends enumeration: the bracket is that of a larger domain then.

    Source: Bian, Buhmann, Krause, Tschiatschek 2017, Definition 1 (after Das and Kempe 2011).
    """
    domain, inner = domain_of(f, owners, plan), Budget.inside(budget, time_limit, max_evaluations=max_evaluations)
    seed = check_integer("seed", seed, low=0)
    try:
        if domain.count > params.largest_enumeration:
            return _ratio_from_curvature(domain, seed, inner, params)
        part = inner.part(params.enumeration_share)
        values, groups = _monotone_values(domain, part), domain.groups
        if float(np.prod([2.0 * len(group) + 1 for group in groups])) <= params.largest_pairs:
            found = _smallest_ratio(values, groups, domain.noise, part)
            part.check()
            known = 0.0 if len(_hidden_owners(domain, values)) > 1 else found.lower
            return _ratio(known, found, domain, "every nested pair of sets", Stop.EXHAUSTED)
        later = _later_marginals(values, groups, domain.noise, inner)
        later = 0.0 if len(_hidden_owners(domain, values)) > 1 else later
    except OutOfBudget:
        return _ratio_from_curvature(domain, seed, inner, params)
    except KeyboardInterrupt:
        inner.interrupt()
        return _ratio_from_curvature(domain, seed, inner, params)
    found = _sampled_ratio(domain, seed, inner, params)
    return _ratio(later, found, domain, "later marginals; a searched pair", inner.stop() or Stop.HEURISTIC)


@interruptible
@Step("generalised curvature")
def generalised_curvature(
    f: SetFunction,
    owners: ArrayLike | None = None,
    *,
    plan: ArrayLike | None = None,
    seed: int = 0,
    time_limit: float | None = DEFAULT.seconds,
    max_evaluations: int | None = None,
    budget: Budget | None = None,
    params: CurvatureParams = DEFAULT,
) -> GeneralisedCurvature:
    """Bracket the generalised curvature ``alpha`` of a non-decreasing function.

    Exact if the domain can be enumerated, by running maxima over subsets (O(n) passes an element). Beyond, for
    information criteria: at most the total curvature (submodular ones: the curvature), at least what a seeded search
    attains.

    Arguments and errors are those of :func:`ratt_opt.total_curvature`; ``seed`` : of the search beyond enumeration.

    Source: Bian, Buhmann, Krause, Tschiatschek 2017, Definition 2.
    """
    domain, inner = domain_of(f, owners, plan), Budget.inside(budget, time_limit, max_evaluations=max_evaluations)
    seed = check_integer("seed", seed, low=0)
    exact = None
    if domain.count <= params.largest_enumeration:
        try:
            part = inner.part(params.enumeration_share)
            values = _monotone_values(domain, part)
            exact = _smallest_kept(values, domain.groups, domain.noise, part)
            exact = replace(exact, least=0.0) if _hidden_owners(domain, values) else exact
        except OutOfBudget:
            pass  # a bracket in the time left
        except KeyboardInterrupt:
            inner.interrupt()
    if exact is not None:
        kept, upper = exact, complement_above(exact.least)
        how, stop = "every nested pair of sets", Stop.EXHAUSTED
    else:
        # Total curvature compares a marginal with any other of its element, not only with earlier ones.
        found = curvature_over(domain, total=not f.is_submodular, gap=params.gap, budget=inner, params=params)
        kept, upper = _searched_kept(domain, found, seed, inner, params), found.upper
        how, stop = f"at most the curvature ({found.how}); a searched pair", found.stop
    small, large = map(domain.named, (kept.small, kept.large))
    x, lower = None if kept.element is None else domain.element(kept.element), complement_below(kept.most)
    return GeneralisedCurvature(
        lower=min(lower, upper),
        upper=upper,
        domain=domain.name,
        element=x,
        small=small,
        large=large,
        how=how,
        stop=stop,
    )


def _ratio_from_curvature(domain: Domain, seed: int, budget: Budget, params: CurvatureParams) -> SubmodularityRatio:
    """``rho(w | S)`` is at least ``1 - c`` times the largest marginal of ``w``; those add up to ``rho(W | S)``."""
    if domain.is_submodular:
        return _ratio(1.0, _Pair(), domain, "submodular by theory", Stop.EXHAUSTED)
    curved = curvature_over(domain, total=True, gap=params.gap, budget=budget, params=params)
    found = _sampled_ratio(domain, seed, budget, params)
    lower = complement_below(curved.upper)
    return _ratio(lower, found, domain, "1 - total curvature; a searched pair", curved.stop)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Pair:
    """``upper`` is attained by ``added`` on top of ``base``; no pair looked at has a ratio below ``lower``."""

    lower: float = 1.0
    upper: float = 1.0
    base: Context = ()
    added: Context = ()


def _ratio(lower: float, found: _Pair, domain: Domain, how: str, stop: Stop) -> SubmodularityRatio:
    upper, (base, added) = found.upper, map(domain.named, (found.base, found.added))
    if domain.is_submodular:
        if upper < 1:
            shown = f"{list(added)} add more to {list(base)} together than each alone: ratio {upper:.6g}"
            raise InputError("f", "must be submodular, as it states", shown)
        lower = 1.0
    return SubmodularityRatio(
        lower=min(lower, upper), upper=upper, domain=domain.name, base=base, added=added, how=how, stop=stop
    )


def _monotone_values(domain: Domain, budget: Budget) -> FloatArray:
    values = domain.values(budget)
    enumerate_marginals(domain, budget, values)  # refuses a function that falls
    return values


def _hidden_owners(domain: Domain, values: FloatArray) -> set[int]:
    """Owners of elements that may add something where that is computed as 0: no quotient of it is known."""
    may_add = domain.may_add
    if not may_add.any():
        return set()
    least = {x: float(gain.min()) for x, gain, _ in each_marginal(values, domain.groups)}
    return {int(domain.owners[x]) for x, gain in least.items() if may_add[x] and gain <= 0}


def _smallest_ratio(values: FloatArray, groups: list[IntArray], noise: float, budget: Budget) -> _Pair:
    """Ends of ``gamma`` (1 if nothing restricts it) and the sets that attain the upper one."""
    sizes = np.array(values.shape, dtype=np.int64)
    found = smallest_gain_ratio(np.ravel(values), sizes, budget, noise)
    lower = found.lower if found.lower >= 1 else max(found.lower, 0.0) * (1 - RATIO_ROUNDING)
    upper = found.upper * (1 + RATIO_ROUNDING)
    if upper >= 1:
        return _Pair(lower=min(lower, 1.0))
    whole = elements_at(np.unravel_index(found.top, values.shape), groups)
    base = tuple(e for bit, e in enumerate(reversed(whole)) if found.part >> bit & 1)
    return _Pair(lower=lower, upper=upper, base=base, added=tuple(e for e in whole if e not in base))


@dataclass(frozen=True, slots=True, kw_only=True)
class _Kept:
    """Share of an ``element``'s gain on ``small`` that it keeps on ``large``: at most ``most``; none keeps less than
    ``least``.
    """

    least: float = 1.0
    most: float = 1.0
    element: int | None = None
    small: Context = ()
    large: Context = ()


def _smallest_kept(values: FloatArray, groups: list[IntArray], noise: float, budget: Budget) -> _Kept:
    """Ends of the smallest ``rho(i | B) / rho(i | A)``, ``A`` in ``B`` (1 if no gain is positive), with both sets."""
    best, least = _Kept(), 1.0
    for i, gain, rest in each_marginal(values, groups):
        budget.check()
        earlier = over_subsets(np.maximum, gain)
        useful, sure = earlier > 0, earlier > noise
        least = min(least, float(quotient_below(gain[useful], earlier[useful], noise).min(initial=1.0)))
        kept = np.full(gain.shape, np.inf)
        kept[sure] = quotient_above(gain[sure], earlier[sure], noise)
        where = int(kept.argmin())
        if kept.flat[where] < best.most:
            index = np.unravel_index(where, kept.shape)
            small = elements_at(_attaining_subset(gain, index, float(earlier[index])), rest)
            best = _Kept(most=float(kept[index]), element=i, small=small, large=elements_at(index, rest))
    return replace(best, least=min(least, best.most))


def _later_marginals(values: FloatArray, groups: list[IntArray], noise: float, budget: Budget) -> float:
    """Smallest ``rho(w | S)`` over the largest ``rho(w | T)``, ``T`` containing ``S``, if that is positive."""
    best = 1.0
    for _, gain, _ in each_marginal(values, groups):
        budget.check()
        later = gain.copy()
        for axis in range(gain.ndim):
            view = np.moveaxis(later, axis, 0)
            np.maximum(view[0], view.max(axis=0), out=view[0])
        useful = later > 0
        best = min(best, float(quotient_below(gain[useful], later[useful], noise).min(initial=1.0)))
    return best


def _attaining_subset(gain: FloatArray, index: tuple[np.intp, ...], value: float) -> tuple[int, ...]:
    """A subset of the set at ``index`` if the gain is ``value``."""
    options = np.ix_(*[[0, int(pick)] if pick else [0] for pick in index])
    local = gain[options]
    where = np.unravel_index(int((local == value).argmax()), local.shape)
    return tuple(int(pick) if chosen else 0 for pick, chosen in zip(index, where, strict=True))


def _samples(
    domain: Domain, seed: int, budget: Budget, params: CurvatureParams
) -> Iterator[tuple[FloatArray, list[IntArray]]]:
    """Tables of all subsets of random sets of the domain, while there is time."""
    rng = np.random.default_rng(seed)
    groups = domain.groups
    size = min(params.sampled_size, len(groups))
    for _ in range(params.samples):
        if budget.is_over:
            return
        taken = np.sort(rng.choice(len(groups), size, replace=False))
        chosen = [np.array([rng.choice(groups[k])]) for k in taken]
        try:
            values = finite_values(values_over(domain.restricted, chosen, budget))
        except OutOfBudget:
            return
        yield values, chosen


def _sampled_ratio(domain: Domain, seed: int, budget: Budget, params: CurvatureParams) -> _Pair:
    samples = _samples(domain, seed, budget, params)
    tried = (_smallest_ratio(values, groups, domain.noise, Budget()) for values, groups in samples)
    return min(tried, key=lambda pair: pair.upper, default=_Pair())


def _searched_kept(domain: Domain, found: Curvature, seed: int, budget: Budget, params: CurvatureParams) -> _Kept:
    """The best of the sampled pairs and, if nested, of the contexts that attain the curvature (restricted names)."""
    tried = [_Kept()]
    samples = _samples(domain, seed, budget, params)
    tried += [_smallest_kept(values, groups, domain.noise, Budget()) for values, groups in samples]
    if found.element is not None and set(found.largest_context) <= set(found.smallest_context):
        back = {domain.element(x): x for x in range(domain.restricted.n)}
        small, large = (tuple(back[e] for e in c) for c in (found.largest_context, found.smallest_context))
        most = float(np.nextafter(1.0 - found.lower, 2.0))
        tried.append(_Kept(most=most, element=back[found.element], small=small, large=large))
    return min(tried, key=lambda pair: pair.most)
