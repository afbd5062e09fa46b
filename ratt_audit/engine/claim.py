"""The language of the cone: ground sets with robots, linear expressions, claims.

A claim reads: for every set function of this class on these elements that satisfies
these premises, this linear expression in its values is at least zero.

A class is a polyhedral cone of tables. The elementary inequalities that span its dual cone are listed by key, so
that a proof can name each one and a checker can rebuild it from the name alone. ``feasible`` lists only those among
sets with one element per robot: they hold for more functions (the curvature is then over feasible sets), so a proof
from them is stronger.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache
from itertools import combinations
from typing import TYPE_CHECKING

from ratt_audit.engine.polynomials import ONE, ZERO, Polynomial, T, constant, signed_sum
from ratt_opt.errors import InputError, ProofError
from ratt_opt.worst_ratio.function_class import FunctionClass

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

__all__ = ["Claim", "Elementary", "Ground", "Inequality", "Linear", "elementary",
           "elementary_keys", "largest_marginal"]  # fmt: skip


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

    @staticmethod
    @cache
    def members(mask: int) -> tuple[int, ...]:
        """Indices of the elements of ``mask``."""
        return tuple(e for e in range(mask.bit_length()) if mask >> e & 1)

    def is_feasible(self, mask: int) -> bool:
        """Tell whether no robot owns two elements of ``mask``."""
        owners = [self.owner[e] for e in self.members(mask)]
        return len(set(owners)) == len(owners)

    def text(self, mask: int) -> str:
        """``f(a,b)`` for the set of ``mask``."""
        return f"f({','.join(self.names[e] for e in self.members(mask))})"


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
    """Claim that ``conclusion >= 0`` for every function of the class on ``ground`` that satisfies ``premises``.

    ``sides`` : (left, right) if the claim is ``left >= right`` and the best factor on the right makes sense.
    Claims are equal when they are the same question: neither reasons nor sides count.
    """

    function_class: FunctionClass
    ground: Ground
    premises: tuple[Inequality, ...] = ()
    conclusion: Linear
    sides: tuple[Linear, Linear] | None = field(default=None, compare=False)

    @property
    def expressions(self) -> tuple[Linear, ...]:
        """Expressions of the claim, premises first."""
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
        return f"{(expression or self.conclusion).text(self.ground, self.function_class.symbol)} >= 0"


@dataclass(frozen=True, slots=True, order=True)
class Elementary:
    """Name of an elementary inequality: a rule, one or two elements, and the set they are added to.

    Rules: ``monotone`` f(S+x) >= f(S); ``low`` f(S+x) - f(S) >= (1-c) m(x); ``high`` f(S+x) - f(S) <= m(x),
    the largest marginal of x; ``diminishing`` f(S+x) + f(S+y) >= f(S+x+y) + f(S);
    ``curvature`` f(S+x) - f(S) >= (1-k) f(x).
    """

    rule: str
    elements: tuple[int, ...]
    base: int


_RULES = {
    FunctionClass.NON_DECREASING: ("monotone",),
    FunctionClass.TOTAL_CURVATURE: ("low", "high", "monotone"),
    FunctionClass.SUBMODULAR: ("diminishing", "monotone"),
    FunctionClass.CURVATURE: ("diminishing", "curvature", "monotone"),
}


def largest_marginal(ground: Ground, element: int) -> str:
    """Name of the auxiliary number m(x) >= every marginal of element x."""
    return f"m({ground.names[element]})"


def elementary(function_class: FunctionClass, ground: Ground, key: Elementary) -> Inequality:
    """Rebuild the inequality that ``key`` names; raises ``ProofError`` if it names none of this class."""
    x = key.elements[0]
    added = sum(1 << e for e in key.elements)
    is_repeated = key.base & added or len(set(key.elements)) != len(key.elements)
    is_outside = (key.base | added) >> ground.n or (key.rule == "diminishing") != (len(key.elements) == 2)
    if key.rule not in _RULES[function_class] or is_repeated or is_outside:
        raise ProofError(f"{key} is no elementary inequality of the class '{function_class.value}'")
    marginal = Linear.of(key.base | 1 << x) - Linear.of(key.base)
    name, base = ground.names[x], ground.text(key.base)[2:-1] or "nothing"
    if key.rule == "monotone":
        return Inequality(f"adding {name} to {{{base}}} does not lose", marginal)
    text, largest = f"the marginal of {name} at {{{base}}} is at", largest_marginal(ground, x)
    if key.rule == "low":
        return Inequality(f"{text} least (1-c) m({name})", marginal - Linear.of(largest, T))
    if key.rule == "high":
        return Inequality(f"{text} most m({name})", Linear.of(largest) - marginal)
    if key.rule == "curvature":
        return Inequality(f"{text} least (1-k) f({name})", marginal - Linear.of(1 << x, T))
    y = key.elements[1]
    later = Linear.of(key.base | added) - Linear.of(key.base | 1 << y)
    return Inequality(f"{name} adds no more to {{{base}}} once {ground.names[y]} is there", marginal - later)


def elementary_keys(function_class: FunctionClass, ground: Ground, *, feasible: bool) -> Iterator[Elementary]:
    """Yield enough elementary inequalities to span the class (redundant ones are left out)."""

    def fits(base: int, x: int) -> bool:
        clashes = feasible and any(ground.owner[e] == ground.owner[x] for e in ground.members(base))
        return not base >> x & 1 and not clashes

    for base in (m for m in range(1 << ground.n) if not feasible or ground.is_feasible(m)):
        free = [x for x in range(ground.n) if fits(base, x)]
        for x in free:
            # Nothing can be added after x when what is free beside it is barred, being of the same robot.
            is_last = all(y == x or (feasible and ground.owner[y] == ground.owner[x]) for y in free)
            yield from (Elementary(rule, (x,), base) for rule in _single_rules(function_class, base, is_last=is_last))
        if function_class.is_submodular:
            for x, y in combinations(free, 2):
                if not feasible or ground.owner[x] != ground.owner[y]:
                    yield Elementary("diminishing", (x, y), base)


def _single_rules(function_class: FunctionClass, base: int, *, is_last: bool) -> tuple[str, ...]:
    """Rules for adding one element to ``base``."""
    if function_class is FunctionClass.NON_DECREASING:
        return ("monotone",)
    if function_class is FunctionClass.TOTAL_CURVATURE:
        # With c = 0 the two bounds below allow negative weights.
        return ("low", "high") if base else ("monotone", "low", "high")
    # Diminishing marginals: the smallest one is at the largest set.
    smallest = ("monotone", "curvature") if function_class is FunctionClass.CURVATURE and base else ("monotone",)
    return smallest if is_last else ()
