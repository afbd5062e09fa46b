"""Two measurements of the corpus beside each other, a line for each part."""

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from analysis.tables import read_csv
from ratt_opt._rounding import relative_gap

__all__ = ["Rows", "apart", "compared", "differing", "lost", "read_rows"]

Row = dict[str, str]
Rows = dict[tuple[str, str], Row]
CLOSED = {"attack": 1e-6, "plan": 1e-4, "certificate": 1.01e-4}
"""Relative width that counts as closed; a certificate's ends lie apart by what its numbers are rounded, too."""
LEAST_GAP, LEAST_SECONDS = 1e-6, 0.01
"""Below, gaps and seconds count as these: they are rounding and noise."""
LIMITED = ("limited_lower", "limited_upper", "limited_nodes")


def read_rows(folder: Path, parts: Iterable[str]) -> Rows:
    """(part, case) -> row, of the parts whose files are there; a later row takes the place of an earlier one."""
    tables = (read_csv(path) for part in parts if (path := folder / f"{part}.csv").exists())
    return {(row["part"], row["case"]): row for table in tables for row in table}


def _gap(row: Row) -> float:
    return relative_gap(float(row["lower"]), float(row["upper"])) if float(row["upper"]) > 0 else 0.0


def _is_closed(row: Row) -> bool:
    """Say whether both ends meet; the search says it if the lower end is 0."""
    return (float(row["lower"]) <= 0 and row["stop"] == "closed") or _gap(row) <= CLOSED[row["asked"]] * (1 + 1e-9)


def lost(then: Rows, now: Rows) -> list[tuple[str, str]]:
    """Cases that were closed and are open now."""
    return [key for key in now if key in then and _is_closed(then[key]) and not _is_closed(now[key])]


def apart(then: Rows, now: Rows) -> list[tuple[str, str]]:
    """Cases whose two brackets have no value in common: one is false. Attacks on other plans are no matter of this."""

    def are_apart(one: Row, other: Row) -> bool:
        if one["asked"] == "attack" and one["plan"] != other["plan"]:
            return False
        return float(one["lower"]) > float(other["upper"]) or float(other["lower"]) > float(one["upper"])

    return [key for key in now if key in then and are_apart(then[key], now[key])]


def differing(then: Rows, now: Rows) -> list[tuple[str, str]]:
    """Cases whose runs that are limited by nodes did not give the same."""

    def differ(one: Row, other: Row) -> bool:
        has_both = bool(one["limited_nodes"] and other["limited_nodes"])
        return has_both and any(one[name] != other[name] for name in LIMITED)

    return [key for key in now if key in then and differ(then[key], now[key])]


def compared(then: Rows, now: Rows) -> list[dict[str, Any]]:
    """A line for each part, of the cases that both have: now over then, geometric means."""
    lines = []
    for part in dict.fromkeys(part for part, _ in now):
        pairs = [(then[key], now[key]) for key in now if key[0] == part and key in then]
        open_pairs = [pair for pair in pairs if not (_is_closed(pair[0]) and _is_closed(pair[1]))]
        limited = sum(bool(one["limited_nodes"] and other["limited_nodes"]) for one, other in pairs)
        own = {key: row for key, row in now.items() if key[0] == part}
        lines.append(
            {
                "part": part,
                "cases": len(pairs),
                "closed_then": sum(_is_closed(one) for one, _ in pairs),
                "closed_now": sum(_is_closed(other) for _, other in pairs),
                "lost": len(lost(then, own)),
                "gained": len(lost(own, then)),
                "gap_ratio": _ratio(open_pairs, lambda row: max(_gap(row), LEAST_GAP)),
                "seconds_ratio": _ratio(pairs, lambda row: max(float(row["cpu_s"]), LEAST_SECONDS)),
                "proof_ratio": _ratio(pairs, lambda row: _number(row["proof_bytes"])),
                "verify_ratio": _ratio(pairs, lambda row: _number(row["verify_s"])),
                "same_nodes": f"{limited - len(differing(then, own))} of {limited}",
                "other_plan": sum(one["plan"] != other["plan"] for one, other in pairs if one["asked"] == "attack"),
                "apart": len(apart(then, own)),
            }
        )
    return lines


def _number(text: str) -> float:
    return float(text) if text else np.nan


def _ratio(pairs: Sequence[tuple[Row, Row]], value: Callable[[Row], float]) -> float | str:
    """Geometric mean of now over then, of the pairs of which both are known; empty if none is."""
    logs = np.log([value(now) / value(then) for then, now in pairs])
    known = logs[np.isfinite(logs)]
    return float(np.exp(known.mean())) if known.size else ""
