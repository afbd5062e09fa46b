"""The short tier: tests that reach most lines for their seconds, until the seconds are spent.

A line counts once for the first test that reaches it, and less for each further one, which finds some of the faults
that the others miss. What a test adds falls as others join it: the sum is submodular, so greedy choices by gain per
second do well. Source: M. Sviridenko, "A note on maximizing a submodular set function subject to a knapsack
constraint", Operations Research Letters 32 (2004).
"""

import csv
import heapq
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from analysis.test_tier.reached_lines import Reach

__all__ = [
    "Cost",
    "Part",
    "chosen",
    "parts_of",
    "reached_units",
    "read_costs",
    "read_list",
    "summary",
    "write_costs",
    "write_list",
]

AGAIN = 0.7
"""Factor by which the weight of a line falls with each further test."""
OWN = 10.0
"""Lines that a test is worth by itself: it asserts what no other does."""
LEAST = 0.004
"""Seconds that every test costs: to collect and report it."""
CASES, FIRST = 12, 0.7
"""A function can join with this many cases, which find this share of what all of them do."""
EVERY, CHECKERS = 0.2, 2.5
"""Seconds that every function has for some of its cases, and one that tests checkers of certificates: nothing else sees
a rule that a checker no longer applies."""
OF_CHECKERS = "tests/certificates/"
ONE = 1.0
"""A function has at least one case if that takes no more seconds: most faults that the tier missed were seen by one
case of half a second or more."""


@dataclass(frozen=True, slots=True)
class Cost:
    """Processor seconds of a test function with all its cases; ``shared`` are those of fixtures of its file."""

    tests: int
    seconds: float
    shared: float = 0.0

    def __add__(self, other: "Cost") -> "Cost":
        """The cost of more cases of the same function."""
        return Cost(self.tests + other.tests, self.seconds + other.seconds, max(self.shared, other.shared))


def read_costs(path: Path) -> dict[str, Cost]:
    """Read the measured costs of each test function; empty if there are none."""
    if not path.exists():
        return {}
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))[1:]
    return {name: Cost(int(tests), *(float(one) for one in seconds)) for name, tests, *seconds in rows}


def write_costs(path: Path, costs: Mapping[str, Cost]) -> None:
    """Write a row for each test function, sorted by name."""
    with path.open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(("function", "tests", "seconds", "shared"))
        for name, cost in sorted(costs.items()):
            rows.writerow((name, cost.tests, f"{cost.seconds:.3f}", f"{cost.shared:.3f}"))


def reached_units(reach: Reach, tests: Sequence[str]) -> tuple[list[np.ndarray], np.ndarray]:
    """Number the sets of lines that each test reaches, with one of its own; count the lines in each set."""
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
    """Some more cases of a test function that may join the tier, which then runs ``cases`` of them."""

    test: int
    cases: int
    seconds: float
    share: float
    after: int | None
    """The part that has to be there before."""
    always: bool


def parts_of(names: Sequence[str], costs: Sequence[Cost]) -> list[Part]:
    """A function joins with the cases that it always has; it can join with some more, and with the others later.

    Functions that share fixtures have equal parts of their seconds: if one joins, the others tend to follow.
    """
    files = [name.partition("::")[0] for name in names]
    users = Counter(file for file, cost in zip(files, costs, strict=True) if cost.shared)
    parts: list[Part] = []
    for test, (name, cost) in enumerate(zip(names, costs, strict=True)):
        each = max(cost.seconds / cost.tests, LEAST)
        few = min(cost.tests, CASES)
        shared = cost.shared / max(1, users[files[test]])
        own = CHECKERS if name.startswith(OF_CHECKERS) else EVERY
        always = min(few, max(int(each + shared <= ONE), int((own - shared) / each)))
        begun = 0
        for cases in sorted({always, few, cost.tests} - {0}):
            share = _share(cases, cost.tests) - _share(begun, cost.tests)
            seconds = each * (cases - begun) + (0.0 if begun else shared)
            parts.append(Part(test, cases, seconds, share, len(parts) - 1 if begun else None, cases == always))
            begun = cases
    return parts


def _share(cases: int, tests: int) -> float:
    """Return the share of a function's findings that some of its cases find."""
    return 1.0 if cases == tests else FIRST * cases / min(tests, CASES)


def chosen(parts: Sequence[Part], units: Sequence[np.ndarray], worth: np.ndarray, budget: float) -> dict[int, int]:
    """Cases of each test, by greedy gain per second while the budget lasts; a part that no longer fits stays out."""
    worth = worth.copy()
    taken: set[int] = set()
    then = {part.after: i for i, part in enumerate(parts) if part.after is not None}

    def gain(i: int) -> float:
        one = parts[i]
        return math.inf if one.always else one.share * float(worth[units[one.test]].sum()) / one.seconds

    ahead = [(-gain(i), i) for i, part in enumerate(parts) if part.after is None]
    heapq.heapify(ahead)
    while ahead:
        _, i = heapq.heappop(ahead)
        if parts[i].seconds > budget and not parts[i].always:
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
            sum(costs[name].seconds * n / costs[name].tests for name, n in of.items()),
        )
        for tier, of in (("short", short), ("whole", whole))
    ]
