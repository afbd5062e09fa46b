"""The adapter to HiGHS."""

import signal
import subprocess
import sys

import numpy as np
import pytest

from ratt_opt.highs import LinearProgram, rows_of

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


@pytest.mark.parametrize("integer", [False, True])
def test_an_interrupt_ends_a_long_run_between_its_steps(integer: bool) -> None:
    """HiGHS answered it once all was done, seconds later for the smallest largest group of 30 robots."""
    rng = np.random.default_rng(0)
    rows = rows_of([(range(40), rng.random(40).tolist()) for _ in range(20)], 4.1)
    program = LinearProgram(rng.random(40) + 1, 0, 3, rows=rows, integer=[integer] * 40)
    asked: list[int] = []

    def interrupt(_: object) -> None:
        asked.append(1)
        if len(asked) == 1:
            signal.raise_signal(signal.SIGINT)

    question = program._highs.cbMipInterrupt if integer else program._highs.cbSimplexInterrupt
    question.subscribe(interrupt)
    before = signal.getsignal(signal.SIGINT)
    with pytest.raises(KeyboardInterrupt):
        program.solve(is_long=True)
    assert signal.getsignal(signal.SIGINT) is before
    assert len(asked) < 3
    question.unsubscribe(interrupt)
    assert program.solve(is_long=True).is_optimal
