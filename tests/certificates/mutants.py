"""Certificates with one field changed, and whether what they claim is still true."""

import copy
import json
from warnings import catch_warnings, filterwarnings

import networkx as nx
import numpy as np

from ratt_opt import (
    FileFormatError,
    InputError,
    ProofError,
    exhaustive_optimum,
    verify_certificate,
)
from tests.certificates.cases import certified, full, problem_of
from tests.oracles import brute_force_worst_case

MARGIN = 1e-9
"""A claim is called false only when it is by more than this, so that the oracle's rounding cannot matter."""


def places(value, at=()):
    """Every (path, value) of numbers, texts and lists in a document."""
    if isinstance(value, dict):
        for name in value:
            yield from places(value[name], (*at, name))
    elif isinstance(value, list):
        yield at, value
        for k, item in enumerate(value):
            yield from places(item, (*at, k))
    else:
        yield at, value


def variants(value, rng):
    """Corruptions of one field."""
    if isinstance(value, str):
        return ["trace", "maxeig", "", 0]
    if isinstance(value, list):
        if not value:
            return []
        k = int(rng.integers(len(value)))
        return [value[:k] + value[k + 1 :], [*value, value[k]], value[::-1], []]
    if isinstance(value, int):
        return [value + 1, value - 1, 0, -value - 1, value + 1000]
    return [value * (1 + 1e-6), value * (1 - 1e-6), value * 2, value / 2, -value, 0.0, value + 1.0, 1e4]


def changed(document, at, value):
    mutant = copy.deepcopy(document)
    holder = mutant
    for step in at[:-1]:
        holder = holder[step]
    holder[at[-1]] = value
    return mutant


def too_indefinite(record):
    """Whether some information matrix is much further from semidefinite than rounding explains."""
    eigenvalues = [np.linalg.eigvalsh(full(p, record["dimension"])) for row in record["information"] for p in row]
    return any(values[0] < -1e-7 * max(abs(values)) for values in eigenvalues)


def is_false(document):
    """Whether the claim is false by more than the margin; True also where the data state no valid problem."""
    try:
        with catch_warnings():
            filterwarnings("ignore", "information: negative eigenvalues set to 0")
            problem = problem_of(document)
        plan = problem.check_plan(document["plan"])
    except InputError as error:
        # The verifier covers matrices that are a little further from semidefinite than the library takes.
        return "positive semidefinite" not in str(error) or too_indefinite(document["problem"])
    except (ValueError, IndexError, KeyError, TypeError, nx.NetworkXError):
        return True
    if problem.information_objective.repaired:
        return too_indefinite(document["problem"])  # the verifier's values are those of the matrices as stated
    claim = document["claim"]
    scale = max(1e-3, abs(problem.objective(range(problem.objective.n))))
    optimum, worst = exhaustive_optimum(problem).lower, brute_force_worst_case(problem, plan)
    return claim["upper"] < optimum - MARGIN * scale or claim["lower"] > worst + MARGIN * scale


def accepted(document, path):
    path.write_text(json.dumps(document))
    return believed(path)


def believed(path):
    try:
        verified = verify_certificate(path)
    except (ProofError, FileFormatError) as error:
        if "\n" in str(error):
            raise AssertionError("an error must be one line") from error
        return False
    return verified.lower_proved


def refused(lie, part, rng, share, path):
    """Mutate a part of a file whose claim is false; returns how many mutants, of which none is accepted."""
    count = 0
    for at, value in list(places(part)):
        for new in variants(value, rng):
            if new != value and rng.random() <= share:
                count += 1
                assert not accepted(changed(lie, at, new), path), (at, value, new)
    return count


def with_lower_end(problem, plan, worst, part, path):
    """A certificate of the plan's worst case, less a little, by a proof of its own."""
    document = certified(problem, path)[1] | {"plan": [int(e) for e in plan], "lower": part}
    return document | {"claim": {"lower": worst * (1 - 2e-7), "upper": max(document["claim"]["upper"], worst)}}


def refused_lower_ends(proofs, rng, share, path):
    """Mutate proofs of worst cases, of which a little more is claimed; returns how many mutants.

    ``proofs`` : problem, plan, worst case, and the lower proof of a little less, or ``None``
    """
    count = 0
    for problem, plan, worst, part in proofs:
        if part is None:
            continue
        document = with_lower_end(problem, plan, worst, part, path)
        assert accepted(document, path)
        lie = changed(document, ("claim", "lower"), worst * (1 + 1e-5))
        lie["claim"]["upper"] = max(lie["claim"]["upper"], 2 * worst)
        assert is_false(lie)
        count += refused(lie, {"lower": part}, rng, share, path)
    return count
