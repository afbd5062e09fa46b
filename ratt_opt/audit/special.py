"""Lines whose readings differ in the statement itself, not only in a premise."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

from ratt_opt.audit.entry import Entry, SizedClaim
from ratt_opt.audit.language import Claim, FunctionClass
from ratt_opt.audit.polynomial import T, constant
from ratt_opt.audit.roles import Team

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["special_entries"]

READING = "for every set W of |Vg| robots of V1, as the line says"
ONE_PLUS_K = constant(2) - T
GROUP = ("b1", "b2", "g1")


def special_entries() -> Iterator[Entry]:
    """Yield sub_p2d1v1_9 read "for all W in V1 with |W| = |Vg|", and sub_p2d1v1_10 from that reading."""
    roles = "f normalised, non-decreasing, submodular, curvature <= k; RATT's choices"
    for kind in ("step", "cumulative"):
        yield Entry(
            label="sub_p2d1v1_9",
            kind=kind,
            chain="sub_p2d1v1",
            statement="from the line before: >= (1-k)/(1+k) f(u* on W)"
            if kind == "step"
            else "from the start of its chain: >= (1-k)/(1+k) f(u* on W)",
            hypotheses=roles,
            claims=tuple(_claims(from_start=kind == "cumulative")),
            reading=READING,
            survives_by="" if kind == "cumulative" else "sub_p2d1v1_10/cumulative",
        )


def _claims(*, from_start: bool) -> Iterator[SizedClaim]:
    """V1 = {b1, b2, g1}, one of it blinded; x1 is the greedy robot in V2, so |Vg| = 2."""
    for order in (("g1", "x1"), ("x1", "g1")):
        team = Team(("b1", "b2"), order)
        for attacked in ("b1", "g1"):
            left = [robot for robot in GROUP if robot != attacked]
            above = team.chosen(left) if from_start else team.chosen(order) * T
            for chosen in combinations(GROUP, 2):
                first, second = above * ONE_PLUS_K, team.compared(chosen) * T
                claim = Claim(
                    kind=FunctionClass.CURVATURE,
                    ground=team.ground,
                    premises=team.premises,
                    conclusion=(first - second).reduced(),
                )
                text = f"2 bait, 2 greedy, blinded: {attacked}; W = {{{','.join(chosen)}}}; order {','.join(order)}"
                yield SizedClaim(size=text, robots=4, claim=claim, left=first, right=second, team=team)
