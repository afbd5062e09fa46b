"""Robots, budgets and what RATT and CAA derive from them, and the outcome of trying a claim on all of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.entry import Counted
from ratt_opt.audit.engine.decide import Verdict
from ratt_opt.graph.caa import caa

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

__all__ = ["LARGEST", "SHOWN_CASES", "Setting", "counted", "every_link_budget", "every_setting"]

LARGEST = 8
"""Largest team enumerated: claims that fail do so by N = 4, what occurs does by 7; a robot more takes twice as long."""
SHOWN_CASES = 3
"""Cases that an entry of the ledger prints."""


@dataclass(frozen=True, slots=True)
class Setting:
    """One instance's numbers: N, alpha_s, alpha_c and what RATT derives from them."""

    n_robots: int
    alpha_s: int
    alpha_c: int

    @property
    def alpha_cs(self) -> int:
        """Equivalent sensing attacks."""
        return caa(self.n_robots, self.alpha_c).alpha_cs

    @property
    def alpha(self) -> int:
        """Number of baits, when smaller than N."""
        return self.alpha_s + self.alpha_cs

    @property
    def n_greedy(self) -> int:
        """Number of greedy robots; negative where there are more attacks than robots."""
        return self.n_robots - self.alpha

    @property
    def n_max(self) -> int:
        """Largest group by CAA."""
        return self.n_robots - self.alpha_cs

    def text(self) -> str:
        """The numbers in words."""
        return f"N = {self.n_robots}, alpha_s = {self.alpha_s}, alpha_c = {self.alpha_c}, alpha_cs = {self.alpha_cs}"


def every_link_budget(smallest: int, largest: int) -> Iterator[tuple[int, int]]:
    """Yield (N, alpha_c) for every team and every number of links of its complete graph."""
    for n_robots in range(smallest, largest + 1):
        for alpha_c in range(n_robots * (n_robots - 1) // 2 + 1):
            yield n_robots, alpha_c


def every_setting(largest: int) -> Iterator[Setting]:
    """Yield all settings of 2 to ``largest`` robots, by N, then alpha_c, then alpha_s."""
    for n_robots, alpha_c in every_link_budget(2, largest):
        for alpha_s in range(n_robots + 1):
            yield Setting(n_robots, alpha_s, alpha_c)


def counted(faults: Iterable[str], sizes: str, what: str) -> Counted:
    """The outcome of an enumeration: ``faults`` says for each item what breaks the claim, or is empty.

    Nothing seen proves nothing.
    """
    found = list(faults)
    cases = [fault for fault in found if fault]
    verdict = Verdict.REFUTED if cases else Verdict.PROVED if found else Verdict.UNDECIDED
    return Counted(
        verdict=verdict,
        sizes=sizes,
        detail=f"{len(found)} {what} enumerated, {len(cases)} break the claim",
        cases=tuple(cases[:SHOWN_CASES]),
    )
