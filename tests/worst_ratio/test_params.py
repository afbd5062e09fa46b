"""Parameters of worst-case ratios: brackets hold whatever they are; what no search could go on with is refused."""

from fractions import Fraction

import pytest

import ratt_opt as ro
from ratt_opt import WorstRatioParams
from tests.extremes import at_extremes, places


@pytest.mark.parametrize("family", ["submodular", "nondecreasing"])
@pytest.mark.parametrize("place", places(WorstRatioParams()))
def test_the_bracket_holds_the_ratio_at_extremes(place: str, family: str) -> None:
    """Of two robots, one of which is blinded: found without a theorem, with the parameters as they are by default."""
    options = {"curvature": "1/2", "family": family, "use_theorem": False}
    known = ro.worst_case_ratio(2, 1, 0, **options)
    assert known.exact_lower == known.exact_upper
    for _, params in at_extremes(WorstRatioParams(), place, {"robots", "rows"}):
        found = ro.worst_case_ratio(2, 1, 0, **options, params=params, time_limit=1.0)
        assert Fraction(0) <= found.exact_lower <= known.exact_lower
        assert found.exact_upper >= known.exact_upper


def test_what_no_search_can_go_on_with_is_refused() -> None:
    with pytest.raises(ro.InputError, match=r"params.rows must be at least 1; got 0"):
        WorstRatioParams(rows=0)
    with pytest.raises(ro.InputError, match=r"params.denominators must be at least 1"):
        WorstRatioParams(denominators=(0,))
    with pytest.raises(ro.InputError, match=r"n_robots must be an integer in \[1, 2\]; got 3"):
        ro.worst_case_ratio(3, 1, 0, curvature=0.5, family="submodular", params=WorstRatioParams(robots=2))
