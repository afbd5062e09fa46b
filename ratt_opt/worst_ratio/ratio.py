"""The smallest ratio of a planner's worst-case value to the optimum over all instances of a class."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import inf, nextafter
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import check_integer, readonly
from ratt_opt.budget import Budget, OutOfBudget, Stop, interruptible
from ratt_opt.errors import InputError
from ratt_opt.running.progress import Step
from ratt_opt.worst_ratio.class_rows import NonDecreasing, Submodular
from ratt_opt.worst_ratio.closed_form import proved_ratio
from ratt_opt.worst_ratio.params import DEFAULT, WorstRatioParams
from ratt_opt.worst_ratio.ratio_search import RatioSearch, Skeleton, skeleton
from ratt_opt.worst_ratio.witness import FAMILIES, PLANNERS, RatioQuestion, RatioWitness, replay

if TYPE_CHECKING:
    from ratt_opt.worst_ratio.class_rows import ClassRows

__all__ = ["WorstCaseRatio", "class_rows", "worst_case_ratio"]

DOMAINS = ("elements", "feasible")


@dataclass(frozen=True, slots=True, kw_only=True)
class WorstCaseRatio:
    """Claim ``lower <= smallest ratio over the class <= upper``; both ends are proved.

    ``exact_upper`` is attained by ``witness``, replayed through the library in exact arithmetic.
    ``exact_lower`` is proved by rational multipliers of every linear program of the search
    (``lower_from`` is ``"multipliers"``) or by a theorem with a written proof (``"theorem"``: ``proved_ratio``).
    ``lower`` and ``upper`` are these rounded outward to float64. ``stop`` is ``CLOSED`` when the exact
    ends are equal, ``EXHAUSTED`` when the search ended but some bound did not verify in rationals,
    else ``TIME`` or ``INTERRUPTED``. ``nodes`` and ``programs`` count the search's nodes and linear programs.
    """

    lower: float
    upper: float
    exact_lower: Fraction
    exact_upper: Fraction
    lower_from: str
    witness: RatioWitness
    stop: Stop
    nodes: int
    programs: int


@interruptible
@Step("the worst ratio")
def worst_case_ratio(
    n_robots: int,
    alpha_s: int,
    alpha_c: int,
    *,
    curvature: float | str | Fraction,
    family: str,
    planner: str = "ratt",
    domain: str = "elements",
    time_limit: float | None = None,
    use_theorem: bool = True,
    budget: Budget | None = None,
    params: WorstRatioParams = DEFAULT,
) -> WorstCaseRatio:
    """Return a proved bracket on the smallest ratio that ``planner`` can have, over all instances of a class.

    The instances: N robots on the complete graph with any number of elements each, and any normalised non-decreasing
    set function that is submodular with curvature at most ``curvature``, or has total curvature at most that.
    Restricting an instance to the planner's and an optimal plan's elements keeps the ratio and does not
    raise the curvature, so 2N elements suffice and the smallest ratio is attained.

    Parameters
    ----------
    n_robots : N in [1, 7] (``params.robots``)
    alpha_s : robots the attacker blinds, in [0, N - 1] (with all robots blinded the optimum is 0)
    alpha_c : links the attacker cuts, in [0, N (N - 1) / 2]
    curvature : in [0, 1]; a float is read as the decimal it prints as, so that 0.3 means 3/10
    family : ``"submodular"`` or ``"nondecreasing"``
    planner : ``"ratt"``, ``"myopic"`` or ``"greedy"``
    domain : the curvature is over all ``"elements"`` (the paper's definition) or over ``"feasible"`` sets,
        one element per robot
    time_limit : seconds of wall time; the bracket stays valid
    use_theorem : start from the largest bound with a written proof (``proved_ratio``) and stop once it is attained;
        ``False`` proves the lower end by multipliers alone
    budget : an outer search's budget: its seconds and interrupts count too
    params : of its linear programs and rational arithmetic

    Raises
    ------
    InputError : an argument is out of range or unknown.

    Source: the ratio of Theorem 1 (eqn:appro_non_descrease, eqn:appro_submodular); finite by the argument above.
    """
    n_robots = check_integer("n_robots", n_robots, low=1, high=params.robots)
    question = RatioQuestion(
        n_robots=n_robots,
        alpha_s=_check_sensing(alpha_s, n_robots),
        alpha_c=check_integer("alpha_c", alpha_c, low=0, high=n_robots * (n_robots - 1) // 2),
        curvature=check_curvature(curvature),
        family=family,
        domain=domain,
        planner=planner,
    )
    choices = (("family", family, FAMILIES), ("planner", planner, PLANNERS), ("domain", domain, DOMAINS))
    for name, value, known in choices:
        if value not in known:
            raise InputError(name, f"must be one of {', '.join(known)}", value)
    own = Budget.inside(budget, time_limit)
    parts = skeleton(question.n_robots, question.alpha_s, question.alpha_c, question.n_bait)
    floor = proved_ratio(question) if use_theorem else Fraction(0)
    search = RatioSearch(
        parts, class_rows(parts, question, params), lambda table: replay(question.witness(table)), floor
    )
    stop = Stop.EXHAUSTED
    try:
        search.run(own)
    except OutOfBudget as spent:
        stop = spent.stop
    except KeyboardInterrupt:
        stop = own.interrupt()
    return _result(search, question, stop)


def check_curvature(value: float | str | Fraction) -> Fraction:
    """Return a curvature in [0, 1] as a rational; floats are read as the decimal they print as."""
    rule = "must be a number in [0, 1]"
    try:
        number = value if isinstance(value, Fraction) else Fraction(str(value))
    except (ValueError, ZeroDivisionError):
        raise InputError("curvature", rule, value) from None
    if not 0 <= number <= 1:
        raise InputError("curvature", rule, value)
    return number


def _check_sensing(alpha_s: int, n_robots: int) -> int:
    rule = f"must be an integer in [0, {n_robots - 1}] (with every robot blinded the optimum is 0 and no ratio exists)"
    try:
        return check_integer("alpha_s", alpha_s, low=0, high=n_robots - 1)
    except InputError:
        raise InputError("alpha_s", rule, alpha_s) from None


def class_rows(parts: Skeleton, question: RatioQuestion, params: WorstRatioParams = DEFAULT) -> ClassRows:
    """Columns and rows of the class that a question is about."""
    if question.family == "submodular":
        return Submodular(parts.n_robots, question.curvature, question.domain, params)
    compared = [mask for pair in parts.comparisons for mask in pair]
    groups = parts.groups
    masks = [*compared, *groups, *(group << parts.n_robots for group in groups)]
    return NonDecreasing(parts.n_robots, question.curvature, masks, params)


def _result(search: RatioSearch, question: RatioQuestion, stop: Stop) -> WorstCaseRatio:
    counts = np.bitwise_count(np.arange(4**question.n_robots)).astype(np.int64)
    # The number of elements is in every class, and every plan is optimal for it: ratio 1.
    witness = question.witness(readonly(counts) if search.table is None else search.table)
    lower, upper = search.lower, search.upper
    return WorstCaseRatio(
        lower=_down(lower),
        upper=-_down(-upper),
        exact_lower=lower,
        exact_upper=upper,
        lower_from="theorem" if lower == search.floor else "multipliers",
        witness=witness,
        stop=Stop.CLOSED if lower == upper else stop,
        nodes=search.nodes,
        programs=search.programs,
    )


def _down(value: Fraction) -> float:
    """Largest float that is at most ``value``."""
    near = float(value)
    return near if Fraction(near) <= value else nextafter(near, -inf)
