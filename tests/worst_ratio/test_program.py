"""Bounds of a linear program: right multipliers prove them, wrong ones prove nothing."""

from dataclasses import replace
from fractions import Fraction

from ratt_opt.budget import Budget
from ratt_opt.worst_ratio.program import Inequality, RatioProgram, basic_multipliers, checked_bound, proved_bound


def test_wrong_multipliers_prove_nothing():
    program = RatioProgram(2)
    program.add([Inequality({0: Fraction(1), 1: Fraction(-1)}), Inequality({1: Fraction(1)}, Fraction(1))])
    claimed = program.solve(10.0)
    assert proved_bound(program, claimed, Budget()) == 1
    claimed.y[:] = [5.0, 5.0]
    assert proved_bound(program, claimed, Budget()) == 1, "the basis still gives the right ones"
    wrong = replace(claimed, basic_columns=(1,), tight_rows=(1,))
    assert checked_bound(program, basic_multipliers(program, wrong)) != 1
