"""The command line: measure the tests, choose the short tier, make faults, and show what finds them."""

import argparse
import math
import os
import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from functools import partial
from pathlib import Path
from time import monotonic

from analysis.test_tier.campaign import Campaign, Measured, draw, read_rows
from analysis.test_tier.choose import (
    chosen,
    parts_of,
    reached_units,
    read_costs,
    read_list,
    summary,
    write_costs,
    write_list,
)
from analysis.test_tier.reached_lines import Reach, collect, load, merged, save
from analysis.test_tier.tree import ROOT, Tree

LIST = ROOT / "tests" / "short_tier.txt"
COSTS, REACH = "costs.csv", "reach.json"


def main() -> int:
    """Run one of the steps."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("step", choices=sorted(STEPS), help="what to do")
    parser.add_argument("tests", nargs="*", help="measure these files or functions only; the others stay as they are")
    parser.add_argument("--folder", type=Path, default=ROOT / "build" / "test_tier", help="of what is measured")
    parser.add_argument("--seconds", type=float, default=240.0, help="of the short tier (default %(default)s)")
    parser.add_argument("--mutants", type=int, default=200, help="how many (default %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of the mutants (default %(default)s)")
    parser.add_argument("--time-limit", type=float, default=math.inf, help="seconds; run the same command to go on")
    options = parser.parse_args()
    options.folder = options.folder.absolute()
    STEPS[options.step](options)
    return 0


def _measure(options: argparse.Namespace) -> None:
    """Run tests in a clone, with coverage; keep their costs and the lines that they reach."""
    folder, tree = options.folder, Tree(options.folder)
    tree.prepare()
    for left in folder.glob("lines.*"):
        left.unlink()
    environment = os.environ | {"PYTHONPATH": str(tree.root), "TIER_FOLDER": str(folder)}
    command = [sys.executable, "-m", "pytest", "--whole", "-n0", "-p", "analysis.test_tier.reach", *options.tests]
    subprocess.run(command, cwd=tree.root, env=environment, check=False)
    new = read_costs(folder / "measured.csv")
    costs, lines = (read_costs(folder / COSTS), load(folder / REACH)) if options.tests else ({}, {})
    write_costs(folder / COSTS, costs | new)
    save(folder / REACH, merged(lines, collect(folder, tree.root, new), new))


def _choose(options: argparse.Namespace) -> None:
    """Write the list of what the short tier leaves out."""
    costs = read_costs(options.folder / COSTS)
    names = sorted(costs)
    units, worth = reached_units(Reach(ROOT, load(options.folder / REACH)), names)
    kept = chosen(parts_of(names, [costs[name] for name in names]), units, worth, options.seconds)
    cases = {name: kept.get(i, 0) for i, name in enumerate(names)}
    write_list(LIST, {name: n for name, n in cases.items() if n < costs[name].tests})
    _table(options)


def _campaign(options: argparse.Namespace, step: Callable[[Campaign, float], None]) -> None:
    tree = Tree(options.folder)
    tree.prepare()
    reach = Reach(tree.root, load(options.folder / REACH))
    measured = Measured(reach, read_costs(options.folder / COSTS), read_list(LIST))
    mutants = draw(tree.root, options.seed, options.mutants)
    try:
        step(Campaign(tree, measured, mutants, _rows(options), _say), monotonic() + options.time_limit)
    finally:
        tree.close()
    _table(options)


def _rows(options: argparse.Namespace) -> Path:
    path: Path = options.folder / f"mutants-{options.seed}.csv"
    return path


def _say(text: str) -> None:
    print(text, flush=True)


def _table(options: argparse.Namespace) -> None:
    """Print tests, seconds and faults of both tiers."""
    found = Counter(row.found for row in read_rows(_rows(options)).values())
    print(f"{'tier':8}{'functions':>10}{'tests':>8}{'seconds':>9}{'faults found':>14}")
    for tier, functions, tests, seconds in summary(read_costs(options.folder / COSTS), read_list(LIST)):
        faults = found["short"] + (found["whole"] if tier == "whole" else 0)
        print(f"{tier:8}{functions:10,}{tests:8,}{seconds:9.0f}{faults:14}")
    print(
        f"{sum(found.values())} faults: {found['none']} found by neither, {found['open']} not tried on the whole suite"
    )


STEPS: dict[str, Callable[[argparse.Namespace], None]] = {
    "measure": _measure,
    "choose": _choose,
    "mutate": partial(_campaign, step=Campaign.near),
    "together": partial(_campaign, step=Campaign.together),
    "again": partial(_campaign, step=Campaign.again),
    "table": _table,
}

if __name__ == "__main__":
    sys.exit(main())
