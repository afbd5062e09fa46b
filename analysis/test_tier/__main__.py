"""The command line: measure the tests, choose the short tier, make faults, and show what finds them."""

from __future__ import annotations

import argparse
import math
import os
import subprocess
import sys
from collections import Counter
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING

from analysis.test_tier import reached_lines
from analysis.test_tier.campaign import Campaign, Measured, draw
from analysis.test_tier.choose import (
    CASES,
    KEPT,
    chosen,
    parts_of,
    reached_units,
    read_costs,
    read_list,
    summary,
    write_list,
)
from analysis.test_tier.tree import ROOT, Tree

if TYPE_CHECKING:
    from collections.abc import Callable

    from analysis.test_tier.choose import Cost

LIST = ROOT / "tests" / "short_tier.txt"
REACH = "reach.json"


def main() -> int:
    """Run one of the steps."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("step", choices=sorted(STEPS), help="what to do")
    parser.add_argument("--folder", type=Path, default=ROOT / "build" / "test_tier", help="of what is measured")
    parser.add_argument("--seconds", type=float, default=90.0, help="of the short tier (default %(default)s)")
    parser.add_argument("--mutants", type=int, default=200, help="how many (default %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of the mutants (default %(default)s)")
    parser.add_argument("--time-limit", type=float, default=math.inf, help="seconds; run the same command to go on")
    options = parser.parse_args()
    options.folder = options.folder.absolute()
    return STEPS[options.step](options)


def _measure(options: argparse.Namespace) -> int:
    """Run the whole suite in a clone, with coverage; keep costs and reached lines."""
    tree = Tree(options.folder)
    tree.prepare()
    environment = os.environ | {"PYTHONPATH": str(tree.root), "TIER_FOLDER": str(options.folder), "TIER_REACH": "1"}
    command = [sys.executable, "-m", "pytest", "--whole", "-n0", "-p", "analysis.test_tier.reach"]
    subprocess.run(command, cwd=tree.root, env=environment, check=False)
    tree.keep_compiled()
    lines = reached_lines.collect(options.folder, _costs(options))
    reached_lines.save(options.folder / REACH, lines, tree.root)
    return 0


def _costs(options: argparse.Namespace) -> dict[str, Cost]:
    return read_costs(sorted(options.folder.glob("costs*.csv")))


def _choose(options: argparse.Namespace) -> int:
    """Write the list of what the short tier leaves out."""
    costs = _costs(options)
    names = sorted(costs)
    units, worth = reached_units(reached_lines.load(options.folder / REACH, ROOT), names)
    kept = chosen(parts_of(names, [costs[name] for name in names]), units, worth, options.seconds)
    cases = {name: kept.get(i, CASES if name in KEPT else 0) for i, name in enumerate(names)}
    write_list(LIST, {name: n for name, n in cases.items() if n < costs[name].tests})
    return _table(options)


def _campaign(options: argparse.Namespace, step: Callable[[Campaign, float], None]) -> int:
    tree = Tree(options.folder)
    tree.prepare()
    reach = reached_lines.load(options.folder / REACH, tree.root)
    mutants = draw(tree.root, options.seed, options.mutants)
    try:
        campaign = Campaign(tree, Measured(reach, _costs(options), read_list(LIST)), mutants, _rows(options))
        step(campaign, monotonic() + options.time_limit)
    finally:
        tree.close()
    return _table(options)


def _rows(options: argparse.Namespace) -> Path:
    path: Path = options.folder / f"mutants-{options.seed}.csv"
    return path


def _say(text: str) -> None:
    print(text, flush=True)


def _table(options: argparse.Namespace) -> int:
    """Print tests, seconds and faults of both tiers."""
    found = Counter(row.found for row in Campaign.read(_rows(options)).values())
    print(f"{'tier':8}{'functions':>10}{'tests':>8}{'seconds':>9}{'faults found':>14}")
    for tier, functions, tests, seconds in summary(_costs(options), read_list(LIST)):
        faults = found["short"] + (found["whole"] if tier == "whole" else 0)
        print(f"{tier:8}{functions:10,}{tests:8,}{seconds:9.0f}{faults:14}")
    print(
        f"{sum(found.values())} faults: {found['none']} found by neither, {found['open']} not tried on the whole suite"
    )
    return 0


STEPS: dict[str, Callable[[argparse.Namespace], int]] = {
    "measure": _measure,
    "choose": _choose,
    "mutate": lambda options: _campaign(options, lambda campaign, until: campaign.near(until, _say)),
    "together": lambda options: _campaign(options, lambda campaign, until: campaign.together(until, _say)),
    "table": _table,
}

if __name__ == "__main__":
    sys.exit(main())
