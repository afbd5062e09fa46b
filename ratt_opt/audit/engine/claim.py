"""The language of the cone: ground sets with robots, linear expressions, claims.

A claim reads: for every set function of this class on these elements that satisfies
these premises, this linear expression in its values is at least zero.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING

from ratt_opt.audit.engine.polynomial import ONE, ZERO, Polynomial, constant, signed_sum
from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

__all__ = ["Claim", "FunctionClass", "Ground", "Inequality", "Linear"]


class FunctionClass(Enum):
    """Classes of normalised set functions."""

    ANY = "normalised"
    NON_DECREASING = "non-decreasing"
    TOTAL_CURVATURE = "non-decreasing, total curvature at most c"
    SUBMODULAR = "non-decreasing and submodular"
    CURVATURE = "non-decreasing and submodular, curvature at most k"

    @property
    def symbol(self) -> str:
        """Letter of the curvature in texts."""
        return "c" if self is FunctionClass.TOTAL_CURVATURE else "k"

    @property
    def is_submodular(self) -> bool:
        """Whether marginals diminish."""
        return self in (FunctionClass.SUBMODULAR, FunctionClass.CURVATURE)

    @property
    def is_parametric(self) -> bool:
        """Whether the class depends on a curvature value."""
        return self in (FunctionClass.TOTAL_CURVATURE, FunctionClass.CURVATURE)


@dataclass(frozen=True, slots=True)
class Ground:
    """Named elements and the robot that owns each; a set is *feasible* with at most one element per robot."""

    names: tuple[str, ...]
    owner: tuple[int, ...]

    def __post_init__(self) -> None:
        if len(set(self.names)) != len(self.names) or len(self.names) != len(self.owner):
            raise InputError("ground", "must give every element one distinct name and one owner", self.names)

    @property
    def n(self) -> int:
        """Number of elements."""
        return len(self.names)

    def mask(self, elements: Iterable[str]) -> int:
        """Bit mask of a set of names."""
        return sum(1 << self.names.index(name) for name in set(elements))

    def members(self, mask: int) -> tuple[int, ...]:
        """Indices of the elements of ``mask``."""
        return _members(mask)

    def is_feasible(self, mask: int) -> bool:
        """Whether no robot owns two elements of ``mask``."""
        owners = [self.owner[e] for e in _members(mask)]
        return len(set(owners)) == len(owners)

    def text(self, mask: int) -> str:
        """``f(a,b)`` for the set of ``mask``."""
        return f"f({','.join(self.names[e] for e in self.members(mask))})"


@cache
def _members(mask: int) -> tuple[int, ...]:
    return tuple(e for e in range(mask.bit_length()) if mask >> e & 1)


Key = int | str
"""A function value (bit mask > 0) or a named auxiliary number."""


@dataclass(frozen=True, slots=True)
class Linear:
    """``sum of coefficient * value``; the value of the empty set is zero and never stored."""

    terms: Mapping[Key, Polynomial] = field(default_factory=dict)

    def __hash__(self) -> int:
        return hash(frozenset(self.terms.items()))

    @staticmethod
    def of(key: Key, coefficient: Polynomial = ONE) -> Linear:
        """One term."""
        return Linear({key: coefficient} if key != 0 and coefficient else {})

    def __add__(self, other: Linear) -> Linear:
        total = dict(self.terms)
        for key, coefficient in other.terms.items():
            total[key] = total.get(key, ZERO) + coefficient
        return Linear({key: value for key, value in total.items() if value})

    def __mul__(self, factor: Polynomial) -> Linear:
        return Linear({key: product for key, value in self.terms.items() if (product := value * factor)})

    def __neg__(self) -> Linear:
        return self * constant(-1)

    def __sub__(self, other: Linear) -> Linear:
        return self + -other

    @property
    def degree(self) -> int:
        """Largest power of ``t`` in a coefficient."""
        return max((value.degree for value in self.terms.values()), default=0)

    def reduced(self) -> Linear:
        """Divide by the largest common power of ``t``: for ``t > 0`` the sign stays, so the claim gets no weaker."""
        power = min((value.lowest_power() for value in self.terms.values()), default=0)
        return Linear({key: value.shifted(power) for key, value in self.terms.items()})

    def value(self, values: Mapping[Key, Fraction], t: Fraction) -> Fraction:
        """Exact value for given function values at ``t = 1 - curvature``."""
        return sum((coefficient(t) * values[key] for key, coefficient in self.terms.items()), Fraction(0))

    def text(self, ground: Ground, symbol: str) -> str:
        """Readable form, larger sets last."""
        parts = []
        for key in sorted(self.terms, key=lambda k: (isinstance(k, str), str(k) if isinstance(k, str) else k)):
            name = key if isinstance(key, str) else ground.text(key)
            coefficient = self.terms[key].text(symbol)
            if " " in coefficient:
                coefficient = f"[{coefficient}]"
            plain = {"1": name, "-1": f"-{name}"}
            parts.append(plain.get(coefficient, f"{coefficient}*{name}"))
        return signed_sum(parts)


@dataclass(frozen=True, slots=True)
class Inequality:
    """``expression >= 0``, with the reason or role it stands for, which is no part of the statement."""

    reason: str = field(compare=False)
    expression: Linear


@dataclass(frozen=True, slots=True, kw_only=True)
class Claim:
    """For every function of the class on ``ground`` that satisfies ``premises``: ``conclusion >= 0``.

    ``sides`` : (left, right) where the claim is ``left >= right`` and the best factor on the right makes sense.
    Claims are equal when they are the same question: neither reasons nor sides count.
    """

    function_class: FunctionClass
    ground: Ground
    premises: tuple[Inequality, ...] = ()
    conclusion: Linear
    sides: tuple[Linear, Linear] | None = field(default=None, compare=False)

    @property
    def symbol(self) -> str:
        """Letter of the curvature in texts."""
        return self.function_class.symbol

    @property
    def expressions(self) -> tuple[Linear, ...]:
        """Everything the claim speaks of, premises first."""
        return (*(premise.expression for premise in self.premises), self.conclusion)

    @property
    def sets(self) -> tuple[int, ...]:
        """Bit masks of the sets whose values occur, ascending."""
        return tuple(sorted({key for e in self.expressions for key in e.terms if isinstance(key, int)}))

    @property
    def auxiliaries(self) -> tuple[str, ...]:
        """Names of the numbers that are not function values, in order of appearance."""
        return tuple(dict.fromkeys(key for e in self.expressions for key in e.terms if isinstance(key, str)))

    def text(self, expression: Linear | None = None) -> str:
        """The conclusion (or another inequality on these elements) as ``... >= 0``."""
        return f"{(expression or self.conclusion).text(self.ground, self.symbol)} >= 0"
