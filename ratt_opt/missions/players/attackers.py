"""Attackers of a mission: none, the exact worst case, heuristics, or the user's own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.attack.heuristics import bounded_rational_attack, greedy_attack, random_attack
from ratt_opt.attack.params import DEFAULT
from ratt_opt.budget import uninterrupted
from ratt_opt.errors import InputError
from ratt_opt.missions.players import names
from ratt_opt.missions.players.named import get_player, table_of
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import IntArray
    from ratt_opt.attack.task import AttackResult
    from ratt_opt.problem import Problem

    Attacker = Callable[[Problem, IntArray, int], Attack | AttackResult]
    OwnAttacker = Callable[[Problem, IntArray], Attack | AttackResult]

__all__ = ["ATTACKERS", "WorstAttacker", "attack_of", "get_attacker"]


@dataclass(frozen=True, slots=True, kw_only=True)
class WorstAttacker:
    """Attacker that finds the worst case of each step's plan.

    ``nodes`` : of a worst case on a graph that is not complete, beyond what is exact at once (some ten seconds a step);
    fewer save time, and the attack may not be the worst. A limit of seconds would make missions depend on the machine.
    """

    nodes: int = 500_000

    def __call__(self, problem: Problem, elements: IntArray) -> AttackResult:
        """Attack one step's plan."""
        at_once = problem.threat.links_alike or problem.n_robots <= DEFAULT.all_sets.valued
        return worst_case_attack(problem, elements, max_nodes=None if at_once else self.nodes, brief=not at_once)


_BY_NAME: dict[str, Attacker] = {
    "none": lambda _problem, _plan, _seed: Attack(),
    "worst": lambda problem, plan, _seed: WorstAttacker()(problem, plan),
    "bounded_rational": lambda problem, plan, _seed: bounded_rational_attack(problem, plan),
    "greedy": lambda problem, plan, _seed: greedy_attack(problem, plan),
    "random": lambda problem, plan, seed: random_attack(problem, plan, seed=seed),
}
ATTACKERS = table_of(names.ATTACKERS, _BY_NAME)
"""Attackers by name; each is called with the problem, the plan and a seed of the step."""


def get_attacker(attacker: str | OwnAttacker) -> Attacker:
    """The attacker of that name, or the given one, called with problem and plan.

    InputError : there is none of that name, or it cannot be called.
    """
    if callable(attacker):
        return lambda problem, plan, _seed: attacker(problem, plan)
    return get_player("attacker", attacker, ATTACKERS)


def attack_of(found: Attack | AttackResult, problem: Problem) -> Attack:
    """An attacker's attack, checked. InputError : it is none, or exceeds the budgets.

    A search that the user interrupted is no attacker's: KeyboardInterrupt.
    """
    attack = found if isinstance(found, Attack) else getattr(uninterrupted(found), "attack", None)
    if not isinstance(attack, Attack):
        raise InputError("attacker", "must return an Attack", type(found).__name__)
    return problem.check_attack(attack)
