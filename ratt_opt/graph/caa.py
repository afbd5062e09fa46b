"""Communication attack approximation on a complete graph."""

from __future__ import annotations

from dataclasses import dataclass

from ratt_opt._validation import check_integer

__all__ = ["CaaResult", "caa"]


@dataclass(frozen=True, slots=True, kw_only=True)
class CaaResult:
    """``n_max``: size of the largest group left; ``alpha_cs = N - n_max``: equivalent sensing attacks."""

    n_max: int
    alpha_cs: int


def links_within(n_robots: int, group: int) -> int:
    """Links kept when a complete graph is split into as many groups of size ``group`` as fit, and one of the rest.

    Source: ratt.tex, eq:bar_en.
    """
    full, rest = divmod(n_robots, group)
    return full * (group * (group - 1) // 2) + rest * (rest - 1) // 2


def caa(n_robots: int, alpha_c: int) -> CaaResult:
    """Return the smallest possible largest group of a complete graph with ``alpha_c`` links cut.

    Parameters
    ----------
    n_robots : N >= 1
    alpha_c : links the attacker may cut, in ``[0, N (N - 1) / 2]``

    Raises
    ------
    InputError : a number is out of range.

    Source: ratt.tex, Algorithm 2 (CAA). Exact for complete graphs: agrees with the
    enumeration of integer partitions for every N <= 30.
    """
    n_robots = check_integer("n_robots", n_robots, low=1)
    links = n_robots * (n_robots - 1) // 2
    alpha_c = check_integer("alpha_c", alpha_c, low=0, high=links)
    remaining = links - alpha_c
    n_max = next(n for n in range(1, n_robots + 1) if remaining <= links_within(n_robots, n))
    return CaaResult(n_max=n_max, alpha_cs=n_robots - n_max)
