"""Answers of the searches on one case of the corpus: both ends, nodes, processor seconds, and the proof's size."""

import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from time import process_time
from typing import Any
from zlib import crc32

import numpy as np

import ratt_opt as ro
from analysis.benchmarks.instances import warm_up
from analysis.golden.corpus import CRITERIA, Case, get_case
from ratt_opt import MaxMinResult, Problem
from ratt_opt._validation import IntArray
from ratt_opt.errors import UndecidedError

__all__ = ["GAP", "measured", "measured_by_name", "warm"]

GAP = 1e-4
"""Names a search for the best plan."""
BRIEF = 2.0
"""Seconds below which a run is made again and the second counts: the first may have loaded modules."""
WARM = 40
"""Robots of the complete graphs that are attacked once before any case."""


def measured_by_name(part: str, name: str) -> dict[str, Any]:
    """A row of the corpus, for a worker that was told its name; the first call loads modules."""
    warm()
    return measured(get_case(part, name))


def measured(case: Case) -> dict[str, Any]:
    """One row: the timed run, and the run that is limited by nodes and always the same."""
    problem = case.problem()
    plan = ro.ratt(problem).elements if case.asked == "attack" else None
    found, spent = _timed(lambda: _asked(problem, plan, time_limit=case.seconds))
    named = _named(found.elements if plan is None else plan)
    row: dict[str, Any] = {"part": case.part, "case": case.name, "asked": case.asked, "plan": named}
    row |= {"lower": found.lower, "upper": found.upper, "stop": found.stop.value, "nodes": found.nodes, "cpu_s": spent}
    row |= {"limited_lower": "", "limited_upper": "", "limited_nodes": ""}
    if case.nodes is not None:
        limited = _asked(problem, plan, max_nodes=case.nodes)
        row |= {"limited_lower": limited.lower, "limited_upper": limited.upper, "limited_nodes": limited.nodes}
    row |= {"proof_bytes": "", "write_s": "", "verify_s": ""}
    return row | (_proved(problem, found) if case.asked == "certificate" else {})


def _asked(problem: Problem, plan: IntArray | None, **limits: Any) -> Any:
    if plan is None:
        return ro.solve_maxmin(problem, gap=GAP, **limits)
    return ro.worst_case_attack(problem, plan, brief="max_nodes" in limits, **limits)  # as the record was made


def _timed(run: Callable[[], Any]) -> tuple[Any, float]:
    for _ in range(2):
        began = process_time()
        found = run()
        spent = process_time() - began
        if spent > BRIEF:
            break
    return found, spent


def _named(elements: IntArray) -> str:
    """A short name of a plan: two attacks are of the same plan if it is the same."""
    return f"{crc32(np.asarray(elements, dtype=np.int64).tobytes()):08x}"


def _proved(problem: Problem, found: MaxMinResult) -> dict[str, Any]:
    """The certificate's ends instead of the search's, its size, and the seconds for writing and for verifying it."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "certificate.json"
        began = process_time()
        try:
            ro.certify(problem, found, path)
        except (ro.InputError, UndecidedError):  # it is too long for the verifier
            return {"stop": "no certificate"}
        written = process_time()
        verified = ro.verify_certificate(path)
        seconds = {"write_s": written - began, "verify_s": process_time() - written}
        lower = verified.lower if verified.lower_proved else 0.0
        return {"lower": lower, "upper": verified.upper, "proof_bytes": path.stat().st_size} | seconds


@cache
def warm() -> None:
    """Load what searches load when they are first used, once in a process."""
    for kind in CRITERIA:
        warm_up(kind)
        for robots in (WARM // 4, WARM // 2, WARM):
            problem = ro.random_scenario(robots, 5, alpha_s=robots // 3, alpha_c=robots, seed=0).problem(kind)
            ro.worst_case_attack(problem, ro.ratt(problem).elements, time_limit=2)
