"""What an interrupt must not leave half done."""

import subprocess
import sys

import pytest

from ratt_opt.running import interrupts
from tests.interrupts import INTERRUPTED_IMPORTS


def test_a_package_whose_import_was_interrupted_is_imported_whole_next_time(tmp_path, monkeypatch):
    """Its modules would otherwise know the one that was given up, which lacks what came later."""
    package = tmp_path / "half_imported"
    package.mkdir()
    (package / "part.py").write_text("import half_imported\nowner = lambda: half_imported.late\n")
    interrupting = "if not __import__('os').path.exists(__file__ + '.again'):\n    raise KeyboardInterrupt\n"
    (package / "__init__.py").write_text(f"from half_imported.part import owner\n{interrupting}late = 1\n")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(KeyboardInterrupt):
        interrupts.imported_whole("half_imported")
    (package / "__init__.py.again").touch()
    assert interrupts.imported_whole("half_imported").owner() == 1


SOLVER = f"""{INTERRUPTED_IMPORTS}
import time
from ratt_opt.highs import LinearProgram
sys.meta_path.insert(0, Interrupts("highspy._core"))
try:
    LinearProgram([1.0])
    time.sleep(60)
except KeyboardInterrupt:
    print("answered", "highspy" in sys.modules)
print(LinearProgram([1.0]).solve().is_optimal)
"""


def test_one_while_the_solver_of_programs_is_imported_comes_after_it():
    """Its extension said "initialization failed" from then on where it came while that was loaded."""
    done = subprocess.run([sys.executable, "-c", SOLVER], capture_output=True, text=True, check=False)
    assert done.stdout == "answered True\nTrue\n", done.stderr


INTERRUPTED_IMPORT = f"""{INTERRUPTED_IMPORTS}
import time
import ratt_opt as ro
sys.meta_path.insert(0, Interrupts(sys.argv[1]))
try:
    ro.certify, ro.verify_certificate
    time.sleep(60)
except KeyboardInterrupt:
    print("answered")
assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
problem = ro.random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=0).problem()
print(ro.solve_maxmin(problem).stop.value, ro.total_curvature(problem.objective).lower >= 0)
"""


@pytest.mark.parametrize(
    "module",
    ["numpy.dtypes", "numpy.linalg", "networkx", "networkx.utils.configs", "flint.types.arb", "ratt_opt.problem"],
)
def test_an_interrupt_while_names_are_loaded_leaves_nothing_half_imported(module: str) -> None:
    """NumPy could be loaded only once per process, networkx knew half of itself: every later search failed."""
    command = [sys.executable, "-c", INTERRUPTED_IMPORT, module]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.stdout == "answered\nclosed True\n", done.stderr
