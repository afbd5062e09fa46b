"""Two thousand tiny teams, with rows and hulls from the root: ends and certificates against every plan and attack."""

from pathlib import Path

import networkx as nx
import numpy as np
import pytest

from ratt_opt import LogDetObjective, Problem, TraceObjective, certify, exhaustive_optimum
from ratt_opt.budget import Budget
from ratt_opt.solvers.maxmin.rows.separation import RowSeparation
from ratt_opt.solvers.maxmin.solve import solve_in_coordinates
from ratt_opt.solvers.maxmin.stages.schedule import TREES_ALONE
from tests.solvers.maxmin.proofs import proved_upper

pytestmark = pytest.mark.slow


def drawn(rng: np.random.Generator) -> Problem:
    """Three to five robots, with links to cut, protected robots and links, and a trace of outputs now and then."""
    robots, d = int(rng.integers(3, 6)), int(rng.integers(1, 3))
    sizes, targets = rng.integers(1, 4, robots), int(rng.integers(2, 7))
    n = int(sizes.sum())
    roots = rng.normal(size=(n, targets, d, d)) * 10.0 ** rng.uniform(-1, 1.5, size=(n, targets, 1, 1))
    roots[rng.random((n, targets)) < 0.3, 1:] = 0.0
    roots[rng.random((n, targets)) < 0.5] = 0.0
    information = np.einsum("ejki,ejkl->ejil", roots, roots)
    spread = rng.normal(size=(targets, d, d))
    prior, weights = spread @ np.swapaxes(spread, 1, 2) + 0.1 * np.eye(d), rng.uniform(0.2, 2, targets)
    kind = int(rng.integers(3))
    if kind == 0:
        objective = LogDetObjective(prior, information, weights)
    else:
        output = rng.normal(size=(1, d)) if kind == 2 else None
        objective = TraceObjective(prior, information, weights, output=output)
    graph = nx.gnp_random_graph(robots, 0.7, seed=int(rng.integers(2**31))) if rng.random() < 0.5 else None
    links = list(graph.edges if graph is not None else nx.complete_graph(robots).edges)
    return Problem(
        objective,
        np.repeat(np.arange(robots), sizes).tolist(),
        graph,
        int(rng.integers(0, robots - 1)),
        int(rng.integers(0, len(links) + 1)),
        protected_robots=[0] if rng.random() < 0.3 else (),
        protected_links=links[:1] if rng.random() < 0.3 else (),
    )


@pytest.mark.parametrize("block", range(20))
def test_both_ends_meet_at_the_best_of_all_plans(block: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(RowSeparation, "first_node", lambda _: 0)
    rng = np.random.default_rng([93, block])
    for _ in range(100):
        problem = drawn(rng)
        best = exhaustive_optimum(problem).lower
        stages = None if rng.random() < 0.5 else TREES_ALONE
        found = solve_in_coordinates(problem, Budget(max_nodes=2_000), 1e-6, stages=stages)
        rounding = 1e-9 * best + 16 * problem.objective.rounding
        assert found.lower <= best + rounding
        assert best <= found.upper + rounding
        assert found.upper - found.lower <= 2e-6 * found.upper + rounding
        assert proved_upper(problem, found.proof) >= best - rounding
        made = certify(problem, found, tmp_path / "best.json")
        assert made.verified.lower <= best + rounding
        assert best - rounding <= made.verified.upper <= found.upper * (1 + 1e-7) + rounding
