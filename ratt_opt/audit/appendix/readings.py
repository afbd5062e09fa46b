"""Lines whose readings differ in the statement itself, not only in a premise."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.entry import Entry, SizedClaim
from ratt_opt.audit.appendix.roles import Team
from ratt_opt.audit.engine.claim import Claim, FunctionClass
from ratt_opt.audit.engine.polynomial import T, constant

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["special_entries"]

READING = "for every set W of |Vg| robots of V1, as the line says"
ONE_PLUS_K = constant(2) - T
GROUP = ("b1", "b2", "g1")


def special_entries() -> Iterator[Entry]:
    """Yield the entries of this module."""
    yield from _every_subset()
    yield from _substitution()


def _substitution() -> Iterator[Entry]:
    """Pattern 2, i): a bait of V1 stands in for a greedy robot x1 of V2. Does the value not rise with the stand-in?"""
    sides = (
        ("RATT's plan", "f(u on V1) >= f(u on V1 with a bait replaced by x1)"),
        ("the optimum", "f(u* on V1 with a bait replaced by x1) >= f(u* on V1)"),
    )
    for reading, text in sides:
        yield Entry(
            label="nd_p2_substitution",
            kind="claim",
            chain="nd_p2d1v1",
            statement=f"the bait is individually better than x1, hence {text}",
            hypotheses="total curvature <= c; all of RATT's choices",
            claims=tuple(_swaps(own=reading == "RATT's plan")),
            reading=reading,
            survives_by="nd_p2d1v1/cumulative",
            serves_by="nd_p2d1v1/cumulative",
        )


def _swaps(*, own: bool) -> Iterator[SizedClaim]:
    for order in (("g1", "x1"), ("x1", "g1")):
        team = Team(("b1",), order)
        whole, swapped = ["b1", "g1"], ["x1", "g1"]
        first = team.chosen(whole) if own else team.compared(swapped)
        second = team.chosen(swapped) if own else team.compared(whole)
        kind = FunctionClass.TOTAL_CURVATURE
        claim = Claim(kind=kind, ground=team.ground, premises=team.premises, conclusion=first - second)
        text = f"b1 replaced by x1 beside g1; greedy order {','.join(order)}"
        yield SizedClaim(size=text, robots=3, claim=claim, left=first, right=second, team=team)


def _every_subset() -> Iterator[Entry]:
    """Yield sub_p2d1v1_9 read "for all W in V1 with |W| = |Vg|"."""
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
            survives_by="sub_p2d1v1_10/cumulative",
            serves_by=f"sub_p2d1v1_9/{kind}/",
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
