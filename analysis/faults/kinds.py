"""All kinds of cases, and how often each comes."""

from analysis.faults.campaign import Kind
from analysis.faults.inside import INSIDE
from analysis.faults.processes import PROCESSES

__all__ = ["KINDS"]

KINDS: dict[str, tuple[float, Kind]] = {**INSIDE, **PROCESSES}
