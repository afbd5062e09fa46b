"""Small certified problems, and certificates made without the solver."""

import json

import networkx as nx
import numpy as np

from ratt_opt import Problem, exhaustive_optimum, worst_case_attack
from ratt_opt.certificates.upper import upper_record
from ratt_opt.certificates.write import write_certificate
from ratt_opt.solvers.maxmin.proof import ElementBranch, Leaf, TangentCut, UpperProof, WinnerBranch
from tests.strategies import OBJECTIVES


def one_leaf_per_plan(problem: Problem) -> UpperProof:
    """A tight proof without a search: split every robot into single elements; one cut a group at each plan."""
    attacks, cuts = [], []
    f = problem.objective

    def tree(plan):
        i = len(plan)
        if i < problem.n_robots:
            own = problem.choices[i].tolist()
            branch = ElementBranch(robot=i, parts=tuple((e,) for e in own))
            return [branch, *(node for e in own for node in tree([*plan, e]))]
        attack = worst_case_attack(problem, plan).attack
        attacks.append(attack)
        left = (group - attack.sensing for group in problem.communication.groups(attack.links))
        groups = tuple(sorted(tuple(sorted(group)) for group in left if group)) or ((),)
        leaves = []
        for group in groups:
            point = f.posterior_information(np.array([plan[r] for r in group], dtype=np.int64))
            target = int(np.argmax(f.weights / np.linalg.eigvalsh(point)[:, 0]))
            cuts.append(TangentCut(attack=len(attacks) - 1, group=group, point=point, target=target))
            leaves.append(Leaf(cuts=(len(cuts) - 1,), weights=(1.0,)))
        return leaves if len(leaves) == 1 else [WinnerBranch(attack=len(attacks) - 1, parts=groups), *leaves]

    nodes = tuple(tree([]))
    return UpperProof(attacks=tuple(attacks), cuts=tuple(cuts), tree=nodes)


def certified(problem: Problem, path):
    """A certificate of the exhaustive optimum, made without the solver; returns it and its document."""
    best = exhaustive_optimum(problem)
    part = upper_record(problem, one_leaf_per_plan(problem))
    written = write_certificate(problem, best.elements, lower=best.lower, upper=best.upper, upper_part=part, path=path)
    return written, json.loads(path.read_text())


def full(flat, d):
    """A symmetric matrix from its lower triangle."""
    matrix = np.zeros((d, d))
    matrix[np.tril_indices(d)] = flat
    return matrix + np.tril(matrix, -1).T


def problem_of(document) -> Problem:
    """Rebuild the problem that a certificate states (tests only; shares nothing with the verifier)."""
    record = document["problem"]
    d = record["dimension"]

    owners = np.array(record["owners"])
    graph = nx.Graph()
    graph.add_nodes_from(range(int(owners.max()) + 1))
    graph.add_edges_from(record["links"])
    objective = OBJECTIVES[record["objective"]](
        np.array([full(p, d) for p in record["prior"]]),
        np.array([[full(p, d) for p in row] for row in record["information"]]),
        record["weights"],
    )
    return Problem(
        objective,
        owners,
        graph,
        record["alpha_s"],
        record["alpha_c"],
        frozenset(record["protected_robots"]),
        frozenset(map(tuple, record["protected_links"])),
    )
