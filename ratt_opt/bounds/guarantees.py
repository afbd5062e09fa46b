"""Guarantees on RATT's worst-case value as a share of the optimum, known from the curvature alone.

Each is a number in [0, 1] with its hypotheses; a curvature may be a number or a bracket, whose upper (conservative)
end is then used. The curvature must be taken over a domain that holds every set the proof meets: the feasible sets
(at most one element per robot) suffice for all of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Protocol, Self, TypeVar, runtime_checkable

from ratt_opt._validation import check_integer, check_number
from ratt_opt.errors import InputError

__all__ = [
    "Guarantee",
    "all_bait_group_bound",
    "needs_of",
    "pattern_free_bound",
    "remark1_bound",
    "sensing_only_bound",
    "theorem1_bound",
]

SUBMODULAR = "normalised, non-decreasing, submodular"
NON_DECREASING = "normalised, non-decreasing"


@runtime_checkable
class HasUpper(Protocol):
    """Anything with a proved upper end."""

    @property
    def upper(self) -> float:
        """Proved upper end."""


@dataclass(frozen=True, eq=False, repr=False)
class Guarantee(float):
    """A share of the optimum that is guaranteed, with its hypotheses, its source and its proof.

    ``proof`` : the function of this library whose documentation has the proof, and the theorem in ``formal/`` if
    there is one; empty if only the source has the proof. It is a number: equal, as numbers are, to
    what has its ``value``.
    """

    value: float
    hypotheses: tuple[str, ...]
    source: str
    proof: str = ""

    def __new__(cls, value: float, hypotheses: tuple[str, ...], source: str, proof: str = "") -> Self:  # noqa: ARG004  (fields)
        """Make the number; the fields follow."""
        return super().__new__(cls, value)

    def __post_init__(self) -> None:
        object.__setattr__(self, "value", float(self.value))

    # Copies are made by ``__new__``, which needs all fields.
    def __getnewargs__(self) -> tuple[float, tuple[str, ...], str, str]:  # type: ignore[override]
        return self.value, self.hypotheses, self.source, self.proof

    __str__ = float.__repr__

    def __repr__(self) -> str:
        return f"Guarantee({self.value!r}, {self.source!r})"

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "value": self.value,
            "hypotheses": list(self.hypotheses),
            "source": self.source,
            "proof": self.proof,
        }


IN_COQ = {"k": "ratt_submodular", "c": "ratt_non_decreasing"}


def _by_pattern_free(kind: str) -> str:
    """Name the proofs of a bound that is no larger than the pattern-free one."""
    return f"pattern_free_bound; in Coq {IN_COQ[kind]}"


Curvatures = float | HasUpper | None
Share = TypeVar("Share", float, Fraction)
"""A formula's number, in floating point or exact."""


def theorem1_bound(alpha_cs: int, *, k: Curvatures = None, c: Curvatures = None, all_bait: bool = False) -> Guarantee:
    """The paper's bound for RATT under sensing and link attacks.

    ``min[(1-c)^3, (1-c)^2 / alpha_cs]`` from the total curvature ``c``; ``min[(1-k)/(1+k), (1-k)/alpha_cs]`` from
    the curvature ``k`` of a submodular objective. With ``alpha_cs = 0`` the second terms, which divide by it, concern
    groups that do not exist and are absent. With ``all_bait`` (``alpha >= N``) the appendix proves ``(1-c)^2``
    and ``1-k``. Give exactly one of ``k`` and ``c``.

    Raises
    ------
    InputError : neither or both curvatures, one outside [0, 1], or a negative ``alpha_cs``.

    Source: ratt.tex, Theorem 1; eq:nd2 and eq:sub2 for all bait. Its proof there has gaps: see
    ``docs/researchers/audit.md``. :func:`pattern_free_bound` is at least as large, and proved.
    """
    alpha_cs = check_integer("alpha_cs", alpha_cs, low=0)
    kind, value = one_curvature(k, c)
    keep = 1 - value
    if kind == "k":
        bound = keep if all_bait else min(keep / (1 + value), keep / max(alpha_cs, 1))
    else:
        bound = keep**2 if all_bait else min(keep**3, keep**2 / max(alpha_cs, 1))
    return Guarantee(bound, needs_of(kind, "RATT's plan"), "ratt.tex, Theorem 1", _by_pattern_free(kind))


def remark1_bound(*, k: Curvatures = None, c: Curvatures = None) -> Guarantee:
    """The paper's bound for the myopic plan (all bait): ``1-k``, respectively ``(1-c)^2``.

    Raises
    ------
    InputError : neither or both curvatures, or one outside [0, 1].

    Source: ratt.tex, Remark 1.
    """
    kind, value = one_curvature(k, c)
    bound = 1 - value if kind == "k" else (1 - value) ** 2
    return Guarantee(bound, needs_of(kind, "the myopic plan"), "ratt.tex, Remark 1", _by_pattern_free(kind))


def sensing_only_bound(*, k: Curvatures = None, c: Curvatures = None) -> Guarantee:
    """Bound of the prior work without link attacks: ``(1-k)/(1+k)``, respectively ``(1-c)^3``.

    Raises
    ------
    InputError : neither or both curvatures, or one outside [0, 1].

    Source: Tzoumas, Jadbabaie, Pappas 2018, Theorem 1, as ratt.tex quotes it after its Theorem 2.
    """
    kind, value = one_curvature(k, c)
    bound = (1 - value) / (1 + value) if kind == "k" else (1 - value) ** 3
    needs = needs_of(kind, "RATT's plan", "no link attacks (alpha_c = 0)")
    return Guarantee(bound, needs, "Tzoumas et al. 2018, Theorem 1", _by_pattern_free(kind))


def pattern_free_bound(*, k: Curvatures = None, c: Curvatures = None) -> Guarantee:
    """``1-k``, respectively ``(1-c)^2``, whatever the budgets, the graph and the attack: at least Theorem 1's bounds.

    Proof. Let ``u`` be a plan in which each robot is bait (individually best element) or was chosen greedily in
    some order, ``o`` any plan, ``S`` any set of robots, ``G_i`` the elements chosen greedily before robot ``i``'s.

    Submodular, curvature ``k``. For greedy robots of ``S`` in greedy order, submodularity, the greedy choice (robot
    ``i`` could have taken ``o_i``) and the curvature give
    ``phi(u_Sg) >= sum_i marg(u_i | G_i) >= sum_i marg(o_i | G_i) >= (1-k) sum_i phi(o_i)``. Each bait ``b`` adds at
    least ``(1-k) phi(u_b) >= (1-k) phi(o_b)`` to any set. Hence ``phi(u_S) >= (1-k) sum_S phi(o_i) >= (1-k) phi(o_S)``,
    the last by submodularity.

    Non-decreasing, total curvature ``c``. Let ``m_x`` be the largest marginal of ``x``; every marginal of ``x`` lies
    in ``[(1-c) m_x, m_x]``. Greedy (by its marginals given ``G_i``) or bait (by its value),
    ``m_(u_i) >= (1-c) m_(o_i)``, so ``phi(u_S) >= (1-c) sum_S m_(u_i) >= (1-c)^2 sum_S m_(o_i) >= (1-c)^2 phi(o_S)``.

    As this holds for every ``S`` it holds for every group of every outcome, hence for the best group and
    after the worst attack. All sets met hold at most one element per robot.

    Raises
    ------
    InputError : neither or both curvatures, or one outside [0, 1].

    Source: this library. The bound ``1-k`` is attained (N = 4, alpha_s = 0, alpha_c = 3, k = 0.3).
    """
    kind, value = one_curvature(k, c)
    bound = 1 - value if kind == "k" else (1 - value) ** 2
    needs = needs_of(kind, "each robot is bait or chosen greedily")
    return Guarantee(bound, needs, "pattern-free bound (this library)", _by_pattern_free(kind))


def all_bait_group_bound(size: int, *, k: Curvatures = None, c: Curvatures = None) -> Guarantee:
    """Bound for a surviving group of ``g = size`` bait robots.

    ``(1 + (g-1)(1-k)) / g``, respectively ``(1 + (g-1)(1-c)) / (1 + (g-1)/(1-c))``.

    Proof. Number the group so that ``phi(u_1)`` is its largest value; it is worth at least every ``phi(o_i)`` of the
    group. Submodular: ``phi(u_S) >= phi(u_1) + (1-k) sum_rest phi(u_i)`` with ``phi(u_i) >= phi(o_i)``, and
    ``phi(o_S) <= sum phi(o_i)``; the ratio is smallest when all ``phi(o_i)`` are equal. Non-decreasing:
    ``phi(u_S) >= phi(u_1) + (1-c) sum_rest phi(u_i)`` and, taking the largest ``phi(o_i)`` first,
    ``phi(o_S) <= phi(o_1) + sum_rest phi(o_i) / (1-c)``, with the same extreme.

    Raises
    ------
    InputError : neither or both curvatures, one outside [0, 1], or ``size < 1``.

    Source: this library.
    """
    g = check_integer("size", size, low=1)
    kind, value = one_curvature(k, c)
    keep = 1 - value
    if kind == "k":
        bound = (1 + (g - 1) * keep) / g
    else:
        bound = (1 + (g - 1) * keep) / (1 + (g - 1) / keep) if keep > 0 else float(g == 1)
    needs = needs_of(kind, f"a group of {g} bait robots survives")
    return Guarantee(bound, needs, "all-bait group bound (this library)", "all_bait_group_bound")


def one_curvature(k: Curvatures, c: Curvatures) -> tuple[str, float]:
    """Name and conservative end of the one of the two that is given.

    Raises
    ------
    InputError : neither or both, or one outside [0, 1].
    """
    if (k is None) == (c is None):
        raise InputError("k, c", "must be given one at a time", "neither" if k is None else "both")
    name, given = ("k", k) if k is not None else ("c", c)
    value = check_number(name, given.upper if isinstance(given, HasUpper) and not isinstance(given, str) else given)
    if not 0 <= value <= 1:
        raise InputError(name, "must be in [0, 1]", value)
    return name, value


def needs_of(kind: str, *more: str) -> tuple[str, ...]:
    """Hypotheses of a guarantee by a curvature: the function's class, its curvature, and ``more``."""
    if kind == "k":
        return (SUBMODULAR, "curvature at most k", *more)
    return (NON_DECREASING, "total curvature at most c", *more)
