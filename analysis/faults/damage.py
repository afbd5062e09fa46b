"""Damaged files and odd words."""

import json
from copy import deepcopy
from typing import Any

import numpy as np

__all__ = ["ODD", "damaged"]

ODD = (
    "",
    "0",
    "-1",
    "nan",
    "inf",
    "1e999",
    "true",
    "[b]",
    "\x1b[2J",
    "\u202e",
    "\udc80",
    "a\0b",
    "9" * 5000,
    "--",
    "x=1",
)
VALUES: tuple[Any, ...] = (
    None, True, False, 0, -1, 1, 2**53, 2**64, -0.0, 5e-324, 1e-12, 1e12, 1e300, "", "x", "[b]", "\u202e", "\ud800",
    [], {}, [0, 0],
)  # fmt: skip


def damaged(data: bytes, rng: np.random.Generator) -> bytes:
    """Bytes changed, cut or repeated, or one value of the JSON replaced."""
    way = int(rng.integers(5))
    if way == 0 or not data.lstrip().startswith(b"{"):
        spots = rng.integers(0, len(data), int(rng.integers(1, 4)))
        changed = bytearray(data)
        for spot in spots:
            changed[int(spot)] = int(rng.integers(256))
        return bytes(changed)
    if way == 1:
        first, last = sorted(int(x) for x in rng.integers(0, len(data), 2))
        return data[:first] + data[last:] if rng.random() < 0.5 else data[:last] + data[first:]
    document = json.loads(data)
    for _ in range(int(rng.integers(1, 3))):
        _replace_one(document, rng)
    return json.dumps(document).encode()


def _replace_one(document: Any, rng: np.random.Generator) -> None:
    """Walk to a random place of a document, and replace, scale, remove or repeat what is there."""
    while True:
        keys = list(document) if isinstance(document, dict) else list(range(len(document)))
        if not keys:
            return
        key = keys[int(rng.integers(len(keys)))]
        value = document[key]
        if isinstance(value, (dict, list)) and value and rng.random() < 0.85:
            document = value
            continue
        way = int(rng.integers(4))
        number = isinstance(value, (int, float)) and not isinstance(value, bool)
        if way == 0 and number:
            document[key] = value * (1 + float(rng.normal(0, 10.0 ** rng.integers(-16, 1))))
        elif way == 1 and number:
            document[key] = value + int(rng.integers(-2, 3))
        elif way == 2 and isinstance(document, list):
            document.insert(key, value)
        elif way == 3 and rng.random() < 0.3:
            del document[key]
        else:
            document[key] = deepcopy(VALUES[int(rng.integers(len(VALUES)))])
        return
