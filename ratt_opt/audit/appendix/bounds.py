"""The factors of the paper's bounds, and the claims that a group keeps one, whatever the pattern."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.entry import SizedClaim
from ratt_opt.audit.appendix.roles import Team, team_of
from ratt_opt.audit.engine.polynomial import ONE, Polynomial, T, constant

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from ratt_opt.audit.appendix.roles import Robots
    from ratt_opt.audit.engine.claim import FunctionClass, Linear

__all__ = [
    "CUBED",
    "KEPT",
    "KEPT_OVER_ONE_PLUS_K",
    "ONE_PLUS_K",
    "SQUARED",
    "T2",
    "T3",
    "Factor",
    "every_group",
    "one_group",
]

T2, T3 = T**2, T**3
ONE_PLUS_K = constant(2) - T
"""``1 + k`` with ``t = 1 - k``."""


@dataclass(frozen=True, slots=True)
class Factor:
    """``above / below``, with ``below`` positive for every curvature in [0, 1]."""

    above: Polynomial
    below: Polynomial = ONE

    def gap(self, left: Linear, right: Linear) -> Linear:
        """An expression that is at least zero exactly when ``left >= above/below * right``."""
        return left * self.below - right * self.above


KEPT, SQUARED, CUBED = Factor(T), Factor(T2), Factor(T3)
"""One minus the curvature, its square and its cube."""
KEPT_OVER_ONE_PLUS_K = Factor(T, ONE_PLUS_K)


def every_group(function_class: FunctionClass, factor: Factor, *, largest: int) -> Iterator[SizedClaim]:
    """For every set S of surviving robots: ``f(u on S) >= factor f(o on S)``, whatever the pattern.

    S has any baits and any of the greedy robots; greedy robots outside S were still chosen before
    some in S. Baits outside S and greedy robots chosen later play no part.
    """
    for total in range(1, largest + 1):
        for n_greedy in range(total + 1):
            bait, greedy = team_of(total - n_greedy, n_greedy).bait, team_of(0, n_greedy).greedy
            for chosen in _subsets_with_last(greedy):
                team = Team(bait, greedy, without_optimum=frozenset(greedy) - set(chosen))
                group = bait + chosen
                conclusion = factor.gap(team.chosen(group), team.compared(group))
                text = f"S = {{{','.join(group)}}} of {len(bait)} bait, {n_greedy} greedy"
                yield SizedClaim(size=text, robots=total, claim=team.claim(function_class, conclusion), team=team)


def _subsets_with_last(greedy: Robots) -> Iterator[Robots]:
    if not greedy:
        yield ()
        return
    for size in range(len(greedy)):
        for rest in combinations(greedy[:-1], size):
            yield (*rest, greedy[-1])


def one_group(function_class: FunctionClass, factors: Sequence[Factor], *, all_bait: bool) -> Iterator[SizedClaim]:
    """A group of baits only (or greedy robots only) against the compared plan; ``factors`` of sizes 1, 2, ..."""
    for size, factor in enumerate(factors, start=1):
        team = team_of(size, 0) if all_bait else team_of(0, size)
        conclusion = factor.gap(team.chosen(team.robots), team.compared(team.robots))
        text = f"{size} {'surviving baits' if all_bait else 'greedy robots'}"
        yield SizedClaim(size=text, robots=size, claim=team.claim(function_class, conclusion))
