"""A study whose trials cost nothing, for tests of the engine; workers import it by name."""

import os
import time

import numpy as np

from ratt_opt.studies.cases import Case, Cell, Seeds
from ratt_opt.studies.study import Study

__all__ = ["STUDY", "die", "fail", "measure", "raise_at_once"]

STUDY = Study(
    name="toy",
    cases=tuple(Case(n_robots=n, n_targets=2, alpha_s=a, alpha_c=0) for n in (2, 3) for a in (0, 1)),
    measure="tests.studies.toy:measure",
)


def measure(study: Study, case: Case, seeds: Seeds) -> dict[str, Cell]:
    """Return random numbers of the seeds, as slowly as the environment says."""
    del study
    time.sleep(float(os.environ.get("TOY_SECONDS", "0")))
    rng = np.random.default_rng([seeds.simulation, case.n_robots])
    numbers = rng.standard_normal(2)
    return {"text": "a, b", "value": float(numbers[0]), "scalar": numbers[1], "count": int(rng.integers(10**12))}


def fail(study: Study, case: Case, seeds: Seeds) -> dict[str, Cell]:
    """Fail in the second case."""
    if case == study.cases[1]:
        raise ValueError("no such\nnumber")
    return measure(study, case, seeds)


def raise_at_once(study: Study, case: Case, seeds: Seeds) -> dict[str, Cell]:
    """Fail in every case."""
    raise ValueError(f"nothing works yet: {study.name}, {case.name}, {seeds.scenario}")


def die(study: Study, case: Case, seeds: Seeds) -> dict[str, Cell]:
    """End the worker process in the second case, as running out of memory would."""
    if case == study.cases[1]:
        os._exit(1)
    return measure(study, case, seeds)
