"""Claims of the guide on missions, each judged by paired intervals."""

from __future__ import annotations

from typing import TYPE_CHECKING

from analysis import claims
from analysis.claims import Claim
from analysis.missions import exact_flights, flights
from analysis.missions.consistency import LINEARISATIONS, ratios
from ratt_opt.studies.statistics import Verdict
from ratt_opt.studies.store import read_table

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from ratt_opt.studies.study import Study

__all__ = ["CLAIMS", "write_claims"]

LOW, HIGH = 0.95, 1.10
"""Mean squared error over trace of a filter that knows its error."""


NAMES = {
    "greedy": "Greedy",
    "myopic": "Myopic",
    "random": "Random",
    "nonrobust_optimum": "the best plan without attack",
}
METRICS = (("rmse", "RMSE", "m"), ("trace", "trace of covariance", "m²"))


def _below(study: Study, module: str, left: str, right: str, text: str) -> Iterator[Claim]:
    """The left player's errors, and covariances, are below the right's; ``{}`` in the text is the metric."""
    for metric, named, unit in METRICS:
        yield Claim(
            figure=study.name,
            command=f"analysis.missions.{module} --only {study.name}",
            statement=text.format(named),
            left=f"{left}/{metric}",
            right=f"{right}/{metric}",
            unit=unit,
        )


def _claims() -> Iterator[Claim]:
    for study in flights.STUDIES:
        n = study.cases[0].n_robots
        for other in ("greedy", "myopic", "random"):
            text = f"{n} robots, worst attacks: RATT's {{}} is below that of {NAMES[other]}"
            yield from _below(study, "flights", "ratt/worst", f"{other}/worst", text)
    for study in exact_flights.STUDIES:
        n = study.cases[0].n_robots
        text = f"{n} robots, worst attacks: the {{}} of max-min plans is below RATT's"
        yield from _below(study, "exact_flights", "maxmin/worst", "ratt/worst", text)
        text = f"{n} robots, worst attacks: RATT's {{}} is below that of {NAMES['nonrobust_optimum']}"
        yield from _below(study, "exact_flights", "ratt/worst", "nonrobust_optimum/worst", text)
    yield from _below(flights.MILD, "flights", "greedy/none", "ratt/none", "no attack: Greedy's {} is below RATT's")
    for attacker in ("random", "bounded_rational"):
        text = f"{attacker} attacks: RATT's {{}} is below Greedy's"
        yield from _below(flights.MILD, "flights", f"ratt/{attacker}", f"greedy/{attacker}", text)


CLAIMS = tuple(_claims())


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
