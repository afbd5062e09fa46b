"""Best k robots to protect from blinding, for the worst case of a plan.

Let ``S`` be a best choice and ``P`` a part of it. If the worst attack on the team with ``P`` protected blinds no robot
of ``S``, it stays possible under ``S``, so ``P`` is as good. Otherwise it blinds some robot of ``S`` outside ``P``. So
a search that protects one more robot of the worst attack at a time, over all of them, meets a best choice: at most
``alpha_s^k`` worst attacks instead of one for each set of k robots.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from ratt_opt._validation import check_integer
from ratt_opt._values import ReprMixin
from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.budget import Budget, Stop, interruptible
from ratt_opt.running.progress import Step

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ratt_opt.attack.task import AttackResult
    from ratt_opt.problem import Problem

__all__ = ["BestRobots", "robots_to_protect"]


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class BestRobots(ReprMixin):
    """Claim: ``lower <= worst case of the plan with the best k robots protected <= upper`` [unit of the objective].

    ``robots`` : at most k, ascending; with them the worst case is ``lower`` at least. ``before`` : the worst attack on
    the team as it is; ``after`` : on the team with these robots protected. ``attacks`` : exact attacks made.
    ``stop`` is ``CLOSED`` if every attack closed and the search ended.
    """

    robots: tuple[int, ...]
    lower: float
    upper: float
    before: AttackResult
    after: AttackResult
    stop: Stop
    attacks: int

    def to_dict(self) -> dict[str, Any]:
        """The result as plain data."""
        ends = {"robots": list(self.robots), "lower": self.lower, "upper": self.upper}
        attacks = {"before": self.before.to_dict(), "after": self.after.to_dict()}
        return {**ends, **attacks, "stop": self.stop.value, "attacks": self.attacks}


@interruptible
@Step("robots to protect")
def robots_to_protect(
    problem: Problem,
    elements: ArrayLike,
    k: int,
    *,
    max_nodes: int | None = None,
    time_limit: float | None = None,
    budget: Budget | None = None,
) -> BestRobots:
    """Find the at most ``k`` robots whose protection from blinding leaves the best worst case.

    Parameters
    ----------
    problem, elements : the team, and one element of each robot
    k : number of robots, beside those that are protected already
    max_nodes : for each exact attack
    time_limit : seconds for all of it; unlimited by default
    budget : an outer search's budget: its seconds and interrupts count too

    Raises
    ------
    InputError : the plan is not one element per robot, or a limit is not a number >= 0.
    """
    plan, count = problem.check_plan(elements), check_integer("k", k, low=0, high=problem.n_robots)
    own = Budget.inside(budget, time_limit)
    known: dict[frozenset[int], AttackResult] = {}
    waiting, left = [frozenset[int]()], False
    while waiting:
        chosen = waiting.pop()
        if chosen in known:
            continue
        if known and own.is_over:
            left = True
            break
        team = replace(problem, protected_robots=problem.protected_robots | chosen)
        known[chosen] = found = worst_case_attack(team, plan, max_nodes=max_nodes, budget=own, brief=True)
        if len(chosen) < count:
            waiting += [chosen | {robot} for robot in sorted(found.attack.sensing, reverse=True)]
    best = max(known, key=lambda robots: (known[robots].lower, -len(robots)))
    upper = max(found.upper for found in known.values())
    if left:  # no attack leaves more than none does
        upper = max(upper, *(problem.objective(plan[sorted(group)]) for group in problem.communication.groups()))
    stops = [found.stop for found in known.values()]
    open_stop = next((stop for stop in stops if stop not in {Stop.CLOSED, Stop.EXHAUSTED}), None)
    return BestRobots(
        robots=tuple(sorted(best)),
        lower=known[best].lower,
        upper=upper,
        before=known[frozenset()],
        after=known[best],
        stop=(own.stop() or Stop.TIME) if left else (open_stop or Stop.CLOSED),
        attacks=len(known),
    )
