"""Certified brackets of the marginals of information criteria over domains too large to enumerate."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.curvatures.marginals import MeasuredMarginals
from ratt_opt.curvatures.planar.marginal_brackets import PlanarBrackets
from ratt_opt.curvatures.separable.marginal_brackets import SeparableBrackets

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.curvatures.least_certain import MarginalBrackets
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["bracket_marginals"]


def bracket_marginals(
    f: InformationObjective, owners: IntArray, *, gap: float, budget: Budget, against_own: bool
) -> MeasuredMarginals:
    """Bracket the smallest and largest marginal of every element over sets with at most one element per owner.

    ``owners`` : (n,) 0.. without gaps. ``gap`` : see :class:`MarginalBrackets`.
    ``against_own`` : the ratio that matters is to ``f({x})`` (curvature), not to the largest marginal.
    """
    levels = f.planar_levels()
    brackets: MarginalBrackets
    if levels is not None:
        brackets = PlanarBrackets(levels, owners, f.singletons(), gap=gap, budget=budget, against_own=against_own)
        how = "smallest levels and attained contexts"
    else:
        brackets = SeparableBrackets(f, owners, gap=gap, budget=budget, against_own=against_own)
        how = f"{brackets.rests_on} and attained contexts"
    stop = brackets.run()
    return MeasuredMarginals(marginals=brackets.marginals(), how=how, stop=stop, nodes=budget.nodes)
