"""Robots, budgets and what RATT and CAA derive from them, how groups can be sized, and how a claim fared."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ratt_audit.appendix.entry import Counted
from ratt_audit.engine.decide import Verdict
from ratt_opt.graph.survivor_sizes import caa

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

__all__ = ["LARGEST", "Setting", "caa_groups", "counted", "every_link_budget", "every_setting", "splits"]

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
        """Number of greedy robots; negative if there are more attacks than robots."""
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
    detail = f"{len(found)} {what} enumerated, {len(cases)} break the claim"
    return Counted(verdict=verdict, sizes=sizes, detail=detail, cases=tuple(cases[:SHOWN_CASES]))


def splits(n_robots: int, alpha_c: int, largest: int | None = None) -> list[tuple[int, ...]]:
    """Group sizes, largest first, that cutting ``alpha_c`` links of a complete graph can leave; at most ``largest``."""
    sizes = _partitions(n_robots, n_robots if largest is None else largest)
    return [split for split in sizes if n_robots**2 - sum(s * s for s in split) <= 2 * alpha_c]


def _partitions(total: int, largest: int) -> Iterator[tuple[int, ...]]:
    if total == 0:
        yield ()
        return
    for part in range(min(total, largest), 0, -1):
        for rest in _partitions(total - part, part):
            yield (part, *rest)


def caa_groups(n_robots: int, alpha_c: int) -> tuple[int, ...]:
    """CAA's groups: as many of ``n_max`` robots as fit, and the rest."""
    n_max = caa(n_robots, alpha_c).n_max
    full, rest = divmod(n_robots, n_max)
    return (n_max,) * full + ((rest,) if rest else ())
