"""The extracted checker and the Python verifier on the same files."""

import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from ratt_opt import FileFormatError, ProofError, verify_certificate
from tests.certificates.cases import certified
from tests.certificates.mutants import changed, places, variants
from tests.strategies import random_problem

BUILT = Path(__file__).parents[2] / "formal" / "build" / "ratt-check"
BATCH = 200
ACCEPTED = (0, 3)
KINDS = ("trace", "maxeig", "logdet")


def ratt_check() -> str:
    """The built checker, or the one on the path; skips where there is neither."""
    found = str(BUILT) if BUILT.exists() else shutil.which("ratt-check")
    if found is None:
        pytest.skip("ratt-check is not built (make -C formal ratt-check)")
    return found


def decisions(paths) -> list[int]:
    """What ratt-check says about each file: 0 both ends, 3 the upper end, 1 a fault, 2 no certificate."""
    done = subprocess.run([ratt_check(), *map(str, paths)], capture_output=True, text=True, check=False)
    codes = [int(line.split(" ", 1)[0]) for line in done.stdout.splitlines()]
    assert len(codes) == len(paths), done.stderr
    return codes


def python_decision(path) -> int:
    """The same, by the Python verifier."""
    try:
        return 0 if verify_certificate(path).lower_proved else 3
    except ProofError:
        return 1
    except FileFormatError:
        return 2


def bases(folder, seeds):
    """Certificates of small random problems: dimension 1 to 3, protected robots and links, ragged controls."""
    for seed in seeds:
        rng = np.random.default_rng([47, seed])
        problem = random_problem(rng, 3, kind=KINDS[seed % 3], controls=2, complete=True if seed % 6 < 3 else None)
        written, document = certified(problem, folder / "base.json")
        if written.verified.lower > 1e-3:  # where every robot can be blinded there is nothing to mutate
            yield rng, document


def mutants(rng, document, share, parts=None):
    """One field of any part changed, or of some ``parts``."""
    names = [name for name in document if name != "format"] if parts is None else parts
    for at, value in list(places({name: document[name] for name in names})):
        for new in variants(value, rng):
            if new != value and rng.random() <= share:
                yield at, value, new, changed(document, at, new)


def sweep(folder, documents, share, parts=None):
    """Disagreements, mutants, and mutants that were accepted; ``documents`` : with a generator each."""
    seen = 0

    def changes():
        nonlocal seen
        for rng, document in documents:
            for at, value, new, mutant in mutants(rng, document, share, parts):
                seen += 1
                yield (at, value, new), mutant

    found, accepted = disagreements(folder, changes())
    return found, seen, accepted


def disagreements(folder, documents):
    """The documents, with both decisions, on which one accepts more than the other; and how many were accepted."""
    found, accepted, batch = [], 0, []

    def flush():
        nonlocal accepted
        paths = [folder / f"mutant{k}.json" for k in range(len(batch))]
        for path, (_, document) in zip(paths, batch, strict=True):
            path.write_text(json.dumps(document))
        for (label, document), path, code in zip(batch, paths, decisions(paths), strict=True):
            expected = python_decision(path)
            accepted += code in ACCEPTED
            if code != expected and (code in ACCEPTED or expected in ACCEPTED):
                found.append((label, document, code, expected))
        batch.clear()

    for item in documents:
        batch.append(item)
        if len(batch) == BATCH:
            flush()
    flush()
    return found, accepted
