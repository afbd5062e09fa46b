"""Claims about every group of surviving robots, whatever the pattern, and about groups of baits only."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.entry import SizedClaim
from ratt_opt.audit.appendix.roles import Team, team_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from ratt_opt.audit.appendix.factor import Factor
    from ratt_opt.audit.appendix.roles import Robots
    from ratt_opt.audit.engine.claim import FunctionClass

__all__ = ["every_group", "one_group"]


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


def one_group(
    function_class: FunctionClass, factor: Callable[[int], Factor], *, all_bait: bool, largest: int
) -> Iterator[SizedClaim]:
    """A group of baits only (or greedy robots only) against the compared plan, at every size.

    ``factor`` : of a size
    """
    for size in range(1, largest + 1):
        team = team_of(size, 0) if all_bait else team_of(0, size)
        conclusion = factor(size).gap(team.chosen(team.robots), team.compared(team.robots))
        text = f"{size} {'surviving baits' if all_bait else 'greedy robots'}"
        yield SizedClaim(size=text, robots=size, claim=team.claim(function_class, conclusion))
