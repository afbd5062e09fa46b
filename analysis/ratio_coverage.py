"""Print a table of ``docs/researchers/ratios.md``, on RATT's exact worst ratio.

Run as ``python -m analysis.ratio_coverage TABLE``. TABLE is ``coverage`` (budgets settled by proof and by
computation); ``values`` (their ratios beside the formulas); ``others`` (values that no conjecture was made from);
``threes`` (submodular, three robots left); ``large`` (submodular, six and seven robots); ``planners`` (the best of
three planners, bracketed); or ``best`` (exactly). Minutes each; with ``--quick`` the first rows only.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from analysis.ratios.best_of import best_of_three
from analysis.ratios.coverage_program import coverage_instance
from analysis.ratios.shared_plan import shared_plan_ratio
from ratt_opt import WorstCaseRatio, worst_case_ratio
from ratt_opt.bounds.survivors import survivor_share
from ratt_opt.graph.survivor_sizes import non_dominated_sizes
from ratt_opt.worst_ratio.closed_form import KnownRatio, known_ratio
from ratt_opt.worst_ratio.witness import RatioQuestion

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

__all__ = ["TABLES", "Budget", "Row", "budgets", "coverage", "row_of", "table"]

CURVATURE = Fraction(1, 4)
LARGEST = {"nondecreasing": 6, "submodular": 4}
"""Robots up to which every budget is computed: a second each, respectively."""
SECONDS = 60.0
STATUSES = ("proved", "computed", "open")
SINGLE = (
    ("nondecreasing", 5, 1, 0, Fraction(1, 5)),
    ("nondecreasing", 5, 1, 0, Fraction(1, 10)),
    ("nondecreasing", 7, 1, 0, Fraction(1, 4)),
    ("nondecreasing", 7, 3, 0, Fraction(1, 4)),
    ("submodular", 5, 2, 0, Fraction(1, 2)),
    ("submodular", 5, 2, 0, Fraction(3, 4)),
    ("submodular", 5, 1, 0, Fraction(3, 4)),
)
"""Values that no conjecture was made from."""
THREES = tuple(
    Fraction(n, d) for n, d in ((1, 8), (1, 4), (3, 8), (2, 5), (1, 2), (3, 5), (2, 3), (3, 4), (4, 5), (7, 8))
)
LARGE = tuple(
    (size, swapped, Fraction(k))
    for size, swapped in ((5, 1), (4, 2), (3, 3), (6, 1), (5, 2), (4, 3), (3, 4))
    for k in ("1/4", "2/5", "1/2", "3/4")
)
BEST = ((3, 0), (3, 1), (3, 2), (4, 0), (4, 1))
"""Robots, robots blinded."""
SHARED = ((3, 1, "nondecreasing"), (4, 1, "nondecreasing"), (4, 2, "nondecreasing"), (5, 2, "nondecreasing"),
          (5, 3, "nondecreasing"), (3, 1, "submodular"), (4, 2, "submodular"))  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class Budget:
    """Budgets that leave the same groups and make as many robots bait, hence have the same ratio.

    ``largest``, ``smallest`` : robots that see in the largest group, over the attacks that no other refines.
    """

    n_robots: int
    bait: int
    sizes: tuple[tuple[int, ...], ...]
    members: tuple[tuple[int, int], ...]

    @property
    def largest(self) -> int:
        """Most robots together."""
        return self.sizes[0][0]

    @property
    def smallest(self) -> int:
        """Fewest robots together."""
        return min(sizes[0] for sizes in self.sizes)

    @property
    def text(self) -> str:
        """The budgets in words."""
        return "; ".join(f"{s}, {c}" for s, c in self.members)


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One set of budgets with what is known and what was computed (``None``: nothing was)."""

    budget: Budget
    known: KnownRatio
    found: WorstCaseRatio | None

    @property
    def status(self) -> str:
        """Source of the ratio: proved, computed, or open."""
        if self.known.attained:
            return "proved"
        if self.found is not None and self.found.exact_lower == self.found.exact_upper:
            return "computed"
        return "open"

    @property
    def ratio(self) -> str:
        """The ratio, or its bracket."""
        if self.known.attained:
            return str(self.known.lower)
        if self.found is None:
            return f"at least {self.known.lower}"
        low, high = self.found.exact_lower, self.found.exact_upper
        return str(low) if low == high else f"[{low}, {high}]"


def _question(family: str, n_robots: int, alpha_s: int, alpha_c: int, curvature: Fraction) -> RatioQuestion:
    return RatioQuestion(n_robots=n_robots, alpha_s=alpha_s, alpha_c=alpha_c, curvature=curvature, family=family)


def budgets(n_robots: int) -> list[Budget]:
    """All budgets that leave a robot to see, those alike together."""
    alike: dict[tuple[tuple[tuple[int, ...], ...], int], list[tuple[int, int]]] = {}
    for alpha_s in range(n_robots):
        for alpha_c in range(n_robots * (n_robots - 1) // 2 + 1):
            bait = _question("submodular", n_robots, alpha_s, alpha_c, Fraction(0)).n_bait
            sizes = tuple(non_dominated_sizes(n_robots, alpha_s, alpha_c))
            alike.setdefault((sizes, bait), []).append((alpha_s, alpha_c))
    return [Budget(n_robots=n_robots, bait=b, sizes=s, members=tuple(m)) for (s, b), m in alike.items()]


def row_of(family: str, budget: Budget, curvature: Fraction = CURVATURE) -> Row:
    """Return the known ratio of one set of budgets; it is computed if no written proof settles it."""
    alpha_s, alpha_c = budget.members[0]
    known = known_ratio(_question(family, budget.n_robots, alpha_s, alpha_c, curvature))
    found = None
    if not known.attained and budget.n_robots <= LARGEST[family]:
        found = worst_case_ratio(
            budget.n_robots, alpha_s, alpha_c, curvature=curvature, family=family, time_limit=SECONDS
        )
    return Row(budget=budget, known=known, found=found)


def coverage(family: str, rows: Sequence[Row]) -> tuple[str, ...]:
    """Count the budgets of one team size by the way in which they are settled."""
    counts = {
        name: sum(len(r.budget.members) for r in rows if r.status == name) for name in ("proved", "computed", "open")
    }
    return (family, str(rows[0].budget.n_robots), *map(str, counts.values()))


def _coverage(*, quick: bool) -> Iterator[tuple[str, ...]]:
    for family, top in LARGEST.items():
        for n in range(2, (4 if quick else top) + 1):
            yield coverage(family, [row_of(family, b) for b in budgets(n)])


def _values(*, quick: bool) -> Iterator[tuple[str, ...]]:
    """Non-decreasing functions, groups of two or more: the ratio beside both formulas."""
    for n in range(4, (4 if quick else LARGEST["nondecreasing"]) + 1):
        for b in budgets(n):
            if b.largest > 1:
                row = row_of("nondecreasing", b)
                of = [str(survivor_share(size, 1 - CURVATURE, submodular=False)) for size in (b.smallest, b.largest)]
                counts = (b.n_robots, b.text, b.smallest, b.largest, b.bait)
                yield (*map(str, counts), row.ratio, row.status, *of)


def _others(*, quick: bool) -> Iterator[tuple[str, ...]]:
    for family, n, alpha_s, alpha_c, k in SINGLE[:1] if quick else SINGLE:
        known = known_ratio(_question(family, n, alpha_s, alpha_c, k))
        found = worst_case_ratio(n, alpha_s, alpha_c, curvature=k, family=family, time_limit=SECONDS)
        value = str(found.exact_upper) if found.exact_lower == found.exact_upper else "open"
        formula = known.lower if known.attained else known.conjectured
        yield (family, str(n), f"{alpha_s}, {alpha_c}", str(k), value, str(formula or "none"))


def _threes(*, quick: bool) -> Iterator[tuple[str, ...]]:
    for k in THREES[:2] if quick else THREES:
        found = worst_case_ratio(4, 1, 0, curvature=k, family="submodular", time_limit=SECONDS)
        known = known_ratio(found.witness)
        yield (str(k), str(found.exact_upper), str(known.lower), str(known.conjectured or "none"))


def _large(*, quick: bool) -> Iterator[tuple[str, ...]]:
    """Submodular teams of six and seven robots: a coverage function's ratio beside the proved share."""
    for size, swapped, k in LARGE[:1] if quick else LARGE:
        n = size + swapped
        lower = known_ratio(_question("submodular", n, swapped, 0, k)).lower
        # Smaller teams with as many robots left are in this one: the rest is blinded bait.
        found = (coverage_instance(size, bait, k) for bait in range(1, min(size, swapped) + 1))
        upper = min((ratio for ratio, _ in filter(None, found)), default=Fraction(1))
        yield (str(n), str(swapped), str(k), str(upper), str(lower), "exact" if lower == upper else "bracket")


def _planners(*, quick: bool) -> Iterator[tuple[str, ...]]:
    for n, alpha_s, family in SHARED[:1] if quick else SHARED:
        found = shared_plan_ratio(_question(family, n, alpha_s, 0, CURVATURE), range(n), time_limit=SECONDS)
        alone = worst_case_ratio(n, alpha_s, 0, curvature=CURVATURE, family=family, time_limit=SECONDS).exact_lower
        answer = "no better" if alone == found.upper else "open"
        yield (family, str(n), str(alpha_s), str(alone), str(found.upper), answer)


def _best(*, quick: bool) -> Iterator[tuple[str, ...]]:
    """Non-decreasing functions: the best of three planners exactly, beside RATT alone; four robots take minutes."""
    for n, alpha_s in BEST[:1] if quick else BEST:
        found = best_of_three(n, alpha_s, CURVATURE)
        alone = worst_case_ratio(n, alpha_s, 0, curvature=CURVATURE, family="nondecreasing").exact_lower
        best = str(found.lower) if found.lower == found.upper else f"[{found.lower}, {found.upper}]"
        yield (str(n), str(alpha_s), str(alone), best, "better" if found.lower > alone else "no better")


TABLES: dict[str, tuple[tuple[str, ...], Callable[..., Iterator[tuple[str, ...]]]]] = {
    "coverage": (("class", "robots", *STATUSES), _coverage),
    "values": (
        ("robots", "blinded, cut", "g", "s", "bait", "ratio", "status", "formula in g", "formula in s"),
        _values,
    ),
    "others": (("class", "robots", "blinded, cut", "curvature", "ratio", "formula"), _others),
    "threes": (("k", "ratio", "proved share", "formula"), _threes),
    "large": (("robots", "blinded", "k", "attained", "proved share", "together"), _large),
    "best": (("robots", "blinded", "RATT alone", "best of three", "so it is"), _best),
    "planners": (("class", "robots", "blinded", "RATT alone", "one plan of all three", "best of three"), _planners),
}


def table(name: str, *, quick: bool = False) -> str:
    """One table as Markdown; ``quick`` only its first rows."""
    head, rows = TABLES[name]
    lines = [head, ("---",) * len(head), *rows(quick=quick)]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def main(arguments: list[str] | None = None) -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("table", choices=TABLES)
    parser.add_argument("--quick", action="store_true", help="only its first rows")
    options = parser.parse_args(arguments)
    print(table(options.table, quick=options.quick))


if __name__ == "__main__":
    main()
