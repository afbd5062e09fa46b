"""Lower bounds on the value of many sets of one plan's robots, in integers: targets of two coordinates.

A matrix is replaced by ``[[a, b], [b, c]] / 2^BITS`` in integers: ``a`` and ``c`` one below what they round down to,
``b`` rounded down. What that takes off, times ``2^BITS``, has a diagonal of at least 1 and an entry in ``[0, 1)``
beside it, so it is positive semidefinite, and so is the sum of such losses. The criteria do not decrease with the
information, so where what is left is positive definite, its value is at most the true one. Values are then
rounded down once more. What these bounds do not decide is left to exact arithmetic.
"""

from __future__ import annotations

from math import isqrt, prod
from typing import TYPE_CHECKING

from flint import arb, ctx, fmpq, fmpz

from ratt_opt.certificates.verifier.exact_matrices import total
from ratt_opt.certificates.verifier.work import tick

if TYPE_CHECKING:
    from collections.abc import Callable

    from flint import fmpq_mat

    from ratt_opt.certificates.verifier.statement import Statement

__all__ = ["FixedPoint", "Sums"]

BITS, OF_VALUES, OF_WEIGHTS = 96, 64, 64
"""Binary places of matrices, values and weights: sums of usual size lose less than a claim's last digit says."""
OF_PRODUCTS, AT_ONCE = 128, 5
"""Leading bits that are kept of products of determinants, and how many are multiplied before it is shortened."""

Sums = list[tuple[int, int, int]]
"""One symmetric matrix per target."""


class FixedPoint:
    """The robots of a plan in integers.

    ``start`` : what a set has without any robot; ``none`` : what no robot adds
    """

    def __init__(self, about: Statement, start: list[fmpq_mat]) -> None:
        self.about = about
        self.start: Sums = [_lowered(m) for m in start]
        self.none: Sums = [(0, 0, 0)] * len(start)
        self._own = [[_lowered(m) for m in about.information[e]] for e in about.plan]
        self._copies: dict[tuple[int, int], Sums] = {}
        self._weights = [int(fmpq(w * (1 << OF_WEIGHTS)).ceil()) for w in about.weights]
        whole = about.prior_low if about.objective == "maxeig" else about.prior_trace
        self._whole = int(fmpq(whole * (1 << OF_VALUES + OF_WEIGHTS)).floor())
        with ctx.workprec(OF_PRODUCTS):
            self._log_2 = arb(2).log()
        self._of_weight: dict[fmpq, tuple[list[int], arb]] = {}
        if about.objective == "logdet":
            self._group_by_weight()

    def _group_by_weight(self) -> None:
        """Weight -> targets, and the sum of ``log det`` of their priors."""
        for weight in dict.fromkeys(self.about.weights):
            own = [j for j, w in enumerate(self.about.weights) if w == weight]
            with ctx.workprec(OF_PRODUCTS):
                self._of_weight[weight] = own, total(arb(self.about.prior[j].det()).log() for j in own)

    @staticmethod
    def serves(about: Statement) -> bool:
        """Whether there are formulas for this criterion."""
        return about.d == 2 and about.output is None

    def copies(self, robot: int, times: int = 1) -> Sums:
        """So many copies of a robot's information."""
        if (robot, times) not in self._copies:
            self._copies[robot, times] = [(times * a, times * b, times * c) for a, b, c in self._own[robot]]
        return self._copies[robot, times]

    def plus(self, sums: Sums, robot: int) -> Sums:
        """The sums with one more robot."""
        own = self._own[robot]
        return [(a + x, b + y, c + z) for (a, b, c), (x, y, z) in zip(sums, own, strict=True)]

    def are_worth(self, sums: Sums, more: list[Sums], count: int, lower: fmpq) -> bool:
        """Whether any ``count`` of ``sums`` with one of ``more`` each are shown to be worth ``lower`` on average."""
        kinds: dict[str, Callable[[Sums, list[int]], int | arb | None]]
        kinds = {"trace": self._trace, "logdet": self._log, "maxeig": self._largest}
        value = kinds[self.about.objective]
        values: list[int | arb] = []
        with ctx.workprec(OF_PRODUCTS):
            for own in more:
                tick()
                case = [(a + x, b + y, c + z) for (a, b, c), (x, y, z) in zip(sums, own, strict=True)]
                determinants = [a * c - b * b for a, b, c in case]
                if min(determinants) <= 0 or min(case)[0] <= 0 or (shown := value(case, determinants)) is None:
                    return False
                values.append(shown)
            least = total(sorted(values)[:count])
        return bool(least >= lower * count * (1 if self.about.objective == "logdet" else 1 << OF_VALUES + OF_WEIGHTS))

    def _trace(self, sums: Sums, determinants: list[int]) -> int:
        """A lower bound on the value, in units of ``2^-(OF_VALUES + OF_WEIGHTS)``."""
        terms = [((a + c) << BITS + OF_VALUES) // det + 1 for (a, _, c), det in zip(sums, determinants, strict=True)]
        return self._whole - sum(w * x for w, x in zip(self._weights, terms, strict=True))

    def _log(self, _: Sums, determinants: list[int]) -> arb:
        """A lower bound on ``sum_j w_j log det(L_j P_j)``: one logarithm for all targets of a weight."""
        value = arb(0)
        for weight, (targets, priors) in self._of_weight.items():
            own = determinants if len(self._of_weight) == 1 else [determinants[j] for j in targets]
            product, exponent = 1, -2 * BITS * len(own)
            for k in range(0, len(own), AT_ONCE):
                product *= prod(own[k : k + AT_ONCE])
                spare = max(product.bit_length() - OF_PRODUCTS, 0)
                product, exponent = product >> spare, exponent + spare
            value += weight * (arb(product).log() + exponent * self._log_2 + priors)
        return value.lower()

    def _largest(self, sums: Sums, _: list[int]) -> int | None:
        """A lower bound on the value, in units of ``2^-(OF_VALUES + OF_WEIGHTS)``; ``None`` where none is shown.

        The largest eigenvalue of an inverse is one over the least: ``2 / (a + c - sqrt((a - c)^2 + 4 b^2))``.
        """
        largest = 0
        for (a, b, c), weight in zip(sums, self._weights, strict=True):
            twice_least = a + c - isqrt((a - c) ** 2 + 4 * b * b) - 1
            if twice_least <= 0:
                return None
            largest = max(largest, weight * ((1 << BITS + 1 + OF_VALUES) // twice_least + 1))
        return self._whole - largest


def _lowered(matrix: fmpq_mat) -> tuple[int, int, int]:
    scale = fmpz(1) << BITS
    a, b, c = (int(fmpq(x * scale).floor()) for x in (matrix[0, 0], matrix[0, 1], matrix[1, 1]))
    return a - 1, b, c - 1
