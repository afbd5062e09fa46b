"""An interrupt while loops are compiled is answered at once, and is never lost or turned into another error."""

from __future__ import annotations

import gc
import re
import signal
from pathlib import Path

import pytest
from numba.core.registry import cpu_target

import ratt_opt
from ratt_opt.compiling import numba

SOURCES = sorted(Path(ratt_opt.__file__).parent.rglob("*.py"))


@pytest.mark.filterwarnings("ignore:unclosed file:ResourceWarning")  # when it comes between `open` and `with`
@pytest.mark.parametrize("cached", [False, True])
@pytest.mark.parametrize("callback", ["_object_cache_notify", "_object_cache_getbuffer"])
def test_one_in_a_callback_of_the_compiler_comes_after_it(callback, cached, monkeypatch, tmp_path):
    """There Python drops it; without more the interrupt is lost, or the compiler misses what was being made."""
    engine = cpu_target.target_context._internal_codegen._engine._ee
    original, before = getattr(engine, callback), signal.getsignal(signal.SIGINT)
    met = []

    def interrupted(*arguments):
        if not met:
            met.append(callback)
            signal.raise_signal(signal.SIGINT)
        return original(*arguments)

    monkeypatch.setattr(engine, callback, interrupted)

    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))

    @numba.njit(cache=cached)
    def doubled(x):
        total = 0.0
        for k in range(len(x)):
            total += 2 * x[k]
        return total

    with pytest.raises(KeyboardInterrupt):  # noqa: PT012  (it comes some time later)
        while True:  # compiled once, and then run until the interrupt is here
            doubled((1.0, 2.0))
    gc.collect()
    assert met
    assert signal.getsignal(signal.SIGINT) is before
    assert doubled((1.0, 2.0)) == 6.0


def test_every_module_of_compiled_loops_takes_numba_from_there():
    direct = [path for path in SOURCES if re.search(r"^\s*(import numba|from numba)\b", path.read_text(), re.M)]
    assert [path.name for path in direct] == ["compiling.py"]
