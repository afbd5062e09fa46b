"""Speed of the audit: ``python -m analysis.benchmarks.audit [--five] [--six] [--ledger]``.

Worst-case ratios at N = 3 and 4 against one plain integer program an attack (every class row, every attack, no
symmetry, no theorem to start from); ``--five`` and ``--six`` add N = 5 and 6, which start from the theorem, and the
plain program at N = 5 if no links are cut; ``--ledger`` times the whole proof ledger. Processor seconds.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import coo_array

from ratt_opt import caa, run_audit, worst_case_ratio
from ratt_opt.worst_ratio.search import skeleton

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from ratt_opt.worst_ratio.search import Groups, Skeleton

CURVATURE = Fraction(1, 2)
SMALL = ((3, 1, 0), (3, 0, 2), (4, 1, 0), (4, 0, 3))
FIVE = (("nondecreasing", 5, 1, 0), ("nondecreasing", 5, 0, 6), ("submodular", 5, 1, 0), ("submodular", 5, 0, 7))
SIX = (("nondecreasing", 6, 2, 0), ("nondecreasing", 6, 0, 9), ("submodular", 6, 2, 0))

Terms = list[tuple[int, float]]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--five", action="store_true", help="also N = 5 (about a minute)")
    parser.add_argument("--six", action="store_true", help="also N = 6 (about a minute)")
    parser.add_argument("--ledger", action="store_true", help="also the whole ledger (a few minutes)")
    options = parser.parse_args()
    print(f"{'worst-case ratio':34} {'value':>8} {'seconds':>9} {'plain':>9} {'ratio':>8}")
    small = [(family, *case) for family in ("submodular", "nondecreasing") for case in SMALL]
    for case in (*small, *FIVE * options.five, *SIX * options.six):
        _ratio_line(*case, with_plain=case[1] < 5 or (case[1] == 5 and case[3] == 0))
    if options.ledger:
        with tempfile.TemporaryDirectory() as folder:
            ledger, seconds = _timed(lambda: run_audit(folder))
        print(f"whole ledger: {len(ledger.records)} entries, {seconds:.0f} s; {ledger.counts()}")


def _ratio_line(family: str, n: int, alpha_s: int, alpha_c: int, *, with_plain: bool) -> None:
    def exact() -> Fraction:
        call = partial(worst_case_ratio, n, alpha_s, alpha_c, curvature=CURVATURE, family=family)
        return call(use_theorem=n > 4).exact_lower

    found, fast = _timed(exact)
    line = f"{family:14} N={n} ({alpha_s}, {alpha_c}) {found!s:>16} {fast:9.2f}"
    if with_plain:
        plain, slow = _timed(lambda: plain_ratio(family, n, alpha_s, alpha_c))
        assert abs(plain - float(found)) < 1e-6, "both programs must agree"
        line += f" {slow:9.2f} {slow / fast:7.1f}x"
    print(line, flush=True)


def plain_ratio(family: str, n_robots: int, alpha_s: int, alpha_c: int) -> float:
    """The same number by one integer program for every attack, in floating point."""
    parts = skeleton(n_robots, alpha_s, alpha_c, min(n_robots, alpha_s + caa(n_robots, alpha_c).alpha_cs))
    return min(_program(parts, family, attack) for attack in parts.outcomes)


def _program(parts: Skeleton, family: str, attack: Groups) -> float:
    """Columns: the ratio, every value, every largest marginal, one binary a group ("the optimum reaches 1 here")."""
    n = 2 * parts.n_robots
    groups = parts.groups
    marginal, binary = 1 << n, (1 << n) + n
    rows = [*_class_rows(family, n, marginal)]
    rows += [_difference(a, b) for a, b in parts.comparisons]
    rows += [[(0, 1.0), (group, -1.0)] for group in attack]
    rows += [[(group << parts.n_robots, 1.0), (binary + k, -1.0)] for k, group in enumerate(groups)]
    free = len(rows)
    rows += [[(binary + groups.index(group), 1.0) for group in outcome] for outcome in parts.outcomes]
    columns = binary + len(groups)
    entries = [(i, j, value) for i, row in enumerate(rows) for j, value in row]
    i, j, value = (np.array(part) for part in zip(*entries, strict=True))
    least = np.where(np.arange(len(rows)) < free, 0.0, 1.0)
    cost = np.zeros(columns)
    cost[0] = 1.0
    upper = np.full(columns, np.inf)
    upper[binary:] = 1.0
    found = milp(
        cost,
        constraints=LinearConstraint(coo_array((value, (i, j)), shape=(len(rows), columns)).tocsr(), least),
        bounds=Bounds(0.0, upper),
        integrality=(np.arange(columns) >= binary).astype(int),
    )
    assert found.fun is not None
    return float(found.fun)


def _class_rows(family: str, n: int, marginal: int) -> Iterator[Terms]:
    kept = float(1 - CURVATURE)
    for x in range(n):
        for base in (mask for mask in range(1 << n) if not mask >> x & 1):
            gain = _difference(base | 1 << x, base)
            if family == "nondecreasing":
                yield [*gain, (marginal + x, -kept)]
                yield [*((j, -v) for j, v in gain), (marginal + x, 1.0)]
                continue
            yield [*gain, (1 << x, -kept)] if base else [(1 << x, 1.0)]
            for y in (y for y in range(x + 1, n) if not base >> y & 1):
                yield gain + [(j, -v) for j, v in _difference(base | 1 << x | 1 << y, base | 1 << y)]


def _difference(larger: int, smaller: int) -> Terms:
    """``f(larger) - f(smaller)``; the empty set has value 0 and no column."""
    return [(larger, 1.0), (smaller, -1.0)] if smaller else [(larger, 1.0)]


def _timed(run: Callable[[], Any]) -> tuple[Any, float]:
    began = time.process_time()
    return run(), time.process_time() - began


if __name__ == "__main__":
    main()
