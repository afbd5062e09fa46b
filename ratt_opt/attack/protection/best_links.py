"""Best k links to protect, or to add, for the worst case of a plan."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ratt_opt._rounding import down, up
from ratt_opt._validation import check_integer
from ratt_opt._values import ReprMixin
from ratt_opt.attack import params as parameters
from ratt_opt.attack.exact import worst_case_attack_unrounded
from ratt_opt.attack.protection.choice_search import best_choice
from ratt_opt.attack.protection.known_attacks import KnownAttacks
from ratt_opt.attack.protection.upgrades import Addition, Protection
from ratt_opt.attack.task import CLOSED_WIDTH, AttackMemory, AttackOptions, PlanValues, widened_result
from ratt_opt.budget import Budget, OutOfBudget, Stop, interruptible
from ratt_opt.coordinates.preparation import prepared
from ratt_opt.problem import check_problem
from ratt_opt.running.progress import Step

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike

    from ratt_opt.attack.protection.upgrades import Upgrade
    from ratt_opt.attack.task import AttackResult
    from ratt_opt.graph.communication import Link
    from ratt_opt.problem import Problem

__all__ = ["BestLinks", "links_to_add", "links_to_protect"]


@dataclass(frozen=True, slots=True, kw_only=True)
class BestLinks(ReprMixin):
    """Claim: ``lower <= worst case of the plan with the best k links <= upper`` [unit of the objective].

    ``links`` : at most k, ascending; with them the worst case is ``lower``. ``before`` : the worst attack on the team
    as it is; ``after`` : on the team that has these links. ``attacks`` : exact attacks made, ``nodes`` of them.
    ``stop`` is ``CLOSED`` if the ends meet up to rounding.
    """

    links: tuple[Link, ...]
    lower: float
    upper: float
    before: AttackResult
    after: AttackResult
    stop: Stop
    attacks: int
    nodes: int

    @property
    def gain_lower(self) -> float:
        """Proved gain of these links in the worst case."""
        return max(self.lower - self.before.upper, 0.0)

    @property
    def gain_upper(self) -> float:
        """No k links gain more."""
        return self.upper - self.before.lower

    def to_dict(self) -> dict[str, Any]:
        """The result as plain data."""
        ends = {"lower": self.lower, "upper": self.upper}
        attacks = {"before": self.before.to_dict(), "after": self.after.to_dict()}
        cost = {"stop": self.stop.value, "attacks": self.attacks, "nodes": self.nodes}
        return {"links": [list(link) for link in self.links], **ends, **attacks, **cost}

    def __repr__(self) -> str:
        ends = f"[{down(self.lower, 6)}, {up(self.upper, 6)}]"
        return f"BestLinks({list(self.links)}, {ends}, {self.stop.value}, {self.attacks} attacks)"


@interruptible
@Step("the best links to protect")
def links_to_protect(
    problem: Problem,
    elements: ArrayLike,
    k: int,
    *,
    candidates: Iterable[Link] | None = None,
    max_nodes: int | None = None,
    time_limit: float | None = None,
    budget: Budget | None = None,
) -> BestLinks:
    """Choose the k links whose protection raises the worst case of a plan most.

    A protected link cannot be cut. The search collects attacks until no k links prevent all attacks that are worse
    than the best choice's. The answer is exact if the exact attacker closes (up to 20 robots always), and a bracket
    otherwise. Relies on a non-decreasing objective (not checked). The plan, the robots' sensors and the adversary's
    budgets stay as they are: ``alpha_c`` counts links, also if some are protected.

    Parameters
    ----------
    problem : N robots, E elements
    elements : (N,) element chosen for each robot
    k : links that may be chosen, >= 0
    candidates : links to choose from; all that are not protected yet by default
    max_nodes : for each exact attack
    time_limit : seconds for all of it; unlimited by default
    budget : an outer search's budget: its seconds and interrupts count too

    Raises
    ------
    InputError : the plan is not one element per robot, a candidate is no link or given twice, ``k`` is no integer >= 0,
        or a budget is not a number >= 0.
    """
    upgrade = Protection(prepared(check_problem(problem)), candidates)
    search = _LinkSearch(upgrade, elements, k, max_nodes, Budget.inside(budget, time_limit))
    return search.run()


@interruptible
@Step("the best links to add")
def links_to_add(
    problem: Problem,
    elements: ArrayLike,
    k: int,
    *,
    candidates: Iterable[Link] | None = None,
    max_nodes: int | None = None,
    time_limit: float | None = None,
    budget: Budget | None = None,
) -> BestLinks:
    """Choose the k links whose addition raises the worst case of a plan most.

    A new link lets its ends pool what they see, and can be cut like any other. So it prevents an attack only if the
    adversary cannot cut it too. The plan, the robots' sensors and ``alpha_c`` stay as they are; if the budget is a
    share of the links, scale it yourself. Otherwise as :func:`links_to_protect`.

    Parameters
    ----------
    candidates : pairs of robots without a link, to choose from; all by default. Those within radio range of each
        other if positions are known: :meth:`ratt_opt.scenario.model.Scenario.pairs_within`

    Raises
    ------
    InputError : as for :func:`links_to_protect`; a candidate that is a link already is refused too.
    """
    upgrade = Addition(prepared(check_problem(problem)), candidates)
    search = _LinkSearch(upgrade, elements, k, max_nodes, Budget.inside(budget, time_limit))
    return search.run()


class _LinkSearch:
    """Search that chooses links against the known attacks, and attacks the team that has them, in turn."""

    def __init__(self, upgrade: Upgrade, elements: ArrayLike, k: int, max_nodes: int | None, budget: Budget) -> None:
        self.upgrade, self.budget, self.max_nodes = upgrade, budget, max_nodes
        self.count = min(check_integer("k", k, low=0), len(upgrade.candidates))
        self.values = PlanValues(upgrade.problem, elements)
        self.known = KnownAttacks(upgrade, self.values, budget)
        self.attacks = self.nodes = 0
        self.unproved_stop = Stop.HEURISTIC  # why the last attack that did not close stopped
        self._last: tuple[tuple[Link, ...], Problem, AttackMemory] | None = None  # the last attack, to go on with
        self.links: tuple[Link, ...] = ()
        # Monotonicity, before any attack is known: all robots that all candidates could hold together.
        self.upper = max(self.values(group) for group in upgrade.together())
        self.before = self.after = self._attack(())

    @property
    def level(self) -> float:
        """Cutoff: a better choice has a larger worst-case value than this."""
        best = self.after.lower
        return best + max(CLOSED_WIDTH * abs(best), self.upgrade.problem.objective.rounding)

    def run(self) -> BestLinks:
        """The bracket, when it is closed or the budget spent."""
        stop = None
        try:
            if self.count and not self.budget.is_over:
                # No choice keeps more than all candidates do; an attack found at once is enough to begin with.
                self._attack(self.upgrade.candidates, max_nodes=0)
                while self._improve():
                    pass
            elif not self.budget.is_over and self.after.stop is Stop.HEURISTIC:
                self._settle(())
        except OutOfBudget as out:
            stop = out.stop
        except KeyboardInterrupt:
            stop = self.budget.interrupt()
        if not self.count:
            self.upper = self.after.upper
        problem = self.upgrade.problem
        lower, upper = problem.widen_by_rounding(self.after.lower, max(self.upper, self.after.lower))
        return BestLinks(
            links=self.links,
            lower=lower,
            upper=upper,
            before=widened_result(problem, self.values.plan, self.before),
            after=widened_result(problem, self.values.plan, self.after),
            stop=Stop.CLOSED if self.upper <= self.level else stop or self.budget.stop() or self.unproved_stop,
            attacks=self.attacks,
            nodes=self.nodes,
        )

    def _improve(self) -> bool:
        """Attack the team that has the most promising choice; whether that taught anything."""
        known = self.known
        best = best_choice(known.ascending, self.count, self.budget, above=self.level, enough=self.upper)
        if best is None:
            self.upper = min(self.upper, self.level)
            return False
        self.upper = min(self.upper, best.value)
        links = self._links_of(best.chosen)
        if known.adapt(links, self.level):
            return True
        before = len(known.ascending), self.after.lower
        self._attack(links)
        if (len(known.ascending), self.after.lower) == before:  # an attack that did not close, known already
            self._settle(links)
        return (len(known.ascending), self.after.lower) != before

    def _settle(self, links: tuple[Link, ...]) -> None:
        """Attack the team that has these links in all the time that is left."""
        first = self._attack(links, share=1.0)
        if first.stop is Stop.HEURISTIC and math.isfinite(self.budget.seconds_left):
            self._attack(links, share=1.0)  # which goes on by branch and bound

    def _links_of(self, chosen: int) -> tuple[Link, ...]:
        """The candidates of a bit mask, ascending."""
        links = []
        while chosen:
            links.append(self.upgrade.candidates[(chosen & -chosen).bit_length() - 1])
            chosen &= chosen - 1
        return tuple(links)

    def _attack(
        self, links: tuple[Link, ...], *, share: float | None = None, max_nodes: int | None = None
    ) -> AttackResult:
        """Attack the team that has these links; they become the best if a larger worst case is proved."""
        if self._last is None or self._last[0] != links:
            self._last = links, self.upgrade.changed(links), AttackMemory()
        _, changed, memory = self._last
        nodes = self.max_nodes if max_nodes is None else max_nodes
        share = parameters.DEFAULT.protection.links if share is None else share
        options = AttackOptions(max_nodes=nodes, budget=self.budget.part(share), memory=memory, brief=True)
        result = worst_case_attack_unrounded(changed, self.values.plan, options)
        self.attacks, self.nodes = self.attacks + 1, self.nodes + result.nodes
        if result.stop not in {Stop.CLOSED, Stop.EXHAUSTED}:
            self.unproved_stop = result.stop
        if len(links) <= self.count and (self.attacks == 1 or result.lower > self.after.lower):
            self.links, self.after = links, result
        self.known.meet(result.attack, changed, self.after.lower)
        return result
