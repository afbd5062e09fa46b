"""Measured values of the pages: ``python -m analysis.measurements [--check]``.

``docs/measured.toml`` has each value with its command, date and commit, and the places of the pages that show it. This
program fills the places. With ``--check`` it also measures again what takes less than ten seconds, and returns 1 if a
value is off by more than its factor or a page shows another one.
"""

import argparse
import re
import sys
import tempfile
import time
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from analysis.benchmarks.instances import SETTINGS
from ratt_opt import certify, greedy, random_scenario, ratt, solve_maxmin, verify_certificate, worst_case_attack
from ratt_opt.scenario.limited_view import demo_scenario

__all__ = ["AGAIN", "Value", "filled", "main", "places", "values"]

ROOT = Path(__file__).parents[1]
FILE = ROOT / "docs" / "measured.toml"
SLOT = re.compile(r"\{(\w+)\}")
SHOWN = r"\d[\d,]*(?:\.\d+)?(?:(?: to |, )\d[\d,]*(?:\.\d+)?)?"
"""A number or a range on a page."""
CRITERIA = ("trace", "logdet", "maxeig")
"""Criteria of each team that is measured."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Value:
    """One measured value: its ends (equal if it is one number), and what measures it again (empty: slow)."""

    name: str
    low: float
    high: float
    text: str
    unit: str
    command: str
    again: str
    factor: float

    def is_off(self, low: float, high: float) -> bool:
        """Tell whether a new measurement contradicts it: seconds above, other units on either side."""
        above = high > self.factor * self.high
        return above if self.unit == "s" else above or low * self.factor < self.low


def processor_seconds(run: Callable[[], object]) -> float:
    """Processor time of one call [s]."""
    began = time.process_time()
    run()
    return time.process_time() - began


def values() -> dict[str, Value]:
    """Return the values of the file, by name."""
    found = {}
    for name, entry in tomllib.loads(FILE.read_text(encoding="utf-8"))["value"].items():
        number = entry["number"]
        ends = number if isinstance(number, list) else [number, number]
        text = entry.get("join", " to ").join(f"{end:,}" for end in dict.fromkeys(ends))
        again, factor = entry.get("again", ""), entry.get("factor", 1.0)
        own = {"unit": entry["unit"], "command": entry["command"], "again": again, "factor": factor}
        found[name] = Value(name=name, low=ends[0], high=ends[1], text=text, **own)
    return found


def places() -> list[tuple[Path, str]]:
    """Return the pages with the sentences that show values, ``{name}`` for each."""
    entries = tomllib.loads(FILE.read_text(encoding="utf-8"))["place"]
    return [(ROOT / entry["page"], entry["text"]) for entry in entries]


def filled(page: str, template: str, known: Mapping[str, Value]) -> str:
    """Return the page with the values in the place of the template.

    Raises
    ------
    ValueError : the page does not have the place, or has it more than once.
    """
    parts = SLOT.split(template)
    pattern = "".join(re.escape(part) if k % 2 == 0 else SHOWN for k, part in enumerate(parts))
    if (count := len(re.findall(pattern, page))) != 1:
        raise ValueError(f"{count} places like {template!r}")
    text = SLOT.sub(lambda slot: known[slot[1]].text, template)
    return re.sub(pattern, lambda _: text, page)


def main(arguments: Sequence[str] | None = None) -> int:
    """Fill the pages, or check them and the quick values."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--check", action="store_true", help="change nothing; measure again what is quick")
    options = parser.parse_args(arguments)
    known, faults = values(), 0
    for page, template in places():
        old = page.read_text(encoding="utf-8")
        new = filled(old, template, known)
        if new != old and options.check:
            faults += 1
            print(f"{page.relative_to(ROOT)} shows something else than docs/measured.toml: {template}")
        elif new != old:
            page.write_text(new, encoding="utf-8")
    return int(faults + (_measured_faults(known.values()) if options.check else 0) > 0)


def _measured_faults(known: Iterator[Value] | Any) -> int:
    faults = 0
    for value in known:
        if not value.again:
            print(f"{value.name}: {value.text} {value.unit}, slow: {value.command}")
            continue
        began = time.process_time()
        low, high = AGAIN[value.again](value.name)
        off = value.is_off(low, high)
        faults += off
        said = f"now {low:.3g} to {high:.3g} {value.unit}, {'OFF' if off else 'within'} a factor of {value.factor:g}"
        print(f"{value.name}: {value.text} {value.unit}, {said} ({time.process_time() - began:.1f} s)", flush=True)
    return faults


@cache
def _demo_values() -> dict[str, float]:
    """The worst cases of the demo's plans [m²]."""
    problem = demo_scenario().problem()
    plans = {"demo_ratt": ratt(problem), "demo_greedy": greedy(problem)}
    found = {name: worst_case_attack(problem, plan.elements).upper for name, plan in plans.items()}
    return {**found, "demo_best": solve_maxmin(problem, max_nodes=10_000).lower}


def _demo(name: str) -> tuple[float, float]:
    return _demo_values()[name], _demo_values()[name]


def _attack(name: str) -> tuple[float, float]:
    """Seconds of exact attacks on RATT's plans, the worst over budgets and criteria, one seed."""
    n_robots = int(name.rpartition("_")[2])
    n_targets, budgets = SETTINGS[n_robots]
    seconds = []
    for alpha_s, alpha_c in budgets:
        for criterion in CRITERIA:
            problem = random_scenario(n_robots, n_targets, alpha_s=alpha_s, alpha_c=alpha_c, seed=0).problem(criterion)
            elements = ratt(problem).elements
            seconds.append(processor_seconds(lambda p=problem, e=elements: worst_case_attack(p, e)))  # type: ignore[misc]
    return min(seconds), max(seconds)


@cache
def _certificates_10() -> dict[str, tuple[float, float]]:
    """Seconds of the search and of the verification, and kB, over budgets and criteria, one seed of ten robots."""
    n_targets, budgets = SETTINGS[10]
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "certificate.json"
        for alpha_s, alpha_c in budgets:
            for criterion in CRITERIA:
                problem = random_scenario(10, n_targets, alpha_s=alpha_s, alpha_c=alpha_c, seed=0).problem(criterion)
                began = time.process_time()
                solved = solve_maxmin(problem)
                searched = time.process_time() - began
                certify(problem, solved, path)
                verified = processor_seconds(lambda: verify_certificate(path))
                rows.append((searched, verified, path.stat().st_size / 1000))
    names = ("plan_10", "verify_10", "certificate_10")
    return {name: (min(column), max(column)) for name, column in zip(names, zip(*rows, strict=True), strict=True)}


AGAIN: dict[str, Callable[[str], tuple[float, float]]] = {
    "demo": _demo,
    "attack_10": _attack,
    "attack_20": _attack,
    "attack_30": _attack,
    **dict.fromkeys(("plan_10", "verify_10", "certificate_10"), lambda name: _certificates_10()[name]),
}
"""Measurements that take less than ten seconds, by name: the least and the largest value found."""


if __name__ == "__main__":
    sys.exit(main())
