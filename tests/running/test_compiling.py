"""An interrupt while loops are compiled is never lost or turned into another error; upgrades run no outdated code."""

from __future__ import annotations

import gc
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import weakref
from pathlib import Path

import numpy as np
import pytest
from numba.core import event
from numba.core.registry import cpu_target

import ratt_opt
from ratt_opt.running import kept_code
from ratt_opt.running.compiling import INTERRUPTS, _raised_again, numba
from tests.interrupts import INTERRUPTED_IMPORTS

LONG = 60.0
"""Seconds after which an interrupt counts as lost."""
SOURCES = sorted(Path(ratt_opt.__file__).parent.rglob("*.py"))


@pytest.fixture
def own_hook(monkeypatch):
    """What Python drops is seen to as outside of pytest, which puts its own hook in the place of that."""
    monkeypatch.setattr(sys, "unraisablehook", _raised_again(sys.unraisablehook))


@pytest.mark.usefixtures("own_hook")
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

    ends = time.monotonic() + LONG
    with pytest.raises(KeyboardInterrupt):  # noqa: PT012  (it comes some time later)
        while time.monotonic() < ends:  # compiled once, and then run until the interrupt is here
            doubled((1.0, 2.0))
    gc.collect()
    assert met
    assert signal.getsignal(signal.SIGINT) is before
    assert doubled((1.0, 2.0)) == 6.0


@pytest.mark.usefixtures("own_hook")
@pytest.mark.parametrize("kind", ["numba:compiler_lock", "numba:llvm_lock"])
@pytest.mark.parametrize("status", ["on_start", "on_end"])
def test_one_as_a_lock_is_taken_or_left_changes_nothing_for_the_next(kind, status):
    """Before anybody else hears that compiling begins or has ended: then nobody did, and interrupts stayed held."""
    before, met = signal.getsignal(signal.SIGINT), []

    class First(event.Listener):
        def _interrupt(self, name):
            if name == status and not met:
                met.append(name)
                signal.raise_signal(signal.SIGINT)

        def on_start(self, _):
            self._interrupt("on_start")

        def on_end(self, _):
            self._interrupt("on_end")

    first = First()
    event._registered[kind].insert(0, first)
    ends = time.monotonic() + LONG
    try:
        with pytest.raises(KeyboardInterrupt):  # noqa: PT012  (it comes some time later)
            while time.monotonic() < ends:
                numba.njit(lambda x: 2 * x)(1.0)
    finally:
        event.unregister(kind, first)
    gc.collect()
    assert met
    assert signal.getsignal(signal.SIGINT) is before
    assert INTERRUPTS._depth == 0
    assert numba.njit(lambda x: 2 * x)(1.0) == 2.0


class Interrupting:
    """A key that is looked up with an interrupt, as when the value of a weak dictionary goes."""

    is_armed = False

    def __hash__(self):
        if self.is_armed:
            self.is_armed = False
            signal.raise_signal(signal.SIGINT)
        return 0


class Value:
    """Something that a weak reference can be of."""


def test_one_in_the_callback_of_a_weak_reference_comes_after_it():
    """There Python drops it as well, and an attack on a network went on to its limit. Sleep ends by it."""
    began = time.monotonic()
    key, value, weak = Interrupting(), Value(), weakref.WeakValueDictionary()
    weak[key] = value
    key.is_armed = True
    with pytest.raises(KeyboardInterrupt):  # noqa: PT012  (it comes some time later)
        with event.trigger_event("numba:compiler_lock"):
            del value
        time.sleep(LONG)
    assert time.monotonic() - began < LONG
    assert not key.is_armed
    assert not weak


FREED_LATER = """
import signal, sys, time, weakref
from llvmlite.binding.ffi import ObjectRef
from ratt_opt.running.compiling import numba

class Compiled(ObjectRef):
    def close(self):
        signal.raise_signal(signal.SIGINT)

class Interrupting:
    is_armed = False
    def __hash__(self):
        if self.is_armed:
            self.is_armed = False
            signal.raise_signal(signal.SIGINT)
        return 0

key, weak = Interrupting(), weakref.WeakValueDictionary()
freed = Compiled(object())
if sys.argv[1] == "a callback":
    freed.close = None
    weak[key] = freed
    key.is_armed = True
try:
    del freed
    time.sleep(60)
except KeyboardInterrupt:
    print("answered")
"""


@pytest.mark.parametrize("where", ["a destructor", "a callback"])
def test_one_where_the_collector_frees_what_was_compiled_comes_after_it(where):
    """Long after compiling, when nobody handles interrupts: one of 20 of a certificate was lost in a destructor."""
    began = time.monotonic()
    done = subprocess.run([sys.executable, "-c", FREED_LATER, where], capture_output=True, text=True, check=False)
    assert time.monotonic() - began < LONG
    assert (done.stdout, done.stderr) == ("answered\n", "")


IMPORTED_AGAIN = f"""{INTERRUPTED_IMPORTS}
sys.meta_path.insert(0, Interrupts(sys.argv[1]))
try:
    from ratt_opt.running.compiling import numba
except KeyboardInterrupt:
    from ratt_opt.running.compiling import numba
    print(numba.njit(lambda x: 2 * x)(1))
"""


@pytest.mark.parametrize("module", ["numba.core.types", "numba.core.typing", "numba.np.ufunc", "llvmlite.binding"])
def test_one_while_the_compiler_is_imported_leaves_one_that_works(module):
    """Half imported it could not be imported again: every later search of the process ended in an AttributeError."""
    done = subprocess.run([sys.executable, "-c", IMPORTED_AGAIN, module], capture_output=True, text=True, check=False)
    assert done.stdout == "2\n", done.stderr


RETURNS_TWO = """
import signal
from ratt_opt.running.compiling import numba
import numpy as np

@numba.njit("(int64,)")  # compiled here: an interrupt can come in the first call of all
def doubled(n):
    total, count = np.zeros(3), np.ones(3)
    for k in range(n):
        total[k % 3] += np.sin(k)
    return total, count

signal.signal(signal.SIGALRM, signal.default_int_handler)  # a thread could not send it while compiled loops run
signal.setitimer(signal.ITIMER_REAL, 0.02)
try:
    doubled(100_000_000)
    while True:
        pass
except KeyboardInterrupt:
    print("answered")
"""


def test_one_in_compiled_loops_that_return_arrays_stays_an_interrupt():
    done = subprocess.run([sys.executable, "-c", RETURNS_TWO], capture_output=True, text=True, check=False)
    assert done.stdout == "answered\n", done.stderr


@numba.njit
def _drawn(rng, count):
    total = 0.0
    for _ in range(count):
        total += rng.random() + rng.integers(0, 7) + rng.standard_normal()
    return total


@pytest.mark.parametrize("source", [np.random.PCG64, np.random.MT19937, np.random.Philox, np.random.SFC64])
def test_loops_draw_from_a_generator_what_numpy_draws(source):
    ours, theirs = np.random.Generator(source(3)), np.random.Generator(source(3))
    expected = sum(theirs.random() + theirs.integers(0, 7) + theirs.standard_normal() for _ in range(50))
    assert _drawn(ours, 50) == pytest.approx(expected, rel=1e-12)
    assert ours.random() == theirs.random()


DRAWS = """
import random, signal
import numpy as np
from ratt_opt.running.compiling import numba

@numba.njit
def drawn(rng):
    return rng.random()

rng, answered = np.random.default_rng(0), 0
drawn(rng)
signal.signal(signal.SIGALRM, signal.default_int_handler)
while answered < 300:
    try:
        signal.setitimer(signal.ITIMER_REAL, random.uniform(1e-5, 1e-3))
        while True:
            drawn(rng)
    except KeyboardInterrupt:
        answered += 1
print("answered")
"""


def test_one_as_a_generator_is_handed_to_compiled_loops_stays_an_interrupt():
    done = subprocess.run([sys.executable, "-c", DRAWS], capture_output=True, text=True, check=False)
    assert done.stdout == "answered\n", done.returncode


LISTED = """
import signal
import numpy as np
from numba.core.typing.context import BaseContext

original, met = BaseContext.insert_attributes, []

def interrupted(self, attributes):
    met.append(attributes)
    if len(met) == 2:  # some are listed, others are not
        signal.raise_signal(signal.SIGINT)
    return original(self, attributes)

BaseContext.insert_attributes = interrupted
try:
    import ratt_opt.running.compiling
    ratt_opt.running.compiling.numba.njit(lambda x: x.shape[0])(np.ones(2))
except KeyboardInterrupt:
    print("answered")
from ratt_opt.running.compiling import numba
print(numba.njit(lambda x: x.shape[0] + x.size)(np.ones((2, 3))))
"""


def test_one_while_types_are_listed_leaves_nothing_out():
    done = subprocess.run([sys.executable, "-c", LISTED], capture_output=True, text=True, check=False)
    assert done.stdout == "answered\n8\n", done.stderr


HANDED_OVER = """
import gc, signal, sys, time
from llvmlite.binding import ffi
from ratt_opt.running.compiling import numba
import numpy as np

name, met = sys.argv[1], []
original = getattr(ffi.lib, name)

def interrupted(*arguments):
    result = original(*arguments)
    if compiling and not met:
        met.append(name)
        signal.raise_signal(signal.SIGINT)
    return result

ffi.lib._fntab[name] = interrupted
compiling = False
numba.njit(lambda x: x.sum())(np.ones(2))
compiling = True
try:
    numba.njit(lambda x: np.argsort(x).sum() + np.diag(x).sum())(np.ones(3))
    time.sleep(5)
    print("not answered", met)
except KeyboardInterrupt:
    print("answered", met)
for _ in range(5):
    gc.collect()
    print(numba.njit(lambda x: x.sum())(np.ones(2)))
"""


@pytest.mark.parametrize("name", ["LLVMPY_LinkModules", "LLVMPY_AddModule", "LLVMPY_DisposeString"])
def test_one_while_a_module_changes_its_owner_does_not_free_it_twice(name):
    done = subprocess.run([sys.executable, "-c", HANDED_OVER, name], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout == f"answered {[name]}\n" + 5 * "2.0\n"


def test_every_module_of_compiled_loops_takes_numba_from_there():
    direct = [path for path in SOURCES if re.search(r"^\s*(import numba|from numba)\b", path.read_text(), re.M)]
    assert [path.name for path in direct] == ["compiling.py", "kept_code.py"]


INNER = "from ratt_opt.running.compiling import numba\n\n@numba.njit\ndef inner(x):\n    return x + 1\n"
OUTER = """
from ratt_opt.running.compiling import numba
from ratt_opt.constants import FACTOR
from ratt_opt.inner import inner
if False:
    from ratt_opt.records import Record

@numba.njit(cache=True)
def outer(record):
    return FACTOR * inner(record.x)
"""
CALL = """
from ratt_opt import outer, records
print(outer.outer(records.{}(x=1, y=2)), outer.outer.stats.cache_hits.total())
"""


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A package of our name with our rules and loops of its own."""
    folder = tmp_path / "ratt_opt"
    (folder / "running").mkdir(parents=True)
    for name in ("interrupts.py", "kept_code.py", "compiling.py", "__init__.py"):
        shutil.copy(Path(ratt_opt.__file__).parent / "running" / name, folder / "running")
    (folder / "__init__.py").touch()
    (folder / "inner.py").write_text(INNER)
    (folder / "outer.py").write_text(OUTER)
    (folder / "constants.py").write_text("FACTOR = 1\n")
    (folder / "records.py").write_text(records("Record", "x: int\n    y: int"))
    return folder


def records(name: str, fields: str) -> str:
    return f"from typing import NamedTuple\n\nclass {name}(NamedTuple):\n    {fields}\n"


def called(package: Path, record: str = "Record") -> tuple[int, int]:
    """What the loop gives in a process of its own, and how much of it came from an earlier one."""
    command = [sys.executable, "-c", CALL.format(record)]
    done = subprocess.run(command, cwd=package.parent, env={}, capture_output=True, text=True, check=True)
    value, hits = map(int, done.stdout.split())
    return value, hits


def test_an_upgrade_compiles_again_and_leaves_nothing_of_the_old_code(package):
    """As pip leaves it: new sources, and what was kept of the old ones beside them."""
    assert [called(package), called(package)] == [(2, 0), (2, 1)]
    (package / "inner.py").write_text(INNER.replace("1", "10"))
    (package / "records.py").write_text(records("Renamed", "x: int\n    y: int"))
    assert called(package, "Renamed") == (11, 0)
    kept = [path for path in (package / "__pycache__").iterdir() if path.suffix in {".nbi", ".nbc"}]
    assert len(kept) == 2


@pytest.mark.parametrize(
    ("file", "text", "changes"),
    [
        ("inner.py", INNER.replace("1", "10"), True),
        ("constants.py", "FACTOR = 5\n", True),
        ("records.py", records("Record", "y: int\n    x: int"), True),
        ("elsewhere.py", "FACTOR = 5\n", False),
    ],
    ids=["callee", "constant", "layout", "none"],
)
def test_compiled_code_is_kept_while_all_sources_in_it_stay_the_same(file, text, changes, package, monkeypatch):
    monkeypatch.setattr(kept_code, "PACKAGE", package)
    found = []
    for _ in range(2):
        kept_code._text.cache_clear()
        kept_code.fingerprint.cache_clear()
        found.append(kept_code.fingerprint(package / "outer.py"))
        (package / file).write_text(text)
    assert (found[0] != found[1]) is changes


INTERRUPTED = """
from collections import Counter
import networkx as nx, numpy as np
import ratt_opt as ro
from numba.core import event
from ratt_opt.budget import Budget
from tests.strategies import OBJECTIVES, information_data

class Compiled(event.Listener):
    def on_start(self, event):
        compiled[str(event.data["dispatcher"])] += 1
    def on_end(self, event):
        pass

compiled = Counter()
event.register("numba:compile", Compiled())
for robots, dimension in [(10, 1), (24, 2), (24, 3)]:
    for graph in (None, nx.barabasi_albert_graph(robots, 4, seed=1)):
        for kind in OBJECTIVES.values():
            f = kind(*information_data(np.random.default_rng(robots), 2 * robots, 3, dimension))
            problem = ro.Problem(f, np.repeat(np.arange(robots), 2), graph, robots // 5, robots)
            plan = 2 * np.arange(robots)
            interrupted = Budget()
            interrupted.interrupt()
            searches = {
                "attack": lambda: ro.worst_case_attack(problem, plan, budget=interrupted),
                "best plan": lambda: ro.solve_maxmin(problem, budget=interrupted),
                "nobody attacks": lambda: ro.nonrobust_optimum(problem, budget=interrupted),
                "survey": lambda: ro.attack_survey(problem, plan, budget=interrupted),
                "total curvature": lambda: ro.total_curvature(f, problem.robot, budget=interrupted),
                "budgets": lambda: ro.breaking_budgets(problem, plan, 1.0, budget=interrupted),
                "links": lambda: ro.links_to_protect(problem, plan, 2, budget=interrupted),
            }
            for name, search in searches.items():
                search()
                assert not compiled, (name, robots, graph, kind, compiled)
print("nothing")
"""


def test_after_an_interrupt_nothing_is_compiled_any_more(tmp_path):
    """On a first run that took 8 seconds: searches that know something at once were asked for it, and compiled."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-c", INTERRUPTED], env=environment, capture_output=True, text=True, check=False,
        cwd=Path(ratt_opt.__file__).parent.parent,
    )  # fmt: skip
    assert done.stdout == "nothing\n", done.stderr
