"""Proof of both ends of a record: the answer valued again, the bound by its certificate."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ratt_opt.benchmark.instances.forms import SumInput
from ratt_opt.benchmark.proofs.answers import answer_of, only_plan, worth_of
from ratt_opt.benchmark.proofs.enumeration import best_worst_case
from ratt_opt.benchmark.proofs.relaxation import as_information, value_at_least, value_at_most
from ratt_opt.certificates.agreement import differences
from ratt_opt.certificates.verifier.edge_cuts import CUTS_FORMAT, verify_cuts
from ratt_opt.certificates.verifier.limits import SECONDS
from ratt_opt.certificates.verifier.verify import verify_document
from ratt_opt.errors import InputError, ProofError
from ratt_opt.scenario.information_input import InformationInput

if TYPE_CHECKING:
    from ratt_opt.benchmark.instances.instance import BenchmarkInstance

__all__ = ["ENUMERATION", "Proved", "proved_bound", "stated_problem", "verify_record"]

ENUMERATION = "ratt-opt enumeration"
"""Format of a certificate that says: the problem is small, enumerate it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Proved:
    """Both ends of a record as verified: ``value`` is attained by its answer, ``bound`` proved, or infinite."""

    value: float
    bound: float


def stated_problem(instance: BenchmarkInstance) -> tuple[InformationInput, str]:
    """The problem by matrices that a certificate of an instance is about, and its criterion.

    Raises
    ------
    InputError : there is none.
    """
    if isinstance(instance.problem, InformationInput):
        return instance.problem, instance.objective
    if isinstance(instance.problem, SumInput):
        return as_information(instance.problem), "trace"
    raise InputError("instance", "must be by matrices or a sum for this certificate", instance.name)


def proved_bound(instance: BenchmarkInstance, certificate: Any, *, seconds: float = SECONDS) -> tuple[float, float]:
    """The end that no answer passes, and the value of the certificate's own plan, as its proof shows them.

    Plans: nobody can have more than the first. Attacks and cuts: nobody can do with less. The second is minus infinity
    if the certificate proves none.

    Raises
    ------
    InputError : the document is no certificate.
    ProofError : it proves nothing about this instance.
    UndecidedError : that cannot be decided within the limits.
    """
    kind = certificate.get("format") if isinstance(certificate, dict) else None
    if kind == ENUMERATION:
        bound = best_worst_case(instance.team)
        return bound, bound
    if kind == CUTS_FORMAT:
        return _least_cuts(instance, certificate, seconds), -math.inf
    given, objective = stated_problem(instance)
    proved = verify_document(certificate, expected_problem=differences(given, objective), time_limit=seconds)
    value = proved.lower if proved.lower_proved else -math.inf
    if instance.track == "attack":
        if not proved.lower_proved or list(proved.elements) != only_plan(instance).tolist():
            raise ProofError("the certificate does not prove the worst case of the only plan")
        bound = proved.lower
        return (value_at_least(instance.problem, bound) if isinstance(instance.problem, SumInput) else bound), value
    if isinstance(instance.problem, SumInput):
        return value_at_most(instance.problem, proved.upper), value_at_least(instance.problem, value)
    return proved.upper, value


def _least_cuts(instance: BenchmarkInstance, certificate: dict[str, Any], seconds: float) -> float:
    """Weight that every cut has at least. ProofError : the certificate is of another network or size."""
    proved, network = verify_cuts(certificate, time_limit=seconds), instance.network
    stated = certificate["network"]
    weights = network.weight_of or dict.fromkeys(network.links, 1)
    own = {tuple(link): weight for link, weight in zip(stated["links"], stated["weights"], strict=True)}
    expected = {link: weight * proved.scale for link, weight in weights.items()}
    sizes = [size * proved.size_scale for size in network.sizes or (1,) * network.robots]
    same = own == expected and stated["sizes"] == sizes and not stated["protected"]
    if not same or proved.size < network.size * proved.size_scale:
        raise ProofError("the certificate is about another network or smaller groups")
    return math.ceil(proved.lower / proved.scale)


def verify_record(instance: BenchmarkInstance, record: dict[str, Any], *, seconds: float = SECONDS) -> Proved:
    """Prove both ends that a record states.

    Raises
    ------
    InputError : a field is missing, or the answer is none.
    ProofError : an end is better than what is proved; the text says which.
    UndecidedError : a certificate cannot be decided within the limits.
    """
    if record.get("instance") != instance.name:
        raise ProofError(f"the record is of the instance {record.get('instance')}, not {instance.name}")
    answer = answer_of(instance, record)
    if answer is None:
        raise InputError("record", "must hold an answer", sorted(record))
    value, bound = _number(record, "value"), _number(record, "bound")
    sign = 1.0 if instance.maximises else -1.0
    proved, own = sign * math.inf, -math.inf
    if (certificate := record.get("certificate")) is not None:
        proved, own = proved_bound(instance, certificate, seconds=seconds)
    # The plan of the certificate is valued by its proof; other answers, and unproved plans, by the exact attack.
    is_same = instance.track == "plan" and (certificate or {}).get("plan") == answer.get("elements")
    if not (is_same and own >= value):
        worth = worth_of(instance, answer, seconds)
        reached = worth.lower if instance.maximises else worth.upper
        if sign * reached < sign * value:
            raise ProofError(f"the value {value} is not reached: the answer is worth {reached}")
    if sign * bound < sign * proved:
        raise ProofError(f"the bound {bound} is not proved: the certificate proves {proved}")
    if sign * bound < sign * value:
        raise ProofError(f"the bound {bound} contradicts the value {value}")
    return Proved(value=value, bound=bound)


def _number(record: dict[str, Any], name: str) -> float:
    value = record.get(name)
    if value is None and name == "bound":
        return math.inf if "elements" in record else -math.inf
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise InputError(name, "must be a number", value)
    return float(value)
