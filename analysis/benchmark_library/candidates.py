"""Candidates of the benchmark: families of instances, each drawn from a stated call and seed."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import Any

import networkx as nx
import numpy as np

import ratt_opt as ro
from ratt_opt.benchmark.instances.forms import Form, NetworkInput, SumInput, TableInput
from ratt_opt.benchmark.instances.instance import BenchmarkInstance
from ratt_opt.missions.first_step import first_step
from ratt_opt.scenario.on_graph import graph_scenario
from ratt_opt.worst_ratio.families import link_only_instance, pair_instance, sensing_instance, shared_plan_instance
from ratt_opt.worst_ratio.witness import RatioWitness, attaining_instance, limit_instance

__all__ = ["Candidate", "candidates"]

AGAIN = {"": 0, "-b": 100}
"""Ending of a name -> what is added to its seed: two instances of each size."""
CRITERIA = ("trace", "logdet", "maxeig")
GRAPHS: dict[str, Callable[[], nx.Graph]] = {
    "petersen": nx.petersen_graph,
    "frucht": nx.frucht_graph,
    "heawood": nx.heawood_graph,
    "florentine": nx.florentine_families_graph,
    "pappus": nx.pappus_graph,
    "dodecahedron": nx.dodecahedral_graph,
    "desargues": nx.desargues_graph,
    "davis": nx.davis_southern_women_graph,
    "karate": nx.karate_club_graph,
    "tutte": nx.tutte_graph,
    "les-miserables": nx.les_miserables_graph,
}
"""Published graphs of networkx, by size."""


@dataclass(frozen=True, slots=True)
class Candidate:
    """An instance that is not drawn yet."""

    name: str
    family: str
    source: str
    draw: Callable[[], BenchmarkInstance]


def candidates() -> list[Candidate]:
    """All candidates, small before large in each family."""
    families = (_paper, _views, _networks, _doppler, _coverage, _facilities, _attacks, _cuts, _ratios)
    return [candidate for family in families for candidate in family()]


def _candidate(name: str, family: str, source: str, objective: str, problem: Callable[[], Form]) -> Candidate:
    def draw() -> BenchmarkInstance:
        return BenchmarkInstance(name=name, family=family, source=source, objective=objective, problem=problem())

    return Candidate(name, family, source, draw)


def _form(kind: type[Form], /, **fields: Any) -> Form:
    """A record from plain lists."""
    return kind(**fields)


def _of_scenario(make: Callable[..., ro.Scenario], *given: Any, **named: Any) -> Callable[[], Form]:
    return lambda: make(*given, **named).to_information()


def _call(name: str, given: tuple[object, ...], named: Mapping[str, object]) -> str:
    return f"{name}({', '.join([*map(repr, given), *(f'{k}={v!r}' for k, v in named.items())])})"


def _paper() -> Iterator[Candidate]:
    """Section VI of the paper: its budgets, three criteria."""
    for n, m, budgets in ((4, 4, ((1, 3), (2, 4))), (10, 15, ((3, 11), (5, 15), (6, 22))), (20, 20, ((6, 47),))):
        for alpha_s, alpha_c in budgets:
            for again, (seed, objective) in product(AGAIN, enumerate(CRITERIA)):
                named = {"alpha_s": alpha_s, "alpha_c": alpha_c, "seed": seed + AGAIN[again]}
                draw = _of_scenario(ro.random_scenario, n, m, **named)
                name = f"paper-{objective}-n{n:02}-a{alpha_s}-c{alpha_c}{again}"
                yield _candidate(name, "paper", _call("random_scenario", (n, m), named), objective, draw)


def _views() -> Iterator[Candidate]:
    """Cameras that turn, on the complete graph and on disks."""
    for n, m, alpha_s in ((5, 4, 1), (6, 6, 2), (8, 6, 2), (10, 8, 2), (14, 10, 3)):
        for objective in ("trace", "logdet"):
            for again, reach in product(AGAIN, (None, 30.0)):
                budgets = {"alpha_s": alpha_s, "alpha_c": 2 if reach else 0}
                named = {**budgets, "seed": n + AGAIN[again], "communication_range": reach}
                draw = _of_scenario(ro.limited_view_scenario, n, m, **named)
                name = f"views-{objective}-n{n:02}-a{alpha_s}-{'disk' if reach else 'complete'}{again}"
                yield _candidate(name, "limited views", _call("limited_view_scenario", (n, m), named), objective, draw)


def _networks() -> Iterator[Candidate]:
    """Random networks: disks, small worlds, hubs, dense ones."""
    for family in ("disk-6", "disk-12", "small-world", "hubs", "dense"):
        for again, (n, objective) in product(AGAIN, ((8, "logdet"), (12, "trace"), (16, "maxeig"), (24, "trace"))):
            named = {"alpha_s": 0.2, "alpha_c": 0.15, "seed": n + AGAIN[again]}
            draw = _of_scenario(ro.network_scenario, family, n, n, **named)
            source = _call("network_scenario", (family, n, n), named)
            yield _candidate(f"{family}-{objective}-n{n:02}{again}", family, source, objective, draw)


def _doppler() -> Iterator[Candidate]:
    """Targets with velocities, four and six numbers each, and radars that read them."""
    radar = {"range_std": 1.0, "bearing_std": 0.02, "rate_std": 0.1}
    for n, alpha_s, objective in ((4, 1, "trace"), (6, 2, "logdet"), (8, 2, "trace"), (10, 3, "logdet")):
        for motion, dimension in (("constant velocity", 4), ("constant velocity 3d", 6)):

            def problem(
                n: int = n, alpha_s: int = alpha_s, motion: str = motion, d: int = dimension, objective: str = objective
            ) -> Form:
                team = ro.limited_view_scenario(n, n, alpha_s=alpha_s, alpha_c=2, seed=n, communication_range=40.0)
                sensor = ro.DopplerRadar(**radar) if d == 4 else ro.SphericalSensor(0.5, 0.02)
                return first_step(team, ro.MissionModel(motion=motion, sensor=sensor, objective=objective))

            reads = "DopplerRadar" if dimension == 4 else "SphericalSensor"
            source = f"first_step of limited_view_scenario({n}, {n}, seed={n}), {motion}, {reads}"
            yield _candidate(f"velocity{dimension}-{objective}-n{n:02}", "velocities", source, objective, problem)


def _coverage() -> Iterator[Candidate]:
    """Resilient coverage (Shi, Zhou, Tokekar): robots' paths cover targets, robots are lost."""
    sizes = ((5, 4, 30, 1), (6, 5, 40, 2), (8, 5, 60, 2), (8, 7, 80, 3), (10, 7, 100, 3))
    for robots, paths, targets, lost in sizes:
        for seed in (0, 1, 2):

            def problem(r: int = robots, p: int = paths, t: int = targets, a: int = lost, seed: int = seed) -> Form:
                rng = np.random.default_rng(seed)
                covers = [sorted({*rng.integers(0, t, rng.integers(5, 16)).tolist()}) for _ in range(r * p)]
                owner = np.repeat(np.arange(r), p).tolist()
                return _form(
                    SumInput, kind="coverage", covers=covers, weights=[1.0] * t, robot=owner, alpha_s=a, alpha_c=0
                )

            source = f"{robots} robots, {paths} paths of 5 to 15 of {targets} targets, default_rng({seed})"
            name = f"coverage-r{robots:02}-p{paths}-t{targets}-a{lost}-s{seed}"
            yield _candidate(name, "resilient coverage", source, "trace", problem)
    for n, cut in ((6, 2), (8, 3)):

        def on_ring(n: int = n, cut: int = cut) -> Form:
            rng = np.random.default_rng(n)
            covers = [sorted({*rng.integers(0, 5 * n, rng.integers(5, 12)).tolist()}) for _ in range(4 * n)]
            links = [(i, (i + 1) % n) for i in range(n)] + [(0, n // 2)]
            owner = np.repeat(np.arange(n), 4).tolist()
            return _form(
                SumInput,
                kind="coverage",
                covers=covers,
                weights=[1.0] * (5 * n),
                robot=owner,
                alpha_s=1,
                alpha_c=cut,
                links=links,
            )

        source = f"{n} robots on a ring with a chord, 4 paths of 5 to 11 of {5 * n} targets, default_rng({n})"
        yield _candidate(f"coverage-ring-r{n:02}-c{cut}", "resilient coverage", source, "trace", on_ring)


def _facilities() -> Iterator[Candidate]:
    """Facility location under interdiction: open p of n sites, some are lost."""
    for chosen, sites, lost in ((3, 8, 1), (4, 10, 1), (4, 12, 2), (5, 14, 2)):
        for seed in (0, 1, 2):

            def problem(p: int = chosen, n: int = sites, a: int = lost, seed: int = seed) -> Form:
                places = np.random.default_rng(seed).integers(0, 13, (n, 2))
                far = np.abs(places[:, None] - places[None]).sum(axis=-1)
                utility = np.tile(far.max() - far, (p, 1)).astype(float).tolist()
                owner = np.repeat(np.arange(p), n).tolist()
                return _form(SumInput, kind="facility location", utility=utility, robot=owner, alpha_s=a, alpha_c=0)

            source = f"{chosen} of {sites} sites on a grid of 13, L1 distances, default_rng({seed})"
            name = f"facility-p{chosen}-n{sites:02}-a{lost}-s{seed}"
            yield _candidate(name, "facility location under interdiction", source, "trace", problem)


def _attacks() -> Iterator[Candidate]:
    """Attacks alone, on RATT's plan, on published graphs."""
    for k, (name, graph) in enumerate(GRAPHS.items()):
        for objective in (CRITERIA[k % 3], CRITERIA[(k + 1) % 3]):
            for share in (0.1, 0.2):

                def problem(
                    make: Callable[[], nx.Graph] = graph, objective: str = objective, share: float = share
                ) -> Form:
                    network = make()
                    cut, lost = round(share * network.number_of_edges()), round(share * len(network))
                    drawn = graph_scenario(network, len(network), alpha_s=lost, alpha_c=cut, seed=1).to_information()
                    plan = sorted(ro.ratt(drawn.problem(objective)))
                    information = [drawn.information[e] for e in plan]
                    return _form(
                        ro.InformationInput,
                        prior=drawn.prior,
                        information=information,
                        robot=list(range(drawn.n_robots)),
                        alpha_s=lost,
                        alpha_c=cut,
                        links=drawn.links,
                    )

                part = f"{round(100 * share)}"
                source = f"networkx {name}, RATT's plan for {objective}, {part} % of robots and links"
                yield _candidate(f"attack-{name}-{objective}-{part}", "attacks on graphs", source, objective, problem)


def _cuts() -> Iterator[Candidate]:
    """Fewest cuts of published graphs and of grids, some with weights."""
    grids = {f"grid-{k}x{k}": (lambda k=k: nx.convert_node_labels_to_integers(nx.grid_2d_graph(k, k))) for k in (6, 10)}
    for name, graph in {**GRAPHS, **grids}.items():
        for share, weighted in ((2, False), (4, False), (3, True)):

            def problem(make: Callable[[], nx.Graph] = graph, share: int = share, weighted: bool = weighted) -> Form:
                network = nx.convert_node_labels_to_integers(nx.Graph(make()), ordering="sorted")
                links = sorted((min(i, j), max(i, j)) for i, j in network.edges if i != j)
                weights = np.random.default_rng(share).integers(1, 10, len(links)).tolist() if weighted else None
                return _form(
                    NetworkInput, robots=len(network), links=links, size=len(network) // share, weights=weights
                )

            drawn = f", weights of default_rng({share})" if weighted else ""
            source = f"networkx {name}, groups of a share 1/{share}{drawn}"
            yield _candidate(f"cuts-{name}-{share}{'w' if weighted else ''}", "fewest cuts", source, "trace", problem)


def _ratios() -> Iterator[Candidate]:
    """Families on which RATT has its worst ratio."""
    half, third = Fraction(1, 2), Fraction(1, 3)
    witnesses: dict[str, tuple[str, Callable[[], RatioWitness]]] = {
        "pair": ("pair_instance(1/2)", lambda: pair_instance(half)),
        "shared-4": ("shared_plan_instance(2, 1/2)", lambda: shared_plan_instance(2, half)),
        "shared-6": ("shared_plan_instance(3, 1/3)", lambda: shared_plan_instance(3, third)),
        "sensing-5": ("sensing_instance(3, 2, 1/2)", lambda: sensing_instance(3, 2, half)),
        "limit-6": ("limit_instance(3, 1/2)", lambda: limit_instance(3, half)),
        "attaining-6": ("attaining_instance(2, 1/2)", lambda: attaining_instance(2, half)),
        "links-7": ("link_only_instance(1/2)", lambda: link_only_instance(half)),
    }
    for name, (call, make) in witnesses.items():

        def problem(make: Callable[[], RatioWitness] = make) -> Form:
            witness = make()
            owner = np.tile(np.arange(witness.n_robots), 2).tolist()
            values = witness.values.astype(float).tolist()
            budgets = {"alpha_s": witness.alpha_s, "alpha_c": witness.alpha_c}
            return _form(TableInput, values=values, robot=owner, **budgets)

        yield _candidate(f"ratio-{name}", "worst ratios", f"ratt_opt.worst_ratio {call}", "trace", problem)
