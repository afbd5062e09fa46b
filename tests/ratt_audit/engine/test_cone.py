"""The elementary inequalities of a class against its definition."""

from fractions import Fraction

import numpy as np
import pytest

from ratt_audit.engine.claim import elementary, elementary_keys
from ratt_opt import ProofError
from ratt_opt.worst_ratio.function_class import FunctionClass, check_class
from tests.ratt_audit.engine.abc_claims import ABC, ANY, ND, SUB


def in_class(kind: FunctionClass, values: tuple[int, ...], curvature: Fraction) -> bool:
    try:
        check_class(kind, np.array(values), curvature)
    except ProofError:
        return False
    return True


def satisfies_elementary(kind: FunctionClass, values: tuple[int, ...], curvature: Fraction) -> bool:
    """All elementary inequalities of the class hold, with m(x) the largest marginal."""
    known: dict[int | str, Fraction] = {mask: Fraction(v) for mask, v in enumerate(values)}
    for x, name in enumerate(ABC.names):
        marginals = [values[s | 1 << x] - values[s] for s in range(8) if not s >> x & 1]
        known[f"m({name})"] = Fraction(max(marginals))
    keys = elementary_keys(kind, ABC, feasible=False)
    return all(elementary(kind, ABC, key).expression.value(known, 1 - curvature) >= 0 for key in keys)


@pytest.mark.parametrize("kind", [ANY, ND, FunctionClass.SUBMODULAR, SUB])
def test_elementary_inequalities_hold_exactly_on_the_class(kind: FunctionClass) -> None:
    """Integer tables near a modular one, on both sides of the class's border: definition against inequalities."""
    rng = np.random.default_rng(5)
    seen = {True: 0, False: 0}
    sizes = [bin(mask).count("1") for mask in range(8)]
    for _ in range(1500):
        base = [0, 4, 7, 9] if rng.integers(0, 2) else [0, 3, 6, 9]
        noise = int(rng.integers(1, 4))
        values = tuple(int(base[size] + (rng.integers(-noise, noise + 1) if size else 0)) for size in sizes)
        expected = in_class(kind, values, Fraction(2, 3))
        seen[expected] += 1
        assert satisfies_elementary(kind, values, Fraction(2, 3)) == expected
    assert min(seen.values()) > 20
