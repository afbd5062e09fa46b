"""The elementary inequalities that span each class's dual cone.

A class is a polyhedral cone of tables. Its elementary inequalities are listed by key, so
that a proof can name each one and a checker can rebuild it from the name alone.

``feasible`` lists only those among sets with one element per robot: they hold for more
functions (the curvature is then over feasible sets), so a proof from them is stronger.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ratt_opt.audit.engine.claim import FunctionClass, Ground, Inequality, Linear
from ratt_opt.audit.engine.polynomial import T
from ratt_opt.errors import ProofError

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["Elementary", "elementary", "elementary_keys", "largest_marginal"]


@dataclass(frozen=True, slots=True, order=True)
class Elementary:
    """Name of an elementary inequality: a rule, one or two elements, and the set they are added to.

    Rules: ``monotone`` f(S+x) >= f(S); ``low`` f(S+x) - f(S) >= (1-c) m(x); ``high`` f(S+x) - f(S) <= m(x), where
    m(x) is the largest marginal of x; ``diminishing`` f(S+x) + f(S+y) >= f(S+x+y) + f(S);
    ``curvature`` f(S+x) - f(S) >= (1-k) f(x).
    """

    rule: str
    elements: tuple[int, ...]
    base: int


_RULES = {
    FunctionClass.ANY: (),
    FunctionClass.NON_DECREASING: ("monotone",),
    FunctionClass.TOTAL_CURVATURE: ("low", "high", "monotone"),
    FunctionClass.SUBMODULAR: ("diminishing", "monotone"),
    FunctionClass.CURVATURE: ("diminishing", "curvature", "monotone"),
}


def largest_marginal(ground: Ground, element: int) -> str:
    """Name of the auxiliary number m(x) >= every marginal of element x."""
    return f"m({ground.names[element]})"


def elementary(function_class: FunctionClass, ground: Ground, key: Elementary) -> Inequality:
    """Rebuild the inequality that ``key`` names.

    Raises
    ------
    ProofError : the key names no elementary inequality of this class.
    """
    x = key.elements[0]
    added = sum(1 << e for e in key.elements)
    if key.rule not in _RULES[function_class] or key.base & added or len(set(key.elements)) != len(key.elements):
        raise ProofError(f"{key} is no elementary inequality of the class '{function_class.value}'")
    if (key.rule == "diminishing") != (len(key.elements) == 2) or key.base >> ground.n or added >> ground.n:
        raise ProofError(f"{key} is no elementary inequality of the class '{function_class.value}'")
    marginal = Linear.of(key.base | 1 << x) - Linear.of(key.base)
    name, base = ground.names[x], ground.text(key.base)[2:-1] or "nothing"
    if key.rule == "monotone":
        return Inequality(f"adding {name} to {{{base}}} does not lose", marginal)
    if key.rule == "low":
        return Inequality(
            f"the marginal of {name} at {{{base}}} is at least (1-c) m({name})",
            marginal - Linear.of(largest_marginal(ground, x), T),
        )
    if key.rule == "high":
        return Inequality(
            f"the marginal of {name} at {{{base}}} is at most m({name})",
            Linear.of(largest_marginal(ground, x)) - marginal,
        )
    if key.rule == "curvature":
        return Inequality(
            f"the marginal of {name} at {{{base}}} is at least (1-k) f({name})", marginal - Linear.of(1 << x, T)
        )
    y = key.elements[1]
    later = Linear.of(key.base | added) - Linear.of(key.base | 1 << y)
    return Inequality(f"{name} adds no more to {{{base}}} once {ground.names[y]} is there", marginal - later)


def elementary_keys(function_class: FunctionClass, ground: Ground, *, feasible: bool) -> Iterator[Elementary]:
    """Yield enough elementary inequalities to span the class (redundant ones are left out)."""
    sets = [m for m in range(1 << ground.n) if not feasible or ground.is_feasible(m)]
    for base in sets:
        free = [x for x in range(ground.n) if not base >> x & 1 and (not feasible or _fits(ground, base, x))]
        for x in free:
            yield from _single(function_class, base, x, is_last=_is_last(ground, x, free, feasible=feasible))
        if function_class.is_submodular:
            for i, x in enumerate(free):
                for y in free[i + 1 :]:
                    if not feasible or ground.owner[x] != ground.owner[y]:
                        yield Elementary("diminishing", (x, y), base)


def _single(function_class: FunctionClass, base: int, x: int, *, is_last: bool) -> Iterator[Elementary]:
    if function_class is FunctionClass.NON_DECREASING:
        yield Elementary("monotone", (x,), base)
    elif function_class is FunctionClass.TOTAL_CURVATURE:
        if not base:
            # With c = 0 the two bounds below allow negative weights.
            yield Elementary("monotone", (x,), base)
        yield Elementary("low", (x,), base)
        yield Elementary("high", (x,), base)
    elif is_last and function_class is not FunctionClass.ANY:
        # Diminishing marginals: the smallest one is at the largest set.
        yield Elementary("monotone", (x,), base)
        if function_class is FunctionClass.CURVATURE and base:
            yield Elementary("curvature", (x,), base)


def _fits(ground: Ground, base: int, x: int) -> bool:
    return all(ground.owner[e] != ground.owner[x] for e in ground.members(base))


def _is_last(ground: Ground, x: int, free: list[int], *, feasible: bool) -> bool:
    """Whether nothing can be added after ``x``: what is free beside it is barred, being of the same robot."""
    return all(y == x or (feasible and ground.owner[y] == ground.owner[x]) for y in free)
