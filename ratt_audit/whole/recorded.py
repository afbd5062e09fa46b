"""Decisions of an earlier search for whole instances, each instance re-checked from its values alone.

``recorded.json`` lists refuted lines with the teams that a search decided and the values of the smallest instance. The
instance is checked anew: its class and curvature, the line, RATT's plan, the optimum and the worst attack. Verdicts of
the smaller teams are those of the search, which ``ratt-opt audit --search-whole`` repeats.
"""

from __future__ import annotations

import json
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, TypedDict

from ratt_audit.engine.decide import Verdict
from ratt_audit.engine.evidence import Witness, check_witness, values_of
from ratt_audit.whole.replay import replay
from ratt_audit.whole.search import Decided, on_whole_team, ordered_teams
from ratt_opt.errors import ProofError

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from ratt_audit.appendix.roles import Side, SizedClaim
    from ratt_audit.whole.replay import WholeInstance
    from ratt_audit.whole.search import WholeSearch
    from ratt_audit.whole.teams import WholeTeam

__all__ = ["Recorded", "rechecked", "recorded_decisions", "recorded_lines"]


class Recorded(TypedDict):
    """One line: the teams in order with their verdicts, and the values of the last one's instance, if it has one."""

    label: str
    kind: str
    worst_for: str
    teams: list[tuple[str, str]]
    values: list[int] | None


@cache
def recorded_lines() -> tuple[Recorded, ...]:
    """Return all recorded lines."""
    text = files("ratt_audit.whole").joinpath("recorded.json").read_text(encoding="utf-8")
    return tuple(json.loads(text))


def recorded_decisions(
    label: str, kind: str, chain: str, sizes: Iterable[SizedClaim], *, worst_for: Side, search: WholeSearch
) -> tuple[Decided, ...] | None:
    """Return the recorded decisions about one line, re-checked, or ``None`` if it must be searched.

    Raises
    ------
    ProofError : the recorded instance is none, or the recorded teams are not those that a search would try.
    """
    asked = (label, kind, worst_for.value)
    line = next((r for r in recorded_lines() if (r["label"], r["kind"], r["worst_for"]) == asked), None)
    if line is None:
        return None
    teams = ordered_teams(chain, sizes, search.largest)[: len(line["teams"])]
    if [whole.text() for _, whole in teams] != [text for text, _ in line["teams"]]:
        raise ProofError(f"the record of {label} names other teams; run ratt-opt audit --search-whole")
    decided = [
        Decided(whole=whole, verdict=Verdict(verdict), programs=0)
        for (_, whole), (_, verdict) in zip(teams, line["teams"], strict=True)
    ]
    if line["values"] is not None:
        instance = rechecked(*teams[-1], worst_for, line["values"], search)
        decided[-1] = Decided(whole=teams[-1][1], verdict=Verdict.REFUTED, programs=0, instance=instance)
    if any(each.verdict is Verdict.REFUTED and each.instance is None for each in decided):
        raise ProofError(f"the record of {label} refutes it without an instance")
    return tuple(decided)


def rechecked(
    sized: SizedClaim, whole: WholeTeam, worst_for: Side, values: Sequence[int], search: WholeSearch
) -> WholeInstance:
    """Return the instance with these values of all subsets, by bit mask.

    Raises
    ------
    ProofError : the function is not of the line's class, the line holds on it, RATT chooses another plan, the compared
        plan is not optimal, or the attack no worst one.
    """
    claim = on_whole_team(sized, whole)
    curvature = search.curvature if claim.function_class.is_parametric else None
    table = tuple(values)
    if len(table) != 1 << claim.ground.n:
        raise ProofError(f"{len(table)} values for {claim.ground.n} elements: {whole.text()}")
    value = claim.conclusion.value(values_of(table, {}), 1 - search.curvature)
    witness = Witness(names=claim.ground.names, values=table, auxiliary={}, curvature=curvature, violation=-value)
    check_witness(claim, witness)
    return replay(whole, worst_for, claim, witness)
