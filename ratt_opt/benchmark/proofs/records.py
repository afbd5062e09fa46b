"""The table of records: every line verified, and a record that falls only to a verified file."""

from __future__ import annotations

import math
from dataclasses import dataclass
from datetime import date
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt._validation import check_integer
from ratt_opt._version import __version__
from ratt_opt.benchmark.instances.instance import read_document
from ratt_opt.benchmark.instances.library import BenchmarkLibrary, Best, hash_of
from ratt_opt.benchmark.proofs.verification import verify_record
from ratt_opt.certificates.verifier.limits import SECONDS
from ratt_opt.errors import InputError, ProofError, UndecidedError

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

__all__ = ["CheckedRecord", "submit_record", "verify_benchmark"]


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckedRecord:
    """One line of the table of records, looked at.

    ``fault`` : why it is refused, or nothing; ``undecided`` : it is neither refused nor proved within the limits
    """

    instance: str
    value: float
    bound: float
    fault: str = ""
    undecided: bool = False


def verify_benchmark(
    library: BenchmarkLibrary,
    *,
    sample: int | None = None,
    seed: int = 0,
    seconds: float = SECONDS,
    on_line: Callable[[CheckedRecord], object] | None = None,
) -> list[CheckedRecord]:
    """Verify the table of records: hash, both ends, and agreement with the instance.

    Parameters
    ----------
    sample : number of lines, drawn with ``seed``; all by default
    seconds : for valuing one answer, and for one certificate
    on_line : called with every line as it is done

    Raises
    ------
    InputError : ``sample`` is no integer of at least 1.
    """
    names = sorted(library.best)
    if sample is not None and check_integer("sample", sample, low=1) < len(names):
        names = sorted(np.random.default_rng(seed).choice(names, sample, replace=False).tolist())
    found = []
    for name in names:
        found.append(_checked(library, library.best[name], seconds))
        if on_line is not None:
            on_line(found[-1])
    return found


def _checked(library: BenchmarkLibrary, row: Best, seconds: float) -> CheckedRecord:
    try:
        instance = library.instance(row.instance)
        record = read_document(library.record_path(row.instance))
        if hash_of(record) != row.certificate:
            raise ProofError("the record file has another SHA-256 than the table")
        if not isinstance(record, dict):
            raise InputError("record", "must be an object", type(record).__name__)
        proved = verify_record(instance, record, seconds=seconds)
        if (proved.value, proved.bound) != (row.value, row.bound):
            raise ProofError(f"the table says {row.value}, {row.bound}; the record {proved.value}, {proved.bound}")
    except (InputError, ProofError, UndecidedError) as error:
        undecided = isinstance(error, UndecidedError)
        return CheckedRecord(
            instance=row.instance, value=row.value, bound=row.bound, fault=str(error), undecided=undecided
        )
    return CheckedRecord(instance=row.instance, value=row.value, bound=row.bound)


def submit_record(
    library: BenchmarkLibrary, record: dict[str, Any], *, who: str, seconds: float = SECONDS
) -> tuple[BenchmarkLibrary, Best]:
    """Enter a record if it is verified and better than the known one; the library with it, and its line.

    Better: a better value with no worse bound, or a better bound with no worse value.

    Raises
    ------
    InputError : it is no record, or no better than the known one.
    ProofError : an end is not proved.
    """
    name = record.get("instance")
    if not isinstance(name, str):
        raise InputError("record", "must name its instance", name)
    instance = library.instance(name)
    proved = verify_record(instance, record, seconds=seconds)
    known, sign = library.best.get(name), 1.0 if instance.maximises else -1.0
    if known is not None:
        value, bound = sign * (proved.value - known.value), sign * (known.bound - proved.bound)
        gains = 0.0 if math.isnan(bound) else bound  # both infinite
        if value < 0 or gains < 0 or value == gains == 0:
            rule = f"must better the known record {known.value} to {known.bound} at one end, and worsen none"
            raise InputError("record", rule, f"{proved.value} to {proved.bound}")
    row = Best(
        instance=name,
        value=proved.value,
        bound=proved.bound,
        certificate=hash_of(record),
        who=who,
        version=__version__,
        date=date.today().isoformat(),
    )
    return library.set_best(row, record), row


def read_record(path: Path) -> dict[str, Any]:
    """Read a record file, packed or plain. InputError : it holds no object."""
    record = read_document(path)
    if not isinstance(record, dict):
        raise InputError(str(path), "must hold an object", type(record).__name__)
    return record
