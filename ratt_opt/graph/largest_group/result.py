"""What every way to the smallest possible largest group returns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt.graph.communication import CommunicationGraph, Link
    from ratt_opt.graph.threat import Threat

__all__ = ["LargestGroup", "largest_left", "split_result"]


@dataclass(frozen=True, slots=True, kw_only=True)
class LargestGroup:
    """Claim: ``lower <= n_max``, and ``cut`` leaves a largest group of ``upper`` robots, so ``n_max <= upper``.

    ``upper`` is recomputed on the graph. ``reason`` says why ``lower`` holds. ``claimed_lower`` is what a
    solver claims beyond that and nothing has checked (equal to ``lower`` where no solver was asked).
    """

    lower: int
    upper: int
    cut: frozenset[Link]
    method: str
    reason: str
    claimed_lower: int

    def __repr__(self) -> str:
        return f"LargestGroup([{self.lower}, {self.upper}], {len(self.cut)} links cut, {self.method!r}: {self.reason})"

    @property
    def n_max(self) -> int | None:
        """The smallest possible size, where it is known: proved (``is_exact``), or by a solver's claim.

        ``None`` where it is only known to be from ``lower`` to ``upper``.
        """
        return self.upper if self.claimed_lower == self.upper else None

    @property
    def is_exact(self) -> bool:
        """Whether ``lower`` (checked) meets ``upper``."""
        return self.lower == self.upper


def largest_left(graph: CommunicationGraph, cut: Iterable[Link]) -> int:
    """Size of the largest connected component once ``cut`` is gone."""
    return max(len(group) for group in graph.groups(cut))


def split_result(
    threat: Threat, cut: frozenset[Link], lower: int, method: str, reason: str, *, claimed_lower: int | None = None
) -> LargestGroup:
    """The result of a cut and a lower bound, after checking that the cut is allowed."""
    assert len(cut) <= threat.alpha_c, "a cut is within its budget"
    assert not cut & threat.protected_links, "a cut spares protected links"
    upper = largest_left(threat.graph, cut)
    claimed = lower if claimed_lower is None else max(lower, min(claimed_lower, upper))
    return LargestGroup(lower=lower, upper=upper, cut=cut, method=method, reason=reason, claimed_lower=claimed)
