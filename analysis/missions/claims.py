"""What the guide says of missions, each judged by paired intervals."""

from __future__ import annotations

from typing import TYPE_CHECKING

from analysis.missions.consistency import LINEARISATIONS, ratios
from analysis.studies import claims
from analysis.studies.claims import Claim
from analysis.studies.statistics import Verdict
from analysis.studies.store import read_table

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

__all__ = ["CLAIMS", "write_claims"]

LOW, HIGH = 0.95, 1.10
"""Mean squared error over trace of a filter that knows its error."""


def _compared(study: str, metric: str, unit: str, others: tuple[str, ...]) -> Iterator[Claim]:
    text = {"rmse": "RMSE", "trace": "trace of covariance"}[metric]
    named = {"greedy": "Greedy", "myopic": "Myopic", "random": "Random"}
    for other in others:
        yield Claim(
            figure=study,
            command=f"analysis.missions.{study}",
            statement=f"under the worst attacks RATT's {text} is below that of {named[other]}",
            left=f"ratt/worst/{metric}",
            right=f"{other}/worst/{metric}",
            unit=unit,
        )
    yield Claim(
        figure=study,
        command=f"analysis.missions.{study}",
        statement=f"without attack Greedy's {text} is below RATT's (the price of robustness)",
        left=f"greedy/none/{metric}",
        right=f"ratt/none/{metric}",
        unit=unit,
    )


CLAIMS = (
    *_compared("flights", "rmse", "m", ("greedy", "myopic", "random")),
    *_compared("flights", "trace", "m²", ("greedy", "myopic")),
    *(
        Claim(
            figure="exact_flights",
            command="analysis.missions.exact_flights",
            statement=f"under the worst attacks the {text} of exact max-min plans is below RATT's",
            left=f"maxmin/worst/{metric}",
            right=f"ratt/worst/{metric}",
            unit=unit,
        )
        for metric, text, unit in (("rmse", "RMSE", "m"), ("trace", "trace of covariance", "m²"))
    ),
)


def write_claims(out: Path) -> None:
    """Write ``missions_claims.md`` and ``missions_claims.csv``."""
    rows = read_table(out / "consistency")
    first = []
    for linearisation in LINEARISATIONS:
        found = list(ratios(rows, linearisation).values())
        inside = sum(LOW <= ratio <= HIGH for ratio in found)
        verdict = Verdict.CONFIRMED if inside == len(found) else Verdict.CONTRADICTED
        claim = f"{linearisation}: mean squared error over trace within {LOW:g} and {HIGH:.2f} in all cases"
        result = f"{min(found):.3f} to {max(found):.3f}; inside in {inside} of {len(found)} cases; "
        result += f"{len(rows) // len(found)} trials"
        first.append(f"| consistency | `analysis.missions.consistency` | {claim} | {result} | {verdict.value} |")
    claims.write_claims(out, CLAIMS, first=first, name="missions_claims")
