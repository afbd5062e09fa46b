"""The public names by topic, read from the headings of ``__init__.pyi``, so that they stand once."""

from __future__ import annotations

import re

__all__ = ["names_of", "read_topics"]

_MARK = re.compile(r"^# == (?P<topic>.+)$|(?P<name>\w+) as (?P=name)", re.MULTILINE)


def read_topics(stub: str) -> dict[str, tuple[str, ...]]:
    """Return each heading ``# == TOPIC`` with the names imported below it, in the order of the file."""
    topics: dict[str, list[str]] = {}
    for mark in _MARK.finditer(stub):
        if mark["topic"]:
            topics[mark["topic"]] = []
        elif topics:  # what stands above all headings is no topic's
            topics[next(reversed(topics))].append(mark["name"])
    return {topic: tuple(names) for topic, names in topics.items()}


def names_of(topics: dict[str, tuple[str, ...]]) -> list[str]:
    """Return all names, topic by topic, after that of the version, which has none."""
    return ["__version__", *(name for names in topics.values() for name in names)]
