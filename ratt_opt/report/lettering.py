"""Text of users in figures: every letter as it is, on one line, no longer than there is room for.

matplotlib reads text between two ``$`` as mathematics, breaks lines, and draws boxes for letters that its font lacks.
Every figure passes what users named through :func:`literal`, and itself through :func:`choose_fonts` once it is whole.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from textwrap import wrap
from typing import TYPE_CHECKING
from unicodedata import normalize

from ratt_opt.errors import printable

if TYPE_CHECKING:
    from matplotlib.artist import Artist

__all__ = ["Lettering", "choose_fonts", "in_lines", "literal"]

PLACEHOLDERS = "Last Resort"
"""A font that has a box for every letter, which tells a reader less than an escape."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Lettering:
    """Room for text of users.

    ``longest`` : letters of a name in a figure. More of them tell names apart that begin alike; they also cover other
    names and narrow the axes. The whole name stands in the tables.
    ``line`` : letters of a line where a name is broken into lines, beside an axis; fewer leave more to the axes.
    """

    longest: int = 32
    line: int = 18


ROOM = Lettering()


def literal(text: str, room: Lettering = ROOM) -> str:
    r"""Return the text so that matplotlib draws it letter by letter, on one line.

    - What is too long loses its middle.
    - A letter that no installed font has, and what is not printable, are written as escapes: ``\u65e5``.
    - ``$`` begins no mathematics.
    """
    return _kept(text, room).replace("$", r"\$")


def in_lines(text: str, room: Lettering = ROOM) -> str:
    """Return what :func:`literal` returns, broken into short lines."""
    return "\n".join(wrap(_kept(text, room), room.line)).replace("$", r"\$")


def _kept(text: str, room: Lettering) -> str:
    """The letters of a text that are drawn."""
    kept = _shortened(normalize("NFC", printable(text)), room.longest)
    lacking = _lacking(kept)
    if lacking and _font_with(lacking) is None:
        kept = "".join(x.encode("unicode_escape").decode() if ord(x) in lacking else x for x in kept)
    return kept


def choose_fonts(drawn: Artist) -> None:
    """Give each text of a figure, or one text, a further font where its own lacks letters."""
    from matplotlib.text import Text

    for artist in drawn.findobj(Text):
        assert isinstance(artist, Text)
        lacking = _lacking(artist.get_text())
        if lacking and (other := _font_with(lacking)) is not None:
            artist.set_fontfamily([*artist.get_fontfamily(), other])


def _shortened(text: str, longest: int) -> str:
    head = longest // 2
    return text if len(text) <= longest else f"{text[:head]}…{text[head + 1 - longest :]}"


def _lacking(text: str) -> frozenset[int]:
    """The code points of a text that the figures' own font lacks."""
    return frozenset(ord(letter) for letter in text if not letter.isspace()) - _own_letters()


@lru_cache(maxsize=1024)
def _font_with(lacking: frozenset[int]) -> str | None:
    """The name of an installed font that has these code points together."""
    from matplotlib.font_manager import fontManager

    known = (font for font in fontManager.ttflist if PLACEHOLDERS not in font.name)
    return next((font.name for font in known if lacking <= _letters(font.fname)), None)


def _own_letters() -> frozenset[int]:
    import matplotlib as mpl
    from matplotlib.font_manager import FontProperties, findfont

    return _letters(findfont(FontProperties(family=mpl.rcParams["font.family"])))


@lru_cache(maxsize=256)
def _letters(path: str) -> frozenset[int]:
    """The code points of a font; none if it cannot be read."""
    from matplotlib.ft2font import FT2Font

    try:
        return frozenset(FT2Font(path).get_charmap())
    except (OSError, RuntimeError):
        return frozenset()
