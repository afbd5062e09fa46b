"""Which test functions reach a line: measured for Python, by names for what is compiled, which coverage cannot see.

A compiled function counts as reached by the tests that reach a line of Python which names it, or which names a compiled
function that calls it. The same holds for constants and classes, whose lines run once, at import.
"""

from __future__ import annotations

import ast
import json
import re
from collections import defaultdict
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from pathlib import Path

__all__ = ["Reach", "collect", "load", "save"]

C_FUNCTION = re.compile(r"^(?:EXPORTED |static )?[\w ]+?[ *]+(?P<name>\w+)\((?P<arguments>[^;{}]*)\) \{", re.M)
C_SOURCES = "ratt_opt/native/src"
WHOLE_FILE = "*"
"""Ends the context of a fixture that several tests share."""


def collect(folder: Path, tests: Iterable[str]) -> dict[str, dict[int, frozenset[str]]]:
    """The test functions of each line of each file, from the files that coverage left in a folder."""
    from coverage import CoverageData

    every = sorted(tests)
    expanded: dict[str, frozenset[str]] = {}
    reached: dict[str, dict[int, set[str]]] = defaultdict(lambda: defaultdict(set))
    for path in sorted(folder.glob("lines.*")):
        data = CoverageData(str(path))
        data.read()
        for file in data.measured_files():
            for line, contexts in data.contexts_by_lineno(file).items():
                for context in contexts:
                    if context not in expanded:
                        expanded[context] = frozenset(_tests_of(context, every))
                    reached[file][line] |= expanded[context]
        data.close()
    return {file: {line: frozenset(found) for line, found in lines.items()} for file, lines in reached.items()}


def _tests_of(context: str, every: list[str]) -> Iterator[str]:
    name = context.partition("|")[2] if context.startswith("|") else context.partition("|")[0]
    if name.endswith(WHOLE_FILE):
        stem = name.removesuffix(WHOLE_FILE)
        yield from (test for test in every if test.startswith((f"{stem}/", f"{stem}::")))
    elif "::" in name:
        yield name


def save(path: Path, lines: Mapping[str, Mapping[int, frozenset[str]]], root: Path) -> None:
    """Write what was measured; many lines share a set of tests."""
    tests = sorted({test for of_file in lines.values() for found in of_file.values() for test in found})
    number = {test: i for i, test in enumerate(tests)}
    sets: dict[frozenset[str], int] = {}
    files: dict[str, dict[int, int]] = {}
    for file in sorted(lines):
        name = file.removeprefix(f"{root}/")
        files[name] = {line: sets.setdefault(found, len(sets)) for line, found in sorted(lines[file].items())}
    kept = {"tests": tests, "sets": [sorted(number[test] for test in found) for found in sets], "files": files}
    path.write_text(json.dumps(kept), encoding="utf-8")


def load(path: Path, root: Path) -> Reach:
    """Read what was measured of the sources under ``root``."""
    kept = json.loads(path.read_text(encoding="utf-8"))
    tests = kept["tests"]
    sets = [frozenset(tests[i] for i in found) for found in kept["sets"]]
    lines = {name: {int(n): sets[i] for n, i in of_file.items()} for name, of_file in kept["files"].items()}
    return Reach(root, lines)


class Reach:
    """Test functions by line, of every source under a root."""

    def __init__(self, root: Path, lines: Mapping[str, Mapping[int, frozenset[str]]]) -> None:
        self._root = root
        self.lines = lines
        paths = sorted(path for name in ("ratt_opt", "ratt_audit") for path in (root / name).rglob("*.py"))
        self._modules = {path.relative_to(root).as_posix(): _Module(path) for path in paths}

    def tests(self, file: str, line: int) -> frozenset[str]:
        """The test functions that reach a line, or may."""
        if file.endswith((".c", ".h")):
            return self._of_names(self._callers_in_c(file, line))
        module = self._modules[file]
        function = module.function_at(line)
        if function is None:
            return self._of_names(module.names_at(line)) or self._of_lines(file, range(1, module.length + 1))
        if module.is_compiled(function):
            return self._of_names({function.name})
        exact = self._of_lines(file, module.statement_at(line))
        return exact or self._of_lines(file, _inside(function))

    def every_line(self) -> Iterator[frozenset[str]]:
        """The tests of each line of a function: of each measured one, and of each statement that is compiled."""
        for file, of_file in self.lines.items():
            inside = self._modules[file].inside if file in self._modules else frozenset()
            yield from (tests for line, tests in of_file.items() if line in inside)
        for module in self._modules.values():
            for function in module.functions:
                if module.is_compiled(function):
                    tests = self._of_names({function.name})
                    yield from (tests for node in ast.walk(function) if isinstance(node, ast.stmt))
        for path in sorted((self._root / C_SOURCES).glob("*.c")):
            for one in _functions_of_c(path):
                tests = self._of_names(self._callers_in_c(f"{C_SOURCES}/{one.file}", one.lines[0]))
                yield from (tests for _ in one.lines)

    def _of_lines(self, file: str, numbers: Iterable[int]) -> frozenset[str]:
        known = self.lines.get(file, {})
        return frozenset[str]().union(*(known.get(number, frozenset()) for number in numbers))

    def _of_names(self, names: Iterable[str]) -> frozenset[str]:
        """The tests of all lines that name one of these, directly or in a compiled function named there."""
        seen, ahead = set(names), list(names)
        found: set[str] = set()
        while ahead:
            for file, line, function in self._named.get(ahead.pop(), ()):
                if function is None:
                    found |= self.lines.get(file, {}).get(line, frozenset())
                elif function not in seen:
                    seen.add(function)
                    ahead.append(function)
        return frozenset(found)

    @cached_property
    def _named(self) -> dict[str, list[tuple[str, int, str | None]]]:
        """Where each name stands: file, line, and the compiled function around it or what else runs at import."""
        named: dict[str, list[tuple[str, int, str | None]]] = defaultdict(list)
        for file, module in self._modules.items():
            for name, line in module.names:
                function = module.function_at(line)
                if function is not None and not module.is_compiled(function):
                    named[name].append((file, line, None))
                elif function is not None:
                    named[name].append((file, line, function.name))
                else:
                    named[name] += [(file, line, other) for other in module.names_at(line)]
        return named

    def _callers_in_c(self, file: str, line: int) -> set[str]:
        """The exported functions of C that run a line: of a constant or a record, all that may see it."""
        bodies = [one for path in sorted((self._root / C_SOURCES).glob("*.[ch]")) for one in _functions_of_c(path)]
        inside = {one.name for one in bodies if f"{C_SOURCES}/{one.file}" == file and line in one.lines}
        seen = inside or {one.name for one in bodies if file.endswith((".h", f"/{one.file}"))}
        ahead = set(seen)
        while ahead:
            called = re.compile(rf"\b(?:{'|'.join(sorted(ahead))})\b")
            ahead = {one.name for one in bodies if called.search(one.body)} - seen
            seen |= ahead
        return {one.name for one in bodies if one.name in seen and one.exported}


@dataclass(frozen=True, slots=True)
class _FunctionOfC:
    file: str
    name: str
    exported: bool
    lines: range
    body: str


def _functions_of_c(path: Path) -> Iterator[_FunctionOfC]:
    """Those of a file, as it is formatted: the last bracket of a function is alone, or ends its only line."""
    text = path.read_text(encoding="utf-8")
    for found in C_FUNCTION.finditer(text):
        first = text.find("\n", found.end())
        end = first if text[:first].endswith("}") else text.find("\n}\n", found.end()) + 2
        begin = text.count("\n", 0, found.start()) + 1
        lines = range(begin, begin + text.count("\n", found.start(), end) + 1)
        exported = found[0].startswith("EXPORTED")
        yield _FunctionOfC(path.name, found["name"], exported, lines, text[found.end() : end])


def _inside(function: ast.FunctionDef) -> range:
    end = function.body[-1].end_lineno
    assert end is not None
    return range(function.body[0].lineno, end + 1)


class _Module:
    """What a source says about its lines."""

    def __init__(self, path: Path) -> None:
        text = path.read_text(encoding="utf-8")
        self._tree = ast.parse(text)
        self.length = text.count("\n")
        self.functions = [node for node in ast.walk(self._tree) if isinstance(node, ast.FunctionDef)]
        self._by_hand = set(re.findall(r"numba\.njit\((?:\w+\.)*(\w+)\)", text))
        """Functions compiled under another name: ``_x = numba.njit(y)``."""

    @cached_property
    def inside(self) -> frozenset[int]:
        """Lines in functions; the others run once, at import."""
        return frozenset(line for function in self.functions for line in _inside(function))

    def function_at(self, line: int) -> ast.FunctionDef | None:
        """The outermost function around a line."""
        around = [one for one in self.functions if one.lineno <= line <= (one.end_lineno or 0)]
        return min(around, key=lambda one: one.lineno, default=None)

    def is_compiled(self, function: ast.FunctionDef) -> bool:
        """Whether it is compiled, so that coverage cannot see its lines."""
        return any("njit" in ast.unparse(one) for one in function.decorator_list)

    def statement_at(self, line: int) -> range:
        """Lines of the smallest statement that contains a line: of one with a body, its head."""
        spans = []
        for node in ast.walk(self._tree):
            if isinstance(node, ast.stmt):
                body = getattr(node, "body", None)
                end = body[0].lineno - 1 if body else node.end_lineno
                if node.lineno <= line <= max(node.lineno, end or 0):
                    spans.append(range(node.lineno, max(node.lineno, end or 0) + 1))
        return min(spans, key=len, default=range(line, line + 1))

    def names_at(self, line: int) -> set[str]:
        """What a statement outside of functions defines: names that it assigns, or the class around it."""
        found: set[str] = set()
        for node in self._tree.body:
            if not node.lineno <= line <= (node.end_lineno or 0):
                continue
            if isinstance(node, ast.ClassDef | ast.FunctionDef):
                found.add(node.name)
            found |= {one.id for one in ast.walk(node) if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store)}
        return found

    @cached_property
    def names(self) -> list[tuple[str, int]]:
        """All names, attributes and texts of one word, with their lines."""
        found = []
        for node in ast.walk(self._tree):
            given: Any = getattr(node, "id", None) or getattr(node, "attr", None) or getattr(node, "value", None)
            if isinstance(node, ast.Name | ast.Attribute | ast.Constant) and isinstance(given, str):
                found.append((given, node.lineno))
        return found
