"""What the extended study decides, with the same tests as the paper's claims."""

from __future__ import annotations

from typing import TYPE_CHECKING

from analysis.paper.claims import CLOSE, LABELS
from analysis.studies import claims
from analysis.studies.claims import Claim

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

__all__ = ["CLAIMS", "write_claims"]


def _exact_attack() -> Iterator[Claim]:
    command = "analysis.extended.exact_attack"
    for other in ("greedy", "random"):
        statement = f"against the exact attacker RATT's trace is below that of {LABELS[other]}"
        yield Claim(
            figure="exact_attack",
            command=command,
            statement=statement,
            left="ratt/exact/trace",
            right=f"{other}/exact/trace",
        )
    yield Claim(
        figure="exact_attack",
        command=command,
        statement=f"RATT's trace is less than {CLOSE:.0%} above the certified plan's",
        left="ratt/exact/trace",
        right="optimum/exact/trace",
        share=CLOSE,
    )
    yield Claim(
        figure="exact_attack",
        command=command,
        statement="the bounded-rational attacker causes less trace than the exact one (plans of RATT)",
        left="ratt/bounded_rational/trace",
        right="ratt/exact/trace",
    )


def _robust_is_better(study: str) -> Claim:
    return Claim(
        figure=study,
        command=f"analysis.extended.{study}",
        statement="Greedy's worst-case value is below RATT's",
        left="greedy/exact/value",
        right="ratt/exact/value",
        unit="(unit of the objective)",
    )


CLAIMS = (
    *_exact_attack(),
    _robust_is_better("objectives"),
    _robust_is_better("graphs"),
    _robust_is_better("sensitivity"),
    Claim(
        figure="budgets",
        command="analysis.extended.budgets",
        statement="without attack Greedy's trace is below RATT's (the price of robustness)",
        left="greedy/0/trace",
        right="ratt/0/trace",
    ),
)


def write_claims(out: Path) -> None:
    """Write the table of verdicts."""
    claims.write_claims(out, CLAIMS)
