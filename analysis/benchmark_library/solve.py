"""Solve candidates by several solvers, certify what is found, and keep one line a candidate in a journal."""

import json
import math
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import ratt_opt as ro
from analysis.benchmark_library.candidates import Candidate
from ratt_opt.attack.edge_cuts.fewest import fewest_cuts
from ratt_opt.benchmark.instances.forms import SumInput, TableInput
from ratt_opt.benchmark.instances.instance import BenchmarkInstance, read_document, write_document
from ratt_opt.benchmark.proofs.answers import only_plan, worth_of
from ratt_opt.benchmark.proofs.verification import ENUMERATION, proved_bound, stated_problem, verify_record
from ratt_opt.certificates.edge_cuts import certify_cuts
from ratt_opt.errors import InputError, ProofError, UndecidedError
from ratt_opt.planners import scenario_program, sensing_only

__all__ = ["JOURNAL", "SolveParams", "read_journal", "solve_all"]

JOURNAL = "journal.jsonl"


@dataclass(frozen=True, slots=True, kw_only=True)
class SolveParams:
    """Effort for one candidate [s]; more closes more of them.

    ``short``, ``long`` : of the two runs of the search; ``others`` : of each other solver; ``proof`` : of a certificate
    """

    short: float = 4.0
    long: float = 40.0
    others: float = 4.0
    proof: float = 60.0


@dataclass(slots=True)
class _Found:
    """Solvers' answers so far: ``values`` by solver, the best answer, and a certificate."""

    instance: BenchmarkInstance
    values: dict[str, float]
    seconds: dict[str, float]
    best: dict[str, Any]
    who: str
    certificate: dict[str, Any] | None

    def offer(self, who: str, began: float, answer: dict[str, Any]) -> None:
        """Value an answer, and keep it if it is the best."""
        self.seconds[who] = round(time.process_time() - began, 3)
        worth = worth_of(self.instance, answer, 20.0)
        value = worth.lower if self.instance.maximises else worth.upper
        known = self.values.get(self.who)
        self.values[who] = value
        sign = 1 if self.instance.maximises else -1
        if known is None or sign * value > sign * known:
            self.best, self.who = answer, who


def solve_all(candidates: list[Candidate], pool: Path, params: SolveParams, *, seconds: float = math.inf) -> None:
    """Solve what the journal lacks, one candidate after the other, for at most some seconds."""
    pool.mkdir(parents=True, exist_ok=True)
    began, known = time.monotonic(), {line["name"] for line in read_journal(pool)}
    for candidate in candidates:
        if candidate.name in known or time.monotonic() - began > seconds:
            continue
        line = _solved(candidate, pool, params)
        with (pool / JOURNAL).open("a", encoding="utf-8") as journal:
            journal.write(json.dumps(line, allow_nan=False) + "\n")
        print(json.dumps(line), flush=True)


def read_journal(pool: Path) -> list[dict[str, Any]]:
    """Read the lines of solved candidates; a torn last line is left out."""
    path = pool / JOURNAL
    lines = path.read_text(encoding="utf-8").split("\n")[:-1] if path.exists() else []
    return [json.loads(line) for line in lines]


def _solved(candidate: Candidate, pool: Path, params: SolveParams) -> dict[str, Any]:
    instance = candidate.draw()
    found = _Found(instance, {}, {}, {}, "", None)
    {"plan": _plan, "attack": _attack, "cuts": _cut}[instance.track](found, params)
    record = _record(found)
    proved = verify_record(instance, record)
    write_document(instance.document, pool / f"{instance.name}.instance.json.xz")
    write_document(record, pool / f"{instance.name}.record.json.xz")
    size = sum((pool / f"{instance.name}.{kind}.json.xz").stat().st_size for kind in ("instance", "record"))
    return {
        "name": instance.name,
        "code": instance.class_code,
        "family": instance.family,
        "sizes": list(instance.sizes),
        "value": proved.value,
        "bound": proved.bound if math.isfinite(proved.bound) else None,
        "values": found.values,
        "seconds": found.seconds,
        "who": found.who,
        "bytes": size,
    }


def _record(found: _Found) -> dict[str, Any]:
    """The record with the best certified bound; a bound that meets the value from the wrong side is moved onto it."""
    instance, value = found.instance, found.values[found.who]
    record = {"format": "ratt-opt benchmark record", "version": 1, "instance": instance.name, **found.best}
    record |= {"value": value, "bound": None, "certificate": found.certificate}
    if found.certificate is not None:
        bound, own = proved_bound(instance, found.certificate)
        same = found.certificate.get("plan") == found.best.get("elements")
        if instance.track == "plan" and same and math.isfinite(own):
            record["value"] = own
        # An attack on the float side and a proof on the exact one may pass each other by rounding.
        sign = 1 if instance.maximises else -1
        record["bound"] = bound if sign * bound >= sign * record["value"] else record["value"]
    return record


def _plan(found: _Found, params: SolveParams) -> None:
    team = found.instance.team
    solvers: dict[str, Callable[[], Any]] = {
        "greedy": lambda: ro.greedy(team),
        "ratt": lambda: ro.ratt(team),
        "sensing_only": lambda: sensing_only(team),
        "refined": lambda: ro.refined(team, time_limit=params.others),
    }
    if isinstance(found.instance.problem, SumInput):
        solvers["scenario_program"] = lambda: scenario_program(team, time_limit=params.others)
    for who, solver in solvers.items():
        began = time.process_time()
        found.offer(who, began, {"elements": solver().elements.tolist()})
    if isinstance(found.instance.problem, TableInput):
        began = time.process_time()
        found.offer("exhaustive", began, {"elements": ro.exhaustive_optimum(team).elements.tolist()})
        found.certificate = {"format": ENUMERATION, "version": 1}
        return
    given, objective = stated_problem(found.instance)
    stated, start = given.problem(objective), None
    for who, limit in (("maxmin", params.short), ("maxmin long", params.long)):
        began = time.process_time()
        result = ro.solve_maxmin(stated, time_limit=limit, start=start)
        found.offer(who, began, {"elements": result.elements.tolist()})
        if _closed(found, result):
            break
        start = result
    found.certificate = _certificate(lambda path: ro.certify(stated, result, path, time_limit=params.proof))


def _closed(found: _Found, result: ro.MaxMinResult) -> bool:
    whole = isinstance(found.instance.problem, SumInput)
    return result.upper - result.lower <= (0.5 if whole else 1e-6 * abs(result.upper))


def _attack(found: _Found, params: SolveParams) -> None:
    team, plan = found.instance.team, only_plan(found.instance)
    for who, attacker in (("greedy", ro.greedy_attack), ("bounded_rational", ro.bounded_rational_attack)):
        began = time.process_time()
        found.offer(who, began, _as_answer(attacker(team, plan).attack))
    began = time.process_time()
    result = ro.worst_case_attack(team, plan, time_limit=params.long)
    found.offer("worst", began, _as_answer(result.attack))
    only = ro.solve_maxmin(team, time_limit=params.long)
    found.certificate = _certificate(lambda path: ro.certify(team, only, path, time_limit=params.proof))
    if found.certificate is not None:
        try:
            proved_bound(found.instance, found.certificate)
        except ProofError:
            found.certificate = None


def _as_answer(attack: ro.Attack) -> dict[str, Any]:
    return {"sensing": sorted(attack.sensing), "links": [list(link) for link in sorted(attack.links)]}


def _cut(found: _Found, params: SolveParams) -> None:
    network = found.instance.network
    for who, limit in (("fewest_cuts short", params.short), ("fewest_cuts", params.long)):
        began = time.process_time()
        result = fewest_cuts(network.graph, network.size, weights=network.weight_of, time_limit=limit)
        found.offer(who, began, {"cut": [list(link) for link in sorted(result.cut)]})
        if result.lower == result.upper:
            break
    found.certificate = _certificate(
        lambda path: certify_cuts(network.graph, result, path, weights=network.weight_of, time_limit=params.proof)
    )


def _certificate(write: Callable[[Path], object]) -> dict[str, Any] | None:
    """The certificate that is written, or ``None`` if none can be within the limits."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "certificate.json"
        try:
            write(path)
        except (InputError, ProofError, UndecidedError):
            return None
        document: dict[str, Any] = read_document(path)
        return document
