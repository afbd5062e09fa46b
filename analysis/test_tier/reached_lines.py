"""Test functions that reach a line: measured for Python, by names for C, which coverage cannot see.

A function in C counts as reached by the tests that reach a line of Python which names it, or which names a function in
C that calls it. The same holds for constants and classes, whose lines run once, at import.
"""

import ast
import json
import re
from collections import defaultdict
from collections.abc import Container, Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import TypeAlias

from analysis.test_tier.c_mutants import NO_CODE

__all__ = ["Lines", "Reach", "collect", "load", "merged", "save"]

Lines: TypeAlias = "Mapping[str, Mapping[int, frozenset[str]]]"
"""The test functions that reach each line of each file."""
C_FUNCTION = re.compile(r"^(?:EXPORTED |static )?[\w ]+?[ *]+(?P<name>\w+)\([^;{}]*\) \{", re.M)
WORD = re.compile(r"[A-Za-z_]\w*")
PYTHON, C = ".py", ".c"
WHOLE_FILE = "*"
"""Ends the context of a fixture that several tests share."""


def collect(folder: Path, root: Path, tests: Iterable[str]) -> Lines:
    """The test functions of each line of each file below a root, from the files that coverage left in a folder."""
    from coverage import CoverageData

    every = sorted(tests)
    reached: dict[str, dict[int, set[str]]] = defaultdict(lambda: defaultdict(set))
    for path in sorted(folder.glob("lines.*")):
        data = CoverageData(str(path))
        data.read()
        of_context = {context: _tests_of(context, every) for context in data.measured_contexts()}
        for file in data.measured_files():
            for line, contexts in data.contexts_by_lineno(file).items():
                reached[file.removeprefix(f"{root}/")][line].update(*(of_context[context] for context in contexts))
        data.close()
    return {file: {line: frozenset(found) for line, found in lines.items()} for file, lines in reached.items()}


def _tests_of(context: str, every: list[str]) -> list[str]:
    """Return the tests of a context: the inherited one and the switched one stand on either side of a bar."""
    name = context.partition("|")[2] if context.startswith("|") else context.partition("|")[0]
    if name.endswith(WHOLE_FILE):
        stem = name.removesuffix(WHOLE_FILE)
        return [test for test in every if test.startswith((f"{stem}/", f"{stem}::"))]
    return [name] if "::" in name else []


def merged(old: Lines, new: Lines, measured: Container[str]) -> Lines:
    """Merge lines measured again into the old ones; nothing old of the measured tests counts."""
    lines: dict[str, dict[int, frozenset[str]]] = {}
    for file in old.keys() | new.keys():
        before, now = old.get(file, {}), new.get(file, {})
        lines[file] = {
            line: frozenset(test for test in before.get(line, ()) if test not in measured) | now.get(line, frozenset())
            for line in before.keys() | now.keys()
        }
    return lines


def save(path: Path, lines: Lines) -> None:
    """Write what was measured; many lines share a set of tests."""
    tests = sorted({test for of_file in lines.values() for found in of_file.values() for test in found})
    number = {test: i for i, test in enumerate(tests)}
    sets: dict[frozenset[str], int] = {}
    files = {
        file: {line: sets.setdefault(found, len(sets)) for line, found in sorted(lines[file].items())}
        for file in sorted(lines)
    }
    kept = {"tests": tests, "sets": [sorted(number[test] for test in found) for found in sets], "files": files}
    path.write_text(json.dumps(kept), encoding="utf-8")


def load(path: Path) -> Lines:
    """Read what was measured, if anything was."""
    if not path.exists():
        return {}
    kept = json.loads(path.read_text(encoding="utf-8"))
    sets = [frozenset(kept["tests"][i] for i in found) for found in kept["sets"]]
    return {name: {int(n): sets[i] for n, i in of_file.items()} for name, of_file in kept["files"].items()}


@dataclass(frozen=True, slots=True)
class Piece:
    """A function or another statement of a module: the names it defines, and whether coverage sees when it runs."""

    defines: frozenset[str]
    body: range = range(0)
    """Lines of a function without its head, which runs once, at import."""
    measured: bool = False
    languages: tuple[str, ...] = (PYTHON,)
    """Languages whose code may name it."""


class Reach:
    """Test functions by line, of every source under a root."""

    def __init__(self, root: Path, lines: Lines) -> None:
        self._lines = lines
        self._pieces: dict[str, dict[int, Piece]] = {}
        self._statements: dict[str, dict[int, range]] = {}
        self._called: dict[Piece, frozenset[str]] = {}
        self._named: dict[tuple[str, str], list[tuple[str, int]]] = defaultdict(list)
        for path in sorted(path for name in ("ratt_opt", "ratt_audit") for path in (root / name).rglob("*.*")):
            if path.suffix in {".py", ".c", ".h"}:
                self._read(path.relative_to(root).as_posix(), path.read_text(encoding="utf-8"))

    def _read(self, file: str, text: str) -> None:
        if file.endswith(PYTHON):
            tree = ast.parse(text)
            self._pieces[file], self._statements[file] = _pieces_of_python(tree), _statements(tree)
            named = [((PYTHON, name), line) for name, line in _names(tree)]
        else:
            text = NO_CODE.sub(lambda found: re.sub(r"[^\n]", " ", found[0]), text)
            self._pieces[file] = _pieces_of_c(text)
            inside = [(number, line) for number, line in _numbered(text) if self._pieces[file][number].body]
            named = [((C, word), number) for number, line in inside for word in WORD.findall(line)]
        for key, line in named:
            self._named[key].append((file, line))

    def tests(self, file: str, line: int) -> frozenset[str]:
        """The test functions that reach a line, or may."""
        piece = self._pieces[file].get(line, Piece(frozenset()))
        if piece.measured:
            statement = self._statements[file].get(line, range(line, line + 1))
            return self._of_lines(file, statement) or self._of_lines(file, piece.body)
        return self._of_callers(piece) or self._of_lines(file, self._lines.get(file, ()))

    def every_line(self) -> Iterator[frozenset[str]]:
        """The tests of each line of a function."""
        for file, pieces in self._pieces.items():
            for line, piece in pieces.items():
                if line in piece.body:
                    yield self._of_lines(file, [line]) if piece.measured else self._of_callers(piece)

    def _of_lines(self, file: str, numbers: Iterable[int]) -> frozenset[str]:
        known = self._lines.get(file, {})
        return frozenset[str]().union(*(known.get(number, frozenset()) for number in numbers))

    def _of_callers(self, piece: Piece) -> frozenset[str]:
        """The tests of all measured lines that name a piece, or one that is not measured and names it."""
        if piece not in self._called:
            self._called[piece] = self._found_by_callers(piece)
        return self._called[piece]

    def _found_by_callers(self, piece: Piece) -> frozenset[str]:
        seen, ahead = {piece}, [piece]
        found: set[str] = set()
        while ahead:
            one = ahead.pop()
            for file, line in (at for key in product(one.languages, one.defines) for at in self._named.get(key, ())):
                caller = self._pieces[file].get(line, piece)
                if caller.measured:
                    found |= self._lines.get(file, {}).get(line, frozenset())
                elif caller not in seen:
                    seen.add(caller)
                    ahead.append(caller)
        return frozenset(found)


def _pieces_of_python(tree: ast.Module) -> dict[int, Piece]:
    """Map lines to pieces: the outermost function around a line, or the statement of the module."""
    pieces: dict[int, Piece] = {}
    for node in [*(one for one in ast.walk(tree) if isinstance(one, ast.FunctionDef)), *tree.body]:
        end = (node.end_lineno or 0) + 1
        if isinstance(node, ast.FunctionDef):
            piece = Piece(frozenset({node.name}), range(node.body[0].lineno, end), measured=True)
        else:
            stored = (one for one in ast.walk(node) if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store))
            name = {node.name} if isinstance(node, ast.ClassDef) else set()
            piece = Piece(frozenset({one.id for one in stored} | name))
        for line in range(node.lineno, end):
            pieces.setdefault(line, piece)
    return pieces


def _names(tree: ast.Module) -> Iterator[tuple[str, int]]:
    """All names, attributes and texts, with their lines."""
    for node in ast.walk(tree):
        match node:
            case ast.Name(id=name) | ast.Attribute(attr=name) | ast.Constant(value=str(name)):
                yield name, node.lineno


def _statements(tree: ast.Module) -> dict[int, range]:
    """Lines of the smallest statement that contains a line: of one with a body, its head."""
    found: dict[int, range] = {}
    for node in ast.walk(tree):  # outer ones first
        if isinstance(node, ast.stmt):
            body = getattr(node, "body", None)
            end = body[0].lineno - 1 if body else node.end_lineno or 0
            lines = range(node.lineno, max(node.lineno, end) + 1)
            found |= dict.fromkeys(lines, lines)
    return found


def _numbered(text: str) -> Iterable[tuple[int, str]]:
    return enumerate(text.split("\n"), start=1)


def _pieces_of_c(text: str) -> dict[int, Piece]:
    """Map lines to pieces.

    Functions end as they are formatted: with the last bracket alone, or at the end of the only line.
    """
    pieces: dict[int, Piece] = {}
    for head in C_FUNCTION.finditer(text):
        first = text.find("\n", head.end())
        end = first if text[:first].endswith("}") else text.find("\n}\n", head.end()) + 2
        begin = text.count("\n", 0, head.start()) + 1
        lines = range(begin, begin + text.count("\n", head.start(), end) + 1)
        languages = (PYTHON, C) if head[0].startswith("EXPORTED") else (C,)
        pieces |= dict.fromkeys(lines, Piece(frozenset({head["name"]}), lines, languages=languages))
    for number, line in _numbered(text):  # of constants and records
        pieces.setdefault(number, Piece(frozenset(WORD.findall(line)), languages=(C,)))
    return pieces
