"""Certificate of a result, as written and verified, or the reason why there is none."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from ratt_opt.certificates.verifier.edge_cuts import VerifiedCuts
    from ratt_opt.certificates.verifier.verified import Verified
    from ratt_opt.errors import ProofError

__all__ = [
    "CERTIFICATE",
    "CUTS",
    "INTERRUPTED",
    "NOT_ASKED_FOR",
    "PENDING",
    "Certificate",
    "Certification",
    "CutsCertification",
]

CERTIFICATE = "certificate.json"
"""Name of a certificate in a report's folder."""
CUTS = "cuts.json"
"""Name of the certificate of the smallest largest group there."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Certificate:
    """A certificate as written and verified.

    ``lower_shaved`` and ``upper_raised`` : how far the claim's ends lie outside the given bracket [unit of the
    objective]. Exact arithmetic proves a little less than floating point suggests; and the lower end is lower if a
    cover of all attacks was found for a lower value only. The upper end is higher if trees of lemmas met their limits
    (``target_trees.py``), and so prove larger constants.
    """

    path: Path
    verified: Verified
    lower_shaved: float
    upper_raised: float
    size: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Certification:
    """Certificate of a result, or (``None``) ``why_not`` in words.

    ``final`` : whether it stays so; false while a proof is under way, and after one was cut short.
    """

    certificate: Certificate | None = None
    why_not: str = ""
    final: bool = True

    @classmethod
    def faulty(cls, fault: ProofError) -> Certification:
        """Our own proof has a fault: the verifier named the first one."""
        return cls(why_not=f"the proof has a fault: {fault}", final=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class CutsCertification:
    """Certificate that no cut of the links leaves groups smaller than the smallest largest one, or ``why_not``."""

    path: Path | None = None
    verified: VerifiedCuts | None = None
    why_not: str = "not asked for"


NOT_ASKED_FOR = Certification(why_not="not asked for")
"""Certification in a report that was made without a certificate."""
PENDING = Certification(
    why_not="not finished when this report was written; a certificate beside it is of an earlier one", final=False
)
"""Certification in a report while its proof is written and verified; it stays if that is killed."""
INTERRUPTED = Certification(
    why_not="interrupted before it was complete; a certificate beside this report is of an earlier one", final=False
)
