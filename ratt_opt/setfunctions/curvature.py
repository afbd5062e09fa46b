"""Curvature and total curvature, exact or as a certified bracket, with what attains the ends.

Both compare an element's smallest marginal with a largest one. *Which contexts* the marginals
range over is the domain: ``"elements"`` (any set of the others, the definition's reading), ``"feasible"`` (at most one
element per robot: owners are given), or ``"robots"`` (the robots under one plan).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.errors import InputError
from ratt_opt.setfunctions.contexts import LARGEST_ENUMERATION, Domain, domain_of
from ratt_opt.setfunctions.information import InformationObjective
from ratt_opt.setfunctions.marginal_bounds import bracket_marginals
from ratt_opt.setfunctions.marginals import Marginals, enumerate_marginals
from ratt_opt.setfunctions.table import TableFunction

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ratt_opt._validation import FloatArray
    from ratt_opt.setfunctions.base import SetFunction

__all__ = ["Curvature", "check_monotone", "curvature", "total_curvature"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Curvature:
    """Claim: ``lower <= curvature <= upper`` over ``domain``.

    ``element`` attains ``lower``: its marginal in ``smallest_context`` is the smallest found, and the one in
    ``largest_context`` the largest. ``useless`` : elements whose every marginal is 0, left out by definition
    (0 / 0 says nothing about them). ``how`` : what the ends rest on.
    """

    lower: float
    upper: float
    domain: str
    element: int | None
    smallest_context: tuple[int, ...]
    largest_context: tuple[int, ...]
    useless: tuple[int, ...]
    how: str


def total_curvature(f: SetFunction, owners: ArrayLike | None = None, *, plan: ArrayLike | None = None) -> Curvature:
    """Total curvature ``c = 1 - min_x (smallest marginal of x) / (largest marginal of x)``.

    Exact where the domain can be enumerated, else for information criteria a certified bracket:
    see :mod:`ratt_opt.setfunctions.marginal_bounds`.

    Parameters
    ----------
    f : non-decreasing set function; refused with a witness where an enumeration shows that it is not
    owners : (n,) robot of each element, for the domain ``"feasible"``; without it the domain is ``"elements"``
    plan : one element per robot, for the domain ``"robots"`` (``owners`` are then not used)

    Raises
    ------
    InputError : not non-decreasing, or the domain is too large for an enumeration and no bracket is known for ``f``.

    Source: ratt.tex, eq:total_curvature (Sviridenko, Vondrak, Ward 2017, Section 8).
    """
    domain = domain_of(f, owners, plan)
    marginals, how = _marginals(domain)
    return _curvature_from(marginals, marginals.largest_upper, marginals.largest_lower, domain, how)


def curvature(f: SetFunction, owners: ArrayLike | None = None, *, plan: ArrayLike | None = None) -> Curvature:
    """Curvature ``k = 1 - min_x (smallest marginal of x) / f(x)`` of a submodular function.

    Over ``"elements"`` and ``"robots"`` the smallest marginal of a submodular function is the one on top of all
    others, so the ends of the lattice decide it; over ``"feasible"`` it ranges over every joint choice of the others.

    Parameters
    ----------
    f : normalised, non-decreasing and submodular (for the closed form: relied on, not checked, except log-det,
        which is); owners, plan : see :func:`total_curvature`

    Raises
    ------
    InputError : not non-decreasing, or the domain is too large for an enumeration and no bracket is known for ``f``.

    Source: ratt.tex, eq:curvature (Conforti and Cornuejols 1984).
    """
    domain = domain_of(f, owners, plan)
    single = domain.restricted.singletons()
    if domain.name != "feasible":
        marginals, how = _top_of_lattice(domain.restricted), "ends of the lattice (submodular)"
    else:
        marginals, how = _marginals(domain)
    return _curvature_from(marginals, single, single, domain, how)


def _marginals(domain: Domain) -> tuple[Marginals, str]:
    if domain.count <= LARGEST_ENUMERATION:
        found = enumerate_marginals(domain)
        check_monotone(domain, found)
        return found, "every context enumerated"
    if isinstance(domain.restricted, InformationObjective):
        return bracket_marginals(domain.restricted, domain.owners), "convex minorants and attained contexts"
    need = f"{domain.count:.3g} contexts, {domain.count * 8 / 2**30:.3g} GiB"
    raise InputError("f", f"must have at most {LARGEST_ENUMERATION:,} sets in its domain to be enumerated", need)


def check_monotone(domain: Domain, found: Marginals) -> None:
    """Refuse a function with a negative marginal (beyond rounding), showing it."""
    if len(found.smallest_lower) == 0:
        return
    scale = max(float(np.abs(found.largest_upper).max(initial=0.0)), 1e-300)
    worst = int(found.smallest_lower.argmin())
    if found.smallest_lower[worst] < -1e-9 * scale:
        context = domain.named(found.smallest_context[worst])
        shown = f"adding {domain.element(worst)} to {list(context)} changes it by {found.smallest_lower[worst]:.6g}"
        raise InputError("f", "must be non-decreasing", shown)


def _top_of_lattice(f: SetFunction) -> Marginals:
    """Marginals on top of all other elements."""
    everything = np.arange(f.n)
    if isinstance(f, TableFunction):
        top = f.values[-1] - f.values[(2**f.n - 1) ^ (1 << everything)]
    else:
        membership = ~np.eye(f.n, dtype=np.bool_)
        top = f(everything) - f.evaluate(membership)
    contexts = tuple(tuple(int(e) for e in everything if e != x) for x in everything)
    nothing: tuple[tuple[int, ...], ...] = ((),) * f.n
    single = f.singletons()
    return Marginals(top, top, single, single, contexts, nothing)


def _curvature_from(
    marginals: Marginals, largest_upper: FloatArray, largest_lower: FloatArray, domain: Domain, how: str
) -> Curvature:
    useful = largest_upper > 0
    useless = tuple(domain.element(x) for x in np.flatnonzero(~useful))
    if not useful.any():
        return Curvature(
            lower=0.0,
            upper=0.0,
            domain=domain.name,
            element=None,
            smallest_context=(),
            largest_context=(),
            useless=useless,
            how="no element ever adds anything: modular",
        )
    safest = np.full(len(useful), np.inf)
    safest[useful] = np.clip(marginals.smallest_lower[useful], 0.0, None) / largest_upper[useful]
    attained = np.full(len(useful), np.inf)
    seen = useful & (largest_lower > 0)
    attained[seen] = np.clip(marginals.smallest_upper[seen], 0.0, None) / largest_lower[seen]
    x = int(attained.argmin())
    upper = 1.0 - float(safest.min())
    return Curvature(
        lower=min(max(1.0 - float(attained[x]), 0.0), upper),
        upper=min(upper, 1.0),
        domain=domain.name,
        element=domain.element(x),
        smallest_context=domain.named(marginals.smallest_context[x]),
        largest_context=domain.named(marginals.largest_context[x]),
        useless=useless,
        how=how,
    )
