"""Curvature and total curvature, exact or as a certified bracket, with what attains the ends.

Both compare an element's smallest marginal with a largest one. *Which contexts* the marginals
range over is the domain: ``"elements"`` (any set of the others, the definition's reading), ``"feasible"`` (at most one
element per owner: owners are given), or ``"robots"`` (the robots under one plan).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import check_number
from ratt_opt.budget import Budget, OutOfBudget, Stop, interruptible
from ratt_opt.curvatures.any_function import any_marginals
from ratt_opt.curvatures.domains import Domain, domain_of
from ratt_opt.curvatures.marginals import (
    MarginalBrackets,
    Marginals,
    MeasuredMarginals,
    check_monotone,
    enumerate_marginals,
)
from ratt_opt.curvatures.params import DEFAULT, CurvatureParams
from ratt_opt.curvatures.planar.marginal_brackets import PlanarBrackets
from ratt_opt.curvatures.rounded_quotients import complement_above, complement_below, quotient_above, quotient_below
from ratt_opt.curvatures.separable.marginal_brackets import SeparableBrackets
from ratt_opt.errors import InputError
from ratt_opt.running.progress import Step
from ratt_opt.setfunctions.base import TableFunction, finite_values
from ratt_opt.setfunctions.information import InformationObjective
from ratt_opt.setfunctions.metered import Metered
from ratt_opt.setfunctions.properties import NotFound, Violation, find_submodularity_violation

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ratt_opt._validation import FloatArray
    from ratt_opt.setfunctions.base import SetFunction

__all__ = ["Curvature", "curvature", "curvature_over", "total_curvature"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Curvature:
    """Claim: ``lower <= curvature <= upper`` over ``domain``.

    ``element`` attains ``lower``: its marginal in ``smallest_context`` is the smallest found, and the one in
    ``largest_context`` the largest. ``useless`` : elements that surely add nothing, left out by definition (0 / 0
    says nothing about them): without information about what counts or, of functions known by values, whose every
    marginal is 0. ``near_zero`` : others whose largest marginal is within the rounding of the function's values. They
    count for ``upper``, which is then 1, and nothing about them is used for ``lower``.
    Both ends are moved outward by what the values that they are quotients of may have rounded.
    ``how`` : what the ends rest on. ``stop`` : why the search stopped; ``nodes`` : parts of the domain bounded.
    ``marginals`` : what is known of every element of the domain, in ascending order (its contexts name elements by
    their position in that order).
    """

    lower: float
    upper: float
    domain: str
    element: int | None
    smallest_context: tuple[int, ...] = field(repr=False)
    largest_context: tuple[int, ...] = field(repr=False)
    useless: tuple[int, ...] = field(repr=False)
    near_zero: tuple[int, ...] = field(repr=False)
    how: str
    stop: Stop
    nodes: int
    marginals: Marginals = field(compare=False, repr=False)


@interruptible
def total_curvature(
    f: SetFunction,
    owners: ArrayLike | None = None,
    *,
    plan: ArrayLike | None = None,
    gap: float = DEFAULT.gap,
    time_limit: float | None = DEFAULT.seconds,
    max_nodes: int | None = None,
    max_evaluations: int | None = None,
    budget: Budget | None = None,
    params: CurvatureParams = DEFAULT,
) -> Curvature:
    """Total curvature ``c = 1 - min_x (smallest marginal of x) / (largest marginal of x)``.

    Exact if the domain can be enumerated (up to 2**24 sets) in time, else for information criteria a certified
    bracket, tightened by branch and bound; for other functions what theory says of them, and contexts drawn at random
    (seeded), which attain the lower end. An interrupt returns the bracket.

    Parameters
    ----------
    f : non-decreasing set function; refused with a witness if an enumeration shows that it is not
    owners : (n,) owner (robot) of each element, for the domain ``"feasible"``; without it the domain is ``"elements"``
    plan : one element per robot, for the domain ``"robots"`` (``owners`` are then not used)
    gap : the search stops once ``(1 - lower) / (1 - upper) <= 1 + gap``; not used if everything is enumerated
    time_limit : seconds for the search; ``None`` for no limit. max_nodes : parts it may bound
    max_evaluations : values of a function that is no information criterion; unlimited by default
    budget : an outer search's budget: its seconds and interrupts count too
    params : of the algorithms: they decide how soon the bracket closes, not whether it holds

    Raises
    ------
    InputError : not non-decreasing (shown).

    Source: ratt.tex, eq:total_curvature (Sviridenko, Vondrak, Ward 2017, Section 8).
    """
    inner = Budget.inside(budget, time_limit, max_nodes, max_evaluations)
    return curvature_over(
        domain_of(f, owners, plan), total=True, gap=check_number("gap", gap, low=0), budget=inner, params=params
    )


@interruptible
def curvature(
    f: SetFunction,
    owners: ArrayLike | None = None,
    *,
    plan: ArrayLike | None = None,
    gap: float = DEFAULT.gap,
    time_limit: float | None = DEFAULT.seconds,
    max_nodes: int | None = None,
    max_evaluations: int | None = None,
    budget: Budget | None = None,
    params: CurvatureParams = DEFAULT,
) -> Curvature:
    """Curvature ``k = 1 - min_x (smallest marginal of x) / f(x)`` of a submodular function.

    Over ``"elements"`` and ``"robots"`` the smallest marginal of a submodular function is the one on top of all
    others, so the ends of the lattice decide it; over ``"feasible"`` it ranges over every joint choice of the others.

    Parameters
    ----------
    f : normalised, non-decreasing and submodular. Over ``"elements"`` and ``"robots"`` that is checked if the table
        fits, known if theory proves it (log-det), and otherwise relied on, not checked (``how`` says which)
    owners, plan, gap, time_limit, max_nodes, max_evaluations, budget, params : see :func:`total_curvature`

    Raises
    ------
    InputError : not non-decreasing or not submodular (shown).

    Source: ratt.tex, eq:curvature (Conforti and Cornuejols 1984).
    """
    inner = Budget.inside(budget, time_limit, max_nodes, max_evaluations)
    return curvature_over(
        domain_of(f, owners, plan), total=False, gap=check_number("gap", gap, low=0), budget=inner, params=params
    )


@Step("curvature")
def curvature_over(
    domain: Domain, *, total: bool, gap: float, budget: Budget, params: CurvatureParams = DEFAULT
) -> Curvature:
    """The total curvature, or the curvature, over a domain."""
    if total:
        return _curvature_from(_measured(domain, gap, budget, params, against_own=False), domain)
    if domain.name == "feasible":
        found = _measured(domain, gap, budget, params, against_own=True)
        if not domain.is_submodular:
            found = replace(found, how=f"{found.how} (submodularity relied on, not checked)")
    else:
        found = _on_top(domain, budget, params)
    marginals = found.marginals
    if (single := _singles(domain, budget)) is not None:
        marginals = replace(marginals, largest_lower=single, largest_upper=single)
    return _curvature_from(replace(found, marginals=marginals), domain)


def _singles(domain: Domain, budget: Budget) -> FloatArray | None:
    """(n,) marginals without context; ``None`` if the budget does not allow that many values."""
    f = domain.restricted
    metered = f if isinstance(f, InformationObjective | TableFunction) else Metered(f, budget)
    try:
        return finite_values(metered.singletons()) - metered([])
    except OutOfBudget:
        return None


def _on_top(domain: Domain, budget: Budget, params: CurvatureParams) -> MeasuredMarginals:
    """Smallest marginals of a submodular function over sets of any elements: on top of all others."""
    try:
        top, how = _top_of_lattice(domain.restricted, budget), _submodularity(domain, budget, params)
    except OutOfBudget as out:
        return any_marginals(domain, budget, out.stop, params.contexts)
    check_monotone(domain, top)
    return MeasuredMarginals(marginals=top, how=how, stop=Stop.EXHAUSTED, nodes=0)


def _measured(
    domain: Domain, gap: float, budget: Budget, params: CurvatureParams, *, against_own: bool
) -> MeasuredMarginals:
    """``against_own`` : the ratio that matters is to ``f({x})`` (curvature), not to the largest marginal."""
    f = domain.restricted
    if domain.count <= params.largest_enumeration:
        try:
            marginals = enumerate_marginals(domain, budget.part(params.enumeration_share))
            return MeasuredMarginals(marginals=marginals, how="every context enumerated", stop=Stop.EXHAUSTED, nodes=0)
        except OutOfBudget:
            pass  # a bracket in the time left
        except KeyboardInterrupt:
            budget.interrupt()
    if not isinstance(f, InformationObjective):
        return any_marginals(domain, budget, Stop.HEURISTIC, params.contexts)
    kind: type[MarginalBrackets] = SeparableBrackets if f.planar_levels() is None else PlanarBrackets
    brackets = kind(f, domain.owners, gap=gap, budget=budget, against_own=against_own, params=params)
    stop, how = brackets.run(), f"{brackets.rests_on} and attained contexts"
    return MeasuredMarginals(marginals=brackets.marginals(), how=how, stop=stop, nodes=budget.nodes)


def _submodularity(domain: Domain, budget: Budget, params: CurvatureParams) -> str:
    """Say on what the closed form rests; refuse a function that is shown not to be submodular."""
    how = "ends of the lattice"
    if domain.is_submodular:
        return f"{how} (submodular by theory)"
    unchecked = f"{how} (submodularity relied on, not checked)"
    if domain.restricted.n > params.largest_checked:
        return unchecked
    found = find_submodularity_violation(
        domain.restricted, time_limit=None, budget=budget.part(params.enumeration_share)
    )
    if isinstance(found, NotFound):
        return unchecked
    if isinstance(found, Violation):
        sets = " and ".join(str(list(domain.named(s))) for s in (found.a, found.b))
        raise InputError("f", "must be submodular (see total_curvature)", f"slack {found.slack:.6g} at {sets}")
    return f"{how} (submodularity checked)"


def _top_of_lattice(given: SetFunction, budget: Budget) -> Marginals:
    """Marginals on top of all other elements; raises ``OutOfBudget``."""
    f, everything = Metered(given, budget), np.arange(given.n)
    top = f(everything) - f.evaluate(~np.eye(f.n, dtype=np.bool_))
    contexts = tuple(tuple(int(e) for e in everything if e != x) for x in everything)
    nothing: tuple[tuple[int, ...], ...] = ((),) * f.n
    single = given.singletons() if isinstance(given, InformationObjective) else f.singletons()
    return Marginals(top, top, single, single, contexts, nothing)


def _curvature_from(found: MeasuredMarginals, domain: Domain) -> Curvature:
    """The bracket, each quotient moved outward by what its marginals may have rounded."""
    marginals, noise = found.marginals, domain.noise
    most, seen = marginals.largest_upper, marginals.largest_lower
    useful = most > 0
    may_add = useful | domain.may_add
    doubtful = may_add & (most <= noise)
    safe, shown = np.where(may_add, 0.0, np.inf), np.full(len(most), np.inf)
    safe[useful] = quotient_below(marginals.smallest_lower[useful], most[useful], noise)
    sure = useful & (seen > noise)
    shown[sure] = quotient_above(marginals.smallest_upper[sure], seen[sure], noise)
    upper = complement_above(float(safe.min(initial=1.0)))
    x = int(shown.argmin()) if sure.any() else None
    return Curvature(
        lower=0.0 if x is None else min(complement_below(float(shown[x])), upper),
        upper=upper,
        domain=domain.name,
        element=None if x is None else domain.element(x),
        smallest_context=() if x is None else domain.named(marginals.smallest_context[x]),
        largest_context=() if x is None else domain.named(marginals.largest_context[x]),
        useless=tuple(domain.element(x) for x in np.flatnonzero(~may_add)),
        near_zero=tuple(domain.element(x) for x in np.flatnonzero(doubtful)),
        how=found.how if may_add.any() else "no element ever adds anything",
        stop=found.stop,
        nodes=found.nodes,
        marginals=marginals,
    )
