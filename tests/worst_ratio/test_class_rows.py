"""Linear rows of the non-decreasing class: what single elements are bounded by before any other row is found."""

from fractions import Fraction

from ratt_opt.worst_ratio.class_rows import NonDecreasing


def test_single_elements_in_play_lie_between_kept_and_largest_marginals() -> None:
    """Others have no column, and no row."""
    function_class = NonDecreasing(2, Fraction(1, 4), [0b0001, 0b0100, 0b0101])
    bounds = {tuple(sorted(row.terms.items())) for row in function_class.first_rows()}
    expected = set()
    for element in (0, 2):
        single, marginal = function_class.column(1 << element), 1 + element
        expected.add(tuple(sorted({marginal: Fraction(1), single: Fraction(-1)}.items())))
        expected.add(tuple(sorted({single: Fraction(1), marginal: Fraction(-3, 4)}.items())))
    assert bounds == expected
