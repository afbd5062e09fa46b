"""Claims of the extended study, decided by the same tests as the paper's claims."""

from __future__ import annotations

from typing import TYPE_CHECKING

from analysis import claims
from analysis.claims import Claim
from analysis.extended import budgets
from analysis.extended.comparisons import GUARANTEES, shares
from analysis.paper.claims import CLOSE, LABELS
from ratt_opt._rounding import down
from ratt_opt.studies.statistics import Verdict, select
from ratt_opt.studies.store import read_table

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

__all__ = ["CLAIMS", "write_claims"]


CERTIFIED = 0.01
"""An optimum counts as certified when its mean trace exceeds the proved bound by less than this share."""


def _exact_attack() -> Iterator[Claim]:
    command = "analysis.extended.exact_attack"
    for other in ("greedy", "random"):
        statement = f"against the exact attacker RATT's trace is below that of {LABELS[other]}"
        yield Claim(
            figure="exact_attack",
            command=command,
            statement=statement,
            left="ratt/worst/trace",
            right=f"{other}/worst/trace",
        )
    yield Claim(
        figure="exact_attack",
        command=command,
        statement=f"RATT's trace is less than {CLOSE:.0%} above what is proved of every plan",
        left="ratt/worst/trace",
        right="optimum/trace_bound",
        share=CLOSE,
    )
    yield Claim(
        figure="exact_attack",
        command=command,
        statement=f"the optimum is certified: the plan found is less than {CERTIFIED:.0%} above that bound",
        left="maxmin/worst/trace",
        right="optimum/trace_bound",
        share=CERTIFIED,
    )
    yield Claim(
        figure="exact_attack",
        command=command,
        statement="the bounded-rational attacker causes less trace than the exact one (plans of RATT)",
        left="ratt/bounded_rational/trace",
        right="ratt/worst/trace",
    )


def _robust_is_better(study: str) -> Claim:
    return Claim(
        figure=study,
        command=f"analysis.extended --only {study}",
        statement="Greedy's worst-case value is below RATT's",
        left="greedy/worst/value",
        right="ratt/worst/value",
        share=0.0,  # relative: objectives have different units
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
    rows = read_table(out / "guarantees")
    objectives = dict.fromkeys(case.objective for case in GUARANTEES.cases)
    first = [_guarantee_line(rows, objective) for objective in objectives]
    first.append(_break_even_line(read_table(out / "budgets")))
    claims.write_claims(out, CLAIMS, first, name="extended_claims")  # beside the paper's in one folder


def _guarantee_line(rows: Sequence[Mapping[str, str]], objective: str) -> str:
    kept = select(rows, objective=objective)
    found = shares(kept)
    # The smallest ratio was computed for a curvature rounded up, so it alone may fall below what is proved of it.
    ordered = (found["theorem1"] <= found["pattern_free"]).all() and (found["ratio"] <= found["certified"]).all()
    verdict = Verdict.CONFIRMED if ordered else Verdict.CONTRADICTED
    means = ", ".join(f"{name.replace('_', '-')} {down(float(values.mean()), 3)}" for name, values in found.items())
    claim = f"{objective}: no guarantee exceeds the ratio certified on the instance"
    result = f"mean share of the optimum: {means}; {len(kept)} instances"
    command = "analysis.extended --only guarantees"
    return f"| guarantees | `{command}` | {claim} | {result} | {verdict.value} (every instance) |"


def _break_even_line(rows: Sequence[Mapping[str, str]]) -> str:
    found = []
    for case in budgets.STUDY.cases:
        kept = select(rows, case=case.name)
        price = budgets.excess(kept, "ratt")[0].show()
        found.append(f"planned for ({case.alpha_s}, {case.alpha_c}): price {price} %, {budgets.break_even(kept)}")
    claim = "price of robustness, and the attack from which RATT beats Greedy"
    return f"| budgets | `analysis.extended.budgets` | {claim} | {'; '.join(found)} | (measured) |"
