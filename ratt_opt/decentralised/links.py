"""Cost of each link's loss while the team plans: in the worst case of the plan, and in the decision time."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.budget import Budget, Stop, interruptible
from ratt_opt.decentralised.faults import Faults
from ratt_opt.decentralised.plan import decentralised_ratt

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt.attack.task import AttackResult
    from ratt_opt.decentralised.plan import DecentralisedPlan
    from ratt_opt.problem import Problem

__all__ = ["LinkLoss", "LinkLosses", "link_losses"]


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkLoss:
    """Plan of a team that loses a ``link`` as it begins to plan, and the worst case of that plan.

    ``lower``, ``upper`` : bracket of the worst case; ``cost`` : what is proved to be lost of it, negative if the
    plan is proved better, 0 if brackets overlap. ``delay`` : of the decision [s]; ``changed`` : robots that choose
    otherwise; ``parts`` : components
    """

    link: tuple[int, int]
    lower: float
    upper: float
    cost: float
    delay: float
    changed: int
    parts: int


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkLosses:
    """Losses of links, the costliest first; of equals the one that delays most.

    ``plan``, ``worst_case`` : with all links. ``stop`` : ``EXHAUSTED``, or why links are missing
    """

    plan: DecentralisedPlan
    worst_case: AttackResult
    losses: tuple[LinkLoss, ...]
    stop: Stop


@interruptible
def link_losses(
    problem: Problem,
    planner: Callable[..., DecentralisedPlan] = decentralised_ratt,
    *,
    faults: Faults | None = None,
    time_limit: float | None = None,
) -> LinkLosses:
    """Plan once without each link, to see which ones matter for planning.

    The link is lost as the robots begin to plan and is there again for the adversary: what changes is the plan alone.
    ``links_to_protect`` tells which links matter for a plan that is made.

    Parameters
    ----------
    problem : as of :func:`decentralised_ratt`
    planner : called as ``planner(problem, faults=..., time_limit=...)``
    faults : that happen besides
    time_limit : seconds for all links; the first plan and its worst case are made in any case

    Raises
    ------
    InputError : as of the planner.
    """
    budget, faults = Budget(time_limit), faults or Faults()
    plan = planner(problem, faults=faults)
    known = {plan.elements.tobytes(): worst_case_attack(problem, plan.elements, budget=budget)}
    value, losses, stop = known[plan.elements.tobytes()], [], None
    for link in sorted(problem.communication.links):
        left = None if time_limit is None else budget.seconds_left
        other = planner(problem, faults=replace(faults, cuts=(*faults.cuts, (0, *link))), time_limit=left)
        stop = budget.stop()
        if stop is not None:
            break
        key = other.elements.tobytes()
        if key not in known:
            known[key] = worst_case_attack(problem, other.elements, budget=budget)
        lower, upper = known[key].lower, known[key].upper
        loss = LinkLoss(
            link=link,
            lower=lower,
            upper=upper,
            cost=max(value.lower - upper, 0.0) + min(value.upper - lower, 0.0),
            delay=other.decision_time - plan.decision_time,
            changed=int((other.elements != plan.elements).sum()),
            parts=len(other.components),
        )
        losses.append(loss)
    losses.sort(key=lambda loss: (-loss.cost, -loss.delay, loss.link))
    return LinkLosses(plan=plan, worst_case=value, losses=tuple(losses), stop=stop or Stop.EXHAUSTED)
