"""The short tier: tests that reach most lines for their seconds, until the seconds are spent.

A line counts once for the first test that reaches it, and less for each further one, which finds some of the faults
that the others miss. What a test adds falls as others join it: the sum is submodular, so greedy choices by gain per
second do well. Source: M. Sviridenko, "A note on maximizing a submodular set function subject to a knapsack
constraint", Operations Research Letters 32 (2004).
"""

from __future__ import annotations

import csv
import heapq
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from pathlib import Path

    from analysis.test_tier.reached_lines import Reach

__all__ = [
    "KEPT",
    "Cost",
    "Part",
    "chosen",
    "parts_of",
    "reached_units",
    "read_costs",
    "read_list",
    "summary",
    "write_list",
]

AGAIN = 0.7
"""What a line counts for with each further test, of what it counted before."""
OWN = 10.0
"""Lines that a test is worth by itself: it asserts what no other does."""
LEAST = 0.004
"""Seconds that every test costs: to collect and report it."""
CASES, FIRST = 12, 0.7
"""A function with more cases can join with this many, which find this share of what all of them do."""


KEPT = (
    # Checkers refuse each damaged field by name: nothing else sees a rule that a checker no longer applies.
    "tests/certificates/test_group_covers.py::test_every_fault_has_its_name",
    "tests/certificates/test_group_prices.py::test_every_fault_has_its_name",
    "tests/certificates/test_group_sizes.py::test_every_fault_has_its_name",
    # Enumerations are complete: searches still end with true brackets if a branch is missing.
    "tests/attack/test_pricing.py::test_every_group_that_costs_less_is_listed_with_what_it_needs",
    "tests/attack/least_sets/test_sets_of_size.py::test_every_set_below_is_found_once",
)
"""Functions that found faults which the tier had missed, and others for the same kind of fault: they are always in."""


@dataclass(frozen=True, slots=True)
class Cost:
    """Processor seconds of a test function with all its cases; ``shared`` are those of fixtures of its file."""

    tests: int
    seconds: float
    compiling: float
    shared: float = 0.0


def read_costs(paths: Iterable[Path]) -> dict[str, Cost]:
    """What the plug-in wrote, of one or several processes."""
    costs: dict[str, Cost] = {}
    for path in paths:
        with path.open(newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                name, tests = row["function"], int(row["tests"])
                new = Cost(tests, *(float(row[field]) for field in ("seconds", "compiling", "shared")))
                costs[name] = new if name not in costs else _sum(costs[name], new)
    return costs


def _sum(one: Cost, other: Cost) -> Cost:
    seconds, compiling = one.seconds + other.seconds, one.compiling + other.compiling
    return Cost(one.tests + other.tests, seconds, compiling, max(one.shared, other.shared))


def reached_units(reach: Reach, tests: Sequence[str]) -> tuple[list[np.ndarray], np.ndarray]:
    """For each test the sets of lines that it reaches and one of its own, by number; how many lines each set has."""
    place = {test: i for i, test in enumerate(tests)}
    lines: dict[frozenset[int], int] = {}
    for found in reach.every_line():
        unit = frozenset(place[test] for test in found if test in place)
        if unit:
            lines[unit] = lines.get(unit, 0) + 1
    of_test: list[list[int]] = [[] for _ in tests]
    for number, unit in enumerate(lines):
        for i in unit:
            of_test[i].append(number)
    for i, units in enumerate(of_test):
        units.append(len(lines) + i)
    worth = np.array([*lines.values(), *[OWN] * len(tests)], dtype=float)
    return [np.array(units, dtype=np.int64) for units in of_test], worth


@dataclass(frozen=True, slots=True)
class Part:
    """Some cases of a test function that may join the tier; all of them, or ``cases`` as a first part."""

    test: int
    cases: int
    seconds: float
    share: float
    after: int | None = None
    """The part that has to be there before."""


def parts_of(names: Sequence[str], costs: Sequence[Cost]) -> list[Part]:
    """A function of many cases can join with some of them, and with the others later.

    Functions that share fixtures have equal parts of their seconds: if one joins, the others tend to follow.
    """
    files = [name.partition("::")[0] for name in names]
    users = Counter(file for file, cost in zip(files, costs, strict=True) if cost.shared)
    parts: list[Part] = []
    for test, cost in enumerate(costs):
        shared = cost.shared / max(1, users[files[test]])
        seconds = max(cost.seconds - cost.compiling, LEAST * cost.tests)
        if cost.tests <= CASES:
            parts.append(Part(test, cost.tests, seconds + shared, 1.0))
            continue
        first = seconds * CASES / cost.tests
        parts.append(Part(test, CASES, first + shared, FIRST))
        parts.append(Part(test, cost.tests, seconds - first, 1.0 - FIRST, after=len(parts) - 1))
    return parts


def chosen(parts: Sequence[Part], units: Sequence[np.ndarray], worth: np.ndarray, budget: float) -> dict[int, int]:
    """Cases of each test, by greedy gain per second while the budget lasts; a part that no longer fits stays out."""
    worth = worth.copy()
    taken: set[int] = set()
    then = {part.after: i for i, part in enumerate(parts) if part.after is not None}

    def gain(i: int) -> float:
        return parts[i].share * float(worth[units[parts[i].test]].sum()) / parts[i].seconds

    ahead = [(-gain(i), i) for i, part in enumerate(parts) if part.after is None]
    heapq.heapify(ahead)
    while ahead:
        _, i = heapq.heappop(ahead)
        if parts[i].seconds > budget:
            continue
        if ahead and -gain(i) > ahead[0][0]:
            heapq.heappush(ahead, (-gain(i), i))
            continue
        taken.add(i)
        budget -= parts[i].seconds
        worth[units[parts[i].test]] *= AGAIN ** parts[i].share
        if i in then:
            heapq.heappush(ahead, (-gain(then[i]), then[i]))
    return {parts[i].test: parts[i].cases for i in sorted(taken)}


def read_list(path: Path) -> dict[str, int]:
    """Cases that the short tier runs of each listed function."""
    lines = path.read_text(encoding="utf-8").splitlines()
    return {name: int(cases) for name, cases in (line.split() for line in lines)}


def write_list(path: Path, cases: Mapping[str, int]) -> None:
    """Write the functions of which the short tier runs some cases only, or none; sorted."""
    path.write_text("".join(f"{name} {cases[name]}\n" for name in sorted(cases)), encoding="utf-8")


def summary(costs: Mapping[str, Cost], cases: Mapping[str, int]) -> list[tuple[str, int, int, float]]:
    """Tier, test functions, tests and seconds."""
    short = {name: min(cases.get(name, cost.tests), cost.tests) for name, cost in costs.items()}
    whole = {name: cost.tests for name, cost in costs.items()}
    return [
        (
            tier,
            sum(n > 0 for n in of.values()),
            sum(of.values()),
            sum((costs[name].seconds - costs[name].compiling) * n / costs[name].tests for name, n in of.items()),
        )
        for tier, of in (("short", short), ("whole", whole))
    ]
