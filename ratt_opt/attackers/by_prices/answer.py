"""What the search by prices says of a threshold."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ratt_opt.attack.annealing import Partition
    from ratt_opt.attackers.by_prices.prices import PriceVector

__all__ = ["Answer", "Threshold"]


class Threshold(Enum):
    """What became of a threshold."""

    REFUTED = "refuted"
    REACHED = "reached"
    OPEN = "open"


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """``partition`` : an attack below the threshold, where it is reached.

    ``prices`` : that no weak group pays and that claim more links than the budget, where these refuted it
    """

    verdict: Threshold
    partition: Partition | None = None
    prices: PriceVector | None = None
