"""The claims of the ledger on EKF objectives: Section VI scenarios, and geometries moved to break a claim.

Claims about total curvature are tried on the trace criterion, claims about submodular functions on log-det.
Roles are RATT's own choices and an exact optimum; premises about the attack select the instances to which a
claim applies. The largest violation is replayed without rounding.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.audit.engine.claim import FunctionClass
from ratt_opt.audit.real_objectives.cast import Cast, Stage, is_castable
from ratt_opt.audit.real_objectives.exact_criteria import ExactCriterion
from ratt_opt.errors import InputError
from ratt_opt.scenario.generator import random_scenario

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from ratt_opt.audit.appendix.entry import SizedClaim
    from ratt_opt.scenario.model import Scenario

__all__ = ["Finding", "exact_violation", "objective_for", "realistic_search"]

SEEDS = tuple(range(10))
N_TARGETS = 3
STEPS = {True: 150, False: 25}
"""Moves tried for a claim that is refuted, and for one that is proved."""
FOOTING = 1e-9
"""Violations relative to the values involved below this are rounding."""
SPREAD = (30.0, 10.0, 3.0, 1.0)
"""[m] standard deviations of the moves of robots and targets, one after the other."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """The largest violation of one claim: ``-conclusion`` relative to the largest value in it.

    ``origin`` : where the scenario comes from, with its seed; ``players`` : the element in each role.
    """

    violation: float
    sized: SizedClaim
    scenario: Scenario
    origin: str
    players: tuple[int, ...]


def objective_for(kind: FunctionClass) -> str:
    """Criterion that is of the class: log-det is submodular, the trace is non-decreasing only."""
    return "logdet" if kind in (FunctionClass.SUBMODULAR, FunctionClass.CURVATURE) else "trace"


def realistic_search(claims: Sequence[SizedClaim], *, refuted: bool) -> dict[str, object] | None:
    """Try the claims of one entry; return the counts and the worst instance as JSON data, ``None`` where none applies.

    Parameters
    ----------
    refuted : the claims are known to fail for some function: look harder for a geometry that breaks them
    """
    usable = [sized for sized in claims if is_castable(sized.claim, sized.team)]
    if not usable:
        return None
    applied, found = 0, []
    for sized in usable:
        assert sized.team is not None
        for seed in SEEDS:
            scenario = _section_vi(len(sized.team.robots), seed)
            origin = f"random_scenario({scenario.n_robots}, {N_TARGETS}, alpha_s=0, alpha_c=0, seed={seed})"
            tried = list(_violations(sized, scenario, origin))
            applied += bool(tried)
            found += tried
    worst = max(found, key=lambda finding: finding.violation, default=None)
    broken = {(finding.origin, finding.sized.size) for finding in found if finding.violation > FOOTING}
    worst = _climb(worst, usable[0], STEPS[refuted])
    return {
        "objective": objective_for(usable[0].claim.kind),
        "section_vi_instances": applied,
        "section_vi_violations": len(broken),
        "worst": None if worst is None else _record(worst),
    }


@lru_cache(maxsize=64)
def _section_vi(n_robots: int, seed: int) -> Scenario:
    return random_scenario(n_robots, N_TARGETS, alpha_s=0, alpha_c=0, seed=seed)


@lru_cache(maxsize=128)
def _stage_vi(n_robots: int, seed: int, objective: str) -> Stage:
    return Stage(_section_vi(n_robots, seed).problem(objective))


def _violations(sized: SizedClaim, scenario: Scenario, origin: str, stage: Stage | None = None) -> Iterator[Finding]:
    """The relative violation, negative where the claim holds, for each naming of the baits that meets the premises."""
    assert sized.team is not None
    kind = sized.claim.kind
    if stage is None:
        seed = int(origin.rsplit("=", 1)[1].rstrip(")"))
        stage = _stage_vi(scenario.n_robots, seed, objective_for(kind))
    for cast in stage.casts(sized.team):
        if any(cast.evaluate(p.expression, 1.0) < -FOOTING * cast.scale(p.expression) for p in sized.claim.premises):
            continue
        scale = cast.scale(sized.claim.conclusion)
        if scale > 0:
            kept = cast.kept(submodular=objective_for(kind) == "logdet") if sized.claim.conclusion.degree else 1.0
            violation = -float(cast.evaluate(sized.claim.conclusion, kept)) / scale
            yield Finding(violation=violation, sized=sized, scenario=scenario, origin=origin, players=cast.elements)


def _climb(start: Finding | None, sized: SizedClaim, steps: int) -> Finding | None:
    """Move robots and targets at random, keeping what makes the violation larger."""
    best = start
    sized = sized if start is None else start.sized
    assert sized.team is not None
    seed = SEEDS[0]
    rng = np.random.default_rng(seed)
    scenario = _section_vi(len(sized.team.robots), seed) if start is None else start.scenario
    first = f"random_scenario seed {seed}" if start is None else start.origin
    for step in range(steps):
        base = scenario if best is None else best.scenario
        try:
            moved = _moved(base, rng, SPREAD[step % len(SPREAD)])
        except InputError:  # a robot landed on a target
            continue
        stage = Stage(moved.problem(objective_for(sized.claim.kind)))
        origin = f"{first}, then moved at random (step {step + 1} of default_rng({seed}))"
        found = max(_violations(sized, moved, origin, stage), key=lambda finding: finding.violation, default=None)
        if found is not None and (best is None or found.violation > best.violation):
            best = found
    return best


def _moved(scenario: Scenario, rng: np.random.Generator, spread: float) -> Scenario:
    robots = tuple(
        robot.replace(
            x=robot.x + float(rng.normal(0, spread)),
            y=robot.y + float(rng.normal(0, spread)),
            heading=robot.heading + float(rng.normal(0, spread / 30)),
        )
        for robot in scenario.robots
    )
    targets = tuple(
        target.replace(x=target.x + float(rng.normal(0, spread)), y=target.y + float(rng.normal(0, spread)))
        for target in scenario.targets
    )
    return scenario.replace(robots=robots, targets=targets)


def exact_violation(finding: Finding) -> Any:
    """Replay without rounding: minus the conclusion, as a rational (trace) or a ball (log-det).

    ``None`` where a premise is not met exactly.
    """
    claim, team = finding.sized.claim, finding.sized.team
    assert team is not None
    problem = finding.scenario.problem(objective_for(claim.kind))
    cast = Cast(team.ground, finding.players, ExactCriterion(problem.objective))
    one = cast.of(0) + 1
    if not all(cast.evaluate(premise.expression, one) >= 0 for premise in claim.premises):
        return None
    kept = cast.kept(submodular=objective_for(claim.kind) == "logdet") if claim.conclusion.degree else one
    return -cast.evaluate(claim.conclusion, kept)


def _record(finding: Finding) -> dict[str, object]:
    """The worst instance, complete: the scenario file's content, the roles, and the sign of the violation."""
    exact = exact_violation(finding)
    team = finding.sized.team
    assert team is not None
    return {
        "origin": finding.origin,
        "claim": finding.sized.size,
        "relative_violation": finding.violation,
        "violated_exactly": exact is not None and bool(exact > 0),
        "elements": dict(zip(team.ground.names, finding.players, strict=True)),
        "scenario": finding.scenario.model_dump(mode="json"),
    }
