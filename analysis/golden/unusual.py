"""Problems unlike the benchmark's: degenerate, weighted, protected, large, of other dimensions, with user functions."""

from collections.abc import Callable
from typing import Any

import networkx as nx
import numpy as np

import ratt_opt as ro
from ratt_opt import Problem, SetFunction
from ratt_opt._validation import FloatArray
from ratt_opt.setfunctions.criteria.registry import CRITERIA

__all__ = ["UNUSUAL", "unusual_problem"]

Data = dict[str, Any]


def _matrices(rng: np.random.Generator, shape: tuple[int, ...], rank: int, dimension: int) -> FloatArray:
    factor = rng.normal(size=(*shape, dimension, rank))
    return np.asarray(factor @ factor.swapaxes(-1, -2))


def _team(rng: np.random.Generator, dimension: int = 2, largest: int = 24) -> Data:
    """Robots of one to three elements, a graph and budgets, and what their sensors tell about a few targets."""
    robots, targets = int(rng.integers(3, largest + 1)), int(rng.integers(1, 6))
    owners = np.repeat(np.arange(robots), rng.integers(1, 4, robots))
    graph = nx.gnp_random_graph(robots, float(rng.choice([0.2, 0.5, 0.8, 1.0])), seed=int(rng.integers(2**31)))
    shape = (len(owners), targets)
    return {
        "kind": str(rng.choice(list(CRITERIA))),
        "prior": _matrices(rng, (targets,), dimension, dimension) + 0.3 * np.eye(dimension),
        "information": _matrices(rng, shape, dimension, dimension) * rng.choice([0.0, 0.3, 1, 3], (*shape, 1, 1)),
        "owners": owners,
        "graph": graph,
        "alpha_s": int(rng.integers(0, robots)),
        "alpha_c": int(rng.integers(0, graph.number_of_edges() + 1)),
        "more": {},
        "protected": {},
    }


def _problem(data: Data) -> Problem:
    function = CRITERIA[data["kind"]](data["prior"], data["information"], **data["more"])
    return _around(function, data)


def _around(function: SetFunction, data: Data) -> Problem:
    budgets = data["alpha_s"], data["alpha_c"]
    return ro.Problem(function, data["owners"], data["graph"], *budgets, **data["protected"])


def _identical(rng: np.random.Generator) -> Problem:
    """Robots that are copies of two, on any graph."""
    data = _team(rng)
    first = data["information"][:2]
    data["information"] = first[data["owners"] % 2]
    return _problem(data)


def _useless(rng: np.random.Generator) -> Problem:
    """Half of the robots see nothing, and one target is seen by nobody."""
    data = _team(rng)
    data["information"][np.isin(data["owners"], np.flatnonzero(rng.random(data["owners"][-1] + 1) < 0.5))] = 0.0
    data["information"][:, 0] = 0.0
    return _problem(data)


def _rank_one(rng: np.random.Generator) -> Problem:
    """Sensors of bearings: each tells of one direction."""
    data = _team(rng)
    data["information"] = _matrices(rng, data["information"].shape[:2], 1, 2)
    return _problem(data)


def _large_numbers(rng: np.random.Generator) -> Problem:
    """Information of 1e6 beside 1e-6, and priors without knowledge."""
    data = _team(rng)
    data["information"] *= rng.choice([1e-6, 1.0, 1e3, 1e6], (len(data["owners"]), 1, 1, 1))
    data["prior"] *= 10.0 ** rng.integers(-3, 5)
    return _problem(data)


def _weighted(rng: np.random.Generator) -> Problem:
    """Weights of targets over four decades."""
    data = _team(rng)
    data["more"] = {"weights": 10.0 ** rng.uniform(-2, 2, len(data["prior"]))}
    return _problem(data)


def _protected(rng: np.random.Generator) -> Problem:
    """Robots and links that the adversary cannot touch."""
    data = _team(rng)
    links = [(min(e), max(e)) for e in data["graph"].edges]
    robots = range(int(data["owners"][-1]) + 1)
    data["protected"] = {
        "protected_robots": frozenset(i for i in robots if rng.random() < 0.3),
        "protected_links": frozenset(link for link in links if rng.random() < 0.3),
    }
    return _problem(data)


def _dimension(rng: np.random.Generator) -> Problem:
    """One, three, four and six coordinates."""
    return _problem(_team(rng, dimension=int(rng.choice([1, 3, 4, 6])), largest=16))


def _output(rng: np.random.Generator) -> Problem:
    """Four coordinates of which two, or a combination, count."""
    data = _team(rng, dimension=4, largest=16)
    data["kind"] = str(rng.choice(["trace", "maxeig"]))
    rows = np.eye(2, 4) if rng.random() < 0.5 else rng.normal(size=(int(rng.integers(1, 4)), 4))
    data["more"] = {"output": rows}
    return _problem(data)


def _user_function(rng: np.random.Generator) -> Problem:
    """Coverage, facilities, concave functions of sums, and tables: what users bring."""
    data = _team(rng, largest=14)
    elements = len(data["owners"])
    which = int(rng.integers(3))
    function: SetFunction
    if which == 0:
        function = ro.FacilityLocation(rng.random((elements, 8)))
    elif which == 1:
        function = ro.ConcaveOfModular(rng.uniform(0.1, 1.0, elements))
    else:
        function = ro.Modular(rng.uniform(0.0, 1.0, elements))
    return _around(function, data)


def _edges(rng: np.random.Generator) -> Problem:
    """Make an extreme problem: no attack, attacks on everything, or no links."""
    data = _team(rng)
    robots, links = int(data["owners"][-1]) + 1, data["graph"].number_of_edges()
    data["alpha_s"] = int(rng.choice([0, robots]))
    data["alpha_c"] = int(rng.choice([0, links]))
    if rng.random() < 0.2:
        data |= {"graph": nx.empty_graph(robots), "alpha_c": 0}
    return _problem(data)


def _large(rng: np.random.Generator) -> Problem:
    """A hundred robots and more on sparse networks and complete graphs."""
    robots = int(rng.choice([100, 150, 200]))
    budgets: dict[str, Any] = {"alpha_s": float(rng.choice([0.02, 0.1])), "alpha_c": float(rng.choice([0.01, 0.05]))}
    family = str(rng.choice(["disk-6", "hubs", "complete"]))
    kind, seed = str(rng.choice(list(CRITERIA))), int(rng.integers(1000))
    if family != "complete":
        return ro.network_scenario(family, robots, 20, seed=seed, **budgets).problem(kind)
    blinded, cut = round(budgets["alpha_s"] * robots), round(budgets["alpha_c"] * robots * (robots - 1) / 2)
    return ro.random_scenario(robots, 20, alpha_s=blinded, alpha_c=cut, seed=seed).problem(kind)


BUILT: dict[str, tuple[Callable[[np.random.Generator], Problem], int]] = {
    "identical robots": (_identical, 20),
    "useless robots": (_useless, 20),
    "bearings": (_rank_one, 20),
    "large numbers": (_large_numbers, 20),
    "weighted": (_weighted, 20),
    "protected": (_protected, 20),
    "other dimensions": (_dimension, 20),
    "output": (_output, 20),
    "user function": (_user_function, 20),
    "extreme budgets": (_edges, 10),
    "large": (_large, 10),
}
UNUSUAL = {kind: count for kind, (_, count) in BUILT.items()}
"""Kind -> number of cases."""


def unusual_problem(kind: str, seed: int) -> Problem:
    """The problem of one case."""
    build = BUILT[kind][0]
    return build(np.random.default_rng([seed, list(BUILT).index(kind)]))
