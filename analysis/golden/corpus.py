"""The cases of the corpus: which problem, which search, which limits. Names never change their meaning."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import Literal

import numpy as np

import ratt_opt as ro
from analysis.benchmarks.instances import SETTINGS, SHARES, budget_grid, network_problem, team
from analysis.golden.unusual import UNUSUAL, unusual_problem
from ratt_opt import Problem
from ratt_opt.scenario.networks import NETWORK_FAMILIES
from ratt_opt.setfunctions.criteria.names import CLASSES as CRITERIA

__all__ = ["CRITERIA", "PARTS", "Case", "cases", "get_case"]

FAMILIES = tuple(NETWORK_FAMILIES)
PAPER = {robots: SETTINGS[robots] for robots in (10, 20, 30, 40, 60)}
"""Robots -> targets and budgets (blinded, cut) on complete graphs."""
STEPS, DRAWN = 4, 6
"""Budgets of a grid in each direction, and random ones, for each size and criterion."""
NETWORK_SEEDS = {24: 5, 30: 5, 50: 5, 100: 1}
"""Robots -> seeds, of each family and pair of budgets: the rows of the networks table."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One question: of RATT's plan the worst attack, the best plan, or the best plan with its certificate.

    ``seconds`` : of the processor, the limit of the run that is timed
    ``nodes`` : the limit of a second run, which gives the same each time; ``None`` for no such run
    """

    part: str
    name: str
    problem: Callable[[], Problem]
    asked: Literal["attack", "plan", "certificate"]
    seconds: float
    nodes: int | None = None


def _complete(robots: int, targets: int, budgets: tuple[int, int], kind: str, seed: int) -> Problem:
    scenario = ro.random_scenario(robots, targets, alpha_s=budgets[0], alpha_c=budgets[1], seed=seed)
    return scenario.problem(kind)


def _camera(robots: int, targets: int, network: str, seed: int, kind: str) -> Problem:
    problem: Problem = team(robots, targets, network, seed).problem(kind)
    return problem


def _networks() -> Iterator[Case]:
    """(a) attacks on the rows of the networks table."""
    for robots, seeds in NETWORK_SEEDS.items():
        for family, seed, budgets in product(FAMILIES, range(seeds), SHARES):
            yield Case(
                part="networks",
                name=f"{robots} {family} {budgets} {seed}",
                problem=partial(network_problem, family, robots, budgets, seed, "trace"),
                asked="attack",
                seconds=10.0,
                nodes=300 if robots <= 30 else None,
            )


def _budgets(robots: int) -> Iterator[tuple[str, tuple[int, int]]]:
    links = robots * (robots - 1) // 2
    for k, pair in enumerate(PAPER[robots][1]):
        yield f"paper {k}", pair
    for pair in budget_grid(robots, STEPS):
        yield f"grid {pair[0]} {pair[1]}", pair
    rng = np.random.default_rng([robots, 39])
    for one, other in zip(rng.integers(0, robots - 1, DRAWN), rng.integers(0, links + 1, DRAWN), strict=True):
        yield f"random {one} {other}", (int(one), int(other))


def _complete_graphs() -> Iterator[Case]:
    """(b) attacks on complete graphs: the paper's budgets, a grid of budgets, random ones."""
    for robots, kind in product(PAPER, CRITERIA):
        for label, pair in _budgets(robots):
            yield Case(
                part="complete",
                name=f"{robots} {kind} {label}",
                problem=partial(_complete, robots, PAPER[robots][0], pair, kind, 0),
                asked="attack",
                seconds=5.0,
                nodes=1000 if robots <= 40 else None,
            )


def _plans() -> Iterator[Case]:
    """(c) best plans: complete graphs, networks, limited views."""
    for robots, kind, k in product((10, 20, 30), CRITERIA, range(3)):
        problem = partial(_complete, robots, PAPER[robots][0], PAPER[robots][1][k], kind, 1)
        name = f"complete {robots} {kind} paper {k}"
        yield Case(part="plans", name=name, problem=problem, asked="plan", seconds=20.0, nodes=5)
    for robots, family, budgets in product((24, 30), FAMILIES, ("fifth", "third")):
        problem = partial(network_problem, family, robots, budgets, 0, "trace")
        name = f"network {robots} {family} {budgets}"
        yield Case(part="plans", name=name, problem=problem, asked="plan", seconds=30.0)
    for (robots, targets), network, kind, seed in product(
        ((6, 8), (10, 10), (20, 20)), ("complete", "disk"), ("trace", "logdet"), range(3)
    ):
        problem = partial(_camera, robots, targets, network, seed, kind)
        name = f"limited view {robots} {network} {kind} {seed}"
        nodes = 20 if robots <= 10 else None
        yield Case(part="plans", name=name, problem=problem, asked="plan", seconds=20.0, nodes=nodes)


def _certificates() -> Iterator[Case]:
    """(d) certificates of both ends."""
    for robots, kind, k in product((10, 20, 30), CRITERIA, range(2)):
        problem = partial(_complete, robots, PAPER[robots][0], PAPER[robots][1][k], kind, 2)
        name = f"complete {robots} {kind} paper {k}"
        yield Case(part="certificates", name=name, problem=problem, asked="certificate", seconds=20.0)
    for family, budgets in product(FAMILIES, ("fifth", "third")):
        problem = partial(network_problem, family, 24, budgets, 1, "trace")
        name = f"network 24 {family} {budgets}"
        yield Case(part="certificates", name=name, problem=problem, asked="certificate", seconds=30.0)
    for (robots, targets), network, kind in product(((6, 8), (10, 10)), ("complete", "disk"), ("trace", "logdet")):
        problem = partial(_camera, robots, targets, network, 3, kind)
        name = f"limited view {robots} {network} {kind}"
        yield Case(part="certificates", name=name, problem=problem, asked="certificate", seconds=30.0)


def _unusual() -> Iterator[Case]:
    """(e) degenerate, large, weighted, protected, of other dimensions, with output matrices, with user functions."""
    for kind, n_cases in UNUSUAL.items():
        for seed in range(n_cases):
            problem = partial(unusual_problem, kind, seed)
            asked: Literal["attack", "plan"] = "plan" if seed % 4 == 3 and kind != "large" else "attack"
            nodes = None if kind == "large" else 200 if asked == "attack" else 10
            yield Case(part="unusual", name=f"{kind} {seed}", problem=problem, asked=asked, seconds=4.0, nodes=nodes)


PARTS: dict[str, Callable[[], Iterator[Case]]] = {
    "networks": _networks,
    "complete": _complete_graphs,
    "plans": _plans,
    "certificates": _certificates,
    "unusual": _unusual,
}


def cases(parts: list[str] | None = None) -> list[Case]:
    """The cases of these parts of the corpus, of all by default, in a fixed order."""
    return [case for part in parts or PARTS for case in PARTS[part]()]


def get_case(part: str, name: str) -> Case:
    """The case of that name."""
    return next(case for case in PARTS[part]() if case.name == name)
