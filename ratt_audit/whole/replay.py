"""Re-check a whole instance with the library's RATT, exact attack and exhaustive optimum."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_audit.appendix.roles import Side
from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.budget import uninterrupted
from ratt_opt.errors import ProofError
from ratt_opt.problem import Attack, Problem
from ratt_opt.setfunctions.base import TableFunction
from ratt_opt.solvers.exhaustive import exhaustive_optimum
from ratt_opt.solvers.ratt import ratt

if TYPE_CHECKING:
    from ratt_audit.engine.claim import Claim
    from ratt_audit.engine.evidence import Witness
    from ratt_audit.whole.teams import WholeTeam

__all__ = ["WholeInstance", "replay"]


@dataclass(frozen=True, slots=True, kw_only=True)
class WholeInstance:
    """A set function, budgets, RATT's plan, an optimal plan and a worst attack on which a line fails.

    ``values`` : of all subsets, by bit mask over ``names``; ``robot`` : the owner of each element.
    ``worst_for`` : whose worst attack ``attack`` is; ``ratt_worst``, ``optimum`` : the worst cases of both plans.
    ``in_play`` : the values that the line compares; ``violation`` : how much it lacks.
    """

    whole: WholeTeam
    worst_for: Side
    names: tuple[str, ...]
    robot: tuple[int, ...]
    values: tuple[int, ...]
    plan: tuple[int, ...]
    bait: tuple[int, ...]
    optimal: tuple[int, ...]
    attack: Attack
    ratt_worst: float
    optimum: float
    curvature: str
    line: str
    in_play: dict[str, int]
    violation: str

    def problem(self) -> Problem:
        """The instance as a problem of the library; the graph is complete."""
        return _problem(self.whole, self.values)


def _problem(whole: WholeTeam, values: tuple[int, ...]) -> Problem:
    table = TableFunction([float(v) for v in values])
    return Problem(table, np.array(whole.team.ground.owner), None, whole.alpha_s, whole.alpha_c)


def replay(whole: WholeTeam, worst_for: Side, claim: Claim, witness: Witness) -> WholeInstance:
    """Return the instance, re-checked; ``claim`` is the line with the premises that ``witness`` meets.

    Raises
    ------
    ProofError : RATT chooses other elements, the compared plan is not optimal, or the attack no worst one.
    """
    n_robots = len(whole.team.robots)
    problem = _problem(whole, witness.values)
    plan, compared = np.arange(n_robots), np.arange(n_robots, 2 * n_robots)
    index = {robot: i for i, robot in enumerate(whole.team.robots)}
    groups = [[index[r] for r in group] for group in whole.groups]
    attack = Attack(frozenset(index[r] for r in whole.blinded), problem.communication.links_between(groups))
    chosen, best = ratt(problem), exhaustive_optimum(problem)
    worst = {
        side: uninterrupted(worst_case_attack(problem, elements))
        for side, elements in ((Side.RATT, plan), (Side.OPTIMUM, compared))
    }
    attacked = plan if worst_for is Side.RATT else compared
    bait = tuple(range(len(whole.team.bait)))
    checks = {
        "RATT chooses other elements": (chosen.elements == plan).all() and set(chosen.bait) == set(bait),
        "the compared plan is not optimal": best.lower == best.upper == worst[Side.OPTIMUM].lower,
        "the attack is no worst one": problem.team_value(attacked, attack) == worst[worst_for].lower,
    }
    for fault, holds in checks.items():
        if not holds:
            raise ProofError(f"{fault}: {whole.text()}")
    in_play = {key: witness.values[key] for key in claim.conclusion.terms if isinstance(key, int)}
    return WholeInstance(
        whole=whole,
        worst_for=worst_for,
        names=witness.names,
        robot=claim.ground.owner,
        values=witness.values,
        plan=tuple(map(int, plan)),
        bait=bait,
        optimal=tuple(map(int, compared)),
        attack=attack,
        ratt_worst=worst[Side.RATT].lower,
        optimum=best.lower,
        curvature=f"{claim.function_class.symbol} = {witness.curvature}",
        line=claim.text(),
        in_play={claim.ground.text(key): value for key, value in in_play.items()},
        violation=str(witness.violation),
    )
