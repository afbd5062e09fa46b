"""Elements as the compiled loops read them."""

from __future__ import annotations

from ctypes import Structure, c_int32, c_int64, c_void_p
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ratt_opt.attack.team import LARGEST_DIMENSION
from ratt_opt.errors import InputError
from ratt_opt.native.library import address, checked
from ratt_opt.setfunctions.information import triangles

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["ElementsRecord", "PackedElements"]


class ElementsRecord(Structure):
    """``Elements`` of ``native/src/elements.h``."""

    _fields_: ClassVar = [
        *((name, c_int64) for name in ("elements", "targets", "entries")),
        *((name, c_int32) for name in ("dimension", "criterion")),
        *((name, c_void_p) for name in ("weights", "baseline", "prior", "information", "sees")),
    ]


class PackedElements:
    """What elements tell about the targets; symmetric matrices packed, T = d (d + 1) / 2 entries.

    ``criterion`` : the code of trace or log-det; ``weights``, ``baseline`` : (M,) and the weighted criterion of the
    prior information ``prior`` (M, T); ``information`` : (E, M, T); ``sees`` : (E, M) whether there is information

    Raises
    ------
    InputError : a shape or a type is another, or d > 64.
    """

    def __init__(
        self,
        criterion: int,
        dimension: int,
        *,
        weights: FloatArray,
        baseline: FloatArray,
        prior: FloatArray,
        information: FloatArray,
        sees: BoolArray,
    ) -> None:
        if not 1 <= dimension <= LARGEST_DIMENSION:
            raise InputError("dimension", f"must be in [1, {LARGEST_DIMENSION}]", dimension)
        self.count, self.targets, entries = len(information), len(prior), dimension * (dimension + 1) // 2
        self.prior, self.sees = prior, sees
        self._arrays = (  # the record has their addresses only
            checked("weights", weights, np.float64, (self.targets,)),
            checked("baseline", baseline, np.float64, (self.targets,)),
            checked("prior", prior, np.float64, (self.targets, entries)),
            checked("information", information, np.float64, (self.count, self.targets, entries)),
            checked("sees", sees, np.bool_, (self.count, self.targets)),
        )
        sizes = self.count, self.targets, entries
        self.record = ElementsRecord(*sizes, dimension, criterion, *map(address, self._arrays))

    @classmethod
    def of(cls, objective: InformationObjective, information: FloatArray, sees: BoolArray) -> PackedElements:
        """Those of a criterion, with ``information`` (E, M, d, d)."""
        prior = objective.prior_information
        assert objective.compiled_code is not None
        return cls(
            objective.compiled_code,
            objective.dimension,
            weights=np.array(objective.weights),
            baseline=np.ascontiguousarray(objective.criterion(prior)),
            prior=triangles(prior),
            information=triangles(information),
            sees=np.ascontiguousarray(sees),
        )
