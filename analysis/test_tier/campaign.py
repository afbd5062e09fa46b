"""Faults drawn from all families, and which tier of the tests finds them."""

import csv
import random
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import astuple, dataclass, replace
from itertools import takewhile
from pathlib import Path, PurePosixPath
from time import monotonic

from analysis.test_tier.c_mutants import c_mutants
from analysis.test_tier.choose import Cost
from analysis.test_tier.mutants import Mutant, python_mutants
from analysis.test_tier.reached_lines import Reach
from analysis.test_tier.tree import Tree

__all__ = ["Campaign", "Measured", "Row", "draw", "family_of", "read_rows"]

FIELDS = ("number", "family", "fault", "found", "test", "seconds")
PATIENCE = 5.0
"""A test that takes this many times its usual seconds has found the fault."""
MORE = 30.0
"""Seconds besides: a short test may wait for a disk or another process."""
NEAR = 6.0
"""Usual seconds of the tests that a fault is tried with alone; all the others run once for all faults together."""
REFUSED = "does not compile"


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
    """Divide the count among families by their lines, at least one each; the largest remainders are rounded up."""
    whole = sum(lines.values())
    exact = {family: max(1.0, count * n / whole) for family, n in lines.items()}
    shares = {family: int(share) for family, share in exact.items()}
    for family in sorted(exact, key=lambda one: int(exact[one]) - exact[one])[: max(0, count - sum(shares.values()))]:
        shares[family] += 1
    return shares


@dataclass(frozen=True, slots=True)
class Row:
    """Fate of a fault: found by the ``short`` tier, by the ``whole`` suite only, by ``none``; or ``open``."""

    number: int
    family: str
    fault: str
    found: str
    test: str
    seconds: float


def read_rows(file: Path) -> dict[int, Row]:
    """The rows of a file, by number; the last one of a fault counts."""
    if not file.exists():
        return {}
    with file.open(newline="", encoding="utf-8") as opened:
        texts = list(csv.reader(opened))[1:]
    return {int(n): Row(int(n), family, fault, found, test, float(s)) for n, family, fault, found, test, s in texts}


@dataclass(frozen=True, slots=True)
class Measured:
    """Tests that reach each line, usual costs of test functions, and the cases that the short tier runs of some."""

    reach: Reach
    costs: Mapping[str, Cost]
    cases: Mapping[str, int]

    def is_short(self, test: str) -> bool:
        """Tell whether the short tier runs a test function, or some of its cases."""
        return self.cases.get(test, 1) > 0

    def seconds(self, test: str, *, short: bool) -> float:
        """The usual ones, of all cases or of those in the short tier."""
        cost = self.costs[test]
        return cost.seconds * (min(self.cases.get(test, cost.tests), cost.tests) / cost.tests if short else 1.0)

    def reaching(self, mutant: Mutant) -> list[str]:
        """Tests that may find a fault, near and cheap files first."""
        tests = self.reach.tests(mutant.file, mutant.line) & self.costs.keys()
        of_file: dict[str, float] = defaultdict(float)
        for test in tests:
            of_file[_file_of(test)] += self.costs[test].seconds
        return sorted(tests, key=lambda one: (-_common(_file_of(one), mutant.file), of_file[_file_of(one)], one))


class Campaign:
    """Goes through drawn faults; what is known of each is a row of a file, so that it can be stopped."""

    def __init__(
        self, tree: Tree, measured: Measured, mutants: Sequence[Mutant], file: Path, say: Callable[[str], None]
    ) -> None:
        self._tree = tree
        self._measured = measured
        self._mutants = mutants
        self._file = file
        self._say = say
        self.rows = read_rows(file)

    def _note(self, row: Row) -> None:
        self.rows[row.number] = row
        new = not self._file.exists()
        with self._file.open("a", newline="", encoding="utf-8") as opened:
            csv.writer(opened, lineterminator="\n").writerows([FIELDS, astuple(row)] if new else [astuple(row)])
        self._say(f"{row.number}: {row.found} ({row.test}) {row.seconds:.1f} s, {row.fault}")

    def near(self, until: float) -> None:
        """Run the nearest tests of the short tier for every fault that has no row."""
        for number, mutant in enumerate(self._mutants):
            if monotonic() < until and number not in self.rows:
                began = monotonic()
                test = self._found_near(mutant)
                found = {"": "open", REFUSED: "none"}.get(test, "short")
                self._note(Row(number, family_of(mutant.file), str(mutant), found, test, monotonic() - began))

    def _found_near(self, mutant: Mutant) -> str:
        tests: list[str] = []
        seconds = 0.0
        for test in filter(self._measured.is_short, self._measured.reaching(mutant)):
            seconds += self._measured.seconds(test, short=True)
            if seconds > NEAR and tests:
                break
            tests.append(test)
        return self._failing([mutant], tests, short=True)

    def _failing(self, mutants: Iterable[Mutant], tests: Sequence[str], *, short: bool) -> str:
        """The first test that fails with some faults, or what else they break; empty if all is well."""
        with self._tree.with_faults(mutants) as compiles:
            return self._run(tests, short=short) if compiles else REFUSED

    def _run(self, tests: Sequence[str], *, short: bool) -> str:
        if not tests:
            return ""
        limits = {test: PATIENCE * self._measured.seconds(test, short=short) + MORE for test in tests}
        ended, test = self._tree.run(limits, self._measured.cases if short else {})
        return "" if ended in {"passed", "no tests"} else f"{test} {ended}"

    def together(self, until: float) -> None:
        """Run each tier with all the faults left over; halve them for every test that fails, until one is left."""
        for tier in ("short", "whole"):
            done = self._file.with_suffix(f".{tier}-{len(self.rows)}.txt")
            known = done.read_text(encoding="utf-8").split() if done.exists() else []
            ahead = {file: tests for file, tests in self._files(tier).items() if file not in known}
            while ahead and monotonic() < until:
                file, failing = self._first_failing(ahead, tier, done, until)
                if failing:
                    ahead[file] = self._blame(failing, ahead[file], tier)
            if ahead:
                return
        for row in self._open():
            self._note(replace(row, found="none"))

    def again(self, until: float) -> None:
        """Judge found faults by a list that has changed since: by the test that found one, or all of the short tier."""
        for number, row in sorted(self.rows.items()):
            if monotonic() < until and row.found in {"short", "whole"}:
                mutant, before = self._mutants[number], _function_of(row.test)
                short = [test for test in self._measured.reaching(mutant) if self._measured.is_short(test)]
                tries = ([test for test in short if test == before], short)
                failing = (self._failing([mutant], tests, short=True) for tests in tries)
                if found := next(filter(None, failing), ""):
                    self._note(replace(row, found="short", test=found))
                else:
                    self._note(replace(row, found="whole"))

    def _open(self) -> list[Row]:
        return [row for _, row in sorted(self.rows.items()) if row.found == "open"]

    def _files(self, tier: str) -> dict[str, list[str]]:
        """Files of tests that reach a fault that is left, with these tests; cheap ones first."""
        reaching = {test for row in self._open() for test in self._measured.reaching(self._mutants[row.number])}
        files: dict[str, list[str]] = defaultdict(list)
        for test in sorted(reaching):
            if self._measured.is_short(test) if tier == "short" else test in self._measured.cases:
                files[_file_of(test)].append(test)

        def seconds(file: str) -> float:
            return sum(self._measured.seconds(test, short=tier == "short") for test in files[file])

        return {file: files[file] for file in sorted(files, key=seconds)}

    def _first_failing(self, ahead: dict[str, list[str]], tier: str, done: Path, until: float) -> tuple[str, str]:
        """Go through the files ahead with all faults that are left; stop at one that fails."""
        with self._tree.with_faults([self._mutants[row.number] for row in self._open()]):
            while ahead and monotonic() < until:
                file = next(iter(ahead))
                if failing := self._run(ahead[file], short=tier == "short"):
                    return file, failing
                del ahead[file]
                with done.open("a", encoding="utf-8") as opened:
                    opened.write(f"{file}\n")
                self._say(f"{tier}, {len(ahead)} files ahead: {file} passed")
        return "", ""

    def _blame(self, failing: str, tests: list[str], tier: str) -> list[str]:
        """Note which fault fails a test; the tests of its file that can still find others."""
        function = _function_of(failing)
        asked = [function] if function in tests else tests

        def fails(rows: Sequence[Row]) -> str:
            return self._failing([self._mutants[row.number] for row in rows], asked, short=tier == "short")

        every = self._open()
        likely = [row for row in every if {*asked} & {*self._measured.reaching(self._mutants[row.number])}]
        for rows in (likely, every) if not fails([]) else ():  # what runs before the first test reaches more lines
            left = rows
            while len(left) > 1:
                half = len(left) // 2
                left = left[:half] if fails(left[:half]) else left[half:]
            if left and (found := fails(left)):
                self._note(replace(left[0], found=tier, test=found))
                return tests
        self._say(f"{failing}: not by one fault alone")
        return [test for test in tests if test not in asked]


def _function_of(failing: str) -> str:
    return failing.partition("[")[0].split(" ")[0]


def _file_of(test: str) -> str:
    return test.partition("::")[0]


def _common(test_file: str, file: str) -> int:
    """Folders that a test and a source share: tests mirror the package."""
    own = PurePosixPath(file.removeprefix("ratt_opt/")).parts
    tests = PurePosixPath(test_file.removeprefix("tests/")).parts[:-1]
    return len(list(takewhile(lambda pair: pair[0] == pair[1], zip(own, tests, strict=False))))
