"""Verification of the lower end: one tree of cases, and the conclusion from it for every attack."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ratt_opt.certificates.verifier.cases import Cases
from ratt_opt.certificates.verifier.duals import check_duals
from ratt_opt.certificates.verifier.reading import fields, index, need
from ratt_opt.certificates.verifier.sizes import check_sizes
from ratt_opt.certificates.verifier.work import tick
from ratt_opt.certificates.verifier.worth import Worth

if TYPE_CHECKING:
    from collections.abc import Callable

    from flint import fmpq

    from ratt_opt.certificates.verifier.statement import Statement

__all__ = ["ENUMERATED", "check_lower"]

ENUMERATED = "enumerated"
"""The conclusion that says that the outcomes were enumerated in floating point: no proof."""


def check_lower(about: Statement, part: Any, lower: fmpq) -> int:
    """Check that the plan's value is at least ``lower`` under every attack.

    Returns the number of leaves; 0 if the part says that it is no proof.
    """
    conclusion = part.get("conclusion") if isinstance(part, dict) else None
    if conclusion == ENUMERATED:
        fields("lower proof", part, "conclusion")
        return 0
    known = isinstance(conclusion, str) and conclusion in CONCLUSIONS
    need(known, f"lower proof: the conclusion must be {', '.join(CONCLUSIONS)} or {ENUMERATED}")
    names, check = CONCLUSIONS[str(conclusion)]
    whole = {"limits": []} | part if "limits" in names.split() else part
    _, sets, *given = fields("lower proof", whole, f"conclusion sets{names}")
    cases = Cases(about, Worth(about, lower))
    number, tree = fields("sets", sets, "size tree")
    size = index("sets size", number, about.n + 2)
    return cases.check_sets(size, tree) + check(cases, size, *given)


def _check_forced(cases: Cases, size: int) -> int:
    about = cases.about
    complete = 2 * len(about.links) == about.n * (about.n - 1)
    forced = complete and is_forced(about.n, about.alpha_s, about.alpha_c, size)
    need(forced, f"lower proof: not every attack is shown to leave a group of {size}")
    return 0


def is_forced(n: int, alpha_s: int, alpha_c: int, size: int) -> bool:
    """Decide whether every attack on the complete graph of n robots leaves a group with ``size`` unblinded robots.

    Otherwise groups n_1 + ... = n have (n^2 - sum n_k^2) / 2 <= alpha_c links between them and, to bring each below
    ``size``, sum max(0, n_k - size + 1) <= alpha_s. ``best[r][x]``: largest sum n_k^2 of r robots, blinding x.
    """
    best = [[0] * (alpha_s + 1)]
    for r in range(1, n + 1):
        tick()
        options = [range(1, min(r, size - 1 + x) + 1) for x in range(alpha_s + 1)]
        part = [[k * k + best[r - k][x - max(0, k - size + 1)] for k in ks] for x, ks in enumerate(options)]
        best.append([max(values, default=-n * n - 1) for values in part])
    return size == 0 or n * n - best[n][alpha_s] > 2 * alpha_c


CONCLUSIONS: dict[str, tuple[str, Callable[..., int]]] = {
    "forced": ("", _check_forced),
    "duals": (" limits duals bounds tree", check_duals),
    "cover": (" limits duals bounds tree partition", check_duals),
    "sizes": (" duals forms bounds trees", check_sizes),
}
"""Fields that a proof has beside its lemma on sets, and its check, by name of the conclusion."""
