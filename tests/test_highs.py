"""The adapter to HiGHS."""

from __future__ import annotations

import subprocess
import sys

PROGRAMS = """
from ratt_opt.highs import LinearProgram
print(LinearProgram([1.0, 2.0], 0.0, 3.0, maximise=True).solve().x.tolist())
print(LinearProgram([1.0], 0.5, 3.0, integer=[True]).solve().x.tolist())
"""


def test_solving_prints_nothing() -> None:
    """The first words of HiGHS 1.16 come from its constructor: the output of a command began with them."""
    done = subprocess.run([sys.executable, "-c", PROGRAMS], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == ["[3.0, 3.0]", "[1.0]"]
    assert not done.stderr
