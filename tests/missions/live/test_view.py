"""The live view: what is handed to Rerun, by a stand-in of its interface; where it is installed, a whole file."""

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ratt_opt as ro

TEAM = ro.random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=0, communication_range=200.0)


class Stream:
    """Everything that a recording is told, in order."""

    def __init__(self, application: str) -> None:
        self.told: list[tuple[str, Any]] = [("application", application)]

    def log(self, where: str, what: Any) -> None:
        self.told.append((where, what))

    def set_time(self, timeline: str, *, duration: float) -> None:
        self.told.append((timeline, duration))

    def save(self, path: str) -> None:
        self.told.append(("save", path))

    def spawn(self) -> None:
        self.told.append(("spawn", None))

    def flush(self) -> None:
        self.told.append(("flush", None))

    def disconnect(self) -> None:
        self.told.append(("disconnect", None))


@pytest.fixture
def streams(monkeypatch: pytest.MonkeyPatch) -> list[Stream]:
    """A stand-in for the module ``rerun``: marks are their arguments."""
    made: list[Stream] = []

    def stream(application: str) -> Stream:
        made.append(Stream(application))
        return made[-1]

    def mark(*given: Any, **look: Any) -> dict[str, Any]:
        return {"given": given, **look}

    names = ("Points2D", "Arrows2D", "LineStrips2D", "Scalars")
    monkeypatch.setitem(sys.modules, "rerun", SimpleNamespace(RecordingStream=stream, **dict.fromkeys(names, mark)))
    return made


def test_a_tracker_is_shown_as_it_runs(streams: list[Stream]) -> None:
    tracker = ro.Tracker(TEAM)
    with ro.LiveView() as view:
        plan = tracker.step([ro.Measurement(0, 99, (1.0, 0.0))])
        tracker.lose(2)
        tracker.attacked(ro.Attack(frozenset({1}), frozenset()))
        view.show(tracker, plan)
    told = dict(streams[0].told)
    assert [name for name, _ in streams[0].told][:2] == ["application", "spawn"]
    assert [name for name, _ in streams[0].told][-2:] == ["flush", "disconnect"]
    np.testing.assert_array_equal(told["map/robots"]["given"][0], tracker.state.poses[:, :2])
    assert len({tuple(colour) for colour in told["map/robots"]["colors"]}) == 3  # one sees, one is blinded, one is lost
    assert tracker.links == {(0, 1)}
    np.testing.assert_array_equal(told["map/links"]["given"][0], [tracker.state.poses[[0, 1], :2]])
    np.testing.assert_array_equal(told["map/estimates"]["given"][0], tracker.beliefs.positions)
    for outline, centre, spread in zip(
        told["map/uncertainty"]["given"][0], tracker.beliefs.positions, tracker.beliefs.position_covariance, strict=True
    ):
        offset = outline - centre
        squares = np.einsum("ki,ij,kj->k", offset, np.linalg.inv(spread), offset)
        np.testing.assert_allclose(squares, -2 * np.log(0.05), rtol=1e-9)
    assert told["numbers/skipped"]["given"] == (1.0,)


def test_without_rerun_the_extra_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setitem(sys.modules, "rerun", None)
    with pytest.raises(ro.InputError, match=r"pip install ratt-opt\[live\]"):
        ro.LiveView()
    with pytest.raises(ro.InputError, match=r"pip install ratt-opt\[live\]"):
        ro.run_mission(TEAM, steps=1).animate(tmp_path / "out.rrd")
    assert list(tmp_path.iterdir()) == []


def test_a_file_for_rerun_is_whole(tmp_path: Path) -> None:
    pytest.importorskip("rerun")
    tracker = ro.Tracker(TEAM)
    with ro.LiveView(tmp_path / "live.rrd") as view:
        for _ in range(3):
            view.show(tracker, tracker.step())
    file = ro.run_mission(TEAM, steps=2).animate(tmp_path / "mission.rrd")
    assert all(
        path.read_bytes()[:4] == b"RRF2" and path.stat().st_size > 1000 for path in (file, tmp_path / "live.rrd")
    )
