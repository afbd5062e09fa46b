"""Claims about sizes, groups and patterns, decided by exhaustive enumeration.

An arrangement of N robots says how many baits and how many greedy robots each group has.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations_with_replacement, product
from typing import TYPE_CHECKING

from ratt_opt.audit.decide import Verdict
from ratt_opt.audit.entry import Counted, EnumeratedEntry
from ratt_opt.graph.caa import caa

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["arrangement_entries", "partitions"]

LARGEST = 8

SURVIVES_BY = {
    "caa_determines_groups": "eqn:appro_non_descrease/theorem",
    "caa_counts_groups": "eqn:appro_non_descrease/theorem",
    "pattern2_sizes": "nd_p2/cumulative",
    "patterns_cover": "nd1/cumulative",
    "nd1": "nd1/cumulative",
    "pattern2_distributions_cover": "nd_p2/cumulative",
    "nd_p1d3v1_sizes": "nd_p1d3v1_7/cumulative",
    "nd_p1d3v1_4_counts": "nd_p1d3v1_7/cumulative",
    "sub_p2d1v1_sizes": "sub_p2d1v1_10/cumulative",
    "bound_defined": "pattern_free_nd/theorem",
}
"""Label of a claim -> label and kind of the entry that shows the conclusion without it."""

SERVES_BY = {"nd_p1d3v1_4_counts": "nd_p1d3v1_4_counts_repaired/claim"}
"""Label of a claim -> label and kind of the weaker or repaired claim that the proof could use."""


@dataclass(frozen=True, slots=True)
class Budgets:
    """One instance's numbers: N, alpha_s, alpha_c and what RATT derives from them."""

    n_robots: int
    alpha_s: int
    alpha_c: int

    @property
    def alpha_cs(self) -> int:
        """Equivalent sensing attacks."""
        return caa(self.n_robots, self.alpha_c).alpha_cs

    @property
    def alpha(self) -> int:
        """Number of baits, when smaller than N."""
        return self.alpha_s + self.alpha_cs

    @property
    def n_max(self) -> int:
        """Largest group by CAA."""
        return self.n_robots - self.alpha_cs

    def text(self) -> str:
        """The numbers in words."""
        return f"N = {self.n_robots}, alpha_s = {self.alpha_s}, alpha_c = {self.alpha_c}, alpha_cs = {self.alpha_cs}"


def partitions(total: int, largest: int) -> Iterator[tuple[int, ...]]:
    """Integer partitions of ``total`` with parts at most ``largest``, largest first."""
    if total == 0:
        yield ()
        return
    for part in range(min(total, largest), 0, -1):
        for rest in partitions(total - part, part):
            yield (part, *rest)


def _cut(sizes: tuple[int, ...]) -> int:
    total = sum(sizes)
    return total * (total - 1) // 2 - sum(s * (s - 1) // 2 for s in sizes)


def _budgets(largest: int) -> Iterator[Budgets]:
    for n_robots in range(2, largest + 1):
        for alpha_c in range(n_robots * (n_robots - 1) // 2 + 1):
            for alpha_s in range(n_robots + 1):
                yield Budgets(n_robots, alpha_s, alpha_c)


def _verdict(cases: list[str], sizes: str, checked: int, what: str) -> Counted:
    verdict = Verdict.REFUTED if cases else Verdict.PROVED
    return Counted(
        verdict=verdict,
        sizes=sizes,
        detail=f"{checked} {what} enumerated, {len(cases)} break the claim",
        cases=tuple(cases[:3]),
    )


def _caa_is_exact() -> Counted:
    bad, count = [], 0
    for n_robots in range(1, 13):
        for alpha_c in range(n_robots * (n_robots - 1) // 2 + 1):
            count += 1
            least = min(max(sizes) for sizes in partitions(n_robots, n_robots) if _cut(sizes) <= alpha_c)
            if least != caa(n_robots, alpha_c).n_max:
                bad.append(f"N = {n_robots}, alpha_c = {alpha_c}: smallest possible largest group {least}")
    return _verdict(bad, "N <= 12, every alpha_c", count, "pairs (N, alpha_c)")


def _caa_split(n_robots: int, n_max: int) -> tuple[int, ...]:
    full, rest = divmod(n_robots, n_max)
    return (n_max,) * full + ((rest,) if rest else ())


def _best_packing(weights: tuple[int, ...], sizes: tuple[int, ...]) -> int:
    """Least possible value of the best group over all ways to fill groups of these sizes, f additive."""
    best = sum(weights)
    for homes in product(range(len(sizes)), repeat=len(weights)):
        if all(homes.count(k) == size for k, size in enumerate(sizes)):
            best = min(
                best, max(sum(w for w, h in zip(weights, homes, strict=True) if h == k) for k in range(len(sizes)))
            )
    return best


def _caa_determines_groups() -> Counted:
    bad, count = [], 0
    for n_robots in range(2, 6):
        for alpha_c in range(n_robots * (n_robots - 1) // 2 + 1):
            split = _caa_split(n_robots, caa(n_robots, alpha_c).n_max)
            allowed = [sizes for sizes in partitions(n_robots, n_robots) if _cut(sizes) <= alpha_c]
            for weights in combinations_with_replacement(range(1, 4), n_robots):
                count += 1
                by_caa = _best_packing(weights, split)
                worst = min((_best_packing(weights, sizes), sizes) for sizes in allowed)
                if worst[0] < by_caa:
                    bad.append(
                        f"N = {n_robots}, alpha_c = {alpha_c}, additive f with values {weights}: CAA's groups {split} "
                        f"leave at least {by_caa}, groups {worst[1]} leave {worst[0]}"
                    )
    return _verdict(bad, "N <= 5, additive f with values 1 to 3", count, "functions and budgets")


def _caa_counts_groups() -> Counted:
    bad, count = [], 0
    for n_robots in range(2, LARGEST + 1):
        for alpha_c in range(n_robots * (n_robots - 1) // 2 + 1):
            count += 1
            split = _caa_split(n_robots, caa(n_robots, alpha_c).n_max)
            finer = [s for s in partitions(n_robots, split[0]) if _cut(s) <= alpha_c and len(s) > len(split)]
            if finer:
                bad.append(
                    f"N = {n_robots}, alpha_c = {alpha_c}: CAA's groups {split}, but {finer[0]} is within the budget"
                )
    return _verdict(bad, f"N <= {LARGEST}", count, "pairs (N, alpha_c)")


Arrangement = tuple[tuple[int, int], ...]
"""Groups as (baits, greedy robots)."""


def _arrangements(budgets: Budgets) -> Iterator[Arrangement]:
    """Every way to fill CAA's own groups with RATT's baits and greedy robots (the paper's most favourable reading)."""
    sizes = _caa_split(budgets.n_robots, budgets.n_max)
    seen = set()
    for greedy in product(*(range(size + 1) for size in sizes)):
        if sum(greedy) == budgets.n_robots - budgets.alpha:
            arrangement = tuple(sorted(((s - g, g) for s, g in zip(sizes, greedy, strict=True)), reverse=True))
            if arrangement not in seen:
                seen.add(arrangement)
                yield arrangement


def _is_pattern1(arrangement: Arrangement, budgets: Budgets) -> bool:
    rest = budgets.n_robots - budgets.alpha
    return any(b == budgets.alpha_s and g == rest for b, g in arrangement)


def _is_pattern2(arrangement: Arrangement, budgets: Budgets) -> bool:
    rest = budgets.n_robots - budgets.alpha
    for i, (b1, g1) in enumerate(arrangement):
        for j, (b2, g2) in enumerate(arrangement):
            holds = g1 + g2 == rest and b1 == budgets.alpha_s + g2 and b2 + g2 <= budgets.alpha_cs and b2 > 0
            if i != j and holds:
                return True
    return False


def _patterns_cover() -> Counted:
    bad, count = [], 0
    for budgets in _budgets(LARGEST):
        if budgets.alpha >= budgets.n_robots:
            continue
        for arrangement in _arrangements(budgets):
            count += 1
            if not _is_pattern1(arrangement, budgets) and not _is_pattern2(arrangement, budgets):
                groups = ", ".join(f"{b} bait + {g} greedy" for b, g in arrangement)
                bad.append(f"{budgets.text()}: groups {groups}")
    return _verdict(bad, f"N <= {LARGEST}, N > alpha, CAA's own groups", count, "arrangements")


def _every_budget(check: Callable[[Budgets], str], sizes: str, what: str = "budgets") -> Counted:
    """``check`` returns what is wrong at one budget, or the empty string; budgets with N <= alpha are left out."""
    bad, count = [], 0
    for budgets in _budgets(LARGEST):
        if budgets.alpha < budgets.n_robots:
            count += 1
            if fault := check(budgets):
                bad.append(f"{budgets.text()}: {fault}")
    return _verdict(bad, sizes, count, what)


def _pattern1_size(b: Budgets) -> str:
    size = b.alpha_s + b.n_robots - b.alpha
    return "" if size == b.n_max else f"|V1| = {size}, n_max = {b.n_max}"


def _pattern2_sizes(b: Budgets) -> str:
    """With |V1| = n_max and g2 greedy robots in V2, V1 has n_max - (N - alpha - g2) baits; V2 is in the rest."""
    for g2 in range(1, b.n_robots - b.alpha + 1):
        if b.n_max - (b.n_robots - b.alpha - g2) != b.alpha_s + g2 or b.n_robots - b.n_max > b.alpha_cs:
            return f"|V2g| = {g2}"
    return ""


def _safe_baits(b: Budgets) -> str:
    """Distribution 3: V1b1 holds the baits beyond the alpha_s^1 of V1b2, out of |V1b| = alpha_s."""
    for part in range(1, b.alpha_s):
        if b.alpha - part != b.alpha_s - part:
            return (
                f"alpha_s^1 = {part}: |V1b1| = {b.alpha_s - part}, the text says alpha - alpha_s^1 = {b.alpha - part}"
            )
    return ""


def _safe_baits_submodular(b: Budgets) -> str:
    for g2 in range(1, min(b.n_robots - b.alpha, b.alpha_cs - 1) + 1):
        if b.alpha - b.alpha_s != g2:
            return f"|V2g| = {g2} = |V1b1|, the text says alpha - alpha_s^1 = {b.alpha - b.alpha_s} (all alpha_s in V1)"
    return ""


def _blinded_balance(b: Budgets) -> str:
    """|V1b \\ A*| = |V1g and A*| when |V1b| = |A*| = alpha_s."""
    for hit in range(min(b.alpha_s, b.n_robots - b.alpha) + 1):
        if b.alpha_s - (b.alpha_s - hit) != hit:
            return f"{hit} greedy robots blinded"
    return ""


def _wrong_balance(b: Budgets) -> str:
    """The reason of nd_p1d3v1_4 as written: |V1b1 \\ A*| = |V1g and A*|, with V1b1 never blinded."""
    for part in range(1, b.alpha_s):
        for hit in range(min(part, b.n_robots - b.alpha) + 1):
            if b.alpha_s - part != hit:
                return f"alpha_s^1 = {part}: |V1b1\\A*| = {b.alpha_s - part}, greedy robots blinded: {hit}"
    return ""


def _right_balance(b: Budgets) -> str:
    for part in range(1, b.alpha_s):
        for hit in range(min(part, b.n_robots - b.alpha) + 1):
            if part - (part - hit) != hit:
                return f"alpha_s^1 = {part}, greedy robots blinded: {hit}"
    return ""


def _distributions() -> Counted:
    """Pattern 2: the text lists all blinded robots in V1, all in V2, or part in V1 and the rest elsewhere."""
    bad, count = [], 0
    for total in range(1, 4):
        for v1, v2, v3 in product(range(total + 1), repeat=3):
            if v1 + v2 + v3 == total:
                count += 1
                if not (total in (v1, v2) or 0 < v1 < total):
                    bad.append(f"alpha_s = {total}: {v1} in V1, {v2} in V2, {v3} in V3")
    return _verdict(bad, "three groups, alpha_s <= 3", count, "distributions")


def _no_division_by_zero() -> Counted:
    bad, count = [], 0
    for budgets in _budgets(5):
        count += 1
        if budgets.alpha_cs == 0:
            bad.append(f"{budgets.text()}: the bound divides by zero")
    return _verdict(bad, "N <= 5, every budget", count, "budgets")


def _figure(n_bait_in_second: int) -> Counted:
    """N = 10, alpha_s = 2, alpha_c = 29: three groups, the largest of 5, 7 baits and 3 greedy robots."""
    b = Budgets(10, 2, 29)
    good = [s for s in partitions(10, 5) if len(s) == 3 and s[0] == 5 and _cut(s) <= 29 and s[1] > n_bait_in_second]
    fine = bool(good) and (b.n_max, b.alpha_cs, b.alpha) == (5, 5, 7)
    cases = [] if fine else [f"n_max = {b.n_max}, alpha_cs = {b.alpha_cs}, alpha = {b.alpha}, three groups: {good}"]
    return _verdict(
        cases, "N = 10, alpha_s = 2, alpha_c = 29", len(good), "splits into three groups with the largest of 5"
    )


def arrangement_entries() -> Iterator[EnumeratedEntry]:
    """Yield the pattern and distribution claims."""
    budgets = f"N <= {LARGEST}, every alpha_s and alpha_c with N > alpha"
    rows: tuple[tuple[str, str, str, Callable[[], Counted]], ...] = (
        ("caa_largest_group", "claim", "CAA's n_max is the smallest possible largest group", _caa_is_exact),
        (
            "caa_determines_groups",
            "claim",
            "a worst link attack leaves groups of the sizes CAA computes",
            _caa_determines_groups,
        ),
        ("caa_counts_groups", "claim", "CAA's q_n and r_n give the number of groups left", _caa_counts_groups),
        ("fig:p1_3d", "claim", "the example of Pattern 1 is consistent", lambda: _figure(0)),
        ("fig:p2_3d", "claim", "the example of Pattern 2 is consistent", lambda: _figure(1)),
        (
            "pattern1_sizes",
            "claim",
            "|V1| = n_max when V1 has alpha_s baits and all greedy robots",
            lambda: _every_budget(_pattern1_size, budgets),
        ),
        (
            "pattern2_sizes",
            "claim",
            "|V1| = n_max gives |V1b| = alpha_s + |V2g| and |V2| <= alpha_cs",
            lambda: _every_budget(_pattern2_sizes, budgets),
        ),
        ("patterns_cover", "claim", "every arrangement is Pattern 1 or Pattern 2", _patterns_cover),
        ("nd1", "step", "Patterns 1 and 2 give the bound for all arrangements (they cover them)", _patterns_cover),
        (
            "pattern2_distributions_cover",
            "claim",
            "Distributions 1 to 3 of Pattern 2 cover every sensing attack",
            _distributions,
        ),
        (
            "nd_p1d1v1_4_counts",
            "claim",
            "as many baits survive as greedy robots are blinded",
            lambda: _every_budget(_blinded_balance, budgets),
        ),
        ("nd_p1d3v1_sizes", "claim", "|V1b1| = alpha - alpha_s^1", lambda: _every_budget(_safe_baits, budgets)),
        (
            "nd_p1d3v1_4_counts",
            "claim",
            "|V1b1\\A*| = number of blinded greedy robots (as written)",
            lambda: _every_budget(_wrong_balance, budgets),
        ),
        (
            "nd_p1d3v1_4_counts_repaired",
            "claim",
            "|V1b2\\A*| = number of blinded greedy robots (repaired)",
            lambda: _every_budget(_right_balance, budgets),
        ),
        (
            "sub_p2d1v1_sizes",
            "claim",
            "|V1b1| = alpha - alpha_s^1 in Pattern 2'",
            lambda: _every_budget(_safe_baits_submodular, budgets),
        ),
        (
            "bound_defined",
            "claim",
            "Theorem 1's bound is defined for every budget (alpha_cs > 0)",
            _no_division_by_zero,
        ),
    )
    for label, kind, statement, run in rows:
        yield EnumeratedEntry(
            label=label,
            kind=kind,
            chain="patterns and sizes",
            statement=statement,
            hypotheses="RATT's and CAA's definitions",
            enumerate_cases=run,
            survives_by=SURVIVES_BY.get(label, ""),
            serves_by=SERVES_BY.get(label, ""),
        )
