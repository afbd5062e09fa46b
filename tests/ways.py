"""Ways that a search is sent: limits inside the package, for as long as a test runs.

A way is a table ``{(module, name): value}``; each family has its own in its ``engine.py``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pytest

__all__ = ["Way", "go"]

Way = dict[tuple[Any, str], Any]


def go(monkeypatch: pytest.MonkeyPatch, *ways: Way) -> None:
    """Let searches go these ways until the test ends."""
    for way in ways:
        for (module, name), value in way.items():
            monkeypatch.setattr(module, name, value)
