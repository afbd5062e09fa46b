"""``ratt-check``, the checker extracted from its Coq proof, run as a program of its own (``formal/README.md``)."""

from __future__ import annotations

import os
import shutil
import subprocess
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path

from ratt_opt.errors import FileFormatError, InputError, ProofError, UndecidedError

__all__ = ["ExtractedVerdict", "check_extracted", "find_checker"]

NAME, VARIABLE = "ratt-check", "RATT_CHECK"


class CheckerCode(IntEnum):
    """Exit codes of the program."""

    PROVED = 0
    REFUSED = 1
    UNREADABLE = 2
    UPPER_ONLY = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class ExtractedVerdict:
    """Verdict of the program; ``text`` is its own line. ``lower_proved``: both ends, not the upper alone."""

    program: str
    lower_proved: bool
    text: str


def find_checker() -> str:
    """The program's path: what ``RATT_CHECK`` names, else the one on the search path.

    Raises
    ------
    InputError : there is none.
    """
    named = os.environ.get(VARIABLE)
    found = shutil.which(named or NAME)
    if found is None:
        rule = f"must be on the search path or named by {VARIABLE} (make -C formal ratt-check builds it)"
        raise InputError(NAME, rule, named or "neither")
    return found


def check_extracted(
    path: str | Path, *, program: str | None = None, time_limit: float | None = None
) -> ExtractedVerdict:
    """Run the program on one certificate.

    Parameters
    ----------
    program : its path; looked for where ``None``
    time_limit : seconds; no limit where ``None``

    Raises
    ------
    ProofError : it refuses the certificate.
    FileFormatError : it reads no such certificate.
    UndecidedError : it did not end within the time limit.
    InputError : there is no such program, or what runs is another one.
    """
    found = program or find_checker()
    command = [found, str(Path(path).absolute())]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=time_limit)
    except subprocess.TimeoutExpired:
        raise UndecidedError(f"{NAME}: not decided within {time_limit:g} s") from None
    except OSError as error:
        raise InputError(NAME, "must be a program that runs", f"{found}: {error.strerror}") from None
    code, _, line = done.stdout.partition(" ")
    if code != str(done.returncode) or done.returncode not in set(CheckerCode):
        raise InputError(NAME, "must answer as it is written to", f"{found}: {done.stdout or done.stderr}")
    text = line.removeprefix(f"{command[1]}: ").strip()
    if done.returncode == CheckerCode.REFUSED:
        raise ProofError(f"{NAME}: {text}")
    if done.returncode == CheckerCode.UNREADABLE:
        raise FileFormatError(str(path), f"must be a certificate that {NAME} reads", text)
    return ExtractedVerdict(program=found, lower_proved=done.returncode == CheckerCode.PROVED, text=text)
