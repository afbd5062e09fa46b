"""The numbered lines of the appendix as the paper prints them, in LaTeX without its own macros."""

from __future__ import annotations

import json
from functools import cache
from importlib.resources import files

__all__ = ["Formula", "equation_number", "numbered", "printed_line", "printed_lines"]


class Formula(str):
    """A text that is LaTeX: pages typeset it instead of escaping it."""

    __slots__ = ()


def printed_line(label: str) -> Formula | None:
    """The line with this label (without ``eq:``); a line that starts with a relation continues the one above it."""
    text = printed_lines().get(label)
    return None if text is None else Formula(text)


@cache
def printed_lines() -> dict[str, str]:
    """All of them, by label."""
    text = (files(__package__) / "printed.json").read_text(encoding="utf-8")
    return {str(label): str(line) for label, line in json.loads(text).items()}


def equation_number(label: str) -> int | None:
    """The number that the paper prints beside the equation with this label (without ``eq:``); ``None`` if it has none.

    ``numbers.json`` counts the numbered lines of ratt.tex in the order of the document, as LaTeX does.
    """
    return _numbers().get(label)


def numbered(label: str) -> str:
    """A label with the number that the paper prints: "nd_p1d1v1_8 (19)"."""
    number = equation_number(label)
    return label if number is None else f"{label} ({number})"


@cache
def _numbers() -> dict[str, int]:
    text = (files(__package__) / "numbers.json").read_text(encoding="utf-8")
    return {str(label): int(number) for label, number in json.loads(text).items()}
