r"""Tables for papers: LaTeX with the rules of the package ``booktabs``, which the preamble has to load."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from rich.table import Table

__all__ = ["in_symbols", "latex_of", "latex_table"]

SPECIAL = {
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    **{character: f"\\{character}" for character in "&%$#_{}"},
    "\N{HORIZONTAL ELLIPSIS}": r"\ldots{}",
    "\N{RIGHTWARDS ARROW}": r"$\to$",
    "\N{MULTIPLICATION SIGN}": r"$\times$",
    "\N{MINUS SIGN}": r"$-$",
    "\N{PLUS-MINUS SIGN}": r"$\pm$",
    "\N{LESS-THAN OR EQUAL TO}": r"$\le$",
    "\N{GREATER-THAN OR EQUAL TO}": r"$\ge$",
    "\N{SUPERSCRIPT TWO}": r"$^2$",
    "\N{EN DASH}": "--",
    "<": r"$<$",
    ">": r"$>$",
}
"""Characters that LaTeX would read as commands, or that its oldest fonts lack."""
SYMBOLS = {"alpha_s": r"$\alpha_s$", "alpha_c": r"$\alpha_c$", "alpha_cs": r"$\alpha_{cs}$", "n_max": r"$n_{\max}$"}
"""The paper's symbols of what the library writes in letters."""
SYMBOL = re.compile(rf"(?<!\w)({'|'.join(SYMBOLS)})(?!\w)")
NUMBER = re.compile(r"[\[+-]?\d.*")
"""Pattern of the beginning of cells in a column that is set flush right."""


def latex_table(columns: Sequence[str], rows: Iterable[Sequence[str]], *, caption: str = "", note: str = "") -> str:
    """Return a ``tabular``, in a ``table`` if it has a caption; every text is escaped, columns of numbers flush right.

    ``note`` : set in small letters under the table
    """
    cells = [[_escaped(cell) for cell in row] for row in rows]
    kinds = "".join(_alignment([row[k] for row in cells]) for k in range(len(columns)))
    lines = [
        f"\\begin{{tabular}}{{@{{}}{kinds}@{{}}}}",
        r"\toprule",
        _row(map(_escaped, columns)),
        r"\midrule",
        *map(_row, cells),
        r"\bottomrule",
        r"\end{tabular}",
    ]
    if caption:
        small = [r"\par\smallskip", f"{{\\footnotesize {_escaped(note)}\\par}}"] if note else []
        lines = [r"\begin{table}", r"\centering", f"\\caption{{{_escaped(caption)}}}", *lines, *small, r"\end{table}"]
    return "\n".join(lines) + "\n"


def latex_of(table: Table) -> str:
    """Return a table of the terminal as LaTeX: its title is the caption, its caption the note."""
    columns = [list(column.cells) for column in table.columns]
    rows = [[str(cell) for cell in row] for row in zip(*columns, strict=True)]
    header = [str(column.header) for column in table.columns]
    return latex_table(header, rows, caption=str(table.title or ""), note=str(table.caption or ""))


def _row(cells: Iterable[str]) -> str:
    # After a row's end LaTeX takes a bracket for an argument.
    text = " & ".join(cells)
    return ("{}" if text.startswith("[") else "") + text + r" \\"


def _alignment(cells: Sequence[str]) -> str:
    told = [cell for cell in cells if cell and cell != "none"]
    return "r" if told and all(NUMBER.fullmatch(cell) and "," not in cell.lstrip("[") for cell in told) else "l"


def in_symbols(text: str) -> str:
    """Return a text with the paper's symbols as mathematics, which LaTeX and matplotlib read alike."""
    return SYMBOL.sub(lambda found: SYMBOLS[found[0]], text)


def _escaped(text: str) -> str:
    """Return the text for LaTeX, with the paper's symbols."""
    parts = SYMBOL.split(text)  # every second part is a symbol
    return "".join(SYMBOLS[part] if k % 2 else _letters(part) for k, part in enumerate(parts))


def _letters(text: str) -> str:
    return "".join(SPECIAL.get(character, character) for character in text)
