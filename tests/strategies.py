"""Random instances shared by the tests: built once, drawn from NumPy's generators (seeded loops) or by Hypothesis.

Every builder takes ``rng``. A seeded loop passes ``np.random.default_rng(seed)``; the strategies at the end pass
:class:`Drawn`, which answers the same calls with Hypothesis draws, so that a failure shrinks: to fewer robots, fewer
elements and small round numbers, where equal elements, useless robots and rank-one information are the rule.
"""

import sys
from dataclasses import replace

import networkx as nx
import numpy as np
from hypothesis import settings
from hypothesis import strategies as st

from ratt_opt import (
    ConcaveOfModular,
    LogDetObjective,
    MaxEigenvalueObjective,
    Problem,
    SetFunction,
    TableFunction,
    TraceObjective,
)
from ratt_opt.setfunctions.information import InformationObjective

OBJECTIVES = {"trace": TraceObjective, "logdet": LogDetObjective, "maxeig": MaxEigenvalueObjective}


class OwnTrace(InformationObjective):
    """The trace as a criterion of one's own: nothing but its formula is known."""

    def criterion(self, posterior_information):
        return self.weights * np.trace(np.linalg.inv(posterior_information), axis1=-2, axis2=-1)

    def gradient(self, posterior_information):
        covariance = np.linalg.inv(posterior_information)
        return self.weights[:, None, None] * (covariance @ covariance)


class SquaredVariances(InformationObjective):
    """``sum_j w_j tr(P_j^2)``, which no file of the library knows; convex in ``L = P^{-1}`` as ``x^{-2}`` is."""

    def criterion(self, posterior_information):
        covariance = np.linalg.inv(posterior_information)
        return self.weights * np.trace(covariance @ covariance, axis1=-2, axis2=-1)

    def gradient(self, posterior_information):
        covariance = np.linalg.inv(posterior_information)
        return 2 * self.weights[:, None, None] * (covariance @ covariance @ covariance)


def information_data(rng, n_elements, n_targets, dimension=2):
    """Random priors (M, d, d) and positive semidefinite information (E, M, d, d), some of it rank one or zero."""
    root = rng.normal(size=(n_targets, dimension, dimension))
    prior = root @ root.swapaxes(-1, -2) + 0.3 * np.eye(dimension)
    factor = rng.normal(size=(n_elements, n_targets, dimension, dimension))
    factor[rng.random((n_elements, n_targets)) < 0.3, :, 1:] = 0.0
    factor *= rng.choice([0.0, 0.3, 1.0, 3.0], size=(n_elements, n_targets, 1, 1), p=[0.1, 0.3, 0.4, 0.2])
    return prior, factor @ factor.swapaxes(-1, -2)


def range_bearing(rng, n_robots, n_targets, n_controls=12, side=20.0):
    """Priors and information of robots with range-and-bearing sensors in a square [m], as in Section VI."""
    robots = rng.uniform(0, side, (n_robots, 2))
    targets = rng.uniform(0, side, (n_targets, 2))
    speed = np.array([1.0, -1.0, 3.0, -3.0])[np.arange(n_controls) % 4]
    heading = rng.uniform(0, 2 * np.pi, (n_robots, 1)) + np.array([0.0, 1.0, 3.0])[np.arange(n_controls) // 4 % 3]
    move = speed[None, :, None] * np.stack([np.cos(heading), np.sin(heading)], axis=-1)
    sight = targets - (robots[:, None] + move).reshape(-1, 2)[:, None]
    distance = np.maximum(np.linalg.norm(sight, axis=-1), 0.5)
    unit = sight / distance[..., None]
    across = np.stack([-unit[..., 1], unit[..., 0]], axis=-1)
    bearing = np.abs(np.angle(np.exp(1j * (np.arctan2(sight[..., 1], sight[..., 0]) - heading.reshape(-1, 1)))))
    precision_range = 1 / (0.1 + 0.1 * distance)
    precision_across = 1 / ((0.02 + 0.05 * bearing) * distance**2)
    information = precision_range[..., None, None] * unit[..., :, None] * unit[..., None, :]
    information = information + precision_across[..., None, None] * across[..., :, None] * across[..., None, :]
    prior = np.eye(2) * rng.uniform(1, 5, (n_targets, 1, 1))
    return prior, information


def monotone_table(rng, n):
    """(2**n,) normalised non-decreasing values, otherwise arbitrary; with many ties now and then."""
    steps = rng.integers(0, 3, 2**n).astype(float) if rng.random() < 0.5 else rng.random(2**n)
    values = np.zeros(2**n)
    for mask in range(1, 2**n):
        values[mask] = max(values[mask & ~(1 << i)] for i in range(n) if mask >> i & 1) + steps[mask] * (mask % 3 > 0)
    return values


def random_objective(rng, n_elements, kind=None):
    """An objective over ``n_elements``; ``kind`` is one of OBJECTIVES, or "table" (at most 12 elements)."""
    kinds = [*OBJECTIVES, "table"] if n_elements <= 12 else list(OBJECTIVES)
    kind = kind or str(rng.choice(kinds))
    if kind == "table":
        return TableFunction(monotone_table(rng, n_elements))
    prior, information = information_data(rng, n_elements, int(rng.integers(1, 4)), int(rng.integers(1, 4)))
    return OBJECTIVES[kind](prior, information)


def random_graph(rng, n_robots):
    """A random graph on ``0..N-1``, connected or not, complete now and then."""
    density = rng.choice([0.0, 0.3, 0.5, 0.8, 1.0])
    graph = nx.Graph()
    graph.add_nodes_from(range(n_robots))
    graph.add_edges_from((i, j) for j in range(n_robots) for i in range(j) if rng.random() < density)
    return graph


def random_problem(rng, n_robots=None, *, kind=None, protect=True, complete=None, controls=3):
    """A small random problem: ragged controls, shuffled owners, any graph, any budget, protected parts."""
    n_robots = n_robots or int(rng.integers(1, 6))
    counts = rng.integers(1, controls + 1, n_robots)
    owners = rng.permutation(np.repeat(np.arange(n_robots), counts))
    graph = random_graph(rng, n_robots)
    if complete or (complete is None and rng.random() < 0.3):
        graph = nx.complete_graph(n_robots)
    links = sorted((min(e), max(e)) for e in graph.edges)
    protect = protect and rng.random() < 0.4
    return Problem(
        random_objective(rng, len(owners), kind),
        owners,
        None if complete and rng.random() < 0.5 else graph,
        int(rng.integers(0, n_robots + 1)),
        int(rng.integers(0, len(links) + 1)),
        frozenset(i for i in range(n_robots) if protect and rng.random() < 0.3),
        frozenset(link for link in links if protect and rng.random() < 0.3),
    )


def sparse_problem(rng, kind, dimension=2):
    """Two to four robots of one to four elements, each of which sees few of three to five targets."""
    n, m = int(rng.integers(2, 5)), int(rng.integers(3, 6))
    robot = np.concatenate([np.full(rng.integers(1, 5), i) for i in range(n)])
    root = rng.normal(size=(m, dimension, dimension))
    prior = root @ root.swapaxes(-1, -2) + 0.3 * np.eye(dimension)
    sees = rng.random((len(robot), m)) < rng.choice([0.2, 0.4])
    factor = rng.normal(size=(len(robot), m, dimension, dimension))
    factor *= (sees * rng.choice([0.3, 1.0, 3.0, 10.0], size=sees.shape))[..., None, None]
    objective = OBJECTIVES[kind](prior, factor @ factor.swapaxes(-1, -2), rng.choice([1.0, 2.0], size=m))
    graph = random_graph(rng, n)
    links = list(graph.edges)
    return Problem(
        objective,
        rng.permutation(robot) if rng.random() < 0.3 else robot,
        graph,
        int(rng.integers(0, n + 1)),
        int(rng.integers(0, len(links) + 1)),
        protected_robots={i for i in range(n) if rng.random() < 0.2},
        protected_links={link for link in links if rng.random() < 0.2},
    )


def random_elements(rng, problem):
    """A random plan."""
    return np.array([rng.choice(choice) for choice in problem.choices])


SEEDED = settings(max_examples=60, deadline=None, derandomize=True)
"""Settings of the drawn tests in the quick suite: the same examples in every run."""


BUDGETS = ((5, 0, 6), (5, 1, 4), (6, 0, 9), (6, 1, 7), (6, 2, 4), (5, 0, 3))
"""Robots, blinded, cut of small teams on complete graphs."""


def team_problem(seed, n_robots, *, graph=None):
    """Random team on a random graph: all criteria, targets of one to four coordinates, weights, protected parts."""
    rng = np.random.default_rng(seed)
    name, dimension = list(OBJECTIVES)[seed % 3], 1 + seed % 4
    far = range_bearing(rng, n_robots, 4, 1) if dimension == 2 else None
    data = far or information_data(rng, n_robots, 3, dimension)
    graph = graph or random_graph(rng, n_robots)
    links = sorted((min(link), max(link)) for link in graph.edges)
    held = rng.random() < 0.4
    problem = Problem(
        OBJECTIVES[name](*data, rng.uniform(0.2, 3, len(data[0])) if seed % 5 == 0 else None),
        np.arange(n_robots),
        graph,
        int(rng.integers(0, max(n_robots // 2, 1) + 1)),
        int(rng.integers(0, len(links) + 1)),
        frozenset(i for i in range(n_robots) if held and rng.random() < 0.3),
        frozenset(link for link in links if held and rng.random() < 0.2),
    )
    return problem, random_elements(rng, problem)


def ragged(rng, robots, most, kind, weak=0):
    """A team with 1 to ``most`` elements a robot, some of them equal; the first ``weak`` robots see next to nothing."""
    owners = np.repeat(np.arange(robots), rng.integers(1, most + 1, robots))
    prior, information = information_data(rng, len(owners), 3)
    information[owners < weak] *= 1e-3
    twin = np.flatnonzero(np.diff(owners, prepend=-1) == 0)[:1]
    information[twin] = information[twin - 1]
    return Problem(OBJECTIVES[kind](prior, information), owners, None, 0, 0)


def threatened(problem, alpha_s, alpha_c):
    """The same team under another threat."""
    return Problem(problem.objective, problem.robot, None, alpha_s, alpha_c)


def small_team(seed):
    """A small random problem."""
    rng = np.random.default_rng([23, seed])
    robots, alpha_s, alpha_c = BUDGETS[seed % len(BUDGETS)]
    team = ragged(rng, robots, 4, list(OBJECTIVES)[seed // len(BUDGETS) % 3], weak=int(rng.integers(0, 2)))
    return threatened(team, alpha_s, alpha_c)


class Opaque(SetFunction):
    """Values of another function, counted; nothing else is known of it."""

    def __init__(self, f):
        self.f, self.asked = f, 0

    @property
    def n(self):
        return self.f.n

    def evaluate(self, membership):
        self.asked += len(membership)
        return self.f.evaluate(membership)


class Submodular(Opaque):
    """The same of a function that theory proves submodular."""

    is_submodular = True


class Drawn:
    """The calls of ``numpy.random.Generator`` that the builders use, answered by Hypothesis.

    Real numbers are quarters of small integers: they shrink towards zero, add up exactly and tie often.
    """

    def __init__(self, draw):
        self._draw = draw

    def _array(self, size, one):
        shape = (size,) if isinstance(size, int) else tuple(size)
        return np.array([one() for _ in range(int(np.prod(shape)))]).reshape(shape)

    def integers(self, low, high=None, size=None):
        low, high = (0, low) if high is None else (low, high)
        one = st.integers(int(low), int(high) - 1)
        return self._draw(one) if size is None else self._array(size, lambda: self._draw(one))

    def random(self, size=None):
        one = st.integers(0, 15).map(lambda k: k / 16)
        return self._draw(one) if size is None else self._array(size, lambda: self._draw(one))

    def uniform(self, low=0.0, high=1.0, size=None):
        return low + (high - low) * self.random(size)

    def normal(self, size=None):
        one = st.integers(-6, 6).map(lambda k: k / 4)
        return self._draw(one) if size is None else self._array(size, lambda: self._draw(one))

    def choice(self, options, size=None, p=None):  # noqa: ARG002  (shrinking matters here, not how often)
        one = st.sampled_from(list(options))
        return self._draw(one) if size is None else self._array(size, lambda: self._draw(one))

    def permutation(self, items):
        return np.array(self._draw(st.permutations(list(range(items)) if isinstance(items, int) else list(items))))


@st.composite
def drawn(draw, builder, *args, **options):
    """Whatever ``builder(rng, ...)`` makes."""
    return builder(Drawn(draw), *args, **options)


def problems(n_robots=None, **options):
    """Problems as :func:`random_problem` makes them."""
    return drawn(random_problem, n_robots, **options)


def monotone_tables(n):
    """Values of normalised non-decreasing set functions of ``n`` elements, with ties."""
    return drawn(monotone_table, n)


@st.composite
def problems_with_plans(draw, n_robots=None, **options):
    """A problem and a plan for it."""
    problem = draw(problems(n_robots, **options))
    return problem, random_elements(Drawn(draw), problem)


@st.composite
def table_problems(draw):
    """Monotone tables with few distinct values, so that ties are common; ragged, interleaved owners."""
    n_robots = draw(st.integers(1, 4))
    extra = draw(st.lists(st.integers(0, n_robots - 1), max_size=3))
    robot = np.array(draw(st.permutations([*range(n_robots), *extra])))
    n = len(robot)
    steps = draw(st.lists(st.integers(0, 3), min_size=2**n, max_size=2**n))
    values = np.zeros(2**n)
    for mask in range(1, 2**n):
        below = [values[mask & ~(1 << e)] for e in range(n) if mask >> e & 1]
        values[mask] = max(below) + steps[mask]
    alpha_s = draw(st.integers(0, n_robots))
    alpha_c = draw(st.integers(0, n_robots * (n_robots - 1) // 2))
    return Problem(TableFunction(values), robot, None, alpha_s, alpha_c)


_NODES = st.one_of(
    st.integers(-3, 12),
    st.text("ab01 \n\u202e²", max_size=3),
    st.tuples(st.integers(0, 2), st.sampled_from(["x", "y10", "y9"])),
    st.floats(-2, 2),
    st.binary(max_size=2),
    st.frozensets(st.integers(0, 3), max_size=2),
)


@st.composite
def networkx_graphs(draw):
    """Graphs of any kind and nodes, with labels, loops and parallel edges."""
    kind = draw(st.sampled_from((nx.Graph, nx.DiGraph, nx.MultiGraph, nx.MultiDiGraph)))
    nodes = draw(st.lists(_NODES, min_size=1, max_size=8))
    graph = kind()
    graph.add_nodes_from(nodes)
    ends = st.sampled_from(nodes)
    graph.add_edges_from(draw(st.lists(st.tuples(ends, ends), max_size=20)))
    for node in draw(st.lists(ends, max_size=3)):
        graph.nodes[node]["label"] = draw(st.one_of(st.text(max_size=3), st.integers()))
    return graph


class Curved(Opaque):
    """The same of a function whose total curvature is at most a half."""

    most_total_curvature = 0.5


@st.composite
def functions_by_value(draw, n):
    """A non-decreasing function of ``n`` elements that says as much of itself as is true, or nothing."""
    rng, kind = Drawn(draw), draw(st.sampled_from(["table", "submodular", "curved"]))
    if kind == "table":
        return Opaque(TableFunction(monotone_table(rng, n)))
    weights = np.array([draw(st.integers(0, 4)) for _ in range(n)], dtype=float)
    if kind == "submodular":
        return Submodular(ConcaveOfModular(weights, np.sqrt))
    size = np.bitwise_count(np.arange(2**n)).astype(float)
    return Curved(TableFunction(size + np.maximum(size - 2, 0)))  # marginals are 1 or 2


@st.composite
def problems_by_value(draw, largest=4):
    """A small problem of such a function on any graph."""
    drawn = random_problem(Drawn(draw), draw(st.integers(1, largest)), kind="trace", controls=2)
    return replace(drawn, objective=draw(functions_by_value(drawn.objective.n)))


@st.composite
def degenerate_problems(draw):
    """Small teams with ties, nothing to see, one line of sight, or information of any size against the prior's."""
    n_robots, controls = draw(st.integers(1, 4)), draw(st.integers(1, 2))
    rng = Drawn(draw)
    prior, information = information_data(rng, n_robots * controls, draw(st.integers(1, 3)), 2)
    kind = draw(st.sampled_from(["line", "useless", "identical", "scaled", "out of reach"]))
    if kind == "line":
        v = rng.normal((*information.shape[:2], 2))
        information = v[..., :, None] * v[..., None, :]
    elif kind == "useless":
        information = np.zeros_like(information)
    elif kind == "identical":
        information = np.repeat(information[:1], len(information), axis=0)
    elif kind == "scaled":
        information = information * 10.0 ** draw(st.integers(-10, 8))
    else:
        information[:, 0] = 0.0
    links = n_robots * (n_robots - 1) // 2
    budgets = draw(st.integers(0, n_robots)), draw(st.integers(0, links))
    name = draw(st.sampled_from(sorted(OBJECTIVES)))
    return Problem(OBJECTIVES[name](prior, information), np.repeat(np.arange(n_robots), controls), None, *budgets)


@st.composite
def degenerate_networks(draw):
    """Networks of 13 to 24 robots that know all the same, or of whom only some see anything."""
    n_robots, dimension = draw(st.integers(13, 24)), draw(st.integers(1, 3))
    rng = np.random.default_rng(draw(st.integers(0, 2**16)))
    prior, information = information_data(rng, n_robots, 2, dimension)
    seeing = rng.random(n_robots) < draw(st.sampled_from([0.2, 1.0]))
    information = np.repeat(information[:1] + 0.1 * np.eye(dimension), n_robots, axis=0) * seeing[:, None, None, None]
    graph = nx.gnp_random_graph(n_robots, draw(st.sampled_from([0.2, 0.5])), seed=draw(st.integers(0, 2**16)))
    budgets = draw(st.integers(0, n_robots)), draw(st.integers(0, graph.number_of_edges()))
    name = draw(st.sampled_from(sorted(OBJECTIVES)))
    return Problem(OBJECTIVES[name](prior, information), np.arange(n_robots), graph, *budgets)


@st.composite
def budgets(draw, robots):
    """Any number of blinded robots and cut links of a complete graph."""
    return draw(st.integers(0, robots - 1)), draw(st.integers(0, robots * (robots - 1) // 2))


coefficients = st.lists(st.fractions(min_value=-3, max_value=3, max_denominator=7), max_size=5)
points = st.fractions(min_value=0, max_value=1, max_denominator=11)
"""Of polynomials, and where they are evaluated."""


coordinates = st.floats(-50, 50)
angles = st.floats(-10, 10)
"""Of poses [m, rad]."""


FLOATS = st.floats(allow_nan=False, allow_infinity=False)
POSITIVE = st.floats(min_value=0, exclude_min=True, allow_infinity=False)
DIGITS = st.integers(1, 15)
"""Ends of brackets, and digits that they are printed with."""


def close_above(low: float, rounding: int) -> float:
    """A float a little above another one, as ends of brackets that are nearly closed."""
    return min(low + abs(low) * 10.0**-rounding, sys.float_info.max)


NEARLY_CLOSED = st.builds(close_above, st.floats(-1e300, 1e300), st.integers(1, 17))
