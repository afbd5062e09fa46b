"""Parameters of the main job, family by family: what ``bound(params=...)`` takes and its file of TOML holds."""

from __future__ import annotations

from dataclasses import dataclass, field

from ratt_opt.attack.params import AttackParams
from ratt_opt.bounds.params import BoundParams
from ratt_opt.certificates.params import CertificateParams
from ratt_opt.curvatures.params import CurvatureParams
from ratt_opt.solvers.maxmin.params import MaxMinParams

__all__ = ["DEFAULT", "JobParams"]


@dataclass(frozen=True, slots=True, kw_only=True)
class JobParams:
    """Parameters of the main job, family by family; ``replace`` changes some.

    ``bound(..., params=params)`` uses them, and ``ratt-opt bound --params FILE`` reads them from TOML: a table for each
    part of a family, such as ``[search.first_plans]``. They decide how soon a bracket closes and how tight it is, never
    whether it holds; a remark of the report names those that are not as by default.

    ``search`` : for the best plan. ``attack`` : on each plan; the search's own attacks are part of it
    ``curvatures``, ``bounds`` : of guarantees. ``certificate`` : of the proofs that are written
    """

    search: MaxMinParams = field(default_factory=MaxMinParams)
    attack: AttackParams = field(default_factory=AttackParams)
    curvatures: CurvatureParams = field(default_factory=CurvatureParams)
    bounds: BoundParams = field(default_factory=BoundParams)
    certificate: CertificateParams = field(default_factory=CertificateParams)


DEFAULT = JobParams()
"""Parameters of jobs that are not given any."""
