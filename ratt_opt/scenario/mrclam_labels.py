"""Assignment of labels to landmarks: decided from the sightings, or given by the caller, and explained in words.

The barcode table of a dataset may name landmarks wrongly. Every sighting is compared with every landmark, seen from the
robot's pose at that time. The labelling under which most sightings fit is taken for the true one; it differs from the
table's only if the sightings are clear about it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.scenario.sensor import measure, wrap_angle

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ratt_opt._validation import BoolArray, FloatArray, IntArray

__all__ = ["LabelEvidence", "Sightings", "pose_at"]


@dataclass(frozen=True, slots=True, kw_only=True)
class LabelEvidence:
    """Number of sightings that fit as labelled, and as corrected.

    Counted are those of the corrected labels, or all if none is corrected.
    """

    sightings: int
    fit_as_labelled: int
    fit_as_corrected: int


@dataclass(frozen=True, slots=True, eq=False)
class Sightings:
    """``subjects`` (L,) of the landmarks, and ``made`` (L,) how many sightings are labelled so.

    ``fits`` (L, L) : how many of these fit each landmark; ``nearest`` (L, L) : fit it and are nearest to it.
    """

    subjects: tuple[int, ...]
    made: IntArray
    fits: IntArray
    nearest: IntArray

    @classmethod
    def of(
        cls,
        landmarks: Mapping[int, tuple[float, float]],
        subject_of: Mapping[int, int],
        poses: Sequence[FloatArray],
        measurements: Sequence[FloatArray],
    ) -> Sightings:
        """Count them; ``subject_of`` is the barcode table as it is."""
        subjects = tuple(sorted(landmarks))
        places = np.array([landmarks[subject] for subject in subjects])
        made = np.zeros(len(subjects), dtype=np.int64)
        fits, nearest = np.zeros((2, len(subjects), len(subjects)), dtype=np.int64)
        for path, rows in zip(poses, measurements, strict=True):
            inside = rows[(rows[:, 0] >= path[0, 0]) & (rows[:, 0] <= path[-1, 0])]
            named = np.array([subject_of.get(int(code), -1) for code in inside[:, 1]], dtype=np.int64)
            close, best = _fit(path, inside, places)
            for k, subject in enumerate(subjects):
                made[k] += int((named == subject).sum())
                fits[k] += close[named == subject].sum(axis=0)
                nearest[k] += best[named == subject].sum(axis=0)
        return cls(subjects, made, fits, nearest)

    def corrections(self, fewest: int = 10, clear: float = 2.0) -> dict[int, int]:
        """Subject named -> subject meant, of the labels that the sightings clearly say are exchanged.

        ``fewest`` : of their sightings that fit then; ``clear`` : times as many as fit as labelled
        """
        from scipy.optimize import linear_sum_assignment

        count = len(self.subjects)
        _, meant = linear_sum_assignment(self.nearest + 0.5 * np.eye(count), maximize=True)  # as labelled among equals
        found: dict[int, int] = {}
        for cycle in _cycles(meant.tolist()):
            labelled, corrected = (int(self.nearest[cycle, end].sum()) for end in (cycle, meant[cycle]))
            if corrected >= max(fewest, clear * labelled):
                found |= {self.subjects[k]: self.subjects[int(meant[k])] for k in cycle}
        return dict(sorted(found.items()))

    def evidence(self, corrections: Mapping[int, int]) -> LabelEvidence:
        """Count the sightings for and against these corrections."""
        place = {subject: k for k, subject in enumerate(self.subjects)}
        named = [place[subject] for subject in (corrections or self.subjects) if subject in place]
        meant = [place.get(corrections.get(self.subjects[k], self.subjects[k]), k) for k in named]
        return LabelEvidence(
            sightings=int(self.made[named].sum()),
            fit_as_labelled=int(self.fits[named, named].sum()),
            fit_as_corrected=int(self.fits[named, meant].sum()),
        )

    def told(self, corrections: Mapping[int, int], *, decided: bool) -> str:
        """Say in one line which labelling is used, who decided that, and how many sightings fit."""
        found, by = self.evidence(corrections), "as the sightings say" if decided else "as given"
        if not corrections:
            return f"labels kept, {by}: {found.fit_as_labelled} of {found.sightings} sightings fit as labelled"
        table = ", ".join(f"{named} means {meant}" for named, meant in sorted(corrections.items()))
        return (
            f"labels corrected, {by}: {table}; of {found.sightings} such sightings "
            f"{found.fit_as_labelled} fit as labelled and {found.fit_as_corrected} as corrected"
        )


def pose_at(poses: FloatArray, times: FloatArray) -> FloatArray:
    """Poses (K, 3) interpolated at ``times`` (K,) [s]; angles take the short way round."""
    x, y = (np.interp(times, poses[:, 0], poses[:, c]) for c in (1, 2))
    heading = np.interp(times, poses[:, 0], np.unwrap(poses[:, 3]))
    return np.stack([x, y, wrap_angle(heading)], axis=-1)


def _fit(
    poses: FloatArray, rows: FloatArray, places: FloatArray, within: tuple[float, float] = (1.0, 0.3)
) -> tuple[BoolArray, BoolArray]:
    """(K, L) whether each sighting fits each landmark, and whether it also is nearest to it.

    ``within`` : range and bearing of one that fits agree to within these [m], [rad]
    """
    here = pose_at(poses, rows[:, 0])
    expected = measure(here[:, None], places[None])
    close = np.abs(expected[..., 0] - rows[:, 2:3]) < within[0]
    close &= np.abs(wrap_angle(expected[..., 1] - rows[:, 3:4])) < within[1]
    angle = here[:, 2] + rows[:, 3]
    sighted = here[:, :2] + rows[:, 2:3] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    apart = np.linalg.norm(sighted[:, None] - places, axis=-1)
    return close, close & (np.arange(len(places)) == apart.argmin(axis=1)[:, None])


def _cycles(permutation: list[int]) -> list[list[int]]:
    """The cycles of a permutation that move something."""
    left, found = set(range(len(permutation))), []
    while left:
        start = k = min(left)
        cycle = []
        while k in left:
            left.remove(k)
            cycle.append(k)
            k = permutation[k]
        if len(cycle) > 1:
            found.append(cycle)
        assert k == start
    return found
