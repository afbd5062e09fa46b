"""Costs of planning by messages as powers of robots, diameter and budget: ``python -m analysis.decentralised.costs``.

Five families of networks up to 200 robots; least squares through the logarithms of messages, bytes and decision time.
Intervals are 95 % (Student's t).
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from typing import TYPE_CHECKING

import networkx as nx
import numpy as np
from scipy.stats import t

from ratt_opt.budget import uninterrupted
from ratt_opt.decentralised.faults import Faults
from ratt_opt.decentralised.plan import decentralised_ratt, make_agents
from ratt_opt.decentralised.simulator import Simulation
from ratt_opt.problem import Problem
from ratt_opt.setfunctions.criteria.trace import TraceObjective

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ratt_opt._validation import FloatArray
    from ratt_opt.decentralised.messages import Packet

__all__ = ["FAMILIES", "Run", "powers", "run_of", "table"]

FAMILIES: dict[str, Callable[[int, int], nx.Graph]] = {
    "path": lambda n, _: nx.path_graph(n),
    "random tree": lambda n, seed: nx.random_labeled_tree(n, seed=seed),
    "ring": lambda n, _: nx.cycle_graph(n),
    "degree 8": lambda n, seed: nx.random_regular_graph(8, n, seed=seed),
    "complete": lambda n, _: nx.complete_graph(n),
}
TREES = ("path", "random tree")
SIZES, SHARES = (25, 50, 100, 200), (0.04, 0.2, 0.6)
"""Robots, and the budget as a share of them: robots that may be blinded; no link can be cut."""
LONGEST = ("complete", 200)
"""Teams that take half a minute of computing each: two are enough."""
TARGETS, CONTROLS = 4, 3
COSTS = ("messages", "bytes", "seconds")
CAUSES = ("robots", "diameter", "alpha")


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """Costs of one plan; ``alpha`` : number of baits."""

    family: str
    robots: int
    diameter: int
    alpha: int
    messages: int
    bytes: int
    seconds: float


def problem_of(family: str, n: int, alpha: int, seed: int) -> Problem:
    """One team of random rank-one sensors, ``alpha`` of which may be blinded."""
    rng = np.random.default_rng(seed)
    rows = rng.normal(size=(n * CONTROLS, TARGETS, 2, 1))
    f = TraceObjective(np.tile(np.eye(2), (TARGETS, 1, 1)), rows @ rows.swapaxes(-1, -2))
    return Problem(f, np.repeat(np.arange(n), CONTROLS), FAMILIES[family](n, seed), alpha, 0)


def run_of(family: str, n: int, share: float, seed: int) -> Run:
    """Plan one team, a share of which may be blinded."""
    alpha = max(1, round(share * n))
    problem = problem_of(family, n, alpha, seed)
    plan = uninterrupted(decentralised_ratt(problem))
    return Run(
        family=family,
        robots=n,
        diameter=nx.diameter(problem.graph),
        alpha=alpha,
        messages=plan.messages,
        bytes=plan.bytes,
        seconds=plan.decision_time,
    )


class ItemCount(Simulation):
    """A simulation that counts the items that robots have for their neighbours, each once."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(make_agents(problem), Faults(), 0)
        self.sent: dict[tuple[int, int], int] = {}
        self.run()

    def _transmit(self, packet: Packet, other: int) -> None:
        way = packet.sender, other
        self.sent[way] = max(self.sent.get(way, 0), packet.first + len(packet.items))
        super()._transmit(packet, other)


def items_on_trees(seeds: int) -> str:
    """Sentence about the power of ``N alpha + N^2`` with which items grow on trees, for each family and share alike."""
    most, x, y = 0.0, [], []
    for family in TREES:
        for share in SHARES:
            sizes = [(n, max(1, round(share * n)), seed) for n in SIZES for seed in range(seeds)]
            counts = np.array([sum(ItemCount(problem_of(family, *size)).sent.values()) for size in sizes])
            causes = np.array([n * alpha + n * n for n, alpha, _ in sizes])
            most = max(most, float((counts / causes).max()))
            x += list(np.log(causes) - np.log(causes).mean())
            y += list(np.log(counts) - np.log(counts).mean())
    slope = np.dot(x, y) / np.dot(x, x)
    free = len(x) - len(TREES) * len(SHARES) - 1
    error = np.sqrt(((np.array(y) - slope * np.array(x)) ** 2).sum() / free / np.dot(x, x))
    return (
        f"On trees the items that robots have for their neighbours grow as `N alpha + N^2` to the power {slope:.3f} ± "
        f"{t.ppf(0.975, free) * error:.3f}, for a fixed share of baits; they are at most {most:.2f} times as many."
    )


def powers(runs: Sequence[Run], cost: str, causes: Sequence[str]) -> list[tuple[float, float]]:
    """Power of each cause (``robots``, ``diameter``, ``alpha``), and half the width of its 95 % interval."""
    x = np.log([[getattr(run, cause) for cause in causes] for run in runs])
    design: FloatArray = np.column_stack([np.ones(len(runs)), x])
    y = np.log([getattr(run, cost) for run in runs])
    fit, _, _, _ = np.linalg.lstsq(design, y, rcond=None)
    free = len(runs) - design.shape[1]
    variance = float(((y - design @ fit) ** 2).sum()) / free * np.linalg.inv(design.T @ design)
    half = t.ppf(0.975, free) * np.sqrt(np.diag(variance))
    return [(float(power), float(width)) for power, width in zip(fit[1:], half[1:], strict=True)]


def _shown(fits: Sequence[tuple[float, float]]) -> str:
    return ", ".join(f"{power:.2f} ± {half:.2f}" for power, half in fits)


def table(seeds: int) -> list[str]:
    """Rows of two Markdown tables: powers of robots and alpha by family, and of all three causes over all families."""
    runs = [
        run_of(family, n, share, seed)
        for family in FAMILIES
        for n in SIZES
        for share in (SHARES if (family, n) != LONGEST else SHARES[:2])
        for seed in range(seeds if n < SIZES[-1] else 1)
    ]
    lines = [
        "| network | messages: N, alpha | bytes: N, alpha | seconds: N, alpha | messages / (N alpha + N^2), at most "
        "| largest team, fewest baits |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for family in FAMILIES:
        own = [run for run in runs if run.family == family]
        fits = " | ".join(_shown(powers(own, cost, ("robots", "alpha"))) for cost in COSTS)
        ratio = max(run.messages / (run.robots * run.alpha + run.robots**2) for run in own)
        last = max(own, key=lambda run: (run.robots, -run.alpha))
        told = f"{last.messages:,} messages, {last.bytes / 1e6:.1f} MB, {last.seconds:.1f} s"
        lines.append(f"| {family} | {fits} | {ratio:.2f} | {told} |")
    sparse = [run for run in runs if run.family != "complete"]
    lines += ["", "| cost | N | diameter | alpha |", "| --- | --- | --- | --- |"]
    for cost in COSTS:
        fits = " | ".join(f"{power:.2f} ± {half:.2f}" for power, half in powers(sparse, cost, CAUSES))
        lines.append(f"| {cost} | {fits} |")
    lines += ["", items_on_trees(1)]
    return lines


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description="Costs of planning by messages")
    parser.add_argument("--seeds", type=int, default=2, help="teams of each size and budget, one of the largest")
    print("\n".join(table(parser.parse_args().seeds)))


if __name__ == "__main__":
    main()
