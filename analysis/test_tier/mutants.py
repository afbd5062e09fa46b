"""Small faults of Python: each a changed piece of the source, by the kinds that mutation testing knows.

Source: A. J. Offutt et al., "An experimental determination of sufficient mutant operators", ACM TOSEM 5 (1996): of 22
kinds the relational, arithmetic, logical and absolute-value ones suffice; dropped statements and constants are added.
"""

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import accumulate

__all__ = ["Mutant", "python_mutants"]

COMPARED = (ast.Lt, ast.LtE, ast.Gt, ast.GtE, ast.Eq, ast.NotEq, ast.Is, ast.IsNot, ast.In, ast.NotIn)
COMPARISONS = dict(zip(COMPARED, ("<=", "<", ">=", ">", "!=", "==", "is not", "is", "not in", "in"), strict=True))
ADDED = (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.FloorDiv, ast.BitAnd, ast.BitOr)
ARITHMETIC = dict(zip(ADDED, ("-", "+", "/", "*", "*", "|", "&"), strict=True))
PAIRS = ("min max", "minimum maximum", "argmin argmax", "any all", "floor ceil", "union intersection")
EXCHANGED = {"append": "remove"} | {a: b for pair in PAIRS for a, b in (pair.split(), pair.split()[::-1])}


@dataclass(frozen=True, slots=True)
class Mutant:
    """Characters ``begin`` to ``end`` of a file become ``text``; ``line`` is the first of them."""

    file: str
    line: int
    kind: str
    begin: int
    end: int
    text: str

    def apply(self, source: str) -> str:
        """The file with the fault."""
        return source[: self.begin] + self.text + source[self.end :]

    def __str__(self) -> str:
        return f"{self.file}:{self.line} {self.kind}: {' '.join(self.text.split())}"


def python_mutants(file: str, source: str) -> list[Mutant]:
    """All faults of a module, in its order; none in annotations, messages of errors, decorators and assertions."""
    places = _Places(source)
    found = []
    for node in _nodes(ast.parse(source)):
        for kind, part, text in _changes(node, places):
            begin, end = places.of(part)
            if source[begin:end] != text:
                found.append(Mutant(file, part.lineno, kind, begin, end, text))
    return sorted(found, key=lambda one: (one.begin, one.end, one.kind))


class _Places:
    """Places of nodes in a text; Python counts bytes of UTF-8 in a line."""

    def __init__(self, source: str) -> None:
        self._source = source
        self._lines = source.splitlines(keepends=True)
        self._starts = [0, *accumulate(len(line) for line in self._lines)]

    def of(self, node: ast.expr | ast.stmt) -> tuple[int, int]:
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        ends = ((node.lineno, node.col_offset), (node.end_lineno, node.end_col_offset))
        begin, end = (self._starts[i - 1] + len(self._lines[i - 1].encode()[:byte].decode()) for i, byte in ends)
        return begin, end

    def text(self, node: ast.expr) -> str:
        begin, end = self.of(node)
        return self._source[begin:end]


def _nodes(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the nodes that run and decide something."""
    if isinstance(node, ast.Raise | ast.Assert | ast.Import | ast.ImportFrom | ast.JoinedStr):
        return
    if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
        return
    yield node
    skipped = {"annotation", "returns", "decorator_list", "bases", "type_comment"}
    for name, value in ast.iter_fields(node):
        if name in skipped:
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST):
                yield from _nodes(child)


def _changes(node: ast.AST, places: _Places) -> Iterator[tuple[str, ast.expr | ast.stmt, str]]:
    if isinstance(node, ast.If | ast.While | ast.IfExp):
        yield "condition", node.test, f"(not ({places.text(node.test)}))"
    if isinstance(node, ast.expr):
        yield from ((kind, node, text) for kind, text in _other_values(node, places))
    calls = isinstance(node, ast.Expr) and isinstance(node.value, ast.Call)
    if isinstance(node, ast.AugAssign | ast.Break | ast.Continue) or (isinstance(node, ast.stmt) and calls):
        yield "statement", node, "pass"
    if isinstance(node, ast.Call):
        name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
        if name in EXCHANGED:
            text = places.text(node.func)
            yield "function", node.func, text.removesuffix(name) + EXCHANGED[name]


def _other_values(node: ast.expr, places: _Places) -> Iterator[tuple[str, str]]:
    text = places.text
    match node:
        case ast.Compare(left=left, ops=[operator], comparators=[right]):
            yield "comparison", f"(({text(left)}) {COMPARISONS[type(operator)]} ({text(right)}))"
        case ast.BoolOp(op=operator, values=values):
            other = " or " if isinstance(operator, ast.And) else " and "
            yield "logic", "(" + other.join(f"({text(value)})" for value in values) + ")"
        case ast.BinOp(left=left, op=operator, right=right) if type(operator) in ARITHMETIC:
            if not any(
                isinstance(one, ast.JoinedStr) or isinstance(getattr(one, "value", 0), str) for one in (left, right)
            ):
                yield "arithmetic", f"(({text(left)}) {ARITHMETIC[type(operator)]} ({text(right)}))"
        case ast.UnaryOp(op=ast.USub() | ast.Not(), operand=operand):
            yield "sign", f"({text(operand)})"
        case ast.Constant(value=bool() as value):
            yield "constant", str(not value)
        case ast.Constant(value=int() | float() as value):
            yield "constant", f"({value!r} + 1)"
        case ast.Call(func=ast.Name(id="abs"), args=[argument]):
            yield "function", f"({text(argument)})"
        case _:
            return
