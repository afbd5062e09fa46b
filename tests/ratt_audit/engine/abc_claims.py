"""Claims on three elements of three robots, shared by the tests of the engine."""

from ratt_audit.engine.claim import Claim, Ground, Inequality, Linear
from ratt_opt.worst_ratio.function_class import FunctionClass

ABC = Ground(("a", "b", "c"), (0, 1, 2))
ANY, ND, SUB = FunctionClass.NON_DECREASING, FunctionClass.TOTAL_CURVATURE, FunctionClass.CURVATURE


def f(*names: str) -> Linear:
    return Linear.of(ABC.mask(names))


def claim(kind: FunctionClass, conclusion: Linear, *premises: Inequality) -> Claim:
    return Claim(function_class=kind, ground=ABC, premises=premises, conclusion=conclusion)
