"""The claims of the ledger on EKF objectives: Section VI scenarios, and geometries moved to break a claim.

Claims about total curvature are tried on the trace criterion, claims about submodular functions on log-det.
Roles are RATT's own choices and an exact optimum; premises about the attack select the instances to which a
claim applies. The largest violation is replayed without rounding.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_audit.engine.pace import program_seconds
from ratt_audit.real_objectives.cast import Cast, ExactCriterion, Stage, is_castable
from ratt_opt.errors import InputError
from ratt_opt.scenario.generator import random_scenario

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from ratt_audit.appendix.roles import SizedClaim, Team
    from ratt_opt.scenario.model import Scenario
    from ratt_opt.worst_ratio.function_class import FunctionClass

__all__ = ["Origin", "RealSearch", "Trial", "exact_violation", "search_real_objectives"]

SEEDS = tuple(range(10))
N_TARGETS = 3
STEPS = {True: 150, False: 25}
"""Moves tried for a claim that is refuted, and for one that is proved; each costs an optimum by enumeration."""
FOOTING = 1e-9
"""Violations relative to the values involved below this are rounding."""
SPREAD = (30.0, 10.0, 3.0, 1.0)
"""[m] standard deviations of the moves of robots and targets, one after the other."""


@dataclass(frozen=True, slots=True)
class Origin:
    """Origin of a scenario: Section VI's with ``seed``, moved at random until ``step`` (0: not moved)."""

    n_robots: int
    seed: int
    step: int = 0
    has_start: bool = True
    """Tell whether the claim applied to the scenario before the moves."""

    def __str__(self) -> str:
        first = f"random_scenario({self.n_robots}, {N_TARGETS}, alpha_s=0, alpha_c=0, seed={self.seed})"
        if not self.has_start:
            first = f"random_scenario seed {self.seed}"
        return f"{first}, then moved at random (step {self.step} of default_rng({SEEDS[0]}))" if self.step else first


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """One claim on one scenario: ``violation`` is ``-conclusion`` relative to the largest value in it.

    ``players`` : the element in each role
    """

    violation: float
    sized: SizedClaim = field(repr=False)
    scenario: Scenario = field(repr=False)
    origin: Origin
    players: tuple[int, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class RealSearch:
    """Findings from trying the claims of one entry.

    ``applied``, ``broken`` : cases of Section VI to which a claim applies, and those that break it
    ``worst`` : the largest violation, after moves; ``None`` if no claim ever applied
    ``violated_exactly`` : whether ``worst`` breaks its claim without rounding
    """

    objective: str
    applied: int
    broken: int
    worst: Trial | None
    violated_exactly: bool


def objective_for(function_class: FunctionClass) -> str:
    """Criterion that is of the class: log-det is submodular, the trace is non-decreasing only."""
    return "logdet" if function_class.is_submodular else "trace"


def search_real_objectives(claims: Sequence[SizedClaim], *, refuted: bool) -> RealSearch | None:
    """Try the claims of one entry; ``None`` if none can be cast in the roles of an instance.

    ``refuted`` claims are known to fail for some function: look harder for a geometry that breaks them.
    """
    usable = [sized for sized in claims if is_castable(sized.claim, sized.team)]
    if not usable:
        return None
    applied, trials = 0, []
    for sized in usable:
        for seed in SEEDS:
            origin = Origin(len(_team(sized).robots), seed)
            stage = _stage_vi(origin, objective_for(sized.claim.function_class))
            tried = list(_trials(sized, stage, _section_vi(origin), origin))
            applied += bool(tried)
            trials += tried
    broken = {(trial.origin, trial.sized.size) for trial in trials if trial.violation > FOOTING}
    start = max(trials, key=lambda trial: trial.violation, default=None)
    worst = _climb(start, usable[0], STEPS[refuted])
    exact = None if worst is None else exact_violation(worst)
    return RealSearch(
        objective=objective_for(usable[0].claim.function_class),
        applied=applied,
        broken=len(broken),
        worst=worst,
        violated_exactly=exact is not None and bool(exact > 0),
    )


def _team(sized: SizedClaim) -> Team:
    assert sized.team is not None, "only claims about roles are tried"
    return sized.team


@lru_cache(maxsize=64)
def _section_vi(origin: Origin) -> Scenario:
    return random_scenario(origin.n_robots, N_TARGETS, alpha_s=0, alpha_c=0, seed=origin.seed)


@lru_cache(maxsize=128)
def _stage_vi(origin: Origin, objective: str) -> Stage:
    return Stage(_section_vi(origin).problem(objective))


def _trials(sized: SizedClaim, stage: Stage, scenario: Scenario, origin: Origin) -> Iterator[Trial]:
    """The relative violation, negative if the claim holds, for each naming of the baits that meets the premises."""
    claim = sized.claim
    for cast in stage.casts(_team(sized)):
        if any(cast.evaluate(p.expression, 1.0) < -FOOTING * cast.scale(p.expression) for p in claim.premises):
            continue
        scale = cast.scale(claim.conclusion)
        if scale > 0:
            kept = cast.kept(submodular=claim.function_class.is_submodular) if claim.conclusion.degree else 1.0
            violation = -float(cast.evaluate(claim.conclusion, kept)) / scale
            yield Trial(violation=violation, sized=sized, scenario=scenario, origin=origin, players=cast.elements)


def _climb(start: Trial | None, sized: SizedClaim, steps: int) -> Trial | None:
    """Move robots and targets at random, keeping what makes the violation larger."""
    best, sized = start, sized if start is None else start.sized
    rng = np.random.default_rng(SEEDS[0])
    origin = Origin(len(_team(sized).robots), SEEDS[0]) if start is None else start.origin
    base = _section_vi(origin)
    for step in range(steps):
        program_seconds()  # asks whether there is time
        try:
            moved = _moved(base, rng, SPREAD[step % len(SPREAD)])
        except InputError:  # a robot landed on a target
            continue
        stage = Stage(moved.problem(objective_for(sized.claim.function_class)))
        at = Origin(origin.n_robots, origin.seed, step + 1, start is not None)
        found = max(_trials(sized, stage, moved, at), key=lambda trial: trial.violation, default=None)
        if found is not None and (best is None or found.violation > best.violation):
            best, base = found, moved
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


def exact_violation(trial: Trial) -> Any:
    """Replay without rounding: minus the conclusion, as a rational (trace) or a ball (log-det).

    ``None`` if a premise is not met exactly.
    """
    claim = trial.sized.claim
    problem = trial.scenario.problem(objective_for(claim.function_class))
    cast = Cast(_team(trial.sized).ground, trial.players, ExactCriterion(problem.objective))
    one = cast.of(0) + 1
    if not all(cast.evaluate(premise.expression, one) >= 0 for premise in claim.premises):
        return None
    kept = cast.kept(submodular=claim.function_class.is_submodular) if claim.conclusion.degree else one
    return -cast.evaluate(claim.conclusion, kept)
