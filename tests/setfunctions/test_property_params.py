"""Whatever sets are looked at, a witness is one, and nothing is called proved that is false."""

import numpy as np
import pytest

import ratt_opt as ro
from tests.extremes import at_extremes, places, undocumented

FINDERS = {
    "non-negative": ro.find_negativity,
    "non-decreasing": ro.find_monotonicity_violation,
    "submodular": ro.find_submodularity_violation,
    "modular": ro.find_modularity_violation,
    "subadditive": ro.find_subadditivity_violation,
}
SLACK = {
    "non-negative": lambda f, a, b: f(a),  # noqa: ARG005
    "non-decreasing": lambda f, a, b: f(a | b) - f(a),
    "submodular": lambda f, a, b: f(a) + f(b) - f(a | b) - f(a & b),
    "modular": lambda f, a, b: -abs(f(a) + f(b) - f(a | b) - f(a & b)),
    "subadditive": lambda f, a, b: f(a) + f(b) - f(a | b),
}


@pytest.mark.parametrize("place", places(ro.PropertyParams()))
@pytest.mark.parametrize("tabulated", [0, 24])
def test_witnesses_hold_at_extremes(place: str, tabulated: int) -> None:
    rng = np.random.default_rng(len(place))
    bad = ro.TableFunction(np.append(0.0, rng.normal(size=31)))  # breaks every rule
    good = ro.TableFunction([len(f"{mask:b}".replace("0", "")) for mask in range(32)])  # counts: keeps all
    for _, params in at_extremes(ro.PropertyParams(tabulated=tabulated), place, {"batch"}):
        for rule, find in FINDERS.items():
            found = find(bad, trials=200, time_limit=1.0, params=params)
            assert found is not None
            if found:
                slack = SLACK[rule](lambda s: bad(sorted(s)), set(found.a), set(found.b))
                assert slack == pytest.approx(found.slack, abs=1e-12)
                assert slack < 0
            assert not find(good, trials=50, time_limit=1.0, params=params)


def test_every_field_is_documented_and_checked() -> None:
    assert undocumented(ro.PropertyParams()) == []
    for place in places(ro.PropertyParams()):
        with pytest.raises(ro.InputError, match=rf"params\.{place} must be"):
            ro.PropertyParams(**{place: -1})
    with pytest.raises(ro.InputError, match=r"params\.batch must be"):
        ro.PropertyParams(batch=0)
