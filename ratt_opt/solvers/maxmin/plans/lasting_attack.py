"""Attacks whose smaller groups stay weak under other plans too.

Where all robots are alike to the adversary, an attack on one plan may leave any of the robots outside its largest
group in the smaller ones. Those that happen to be weak under this plan may be strong under others, and
then nobody knows beforehand which group of the outcome wins: the search has to divide on it. Robots that are
weak whatever they do hurt the team just as much, and their groups can be closed once and for all.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.weakest_set.planar_team import PlanarTeam
from ratt_opt.graph.outcomes import realise
from ratt_opt.problem import Attack
from ratt_opt.setfunctions.criteria.two_by_two import triples

if TYPE_CHECKING:
    from ratt_opt.problem import Problem

__all__ = ["LastingAttacks"]


class LastingAttacks:
    """Exchanges the smaller groups of attacks on one problem."""

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._team = _at_their_best(problem) if problem.threat.is_symmetric else None
        self._known: dict[tuple[frozenset[int], tuple[int, ...]], Attack] = {}

    def of(self, attack: Attack) -> Attack:
        """An attack with the same largest group, whose other groups, of the same sizes, are weak at their best.

        The attack itself where robots or links differ to the adversary.
        """
        if self._team is None:
            return attack
        groups = sorted(self._problem.groups_left(attack), key=lambda g: (-len(g), min(g, default=0)))
        sizes = tuple(len(group) for group in groups[1:] if group)
        if not sizes:
            return attack
        key = groups[0], sizes
        if key not in self._known:
            outcome = (groups[0], *self._weakest(groups[0], sizes))
            self._known[key] = Attack(*realise(self._problem.threat, tuple(sorted(outcome, key=min))))
        return self._known[key]

    def _weakest(self, largest: frozenset[int], sizes: tuple[int, ...]) -> list[frozenset[int]]:
        """Disjoint groups of these sizes outside ``largest``, each as weak as exchanges find, the larger ones first."""
        from ratt_opt.attackers.weakest_set.exchanges import weak_sets_of_size  # compiles

        team = self._team
        assert team is not None
        left = np.array([i for i in range(len(team.single)) if i not in largest])
        groups = []
        for size in sizes:
            among = replace(team, information=team.information[left], single=team.single[left])
            chosen = sorted(weak_sets_of_size(among, size)[0]) if size > 1 else [int(among.single.argmin())]
            groups.append(frozenset(left[chosen].tolist()))
            left = np.delete(left, chosen)
        return groups


def _at_their_best(problem: Problem) -> PlanarTeam | None:
    """A team in which each robot sees every target as with whichever of its elements sees that target best.

    No one element need do all of that; its ``single`` values are those of the robots' individually best elements. With
    those elements' information instead, groups counted as weak that other elements make strong: what makes the best
    lone robot need not help a group most.
    """
    single = problem.objective.singletons()
    strongest = np.array([choice[single[choice].argmax()] for choice in problem.choices])
    team = PlanarTeam.of(problem.objective, strongest)
    if team is None:
        return None
    information = problem.information_objective.information
    traces = np.trace(information, axis1=-2, axis2=-1)
    best = np.array([choice[traces[choice].argmax(axis=0)] for choice in problem.choices])
    targets = np.arange(traces.shape[1])
    return replace(team, information=triples(information[best, targets]))
