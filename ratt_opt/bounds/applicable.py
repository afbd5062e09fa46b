"""Guarantees that apply to RATT's plan for one problem, and the reasons why the others do not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.bounds.group_size import achievable_group_size, group_size_bound
from ratt_opt.bounds.guarantees import (
    Curvatures,
    Guarantee,
    all_bait_group_bound,
    pattern_free_bound,
    remark1_bound,
    sensing_only_bound,
    theorem1_bound,
)
from ratt_opt.bounds.params import DEFAULT
from ratt_opt.bounds.survivors import largest_survivor_group, survivor_bound
from ratt_opt.problem import check_problem

if TYPE_CHECKING:
    from ratt_opt.bounds.params import BoundParams
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Problem

__all__ = ["all_guarantees", "inapplicable_guarantees"]

OPTIMAL = "one robot a group"
ALWAYS = "Theorem 1", "pattern-free", "group size", "survivors", "this instance"
SENSING_ONLY, REMARK_1, ALL_BAIT = "sensing only", "Remark 1", "all bait"


def all_guarantees(
    problem: Problem,
    alpha_cs: int,
    *,
    k: Curvatures = None,
    c: Curvatures = None,
    budget: Budget | None = None,
    params: BoundParams = DEFAULT,
) -> dict[str, Guarantee]:
    """The guarantees that apply to RATT's plan for one problem, strongest first.

    Parameters
    ----------
    alpha_cs : sensing attacks that RATT took the link attacks to be worth
    k : curvature, for a submodular objective; c : total curvature; over feasible sets, numbers or brackets
    budget : an outer search's budget: after it, groups are cut by simpler rules, and guarantees that rest on them are
        weaker
    params : how groups are cut
    """
    missing = inapplicable_guarantees(check_problem(problem), alpha_cs)
    seeing = problem.n_robots - min(problem.alpha_s, problem.n_robots - len(problem.protected_robots))
    group_size, survivors = achievable_group_size(problem, budget, params), largest_survivor_group(problem)
    found: dict[str, Guarantee] = {}
    if group_size <= 1:
        found[OPTIMAL] = group_size_bound(group_size, c=1.0)
    for name, given in (("k", {"k": k}), ("c", {"c": c})):
        if given[name] is None:
            continue
        found[f"pattern-free ({name})"] = pattern_free_bound(**given)
        found[f"group size ({name})"] = group_size_bound(group_size, baits_survive=alpha_cs > 0, **given)
        found[f"survivors ({name})"] = survivor_bound(survivors, **given)
        found[f"Theorem 1 ({name})"] = theorem1_bound(alpha_cs, all_bait=ALL_BAIT not in missing, **given)
        if SENSING_ONLY not in missing:
            found[f"{SENSING_ONLY} ({name})"] = sensing_only_bound(**given)
        if REMARK_1 not in missing:
            found[f"{REMARK_1} ({name})"] = remark1_bound(**given)
        if ALL_BAIT not in missing and seeing > 0:
            # No group has more robots that see, and the bound falls with their number.
            found[f"{ALL_BAIT} ({name})"] = all_bait_group_bound(seeing, **given)
    return dict(sorted(found.items(), key=lambda item: -item[1]))


def inapplicable_guarantees(problem: Problem, alpha_cs: int) -> dict[str, str]:
    """Published guarantees that do not apply to RATT's plan for one problem: name -> the hypothesis that fails."""
    alpha = check_problem(problem, knows_at_most=True).alpha_s + alpha_cs
    if problem.at_most is not None:
        reason = f"few robots choose (at_most = {problem.at_most}); proofs compare plans robot by robot"
        return dict.fromkeys([*ALWAYS, SENSING_ONLY, REMARK_1, ALL_BAIT], reason)
    found: dict[str, str] = {}
    if problem.alpha_c > 0:
        found[SENSING_ONLY] = f"links are attacked (alpha_c = {problem.alpha_c})"
    elif alpha >= problem.n_robots:
        found[SENSING_ONLY] = f"every robot may be blinded (alpha_s = {problem.alpha_s})"
    if alpha < problem.n_robots:
        greedy = f"RATT leaves {problem.n_robots - alpha} robots to the greedy step (alpha = {alpha})"
        found[REMARK_1] = found[ALL_BAIT] = greedy
    return found
