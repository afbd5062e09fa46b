"""Errors a user can act on."""

from __future__ import annotations

import re

__all__ = ["FileFormatError", "InputError", "ProofError", "UndecidedError", "printable"]

_LITERAL = re.compile(
    r"[-+]?(\d[\d_]*\.?\d*|\.\d+)([eE][-+]?\d+)?|[-+]?([nN][aA][nN]|[iI]nf|[iI]nfinity)|[Tt]rue|[Ff]alse|None|null"
)
"""Text of a number or a constant."""


def printable(text: str) -> str:
    """The text on one line, as text: what would steer a terminal or cannot be encoded is shown by its escape.

    Control and escape characters, marks of writing direction and lone surrogates are all not printable.
    """
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in " ".join(text.split()))


def _shown(value: object) -> str:
    """The value on one line; text that would read as a number, a constant or other text is quoted."""
    text = printable(str(value)) or repr(value)
    if isinstance(value, str) and (value != value.strip() or _LITERAL.fullmatch(text)):
        text = printable(repr(str(value)))
    return text if len(text) <= 80 else text[:77] + "..."  # a line of a terminal


class InputError(ValueError):
    """An argument breaks a rule; the text is one line: argument, rule, value.

    Parameters
    ----------
    argument : name of the argument, field or file that is wrong
    rule : what must hold, as a phrase that follows the name ("must be in [0, 4]")
    value : the offending value; shown on one line, cut when long
    """

    def __init__(self, argument: str, rule: str, value: object) -> None:
        super().__init__(argument, rule, value)
        self.argument = argument
        self.rule = rule
        self.value = value

    def __str__(self) -> str:
        return f"{printable(self.argument)} {printable(self.rule)}; got {_shown(self.value)}"


class FileFormatError(InputError):
    """A file cannot be read as what it should be; ``argument`` names the file and the field or line."""


class ProofError(Exception):
    """A certificate, or a bound of a search, does not prove its claim; the text names the first fault.

    A search raises it if an end of its bracket excludes the other one, which neither limits nor interrupts cause: then
    a bound is false, or a set function is not what it says.

    ``report`` : what ``ratt_opt.bound`` had found when its own proof failed, a ``BoundReport``; otherwise ``None``.
    """

    report: object = None

    def __init__(self, fault: object = "") -> None:
        super().__init__(printable(str(fault)))


class UndecidedError(ProofError):
    """A certificate is neither proved nor refuted within the verifier's limits; the text names the limit."""
