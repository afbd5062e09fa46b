"""Reading the MRCLAM text format: a tiny synthetic set always, the real data where it is present."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratt_opt import (
    FileFormatError,
    FittedSensor,
    InputError,
    ReplaySettings,
    Scenario,
    fit_sensor,
    from_mrclam,
    ratt,
    read_mrclam,
    replay_mrclam,
    worst_case_attack,
)
from ratt_opt.scenario.mrclam_labels import Sightings
from tests.brackets import is_exact

REAL = Path(__file__).resolve().parents[3] / "shared" / "data" / "mrclam"
START = 1248272276.0
LANDMARKS = {6: (3.0, 0.0), 11: (0.0, 3.0), 17: (-3.0, 0.0)}
REPLAY = {
    "steps": 2,
    "settings": ReplaySettings(start=0.0, period=1.0, cameras=1, alpha_c=1),
    "sensor": FittedSensor(law="std", range_noise=0.05, bearing_noise=0.02),
}
BARCODES = {1: 5, 2: 14, 6: 72, 11: 18, 17: 61}


def _synthetic(folder: Path, *, swapped: bool = True) -> Path:
    """Two robots that turn on the spot; ``swapped``: barcodes 18 and 61 are each seen at the other's landmark."""
    header = "# a comment\n#Subject x y\n"
    (folder / "Landmark_Groundtruth.dat").write_text(
        header + "".join(f"{s}\t{x}\t{y}\t0.0001\t0.0001\n" for s, (x, y) in LANDMARKS.items())
    )
    (folder / "Barcodes.dat").write_text(header + "".join(f" {s} \t {b}\n" for s, b in BARCODES.items()))
    seen_as = {6: 72, 11: 61 if swapped else 18, 17: 18 if swapped else 61}
    for robot, (x, y) in enumerate([(0.0, 0.0), (0.5, 0.5)], start=1):
        poses, sightings = [], []
        for k in range(8):
            heading = math.remainder(3.0 + 0.2 * k, 2 * math.pi)
            poses.append(f"{START + k:.3f}\t{x}\t{y}\t{heading:.9f}\t0.01\t0.01\t0.01")
            for subject, (u, v) in LANDMARKS.items():
                bearing = math.remainder(math.atan2(v - y, u - x) - heading, 2 * math.pi)
                sightings.append(f"{START + k:.3f}\t{seen_as[subject]}\t{math.hypot(u - x, v - y):.3f}\t{bearing:.3f}")
        sightings.append(f"{START + 3:.3f}\t43\t1.0\t0.0")
        (folder / f"Robot{robot}_Pose_estimated.dat").write_text(header + "\n".join(poses) + "\n")
        (folder / f"Robot{robot}_Measurement.dat").write_text(header + "\n".join(sightings) + "\n")
    return folder


def test_a_scenario_from_the_synthetic_set(tmp_path: Path) -> None:
    scenario = from_mrclam(_synthetic(tmp_path), 2.5, alpha_s=1, alpha_c=1)
    assert isinstance(scenario, Scenario)
    assert scenario.n_robots == 2
    assert [t.name for t in scenario.targets] == ["landmark 6", "landmark 11", "landmark 17"]
    assert [(t.x, t.y) for t in scenario.targets] == list(LANDMARKS.values())
    # The heading passes pi between rows 0 and 1: interpolation takes the short way round.
    early = from_mrclam(tmp_path, 0.9, alpha_s=0, alpha_c=0)
    assert early.robots[0].heading == pytest.approx(math.remainder(3.18, 2 * math.pi), abs=1e-7)
    assert from_mrclam(tmp_path, START + 2.5, alpha_s=1, alpha_c=1) == scenario
    found = "11 means 17, 17 means 11; of 32 such sightings 0 fit as labelled and 32 as corrected"
    assert scenario.notes[1] == f"labels corrected, as the sightings say: {found}"
    assert scenario.notes[2] == "2 measurements with unlisted barcodes ignored: [43]"
    assert scenario.sensor.law == "std"


def test_right_labels_are_kept_and_wrong_ones_exchanged_never_in_silence(tmp_path: Path) -> None:
    right, wrong = tmp_path / "right", tmp_path / "wrong"
    for folder in (right, wrong):
        folder.mkdir()
        _synthetic(folder, swapped=folder == wrong)
    kept, exchanged = read_mrclam(right), read_mrclam(wrong)
    assert kept.corrections == {}
    assert kept.labels == "labels kept, as the sightings say: 48 of 48 sightings fit as labelled"
    assert exchanged.corrections == {11: 17, 17: 11}
    assert (exchanged.subject_of[18], exchanged.subject_of[61]) == (17, 11)
    for data in (kept, exchanged):
        assert from_mrclam(data, 0, alpha_s=0, alpha_c=0).notes[1] == data.labels
    assert [fit_sensor(folder).labels for folder in (right, wrong)] == [kept.labels, exchanged.labels]


def test_what_the_caller_says_of_labels_counts_whatever_the_sightings_say(tmp_path: Path) -> None:
    _synthetic(tmp_path, swapped=False)
    found = "of 32 such sightings 32 fit as labelled and 0 as corrected"
    told = f"labels corrected, as given: 11 means 17, 17 means 11; {found}"
    exchange = {11: 17, 17: 11}
    assert read_mrclam(tmp_path, exchange).corrections == exchange
    assert from_mrclam(tmp_path, 0, alpha_s=0, alpha_c=0, corrections=exchange).notes[1] == told
    assert fit_sensor(tmp_path, corrections=exchange).labels == told
    assert replay_mrclam(tmp_path, corrections=exchange, **REPLAY).labels == told
    assert "labels kept, as the sightings say" in repr(replay_mrclam(tmp_path, **REPLAY))
    plain = read_mrclam(tmp_path, {})
    assert plain.labels == "labels kept, as given: 48 of 48 sightings fit as labelled"
    for call in (
        lambda: from_mrclam(plain, 0, alpha_s=0, alpha_c=0, corrections={}),
        lambda: fit_sensor(plain, corrections={}),
        lambda: fit_sensor(*[np.ones(30)] * 4, corrections={}),
        lambda: replay_mrclam(plain, steps=1, corrections={}),
    ):
        with pytest.raises(InputError, match=r"corrections must (be given if|come with)"):
            call()


def test_a_robot_that_saw_nothing_and_a_byte_order_mark(tmp_path: Path) -> None:
    _synthetic(tmp_path)
    before = read_mrclam(tmp_path)
    for file in tmp_path.iterdir():
        file.write_bytes(b"\xef\xbb\xbf" + file.read_bytes())
    assert read_mrclam(tmp_path).labels == before.labels
    (tmp_path / "Robot2_Measurement.dat").write_text("# nothing\n")
    data = read_mrclam(tmp_path)
    assert data.measurements[1].shape == (0, 4)
    assert data.corrections == {11: 17, 17: 11}
    assert from_mrclam(tmp_path, 2.5, alpha_s=1, alpha_c=1).n_robots == 2
    fit_sensor(tmp_path)
    assert len(replay_mrclam(tmp_path, **REPLAY).steps) == 2


@settings(max_examples=40)
@given(seed=st.integers(0, 10_000))
def test_the_labelling_that_was_drawn_is_the_one_that_is_found(seed: int) -> None:
    """Landmarks more than half a metre apart, labels exchanged at random, one sighting in ten a misread."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 7))
    places = rng.permutation(36)[:count, None] // [[1, 6]] % 6 * 0.7 + rng.uniform(0, 0.1, (count, 2))
    moved = rng.permutation(count)
    meant = np.arange(count)
    chosen = np.sort(moved[: int(rng.integers(0, count + 1))])
    meant[chosen] = rng.permutation(chosen)
    poses = np.column_stack([np.arange(40.0), rng.uniform(-1, 5, (40, 2)), rng.uniform(-3, 3, 40)])
    rows = []
    for time, *pose in poses.tolist():
        for label in range(count):
            place = places[meant[label] if rng.random() < 0.9 else rng.integers(count)]
            delta = place - pose[:2]
            noise = rng.normal(size=2) * [0.03, 0.01]
            rows.append([time, label, np.hypot(*delta) + noise[0], np.arctan2(*delta[::-1]) - pose[2] + noise[1]])
    landmarks = {label: tuple(place) for label, place in enumerate(places.tolist())}
    found = Sightings.of(landmarks, {label: label for label in landmarks}, [poses], [np.array(rows)])
    assert found.corrections() == {k: int(m) for k, m in enumerate(meant) if k != m}


def test_few_sightings_decide_nothing() -> None:
    poses = np.array([[0.0, 0.0, 0.0, 0.0], [9.0, 0.0, 0.0, 0.0]])
    rows = np.array([[float(k), k % 2, 3.0, (1 - k % 2) * 1.0] for k in range(9)])
    landmarks = {0: (3.0, 0.0), 1: (3 * np.cos(1.0), 3 * np.sin(1.0))}
    found = Sightings.of(landmarks, {0: 0, 1: 1}, [poses], [rows])
    assert found.fits.tolist() == [[0, 5], [4, 0]]
    assert found.corrections() == {}
    more = Sightings.of(landmarks, {0: 0, 1: 1}, [poses], [np.concatenate([rows, rows])])
    assert more.corrections() == {0: 1, 1: 0}


def test_corrections_of_absent_subjects_are_set_aside_and_noted(tmp_path: Path) -> None:
    _synthetic(tmp_path)
    landmarks = tmp_path / "Landmark_Groundtruth.dat"
    landmarks.write_text(
        "".join(line for line in landmarks.read_text().splitlines(keepends=True) if not line.startswith("17"))
    )
    scenario = from_mrclam(tmp_path, 0, alpha_s=0, alpha_c=0, corrections={11: 17, 17: 11})
    assert scenario.notes[2].endswith("their subjects are not in this set: 11 means 17, 17 means 11")


@pytest.mark.parametrize("corrections", [{11: 17}, {11: 17, 6: 17}])
def test_corrections_must_be_a_permutation(tmp_path: Path, corrections: dict[int, int]) -> None:
    with pytest.raises(InputError, match="corrections must exchange labels"):
        from_mrclam(_synthetic(tmp_path), 0, alpha_s=0, alpha_c=0, corrections=corrections)


def test_no_robot_vanishes_with_its_pose_file(tmp_path: Path) -> None:
    _synthetic(tmp_path)
    (tmp_path / "Robot3_Measurement.dat").write_text(f"{START} 5 1 1\n")
    with pytest.raises(FileFormatError, match=r"must hold Robot3_Groundtruth.dat or Robot3_Pose_estimated.dat"):
        from_mrclam(tmp_path, 0, alpha_s=0, alpha_c=0)


def test_a_negative_standard_deviation_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="prior_std must be positive; got -1"):
        from_mrclam(_synthetic(tmp_path), 0, alpha_s=0, alpha_c=0, prior_std=-1.0)


def test_ground_truth_is_preferred_to_estimates(tmp_path: Path) -> None:
    _synthetic(tmp_path)
    truth = "\n".join(f"{START + k} 9 9 0" for k in range(8))
    (tmp_path / "Robot1_Groundtruth.dat").write_text(truth)
    scenario = from_mrclam(tmp_path, 1.0, alpha_s=0, alpha_c=0, corrections={})
    assert (scenario.robots[0].x, scenario.robots[1].x) == (9.0, 0.5)
    assert "Robot1_Groundtruth.dat" in scenario.notes[0]


@pytest.mark.parametrize(
    ("file", "line", "text"),
    [
        ("Barcodes.dat", "7 x", r"Barcodes.dat line 8 must hold 2 finite numbers"),
        ("Landmark_Groundtruth.dat", "7 1.0", r"line 6 must hold 3 finite numbers or more; got 7 1.0"),
        ("Robot2_Measurement.dat", "1248272276 5 nan 0", r"Robot2_Measurement.dat line \d+ must hold 4 finite"),
        ("Barcodes.dat", "7.5 90", r"Barcodes.dat line 8 must name subjects and barcodes by integers"),
        ("Barcodes.dat", "7 72", r"Barcodes.dat line 8 must not repeat a subject or barcode; got 72"),
        ("Landmark_Groundtruth.dat", "6 1 1", r"line 6 must not repeat a subject or barcode; got 6"),
        ("Robot1_Measurement.dat", "1248272277 1e30 1 1", r"line \d+ must name subjects and barcodes by integers"),
        ("Robot1_Pose_estimated.dat", "1 2 3 4", "must have increasing times; got 1.000 after"),
    ],
)
def test_malformed_lines_are_named(tmp_path: Path, file: str, line: str, text: str) -> None:
    _synthetic(tmp_path)
    with (tmp_path / file).open("a") as handle:
        handle.write(line + "\n")
    with pytest.raises(FileFormatError, match=text):
        from_mrclam(tmp_path, 0, alpha_s=0, alpha_c=0)


@pytest.mark.parametrize("file", ["Barcodes.dat", "Landmark_Groundtruth.dat", "Robot2_Measurement.dat"])
def test_missing_files_are_named(tmp_path: Path, file: str) -> None:
    (_synthetic(tmp_path) / file).unlink()
    with pytest.raises(FileFormatError, match=f"{file} must be a text file that can be read; got No such file"):
        from_mrclam(tmp_path, 0, alpha_s=0, alpha_c=0)


def test_an_empty_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match=r"Landmark_Groundtruth\.dat"):
        from_mrclam(tmp_path, 0, alpha_s=0, alpha_c=0)


@pytest.mark.parametrize("time", [-0.1, 7.5, START - 1, START + 8])
def test_times_outside_the_poses_are_refused(tmp_path: Path, time: float) -> None:
    with pytest.raises(InputError, match=r"time must be in \[0, 7.000\] seconds since the start"):
        from_mrclam(_synthetic(tmp_path), time, alpha_s=0, alpha_c=0)


def test_times_in_a_gap_are_refused(tmp_path: Path) -> None:
    _synthetic(tmp_path)
    file = tmp_path / "Robot2_Pose_estimated.dat"
    kept = [
        line for line in file.read_text().splitlines() if not line.startswith((f"{START + 3:.3f}", f"{START + 4:.3f}"))
    ]
    file.write_text("\n".join(kept))
    with pytest.raises(InputError, match=r"must not fall between poses more than 2.0 s apart \(robot 2\)"):
        from_mrclam(tmp_path, 3.5, alpha_s=0, alpha_c=0)
    assert from_mrclam(tmp_path, 5.0, alpha_s=0, alpha_c=0).n_robots == 2


@pytest.mark.skipif(not REAL.is_dir(), reason=f"the MRCLAM data is not at {REAL}")
def test_the_real_dataset() -> None:
    data = read_mrclam(REAL)
    assert data.corrections == {11: 17, 17: 11}
    found = re.search(r"of (\d+) such sightings 0 fit as labelled and (\d+) as corrected", data.labels)
    assert found is not None
    assert int(found[1]) == int(found[2]) > 3600
    scenario = from_mrclam(REAL, 600.0, alpha_s=1, alpha_c=4)
    assert (scenario.n_robots, scenario.n_targets) == (5, 15)
    seen = (np.abs(scenario.information).max(axis=(2, 3)) > 0).sum(axis=1)
    assert seen.max() > 3
    problem = scenario.problem()
    plan = ratt(problem).elements
    result = worst_case_attack(problem, plan)
    assert result.lower > 0
    assert is_exact(problem, plan, result)


@pytest.mark.skipif(not REAL.is_dir(), reason=f"the MRCLAM data is not at {REAL}")
@pytest.mark.parametrize("pairs", [[(11, 17)], [(11, 17), (6, 7)], [(6, 7)], [(6, 12), (12, 20)]])
def test_the_real_dataset_with_other_labels(tmp_path: Path, pairs: list[tuple[int, int]]) -> None:
    """A copy whose barcode table is changed: with 11 and 17 exchanged its labels are right, and are kept."""
    for file in REAL.glob("*.dat"):
        (tmp_path / file.name).write_bytes(file.read_bytes())
    rows = [line.split() for line in (REAL / "Barcodes.dat").read_text().splitlines() if not line.startswith("#")]
    code = {int(row[0]): int(row[1]) for row in rows if row}
    before = dict(code)
    for a, b in pairs:
        code[a], code[b] = code[b], code[a]
    (tmp_path / "Barcodes.dat").write_text("".join(f"{subject} {number}\n" for subject, number in code.items()))
    truth = {before[s]: {11: 17, 17: 11}.get(s, s) for s in before}
    data = read_mrclam(tmp_path)
    assert {number: data.subject_of[number] for number in truth} == truth
    if pairs == [(11, 17)]:
        assert data.corrections == {}
        assert fit_sensor(data).outliers < 0.02
        assert "labels kept, as the sightings say: 2746" in from_mrclam(data, 300.0, alpha_s=1, alpha_c=4).notes[1]
