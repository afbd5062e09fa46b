"""Builders and checker of proofs as tests know them, the problems they are tried on, and what all must do.

What a proof shows is asked here, or of ``certify`` and ``verify_certificate``. This file alone names the builders'
modules; so do, beside an inner part, the tests that compare it with the definition.
"""

from dataclasses import replace

import networkx as nx
import numpy as np
import pytest
from flint import fmpq

from ratt_opt import (
    CertificateParams,
    FileFormatError,
    MaxEigenvalueObjective,
    Problem,
    ProofError,
    TraceObjective,
    network_scenario,
    problem_document,
    ratt,
)
from ratt_opt.certificates import covers, write
from ratt_opt.certificates.covers import cover_proof
from ratt_opt.certificates.group_sizes.proof import group_size_proof
from ratt_opt.certificates.lower import ENUMERATED, lower_proof, weaker_lower_proof
from ratt_opt.certificates.params import DEFAULT, CoverProofParams
from ratt_opt.certificates.plan_sets import NotClosedError, PlanSets
from ratt_opt.certificates.stated_problem import prior_range_of
from ratt_opt.certificates.verifier.lower import check_lower
from ratt_opt.certificates.verifier.statement import Statement
from ratt_opt.certificates.verifier.work import limited, tick, watched
from ratt_opt.errors import UndecidedError
from tests.oracles import brute_force_worst_case
from tests.strategies import OBJECTIVES, information_data, random_problem

CRITERIA = list(OBJECTIVES)
__all__ = [
    "CRITERIA",
    "ENUMERATED",
    "GRAPH_PROOFS",
    "LIMITED",
    "UndecidedError",
    "accepted_leaves",
    "check",
    "drawn",
    "drawn_of_part",
    "limited",
    "lower_proof",
    "network",
    "proof",
    "refuse",
    "small_proofs",
    "stated_in",
    "statement",
    "step",
    "tick",
    "unclosed",
    "watched",
    "weaker_lower_proof",
]


PROVERS = {"cover": (cover_proof, 50_000), "sizes": (group_size_proof, 50_000)}
GRAPH_PROOFS = list(PROVERS)
LIMITED = (6, 7, 17, 25, 51, 65)
"""Seeds of small proofs by duals and covers that have limits, whose proofs name limits."""

STEPS = {
    "lower end": (write, "lower_proof"),
    "upper end": (write, "upper_record"),
    "verification": (write, "verify_certificate"),
    "writing": (write, "_write_verified"),
    "limits": (covers, "_with_limits"),
}
"""What certifying is made of."""


def step(patch, name, instead):
    """Let ``instead(real)`` do a step of certifying."""
    where, what = STEPS[name]
    patch.setattr(where, what, instead(getattr(where, what)))


def unclosed(*_):
    """No proof."""
    raise NotClosedError


SLACK = -1.0
"""Links that duals claim beyond the budget, counted from both sides, so that groups are listed and do not cover the
team. The best duals of small teams claim enough, and no proof of theirs would list any."""


def proof(kind, problem, plan, threshold, nodes=None):
    """The proof of a threshold, or ``None``; where an odd number of links is cut, it lists groups if it can."""
    prove, most = PROVERS[kind]
    slack = CertificateParams(covers=CoverProofParams(margin=SLACK))
    for params in (slack, DEFAULT) if kind == "cover" and problem.alpha_c % 2 else (DEFAULT,):
        try:
            return prove(PlanSets(problem, np.asarray(plan), threshold, params), nodes or most)
        except NotClosedError:
            continue
    return None


def statement(problem, plan):
    """What a certificate states of a problem and a plan, as the verifier reads it."""
    record, plan = problem_document(problem), np.asarray(plan).tolist()
    return Statement(record, plan, prior_range_of(problem, record, plan))


def stated_in(document):
    """The same of a document."""
    return Statement(document["problem"], document["plan"], document["prior_eigenvalue"])


def accepted_leaves(problem, plan, part, value):
    """Leaves that the verifier looks at, where it accepts a proof of a value."""
    return check(statement(problem, plan), part, value)


def check(about, part, value):
    """The same of a statement."""
    return check_lower(about, part, fmpq(*float(value).as_integer_ratio()))


def refuse(problem, plan, part, value, text=None):
    """The verifier refuses a proof of a value; ``text`` : a pattern of what it says."""
    with pytest.raises((ProofError, FileFormatError), match=text):
        accepted_leaves(problem, plan, part, value)


def drawn(seed):
    """A connected graph with things protected, a random plan, and the worst case by brute force."""
    rng = np.random.default_rng([51, seed])
    base = random_problem(rng, int(rng.integers(3, 8)), kind=CRITERIA[seed % 3], controls=2, complete=False)
    n = base.n_robots
    graph = nx.gnp_random_graph(n, 0.5, seed=seed)
    graph.add_edges_from(zip(range(n - 1), range(1, n), strict=True))
    links = sorted(tuple(sorted(link)) for link in graph.edges)
    safe = {links[int(rng.integers(len(links)))]} if seed % 4 == 1 else set()
    seeing = {int(rng.integers(n))} if seed % 4 == 2 else set()
    alpha_s, alpha_c = int(rng.integers(0, n // 2 + 1)), int(rng.integers(1, min(len(links), 6) + 1))
    problem = Problem(base.objective, base.robot, graph, alpha_s, alpha_c, seeing, safe)
    plan = [int(rng.choice(own)) for own in problem.choices]
    return problem, plan, brute_force_worst_case(problem, plan)


def drawn_of_part(seed):
    """The same of criteria of a part of the state, which has one to four coordinates."""
    rng, (problem, plan, _) = np.random.default_rng([53, seed]), drawn(seed)
    dimension = int(rng.integers(1, 5))
    data = information_data(rng, problem.objective.n, int(rng.integers(1, 4)), dimension)
    output = rng.normal(size=(int(rng.integers(1, dimension + 1)), dimension)) * 10.0 ** rng.integers(-1, 5)
    kind = TraceObjective if seed % 2 else MaxEigenvalueObjective
    problem = replace(problem, objective=kind(*data, output=output))
    return problem, plan, brute_force_worst_case(problem, plan)


def small_proofs(kind, seeds, draw=drawn):
    """Problem, plan, worst case, and the proof of a little less, or ``None``."""
    for seed in seeds:
        problem, plan, worst = draw(seed)
        if worst > 1e-3:
            yield problem, plan, worst, proof(kind, problem, plan, worst * (1 - 1e-7))


def network(family, n_robots, shares, seed, criterion="trace"):
    """A drawn network's problem, and RATT's plan for it; ``shares`` : of robots blinded and links cut."""
    scenario = network_scenario(family, n_robots, 8, alpha_s=shares[0], alpha_c=shares[1], seed=seed)
    problem = scenario.problem(criterion)
    return problem, ratt(problem).elements
