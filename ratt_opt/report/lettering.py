"""Letters that the figures' font lacks: another font that is installed, or their escapes."""

from __future__ import annotations

from functools import lru_cache

__all__ = ["lettering"]

PLACEHOLDERS = "Last Resort"
"""A font that has a box for every letter, which tells a reader less than an escape."""


@lru_cache(maxsize=1024)
def lettering(text: str) -> tuple[str, tuple[str, ...]]:
    """The text as it can be drawn, and the font families that have its letters, the figures' own first.

    Letters that no installed font has together are written as escapes: ``\\u65e5``.
    """
    import matplotlib as mpl
    from matplotlib.font_manager import FontProperties, findfont, fontManager

    own = tuple(mpl.rcParams["font.family"])
    lacking = {ord(letter) for letter in text if not letter.isspace()} - _letters(findfont(FontProperties(family=own)))
    if not lacking:
        return text, own
    for font in fontManager.ttflist:
        if PLACEHOLDERS not in font.name and lacking <= _letters(font.fname):
            return text, (*own, font.name)
    return "".join(x.encode("unicode_escape").decode() if ord(x) in lacking else x for x in text), own


@lru_cache(maxsize=256)
def _letters(path: str) -> frozenset[int]:
    """The code points of a font; none if it cannot be read."""
    from matplotlib.ft2font import FT2Font

    try:
        return frozenset(FT2Font(path).get_charmap())
    except (OSError, RuntimeError):
        return frozenset()
