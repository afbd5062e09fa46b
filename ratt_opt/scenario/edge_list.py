"""Lists of edges: two nodes a line, then a weight or attributes as networkx writes them, and nothing else.

Many text files look like such a list and are none: with a header, with counts, other comment marks, adjacency lists,
matrices. Read as edges, they become another network. A line that may be no edge is refused, with what to write instead.
"""

from __future__ import annotations

import re
from ast import literal_eval
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

import networkx as nx

from ratt_opt.errors import FileFormatError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

__all__ = ["parse_edge_list"]

OTHER_MARKS = ("%", "//", "/*", "*", ";", "!", "--", "<", "[", "{", "(")
"""First characters of lines of other formats: comments, sections, Pajek, MatrixMarket, XML, JSON."""
NOT_IN_A_NAME = re.compile(r"""[,;|"<>\[\]{}]|^'|'$""")
INTEGER = re.compile(r"[+-]?\d+")
HEADINGS = re.compile(
    "(from|to|source|target|src|dst|dest|origin|destination|start|end|head|tail|nodes?|edges?|vertex|vertices)"
    "_?(node|vertex)?_?(id|name|from|to)?"
)
"""Words of header rows, in small letters."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Line:
    """An edge as it stands in the file: line number, its two nodes, and the text of what follows them."""

    number: int
    nodes: tuple[str, str]
    rest: str

    @property
    def words(self) -> list[str]:
        return [*self.nodes, *([self.rest] if self.rest else [])]

    @property
    def are_integers(self) -> bool:
        return all(INTEGER.fullmatch(word) for word in self.words)

    @property
    def kind(self) -> str:
        return "attributes" if self.rest.startswith("{") else "a weight" if self.rest else "nothing"


@dataclass(frozen=True, slots=True)
class _Doubt:
    """Reason why the line with this number may be no edge."""

    number: int
    rule: str


def parse_edge_list(text: str, name: str) -> nx.MultiDiGraph:
    """Read a bare list of edges; directed, as lists often have each edge in both directions.

    A line is ``node node``, ``node node weight`` or ``node node {attributes}``, separated by spaces or tabs. All lines
    are of one of these kinds. ``#`` begins a comment, at the start of a line or of a word after the edge.

    Parameters
    ----------
    text : the whole file
    name : of the file, for errors

    Raises
    ------
    FileFormatError : a line is no edge, or may be none; the text names the line and the rule.
    """
    shown = text.splitlines()
    lines = list(_lines(shown, name))
    doubts = (find(lines) for find in DOUBTS) if lines else ()
    doubt = next((doubt for doubt in doubts if doubt is not None), None) or _sections(shown)
    if doubt is not None:
        raise FileFormatError(f"{name} line {doubt.number}", doubt.rule, shown[doubt.number - 1])
    graph = nx.MultiDiGraph()
    for line in lines:
        graph.add_edge(*line.nodes, **_attributes(line, name))
    return graph


def _lines(shown: list[str], name: str) -> Iterator[_Line]:
    for number, text in enumerate(shown, start=1):
        edge = re.sub(r"(^|\s)#.*", "", text).strip()
        if not edge:
            continue
        words = edge.split(maxsplit=2)
        rule = _broken_rule(edge, words)
        if rule:
            raise FileFormatError(f"{name} line {number}", rule, text)
        yield _Line(number=number, nodes=(words[0], words[1]), rest=words[2] if len(words) > 2 else "")


def _broken_rule(edge: str, words: list[str]) -> str:
    if edge.startswith(OTHER_MARKS):
        return "must be an edge: two nodes (a comment begins with #)"
    if len(words) == 1:
        return "must name two nodes, separated by spaces or tabs"
    if any(NOT_IN_A_NAME.search(word) for word in words[:2]):
        return "must name two nodes without commas, quotes or brackets, separated by spaces or tabs"
    if len(words) > 2 and not (words[2].startswith("{") or _is_number(words[2])):
        return "must be an edge: two nodes, then nothing, one weight or {attributes}"
    return ""


def _is_number(text: str) -> bool:
    try:
        return isfinite(float(text)) and "_" not in text
    except ValueError:
        return False


def _attributes(line: _Line, name: str) -> dict[str, object]:
    if line.kind == "a weight":
        return {"weight": float(line.rest)}
    try:
        given = literal_eval(line.rest) if line.rest else {}
    except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError):
        given = None
    if not isinstance(given, dict) or not all(isinstance(key, str) for key in given):
        rule = "must end in attributes as Python writes them, {'weight': 2.5}"
        raise FileFormatError(f"{name} line {line.number}", rule, line.rest)
    return given


def _several_kinds(lines: list[_Line]) -> _Doubt | None:
    """Counts before weighted edges, adjacency lists, DIMACS: lines of different lengths."""
    for line in lines:
        if line.kind != lines[0].kind:
            return _Doubt(line.number, f"must have {lines[0].kind} after its two nodes, as line {lines[0].number} has")
    return None


def _header(lines: list[_Line]) -> _Doubt | None:
    """Text over numbers, or words of headings, that stand nowhere else."""
    first, others = lines[0], _nodes(lines[1:])
    if first.rest or not others or others & set(first.nodes) or any(map(_is_number, first.nodes)):
        return None
    are_headings = all(HEADINGS.fullmatch(node.strip("_").lower()) for node in first.nodes)
    is_header = are_headings or all(map(_is_number, others))
    return _Doubt(first.number, "must be an edge, not a header row") if is_header else None


def _counts(lines: list[_Line]) -> _Doubt | None:
    """``n m`` (OR-Library, METIS) or ``n n m`` (MatrixMarket) over at most ``n`` nodes and ``m`` lines."""
    first, rest = lines[0], lines[1:]
    if not rest or not first.are_integers:
        return None
    others = _nodes(rest)
    n, m, *more = map(int, first.words)
    is_numbered = n == len(others) and others in ({str(k) for k in range(n)}, {str(k + 1) for k in range(n)})
    are_counts = n >= len(others) and len(rest) in {m, 2 * m}
    is_size = n == m and n >= len(others) and len(rest) in more
    is_beyond = is_numbered and m > n + 1
    height = rest[-1].number - first.number
    has_empty_rows = len(rest) < height and height in {n - 1, n}
    if not (are_counts or is_size or is_beyond or has_empty_rows):
        return None
    rule = f"must be an edge, not the numbers of nodes and edges (an edge is clear as {m} {n})"
    return _Doubt(first.number, rule)


def _kinds_of_record(lines: list[_Line]) -> _Doubt | None:
    """``e 1 2`` (DIMACS, gSpan): a word for the kind of line, then two numbers."""
    heads = {line.nodes[0] for line in lines}
    is_kind = len(heads) == 1 or all(len(head) == 1 for head in heads)
    are_ends = all(INTEGER.fullmatch(line.nodes[1]) and INTEGER.fullmatch(line.rest) for line in lines)
    if not (is_kind and are_ends) or any(_is_number(head) for head in heads):
        return None
    return _Doubt(lines[0].number, "must begin with a node, not with the kind of line (a weight is clear as 2.0)")


def _matrix(lines: list[_Line]) -> _Doubt | None:
    """Three rows of three numbers that are symmetric, or all 0 and 1."""
    rows = [line.words for line in lines]
    if len(rows) != 3 or not all(len(row) == 3 and all(map(_is_number, row)) for row in rows):
        return None
    numbers = [[float(word) for word in row] for row in rows]
    is_symmetric = all(numbers[i][j] == numbers[j][i] for i in range(3) for j in range(i))
    is_binary = all(x in {0.0, 1.0} for row in numbers for x in row)
    rule = "must be an edge, not the row of a matrix"
    return _Doubt(lines[0].number, rule) if is_symmetric or is_binary else None


def _adjacency_list(lines: list[_Line]) -> _Doubt | None:
    """Each first word once, and a third word that is always a third node: neighbours."""
    nodes, heads = _nodes(lines), {line.nodes[0] for line in lines}
    if not 1 < len(lines) == len(heads) or not all(line.rest in nodes - set(line.nodes) for line in lines):
        return None
    rule = "must be an edge and a weight, not a node and its neighbours (a weight is clear as 2.0)"
    return _Doubt(lines[0].number, rule)


def _numbered_edges(lines: list[_Line]) -> _Doubt | None:
    """Edges after their numbers: integers that count up from 0 or 1, but no path along them."""
    if len(lines) < 3 or not all(line.rest and line.are_integers for line in lines):
        return None
    heads, seconds, _ = zip(*(map(int, line.words) for line in lines), strict=True)
    is_path = all(second == head + 1 for head, second in zip(heads, seconds, strict=True))
    if is_path or heads[0] not in {0, 1} or heads != tuple(range(heads[0], heads[0] + len(heads))):
        return None
    rule = "must be an edge and a weight, not the number of an edge and its nodes (a weight is clear as 2.0)"
    return _Doubt(lines[0].number, rule)


def _nodes(lines: Iterable[_Line]) -> set[str]:
    return {node for line in lines for node in line.nodes}


def _sections(shown: list[str]) -> _Doubt | None:
    """A lone ``#`` between lines with words: the nodes of the Trivial Graph Format end there."""
    words = [number for number, text in enumerate(shown, start=1) if text.strip() and not text.lstrip().startswith("#")]
    lone = [number for number, text in enumerate(shown, start=1) if text.strip() == "#"]
    for number in lone:
        if words and words[0] < number < words[-1]:
            return _Doubt(number, "must be an edge: # alone parts nodes from edges in another format")
    return None


DOUBTS = (_several_kinds, _header, _counts, _kinds_of_record, _matrix, _adjacency_list, _numbered_edges)
"""Each finds a line that may be no edge, though it has the form of one."""
