"""A part of the corpus that takes a given number of seconds."""

from collections.abc import Iterable, Mapping
from zlib import crc32

__all__ = ["sample"]

TIMES = 3.0
"""Seconds that a case takes, untimed work included, as a multiple of the recorded ones."""
LEAST = 0.05
"""Seconds that a case takes at least."""


def sample(
    names: Iterable[tuple[str, str]], recorded: Mapping[tuple[str, str], Mapping[str, str]], seconds: float
) -> list[tuple[str, str]]:
    """Recorded cases that took that many seconds in all, no more than a thirtieth of them each; the same each time.

    Parts take turns, and within a part the order is that of the names' checksums.
    """

    def costs(key: tuple[str, str]) -> float:
        row = recorded[key]
        return TIMES * max(sum(float(row[name] or 0) for name in ("cpu_s", "write_s", "verify_s")), LEAST)

    parts: dict[str, list[tuple[str, str]]] = {}
    for key in names:
        if key in recorded and costs(key) <= seconds / 30:
            parts.setdefault(key[0], []).append(key)
    queues = [sorted(keys, key=lambda key: crc32("/".join(key).encode())) for keys in parts.values()]
    chosen: list[tuple[str, str]] = []
    while any(queues):
        for queue in queues:
            if queue and (seconds := seconds - costs(queue[0])) >= 0:
                chosen.append(queue.pop(0))
            else:
                queue.clear()
    return chosen
