"""The plan keeps at least the claim's lower end under every attack: one tree of cases, and what follows from it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ratt_opt.certificates.verifier.cases import Cases
from ratt_opt.certificates.verifier.duals import Duals, check_partition
from ratt_opt.certificates.verifier.reading import fields, index, need
from ratt_opt.certificates.verifier.sizes import check_sizes
from ratt_opt.certificates.verifier.work import tick
from ratt_opt.certificates.verifier.worth import Worth

if TYPE_CHECKING:
    from collections.abc import Callable

    from flint import fmpq

    from ratt_opt.certificates.verifier.cases import Close
    from ratt_opt.certificates.verifier.statement import Statement

__all__ = ["ENUMERATED", "LowerCheck"]

ENUMERATED = "enumerated"
"""The conclusion that says that the outcomes were enumerated in floating point: no proof."""


class LowerCheck:
    """Decides the lower proofs of one problem's plan."""

    def __init__(self, about: Statement) -> None:
        self.about = about

    def check(self, part: Any, lower: fmpq) -> int:
        """Check that the plan's value is at least ``lower`` under every attack.

        Returns the number of leaves; 0 if the part says that it is no proof.
        """
        conclusion = part.get("conclusion") if isinstance(part, dict) else None
        if conclusion == ENUMERATED:
            fields("lower proof", part, "conclusion")
            return 0
        ways: dict[str, tuple[str, Callable[..., int]]] = {
            "forced": ("", self._check_forced),
            "duals": (" duals bounds tree", self._check_duals),
            "cover": (" duals bounds tree partition", self._check_duals),
            "sizes": (" duals forms bounds trees", check_sizes),
        }
        known = isinstance(conclusion, str) and conclusion in ways
        need(known, f"lower proof: the conclusion must be {', '.join(ways)} or {ENUMERATED}")
        names, check = ways[str(conclusion)]
        _, sets, *given = fields("lower proof", part, f"conclusion sets{names}")
        cases = Cases(self.about, Worth(self.about, lower))
        size, leaves = _check_sets(cases, sets)
        return leaves + check(cases, size, *given)

    def _check_forced(self, cases: Cases, size: int) -> int:
        about = cases.about
        complete = 2 * len(about.links) == about.n * (about.n - 1)
        forced = complete and is_forced(about.n, about.alpha_s, about.alpha_c, size)
        need(forced, f"lower proof: not every attack is shown to leave a group of {size}")
        return 0

    def _check_duals(self, cases: Cases, size: int, *given: Any) -> int:
        dual_values, bounds, tree, *partition = given
        duals = Duals(cases, dual_values)
        duals.read_bounds(bounds)
        closing: dict[str, Close] = {"flow": duals.close_by_flow}
        if partition:
            closing["listed"] = duals.list_group
        need(bool(partition) == (duals.slack >= 0), "lower proof: whether duals claim more than the budgets is wrong")
        leaves = cases.check(tree, cases.groups(min(size - 1, cases.about.n)), closing)
        for groups in partition:
            check_partition(duals, groups)
        return leaves


def _check_sets(cases: Cases, given: object) -> tuple[int, int]:
    """Check that any ``size`` robots are worth the claim: returns the size, and the leaves of the tree."""
    number, tree = fields("sets", given, "size tree")
    size = index("sets size", number, cases.about.n + 2)
    return size, cases.check_sets(size, tree)


def is_forced(n: int, alpha_s: int, alpha_c: int, size: int) -> bool:
    """Whether every attack on the complete graph of n robots leaves a group with ``size`` seeing robots.

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
