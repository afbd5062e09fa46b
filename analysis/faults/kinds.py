"""All kinds of cases, and how often each comes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from analysis.faults.inside import INSIDE
from analysis.faults.processes import PROCESSES

if TYPE_CHECKING:
    from analysis.faults.campaign import Kind

__all__ = ["KINDS"]

KINDS: dict[str, tuple[float, Kind]] = {**INSIDE, **PROCESSES}
