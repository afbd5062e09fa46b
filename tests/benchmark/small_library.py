"""A library of three small instances with records, made anew: a plan, an attack and a cut."""

import json

import networkx as nx
import numpy as np

import ratt_opt as ro
from ratt_opt.benchmark.instances.forms import NetworkInput, SumInput, TableInput
from ratt_opt.benchmark.instances.library import Best, hash_of


def coverage_instance(name="cover", seed=0, robots=4, lost=1, cut=0, links=None):  # noqa: PLR0917
    rng = np.random.default_rng(seed)
    covers = [sorted({*rng.integers(0, 12, 4).tolist()}) for _ in range(3 * robots)]
    owner = np.repeat(np.arange(robots), 3).tolist()
    form = SumInput(
        kind="coverage", covers=covers, weights=[1.0] * 12, robot=owner, alpha_s=lost, alpha_c=cut, links=links
    )
    return ro.BenchmarkInstance(name=name, family="test", source=f"seed {seed}", problem=form)


def table_instance(name="table", seed=0, robots=3):
    rng = np.random.default_rng(seed)
    values = np.zeros((2,) * (2 * robots))
    values += rng.integers(0, 20, values.shape)
    values.ravel()[0] = 0
    for axis in range(values.ndim):
        np.maximum.accumulate(values, axis=axis, out=values)
    owner = np.repeat(np.arange(robots), 2).tolist()
    form = TableInput(values=values.ravel().tolist(), robot=owner, alpha_s=1, alpha_c=1)
    return ro.BenchmarkInstance(name=name, family="test", source=f"seed {seed}", problem=form)


def plan_instance(name="plan", seed=0, objective="trace", robots=4):
    team = ro.random_scenario(robots, 3, alpha_s=1, alpha_c=2, seed=seed).to_information()
    return ro.BenchmarkInstance(name=name, family="test", source="s", objective=objective, problem=team)


def attack_instance(name="attack", seed=0):
    team = ro.random_scenario(5, 3, alpha_s=1, alpha_c=3, seed=seed).to_information()
    plan = list(ro.ratt(team.problem()))
    only = team.replace(
        information=tuple(team.information[e] for e in plan),
        robot=tuple(range(5)),
        labels=None,
        element_positions=None,
        element_headings=None,
        element_controls=None,
    )
    return ro.BenchmarkInstance(name=name, family="test", source="s", problem=only)


def cuts_instance(name="cuts", weights=None):
    graph = nx.petersen_graph()
    links = sorted((min(link), max(link)) for link in graph.edges)
    form = NetworkInput(robots=10, links=links, size=4, weights=weights)
    return ro.BenchmarkInstance(name=name, family="test", source="networkx", problem=form)


def certificate_of(instance, folder):
    """What the library proves of an instance, and its answer."""
    from ratt_opt.benchmark.proofs.verification import ENUMERATION, stated_problem

    path = folder / "c.json"
    if instance.track == "cuts":
        network = instance.network
        found = ro.fewest_cuts(network.graph, network.size, weights=network.weight_of)
        ro.certify_cuts(network.graph, found, path, weights=network.weight_of)
        return {"cut": [list(link) for link in sorted(found.cut)]}, json.loads(path.read_text())
    if isinstance(instance.problem, TableInput):
        best = ro.exhaustive_optimum(instance.team)
        return {"elements": best.elements.tolist()}, {"format": ENUMERATION, "version": 1}
    given, objective = stated_problem(instance)
    team = given.problem(objective)
    found = ro.solve_maxmin(team)
    ro.certify(team, found, path)
    certificate = json.loads(path.read_text())
    if instance.track == "attack":
        attack = ro.worst_case_attack(team, found.elements).attack
        answer = {"sensing": sorted(attack.sensing), "links": [list(link) for link in sorted(attack.links)]}
        return answer, certificate
    return {"elements": found.elements.tolist()}, certificate


def record_of(instance, folder):
    from ratt_opt.benchmark.proofs.answers import worth_of
    from ratt_opt.benchmark.proofs.verification import proved_bound

    answer, certificate = certificate_of(instance, folder)
    bound, own = proved_bound(instance, certificate)
    worth = worth_of(instance, answer, 10.0)
    value = worth.lower if instance.maximises else worth.upper
    if instance.track == "plan" and np.isfinite(own):
        value = own
    bound = max(value, bound) if instance.maximises else min(value, bound)
    head = {"format": "ratt-opt benchmark record", "version": 1, "instance": instance.name}
    return {**head, **answer, "value": value, "bound": bound, "certificate": certificate}


def small_library(folder, instances=None):
    """A library of these instances, all with proved records."""
    library = ro.BenchmarkLibrary(folder, {}, {})
    for instance in instances or (coverage_instance(), plan_instance(), attack_instance(), cuts_instance()):
        library = library.add(instance, hardness="easy", curated=instance.track != "cuts")
        record = record_of(instance, folder)
        row = Best(
            instance=instance.name,
            value=record["value"],
            bound=record["bound"],
            certificate=hash_of(record),
            who="test",
            version="0",
            date="2026-11-29",
        )
        library = library.set_best(row, record)
    return library
