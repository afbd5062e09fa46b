"""Faults drawn from all families, and which tier of the tests finds them."""

from __future__ import annotations

import csv
import random
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from time import monotonic
from typing import TYPE_CHECKING, Any

from analysis.test_tier.c_mutants import c_mutants
from analysis.test_tier.mutants import Mutant, python_mutants

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from analysis.test_tier.choose import Cost
    from analysis.test_tier.reached_lines import Reach
    from analysis.test_tier.tree import Tree

__all__ = ["Campaign", "Measured", "Row", "draw", "family_of"]

FIELDS = ("number", "family", "fault", "found", "test", "seconds")
PATIENCE = 5.0
"""A test that takes this many times its usual seconds has found the fault."""
COMPILING = 30.0
"""Seconds besides, for what is compiled again."""
NEAR = 6.0
"""Usual seconds of the tests that a fault is tried with alone; all the others run once for all faults together."""


def family_of(file: str) -> str:
    """The folder below a package, or the package of a file right in it."""
    parts = PurePosixPath(file).parts
    return "/".join(parts[: 2 if len(parts) > 2 else 1])


def draw(root: Path, seed: int, count: int) -> list[Mutant]:
    """Faults in all families by their lines, in a random order; at most one in a line."""
    by_family: dict[str, list[Mutant]] = defaultdict(list)
    lines: dict[str, int] = defaultdict(int)
    paths = [path for package in ("ratt_opt", "ratt_audit") for path in (root / package).rglob("*")]
    for path in sorted(path for path in paths if path.suffix in {".py", ".c", ".h"}):
        file, text = path.relative_to(root).as_posix(), path.read_text(encoding="utf-8")
        by_family[family_of(file)] += (python_mutants if path.suffix == ".py" else c_mutants)(file, text)
        lines[family_of(file)] += len([line for line in text.splitlines() if line.strip()])
    drawn: list[Mutant] = []
    for family, share in _shares(lines, count).items():
        chance = random.Random(f"{seed} {family}")
        one_a_line: dict[tuple[str, int], Mutant] = {}
        for mutant in chance.sample(by_family[family], len(by_family[family])):
            one_a_line.setdefault((mutant.file, mutant.line), mutant)
        drawn += list(one_a_line.values())[:share]
    random.Random(seed).shuffle(drawn)
    return drawn


def _shares(lines: Mapping[str, int], count: int) -> dict[str, int]:
    """Of each family by its lines, at least one; the largest remainders are rounded up."""
    whole = sum(lines.values())
    exact = {family: max(1.0, count * n / whole) for family, n in lines.items()}
    shares = {family: int(share) for family, share in exact.items()}
    for family in sorted(exact, key=lambda one: int(exact[one]) - exact[one])[: max(0, count - sum(shares.values()))]:
        shares[family] += 1
    return shares


@dataclass(frozen=True, slots=True)
class Row:
    """What became of a fault: found by the ``short`` tier, by the ``whole`` suite only, by ``none``; or ``open``."""

    number: int
    family: str
    fault: str
    found: str
    test: str
    seconds: float


@dataclass(frozen=True, slots=True)
class Measured:
    """What reaches a line, the usual cost of every test function, and the cases that the short tier runs of some."""

    reach: Reach
    costs: Mapping[str, Cost]
    cases: Mapping[str, int]


class Campaign:
    """Goes through drawn faults; what is known of each is a row of a file, so that it can be stopped."""

    def __init__(self, tree: Tree, measured: Measured, mutants: Sequence[Mutant], file: Path) -> None:
        self._tree = tree
        self._measured = measured
        self._mutants = mutants
        self._file = file
        self.rows = self.read(file)

    @staticmethod
    def read(file: Path) -> dict[int, Row]:
        """The rows of a file, by number; the last one of a fault counts."""
        if not file.exists():
            return {}
        with file.open(newline="", encoding="utf-8") as opened:
            texts = list(csv.reader(opened))[1:]
        rows = [Row(int(n), family, fault, found, test, float(s)) for n, family, fault, found, test, s in texts]
        return {row.number: row for row in rows}

    def _note(self, row: Row, say: Callable[[str], None]) -> None:
        self.rows[row.number] = row
        new = not self._file.exists()
        with self._file.open("a", newline="", encoding="utf-8") as opened:
            rows = csv.writer(opened, lineterminator="\n")
            if new:
                rows.writerow(FIELDS)
            rows.writerow([getattr(row, field) for field in FIELDS])
        say(f"{row.number}: {row.found} ({row.test}) {row.seconds:.1f} s, {row.fault}")

    def reaching(self, mutant: Mutant) -> list[str]:
        """Tests that may find a fault, near and cheap files first."""
        costs = self._measured.costs
        tests = self._measured.reach.tests(mutant.file, mutant.line) & costs.keys()
        of_file: dict[str, float] = defaultdict(float)
        for test in tests:
            of_file[_file_of(test)] += costs[test].seconds
        return sorted(tests, key=lambda one: (-_common(_file_of(one), mutant.file), of_file[_file_of(one)], one))

    def _is_short(self, test: str) -> bool:
        return self._measured.cases.get(test, 1) > 0

    def _seconds(self, test: str, *, short: bool) -> float:
        """The usual ones, of all cases or of those in the short tier."""
        cost = self._measured.costs[test]
        return cost.seconds * (
            min(self._measured.cases.get(test, cost.tests), cost.tests) / cost.tests if short else 1.0
        )

    def _run(self, tests: Iterable[str], *, short: bool, all_tests: bool = False) -> dict[str, Any]:
        limits = {test: PATIENCE * self._seconds(test, short=short) + COMPILING for test in tests}
        return self._tree.run(limits, cases=self._measured.cases if short else {}, all_tests=all_tests)

    def near(self, until: float, say: Callable[[str], None]) -> None:
        """Run the nearest tests of the short tier for every fault that has no row."""
        for number, mutant in enumerate(self._mutants):
            if number in self.rows:
                continue
            if monotonic() > until:
                return
            self._note(self._by_near(number, mutant), say)

    def _by_near(self, number: int, mutant: Mutant) -> Row:
        tests: list[str] = []
        seconds = 0.0
        for test in filter(self._is_short, self.reaching(mutant)):
            seconds += self._seconds(test, short=True)
            if seconds > NEAR and tests:
                break
            tests.append(test)
        about = (number, family_of(mutant.file), str(mutant))
        with self._tree.with_faults([mutant]) as compiles:
            if not compiles:
                return Row(*about, "short", "does not compile", 0.0)
            if not tests:
                return Row(*about, "open", "", 0.0)
            answer = self._run(tests, short=True)
        if answer["ended"] in {"passed", "no tests"}:
            return Row(*about, "open", "", answer["seconds"])
        return Row(*about, "short", f"{answer['test']} {answer['ended']}", answer["seconds"])

    def together(self, until: float, say: Callable[[str], None]) -> None:
        """Run each tier once with all the faults left over, and what failed then with each of them alone."""
        for tier in ("short", "whole"):
            left = [number for number, row in sorted(self.rows.items()) if row.found == "open"]
            suspects = self._failing([self._mutants[number] for number in left], tier, until, say)
            for number in left:
                if monotonic() > until:
                    return
                row = self.rows[number]
                test = self._alone(self._mutants[number], suspects, short=tier == "short")
                if test or tier == "whole":
                    found = tier if test else "none"
                    self._note(Row(number, row.family, row.fault, found, test, row.seconds), say)

    def _failing(self, left: Sequence[Mutant], tier: str, until: float, say: Callable[[str], None]) -> set[str]:
        """Test functions of a tier that fail with all these faults at once; files done before are not run again."""
        done = self._file.with_suffix(f".{tier}.csv")
        known: dict[str, str] = {}
        if done.exists():
            known = dict(line.split(",", 1) for line in done.read_text(encoding="utf-8").splitlines())
        files: dict[str, set[str]] = defaultdict(set)
        for test in set[str]().union(*(self.reaching(mutant) for mutant in left)):
            if self._is_short(test) if tier == "short" else test in self._measured.cases:
                files[_file_of(test)].add(test)
        with self._tree.with_faults(left):
            for file in sorted(set(files) - set(known)):
                if monotonic() > until:
                    break
                known[file] = " ".join(sorted(self._failures(sorted(files[file]), short=tier == "short")))
                with done.open("a", encoding="utf-8") as opened:
                    opened.write(f"{file},{known[file]}\n")
                say(f"{file}: {known[file] or 'passed'}")
        return {test for tests in known.values() for test in tests.split()}

    def _failures(self, tests: Sequence[str], *, short: bool) -> set[str]:
        failed: set[str] = set()
        while left := [test for test in tests if test not in failed]:
            answer = self._run(left, short=short, all_tests=True)
            new = {test.partition("[")[0] for test in answer["failed"]}
            if answer["ended"] == "broken":
                return failed | set(left)
            if answer["ended"] in {"passed", "failed", "no tests"}:
                return failed | new
            failed |= new | {self._tree.last().partition("[")[0]}  # it ended the process
        return failed

    def _alone(self, mutant: Mutant, suspects: set[str], *, short: bool) -> str:
        """A suspect that fails for a fault alone, and passes without."""
        tests = [test for test in self.reaching(mutant) if test in suspects]
        while tests:
            with self._tree.with_faults([mutant]):
                answer = self._run(tests, short=short)
            if answer["ended"] in {"passed", "no tests"}:
                return ""
            found = str(answer["test"]).partition("[")[0]
            if found not in tests:  # the fault is found before a test begins
                return str(answer["ended"])
            if self._run([found], short=short)["ended"] == "passed":
                return f"{answer['test']} {answer['ended']}"
            tests.remove(found)
        return ""


def _file_of(test: str) -> str:
    return test.partition("::")[0]


def _common(test_file: str, file: str) -> int:
    """Folders that a test and a source share: tests mirror the package."""
    own = PurePosixPath(file.removeprefix("ratt_opt/")).parts
    tests = PurePosixPath(test_file.removeprefix("tests/")).parts[:-1]
    return sum(1 for _ in _equal(own, tests))


def _equal(one: Sequence[str], other: Sequence[str]) -> Iterable[str]:
    for a, b in zip(one, other, strict=False):
        if a != b:
            return
        yield a
