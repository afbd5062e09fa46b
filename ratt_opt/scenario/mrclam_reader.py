"""Read the text files of the UTIAS MRCLAM multi-robot dataset.

Source: K. Y. K. Leung, Y. Halpern, T. D. Barfoot, H. H. T. Liu, "The UTIAS Multi-Robot Cooperative
Localization and Mapping Dataset", International Journal of Robotics Research 30(8):969-974, 2011.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.errors import FileFormatError, InputError
from ratt_opt.scenario.mrclam_labels import Sightings

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ratt_opt._validation import FloatArray

__all__ = ["MrclamData", "opened_mrclam", "read_mrclam"]


_POSE_FILES = ("Robot{}_Groundtruth.dat", "Robot{}_Pose_estimated.dat")
"""Pose files in order of preference: the dataset's own ground truth, then poses estimated from its measurements."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MrclamData:
    """The tables of one dataset folder.

    ``landmarks`` : subject -> (x, y) [m]; ``subject_of`` : barcode -> subject, after corrections;
    ``corrections`` : those applied; ``inapplicable`` : those that name a subject this set does not have;
    ``labels`` : one line: which labelling is used, who decided that, and how many sightings fit;
    ``poses`` : per robot (K, 4) time [s], x [m], y [m], heading [rad];
    ``measurements`` : per robot (L, 4) time [s], barcode, range [m], bearing [rad]; ``pose_files`` : names read.
    """

    landmarks: Mapping[int, tuple[float, float]]
    subject_of: Mapping[int, int]
    corrections: Mapping[int, int]
    inapplicable: Mapping[int, int]
    labels: str
    poses: tuple[FloatArray, ...]
    measurements: tuple[FloatArray, ...]
    pose_files: tuple[str, ...]


def opened_mrclam(data: str | Path | MrclamData, corrections: Mapping[int, int] | None) -> MrclamData:
    """The dataset, read if it is a folder. InputError : corrections are given to one that is read already."""
    if not isinstance(data, MrclamData):
        return read_mrclam(data, corrections)
    if corrections is not None:
        raise InputError("corrections", "must be given if the folder is read (read_mrclam)", dict(corrections))
    return data


def read_mrclam(directory: str | Path, corrections: Mapping[int, int] | None = None) -> MrclamData:
    """Read a dataset folder: landmark and barcode tables, and each robot's poses and measurements.

    Parameters
    ----------
    directory : folder with ``Barcodes.dat``, ``Landmark_Groundtruth.dat``, ``RobotN_Measurement.dat`` and
        ``RobotN_Groundtruth.dat`` or ``RobotN_Pose_estimated.dat``, N = 1, 2, ...
    corrections : subject named in the barcode table -> subject meant, a permutation; empty for none. One that names a
        subject this set does not have is set aside in ``inapplicable``. By default the sightings decide: labels are
        exchanged if that makes many more of them fit. In dataset 1, 11 and 17 are.

    Raises
    ------
    FileFormatError : a file is missing or a line is not numbers; the text names file and line.
    InputError : the corrections are not a permutation, so that two labels would mean one subject.
    """
    folder = Path(directory)
    table = _table(folder / "Landmark_Groundtruth.dat", 3, identifiers=(0,))
    landmarks = {int(row[0]): (float(row[1]), float(row[2])) for row in table}
    barcodes = _table(folder / "Barcodes.dat", 2, identifiers=(0, 1))
    known = landmarks.keys() & set(barcodes[:, 0].astype(int).tolist())
    applied = {a: b for a, b in (corrections or {}).items() if {a, b} <= known}
    if set(applied) != set(applied.values()):
        rule = "must exchange labels: every subject named is meant once"
        raise InputError("corrections", rule, dict(corrections or {}))
    pose_files = _pose_files(folder)
    measurements = tuple(_log(folder / f"Robot{k + 1}_Measurement.dat") for k in range(len(pose_files)))
    poses = tuple(_increasing(file, _table(file, 4)) for file in pose_files)
    sightings = Sightings.of(landmarks, {int(code): int(subject) for subject, code in barcodes}, poses, measurements)
    if corrections is None:
        applied = sightings.corrections()
    return MrclamData(
        landmarks=landmarks,
        subject_of={int(code): applied.get(int(subject), int(subject)) for subject, code in barcodes},
        corrections=applied,
        inapplicable={a: b for a, b in (corrections or {}).items() if a not in applied},
        labels=sightings.told(applied, decided=corrections is None),
        poses=poses,
        measurements=measurements,
        pose_files=tuple(file.name for file in pose_files),
    )


def _pose_files(folder: Path) -> list[Path]:
    """One pose file per robot, none missing: a robot must not vanish from the team because its file did."""
    names = (re.fullmatch(r"Robot([1-9]\d{0,3})_\w+\.dat", file.name) for file in folder.glob("Robot*.dat"))
    count = max((int(name[1]) for name in names if name), default=1)
    files = []
    for number in range(1, count + 1):
        file = _pose_file(folder, number)
        if file is None:
            raise FileFormatError(
                str(folder), f"must hold {' or '.join(_POSE_FILES).format(number, number)}", "neither"
            )
        files.append(file)
    return files


def _pose_file(folder: Path, number: int) -> Path | None:
    files = (folder / name.format(number) for name in _POSE_FILES)
    return next((file for file in files if file.exists()), None)


def _log(path: Path) -> FloatArray:
    """Read a robot's measurements; there may be none."""
    return _table(path, 4, identifiers=(1,), unique=False, empty=True)


def _table(
    path: Path, columns: int, *, identifiers: tuple[int, ...] = (), unique: bool = True, empty: bool = False
) -> FloatArray:
    """The numbers of a file, at least ``columns`` on each line; ``#`` starts a comment. ``empty`` : it may have none.

    The columns ``identifiers`` hold whole numbers, in each column all different if ``unique``.
    """
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()  # some loggers write a byte-order mark
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "not UTF-8 text"
        raise FileFormatError(str(path), "must be a text file that can be read", reason) from None
    rows: list[list[float]] = []
    for number, line in enumerate(lines, start=1):
        words = line.split("#", 1)[0].split()
        if not words:
            continue
        try:
            row = [float(word) for word in words]
        except ValueError:
            row = []
        if len(row) < columns or not np.isfinite(row).all():
            raise FileFormatError(f"{path} line {number}", f"must hold {columns} finite numbers or more", line.strip())
        for c in identifiers:
            _check_identifier(f"{path} line {number}", row[c], [other[c] for other in rows] if unique else ())
        rows.append(row[:columns])
    if not rows and not empty:
        raise FileFormatError(str(path), "must hold at least one line of numbers", "none")
    return np.array(rows).reshape(-1, columns)


def _check_identifier(where: str, value: float, others: Sequence[float]) -> None:
    largest = 10**9  # far above any subject or barcode, and exact as a float
    if not (value.is_integer() and 0 <= value <= largest):
        raise FileFormatError(where, f"must name subjects and barcodes by integers in [0, {largest}]", value)
    if value in others:
        raise FileFormatError(where, "must not repeat a subject or barcode", int(value))


def _increasing(path: Path, poses: FloatArray) -> FloatArray:
    if (np.diff(poses[:, 0]) <= 0).any():
        row = int(np.argmax(np.diff(poses[:, 0]) <= 0)) + 1
        raise FileFormatError(
            str(path), "must have increasing times", f"{poses[row, 0]:.3f} after {poses[row - 1, 0]:.3f}"
        )
    return poses
