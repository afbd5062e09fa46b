"""Small faults of C, of the same kinds, in the sources of the compiled loops: by what operators look like there."""

import re
from collections.abc import Iterator

from analysis.test_tier.mutants import Mutant

__all__ = ["c_mutants"]

NO_CODE = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\])*"|^#[^\n]*', re.DOTALL | re.MULTILINE)
CHANGED = {
    "comparison": ("< <=", "<= <", "> >=", ">= >", "== !=", "!= =="),
    "logic": ("&& ||", "|| &&"),
    "arithmetic": ("+ -", "- +", "+= -=", "-= +=", "/ *", "& |", "| &"),
}
OPERATORS = {f" {old} ": (kind, f" {new} ") for kind, of in CHANGED.items() for old, new in map(str.split, of)}
OPERATOR = re.compile("|".join(re.escape(text) for text in sorted(OPERATORS, key=len, reverse=True)))
NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?(?![\w.])")
CONDITION = re.compile(r"\b(?:if|while) \(")
STATEMENT = re.compile(
    r"^ +(?![^\n]*\b(?:return|for|if|else|while|double|int\w*|uint\w*|const|size_t)\b)[^\n;{}=]+ ?[-+|&]?= [^\n;{}]+;$",
    re.M,
)


def c_mutants(file: str, source: str) -> list[Mutant]:
    """All faults of a file, in its order."""
    code = NO_CODE.sub(lambda found: re.sub(r"[^\n]", "\0", found[0]), source)
    found = [
        Mutant(file, source.count("\n", 0, begin) + 1, kind, begin, end, text)
        for begin, end, kind, text in _changes(code)
    ]
    return sorted(found, key=lambda one: (one.begin, one.end, one.kind))


def _changes(code: str) -> Iterator[tuple[int, int, str, str]]:
    for found in OPERATOR.finditer(code):
        yield *found.span(), *OPERATORS[found[0]]
    for found in NUMBER.finditer(code):
        yield *found.span(), "constant", f"({found[0]} + 1)"
    for found in STATEMENT.finditer(code):
        yield *found.span(), "statement", "    ;"
    for found in CONDITION.finditer(code):
        end = _closing(code, found.end())
        yield found.end(), end, "condition", f"!({code[found.end() : end]})"


def _closing(code: str, begin: int) -> int:
    """Find where the bracket that is open at ``begin`` closes."""
    depth = 1
    for place in range(begin, len(code)):
        depth += {"(": 1, ")": -1}.get(code[place], 0)
        if depth == 0:
            return place
    raise AssertionError("a bracket stays open")
