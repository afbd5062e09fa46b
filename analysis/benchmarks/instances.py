"""Instances of the measurements: complete graphs, networks, and cameras that must choose what to look at.

The golden corpus, the rivals and the page of open problems draw their problems here, so names and numbers never change.
"""

from typing import Any

import numpy as np

import ratt_opt as ro

__all__ = ["SETTINGS", "SHARES", "budget_grid", "complete_problem", "network_problem", "team", "warm_up"]

SETTINGS = {
    10: (15, ((3, 11), (5, 15), (6, 22))),
    20: (20, ((6, 47), (10, 63), (13, 95))),
    30: (25, ((10, 108), (15, 145), (20, 217))),
    40: (30, ((13, 195), (20, 260), (26, 390))),
    60: (40, ((20, 442), (30, 590), (40, 885))),
    100: (100, ((33, 1237), (50, 1650))),
}
"""Robots -> targets and the budgets (sensing, links): a third, a half, two thirds; a quarter, a third, a half."""
NETWORK_TARGETS = {24: 25, 30: 25, 50: 30, 100: 100}
SHARES = {"fifth": (0.2, 0.15), "third": (1 / 3, 0.3), "random": None}
"""Shares of the robots blinded and of the links cut; ``None`` draws both up to twice a third of them."""
CAMERA_BUDGETS = {6: (2, 4), 10: (3, 8), 20: (5, 20), 50: (12, 50)}
VIEW, REACH_OF_LINKS = 57.0, 45.0
WARM, WARM_LARGE = 24, 64
"""Robots of the first problems of each objective, not counted: modules are loaded then. Large teams are asked
who is inside first (``attack/thresholds/pricing.py``)."""


def complete_problem(robots: int, alpha_s: int, alpha_c: int, objective: str, seed: int = 0) -> ro.Problem:
    """Draw a random scenario of the paper's kind, on the complete graph."""
    targets = SETTINGS[robots][0] if robots in SETTINGS else 5
    return ro.random_scenario(robots, targets, alpha_s=alpha_s, alpha_c=alpha_c, seed=seed).problem(objective)


def budget_grid(robots: int, steps: int) -> list[tuple[int, int]]:
    """``steps`` numbers of blinded robots, from none to all but two, by ``steps`` of cut links, from 5 to 95 %."""
    links = robots * (robots - 1) // 2
    blinded = np.round(np.linspace(0, robots - 2, steps)).astype(int).tolist()
    cut = np.round(np.linspace(0.05, 0.95, steps) * links).astype(int).tolist()
    return [(one, other) for one in blinded for other in cut]


def network_problem(family: str, robots: int, budgets: str, seed: int, objective: str) -> ro.Problem:
    """Draw a network; ``budgets`` : a name of ``SHARES``."""
    shares = SHARES[budgets] or np.random.default_rng([robots, seed]).uniform(0, 2 / 3, 2).tolist()
    options: dict[str, Any] = {"alpha_s": float(shares[0]), "alpha_c": float(shares[1]), "seed": seed}
    return ro.network_scenario(family, robots, NETWORK_TARGETS[robots], **options).problem(objective)


def team(robots: int, targets: int, network: str, seed: int) -> ro.Scenario:
    """Draw cameras of 57 degrees on a complete or a disk network; no more links are cut than there are."""
    alpha_s, alpha_c = CAMERA_BUDGETS[robots]
    near = REACH_OF_LINKS if network == "disk" else None
    drawn = ro.limited_view_scenario(
        robots, targets, alpha_s=alpha_s, alpha_c=0, seed=seed, view=VIEW, communication_range=near
    )
    links = len(drawn.problem("trace").communication.links)
    return drawn.replace(alpha_c=min(alpha_c, links))


def warm_up(objective: str) -> None:
    """Load what searches load when they are first used."""
    for family in ("disk-6", "dense", "hubs"):  # hubs: nothing quicker than prices closes them
        problem = ro.network_scenario(family, WARM, 5, alpha_s=1 / 3, alpha_c=0.3, seed=0).problem(objective)
        ro.worst_case_attack(problem, ro.ratt(problem).elements, time_limit=2)
        ro.solve_maxmin(problem, time_limit=2)
    problem = ro.network_scenario("hubs", WARM_LARGE, 5, alpha_s=1 / 3, alpha_c=0.3, seed=0).problem(objective)
    ro.worst_case_attack(problem, ro.ratt(problem).elements, time_limit=4)
