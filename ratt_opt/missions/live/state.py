"""Measurements and the state of a tracker: plain data that pickles and becomes JSON."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ratt_opt._validation import FloatArray, check_finite, check_integer, check_number, readonly
from ratt_opt._values import ByValue, ReprMixin
from ratt_opt.errors import InputError
from ratt_opt.missions.belief import Belief
from ratt_opt.problem import Attack

__all__ = ["Measurement", "Moment", "TrackerState"]

FORMAT, VERSION = "ratt-opt tracker", 3


@dataclass(frozen=True, slots=True)
class Measurement:
    """Measurement of ``target`` by ``robot``: range [m] and bearing [rad], or the values of its own sensor.

    ``time`` : when it was measured, on the caller's clock [s]; ``None`` is the time of the step it is given to.
    """

    robot: int
    target: int
    values: tuple[float, ...]
    time: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Moment(ByValue):
    """One time [s] with its data: ``poses`` (N, 3) and their covariances (N, 3, 3), and what was measured then.

    ``belief`` : of the targets, the measurements of this time taken in. ``refused`` : (M,) times in a row, up to this
    one, at which the gate refused all sightings of a target. A measurement has a time of its own if its stamp was ahead
    of this time.
    """

    time: float
    poses: FloatArray
    pose_covariances: FloatArray
    belief: Belief
    refused: tuple[int, ...]
    measurements: tuple[Measurement, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Plain data for strict JSON."""
        return {
            "time": self.time,
            "poses": self.poses.tolist(),
            "pose_covariances": self.pose_covariances.tolist(),
            "mean": self.belief.mean.tolist(),
            "covariance": self.belief.covariance.tolist(),
            "refused": list(self.refused),
            "measurements": [[m.robot, m.target, list(m.values), m.time] for m in self.measurements],
            **({} if len(self.belief.mean) else {"dimension": self.belief.mean.shape[1]}),
        }

    @classmethod
    def from_dict(cls, document: dict[str, Any]) -> Moment:
        """The moment that :meth:`to_dict` wrote. InputError : a field is missing or breaks its rule."""
        _need(document, "time", "poses", "pose_covariances", "mean", "covariance", "refused", "measurements")
        return cls(
            time=check_number("time", document["time"], low=0.0),
            poses=readonly(check_finite("poses", document["poses"], ndim=2)),
            pose_covariances=readonly(check_finite("pose_covariances", document["pose_covariances"], ndim=3)),
            belief=_belief(document),
            refused=tuple(check_integer("refused", count, low=0) for count in _list("refused", document["refused"])),
            measurements=tuple(
                Measurement(
                    check_integer("measurement robot", robot, low=0),
                    check_integer("measurement target", target, low=0),
                    tuple(check_finite("measurement values", values, ndim=1).tolist()),
                    None if stamp is None else check_number("measurement time", stamp),
                )
                for robot, target, values, stamp in _rows("measurements", document["measurements"], 4)
            ),
        )


def _belief(document: dict[str, Any]) -> Belief:
    """The belief of a moment; without targets its lists are empty, and ``dimension`` says that of their states."""
    if document["mean"] == [] and document["covariance"] == []:
        d = check_integer("dimension", document.get("dimension"), low=2)
        return Belief(readonly(np.zeros((0, d))), readonly(np.zeros((0, d, d))))
    return Belief.of(document["mean"], document["covariance"])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class TrackerState(ByValue, ReprMixin):
    """The whole state of a tracker: ``time`` [s] since it began, and the caller's clock ``now`` [s] if there was one.

    ``poses`` : (N, 3) expected at the next measurements; ``moments`` : times of which late measurements are still taken
    in, the last one now; ``controls`` : (N, H, 2) the rest of the last plan; ``steps``, ``missed`` : how many there
    were, and in how many the planner was late. ``targets`` : (M,) their numbers; ``born`` : (M,) when each appeared
    [s]; ``next_target`` : the number of the next one to appear. ``lost`` : robots that are, and since when [s];
    ``attack`` : what is known to be blinded and cut; ``blinded`` : its robots, and since when [s]. ``failed`` : steps
    in which the planner raised an error. ``attacks`` : all that was said, ``(step, attack)``, oldest first.
    """

    time: float
    now: float | None
    poses: FloatArray
    moments: tuple[Moment, ...]
    controls: FloatArray
    targets: tuple[int, ...]
    born: tuple[float, ...]
    next_target: int
    steps: int = 0
    missed: int = 0
    lost: tuple[tuple[int, float], ...] = ()
    attack: Attack = field(default_factory=Attack)
    blinded: tuple[tuple[int, float], ...] = ()
    failed: int = 0
    attacks: tuple[tuple[int, Attack], ...] = ()

    @property
    def belief(self) -> Belief:
        """Belief about the targets at ``time``."""
        return self.moments[-1].belief

    def to_dict(self) -> dict[str, Any]:
        """Plain data for strict JSON; floats at full precision."""
        return {
            "format": FORMAT,
            "version": VERSION,
            "time": self.time,
            "now": self.now,
            "poses": self.poses.tolist(),
            "moments": [moment.to_dict() for moment in self.moments],
            "controls": self.controls.tolist(),
            "steps": self.steps,
            "missed": self.missed,
            "targets": list(self.targets),
            "born": list(self.born),
            "next_target": self.next_target,
            "lost": [list(pair) for pair in self.lost],
            "attack": self.attack.to_dict(),
            "blinded": [list(pair) for pair in self.blinded],
            "failed": self.failed,
            "attacks": [[step, attack.to_dict()] for step, attack in self.attacks],
        }

    @classmethod
    def from_dict(cls, document: dict[str, Any]) -> TrackerState:
        """The state that :meth:`to_dict` wrote, of this version or an older one.

        Raises
        ------
        InputError : a field is missing or breaks its rule, as a covariance that is singular.
        """
        if not isinstance(document, dict):
            raise InputError("state", "must be a record", type(document).__name__)
        if document.get("format") != FORMAT:
            raise InputError("format", f"must be {FORMAT}", document.get("format"))
        version = document.get("version")
        if version is None or version not in range(1, VERSION + 1) or isinstance(version, bool):
            raise InputError("version", f"must be in [1, {VERSION}]", version)
        _need(document, "time", "now", "poses", "controls", "steps", "missed")
        document = _of_version_1(document) if version == 1 else document
        _need(document, "moments", "targets", "born", "next_target", "lost", "attack")
        document = _of_version_2(document) if version < VERSION else document
        _need(document, "blinded", "failed", "attacks")
        moments = tuple(Moment.from_dict(moment) for moment in _list("moments", document["moments"]))
        if not moments:
            raise InputError("moments", "must hold at least one", "none")
        return cls(
            time=check_number("time", document["time"], low=0.0),
            now=None if document["now"] is None else check_number("now", document["now"]),
            poses=readonly(check_finite("poses", document["poses"], ndim=2)),
            moments=moments,
            controls=readonly(check_finite("controls", document["controls"], ndim=3)),
            targets=tuple(check_integer("targets", j, low=0) for j in _list("targets", document["targets"])),
            born=tuple(check_number("born", t, low=0.0) for t in _list("born", document["born"])),
            next_target=check_integer("next_target", document["next_target"], low=0),
            steps=check_integer("steps", document["steps"], low=0),
            missed=check_integer("missed", document["missed"], low=0),
            lost=_since("lost", document["lost"]),
            attack=_attack(document["attack"]),
            blinded=_since("blinded", document["blinded"]),
            failed=check_integer("failed", document["failed"], low=0),
            attacks=tuple(
                (check_integer("attacks", step, low=0), _attack(attack))
                for step, attack in _rows("attacks", document["attacks"], 2)
            ),
        )


def _since(name: str, value: object) -> tuple[tuple[int, float], ...]:
    """Robots, and since when [s]."""
    rows = _rows(name, value, 2)
    return tuple((check_integer(name, i, low=0), check_number(name, t, low=0.0)) for i, t in rows)


def _need(document: object, *names: str) -> None:
    if not isinstance(document, dict):
        raise InputError("state", "must hold records", type(document).__name__)
    missing = sorted(set(names) - set(document))
    if missing:
        raise InputError(missing[0], "is missing", "nothing")


def _attack(document: object) -> Attack:
    _need(document, "sensing", "links")
    assert isinstance(document, dict)
    links = _rows("attack links", document["links"], 2)
    return Attack(frozenset(_list("attack sensing", document["sensing"])), frozenset((i, j) for i, j in links))


def _list(name: str, value: object) -> list[Any]:
    if not isinstance(value, list):
        raise InputError(name, "must be a list", type(value).__name__)
    return value


def _rows(name: str, value: object, length: int) -> list[Any]:
    rows = _list(name, value)
    if not all(isinstance(row, list) and len(row) == length for row in rows):
        raise InputError(name, f"must hold lists of {length}", rows)
    return rows


def _of_version_1(document: dict[str, Any]) -> dict[str, Any]:
    """The fields of version 2: one moment, and targets that were all there from the start."""
    _need(document, "mean", "covariance")
    count = len(check_finite("mean", document["mean"], ndim=2))
    poses = check_finite("poses", document["poses"], ndim=2)
    moment = {name: document[name] for name in ("time", "poses", "mean", "covariance")}
    moment |= {"pose_covariances": np.zeros((len(poses), 3, 3)).tolist(), "measurements": []}
    added = {"moments": [moment], "targets": list(range(count)), "born": [0.0] * count, "next_target": count}
    return {**document, **added, "lost": [], "attack": {"sensing": [], "links": []}}


def _of_version_2(document: dict[str, Any]) -> dict[str, Any]:
    """The fields of this version: nothing was refused, and robots known to be blinded are from now on."""
    count = len(_list("targets", document["targets"]))
    moments = []
    for moment in _list("moments", document["moments"]):
        _need(moment, "measurements")
        rows = [[*row, None] for row in _rows("measurements", moment["measurements"], 3)]
        moments.append({**moment, "refused": [0] * count, "measurements": rows})
    known = _attack(document["attack"])
    blinded = [[i, document["time"]] for i in sorted(known.sensing)]
    attacks = [[document["steps"], document["attack"]]] if known != Attack() else []
    return {**document, "moments": moments, "blinded": blinded, "failed": 0, "attacks": attacks}
