"""One sensor class everywhere: scenarios, missions, trackers, files; by registration and by entry points."""

import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import jsonschema
import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.scenario.sensors import kinds

SONAR = """
from dataclasses import dataclass
import numpy as np
import ratt_opt as ro


@dataclass(frozen=True)
class Sonar(ro.SensorModel):
    std: float = 0.5
    size = 1

    def measure(self, poses, points):
        return np.linalg.norm(points - poses[..., :2], axis=-1, keepdims=True)

    def noise(self, poses, points):
        return np.broadcast_to(self.std**2, (*np.broadcast_shapes(poses.shape[:-1], points.shape[:-1]), 1))
"""
"""A sensor of one's own in twelve lines: what it measures and how well."""


@dataclass(frozen=True)
class Sonar(ro.SensorModel):
    """The range, with a constant standard deviation, up to a reach."""

    std: float = 0.5
    reach: float = 1e6
    size: ClassVar[int] = 1

    def measure(self, poses, points):
        return np.linalg.norm(points - poses[..., :2], axis=-1, keepdims=True)

    def noise(self, poses, points):
        return np.broadcast_to(self.std**2, (*np.broadcast_shapes(poses.shape[:-1], points.shape[:-1]), 1))

    def sees(self, poses, points):
        return np.linalg.norm(points - poses[..., :2], axis=-1) <= self.reach


class Noisy(ro.Sensor):
    """A range-and-bearing sensor with a field of its own."""

    factor: float = 2.0

    def noise_variances(self, distance, bearing):
        a, b = super().noise_variances(distance, bearing)
        return self.factor * a, self.factor * b


@pytest.fixture
def registry(monkeypatch: pytest.MonkeyPatch) -> dict[str, type]:
    registered: dict[str, type] = {}
    monkeypatch.setattr(kinds, "_registered", registered)
    return registered


def team(sensor: object) -> ro.Scenario:
    return ro.random_scenario(4, 3, alpha_s=1, alpha_c=1, seed=3).replace(sensor=sensor)


def test_the_same_class_plans_and_flies_everywhere() -> None:
    """A scenario's sensor, a model's sensor, and RangeOnly with the same noise state the same information."""
    own = team(Sonar(0.5))
    plain = team(ro.Sensor(range_noise=0.25, range_noise_slope=0.0))
    same = ro.RangeOnly(plain.sensor)
    np.testing.assert_allclose(own.information, team(same).information, rtol=1e-8, atol=1e-9)

    def fly(scenario: ro.Scenario, sensor: object) -> np.ndarray:
        """Without choices, which equal values up to rounding would let differ."""
        first = {"planner": lambda p: [own[0] for own in p.choices], "attacker": "none"}
        return ro.run_mission(scenario, steps=3, seed=1, model=ro.MissionModel(sensor=sensor), **first).rmse

    assert np.array_equal(fly(own, None), fly(plain, Sonar(0.5)))
    np.testing.assert_allclose(fly(own, None), fly(plain, "range"), rtol=1e-5)
    report = ro.bound(own, time_limit=20, guarantees="none")
    assert 0 < report.optimum.lower <= report.upper


def test_derivatives_need_not_be_written() -> None:
    rng = np.random.default_rng(0)
    poses, points = rng.uniform(-5, 5, (20, 3)), rng.uniform(8, 2000, (20, 2))
    exact, own = ro.RangeOnly(ro.Sensor()), Sonar()
    np.testing.assert_allclose(own.jacobian(poses, points), exact.jacobian(poses, points), atol=1e-8)
    np.testing.assert_allclose(own.hessian(poses, points), exact.hessian(poses, points), atol=1e-6)
    assert own.jacobian(poses[:, None], points[None]).shape == (20, 20, 1, 2)


def test_angles_of_a_sensor_without_derivatives_wrap() -> None:
    @dataclass(frozen=True)
    class Compass(ro.SensorModel):
        size: ClassVar[int] = 1
        angles: ClassVar[tuple[int, ...]] = (0,)

        def measure(self, poses, points):
            return ro.BearingOnly(ro.Sensor()).measure(poses, points)

        def noise(self, poses, points):
            return np.full((*np.broadcast_shapes(poses.shape[:-1], points.shape[:-1]), 1), 0.01)

    pose, behind = np.zeros(3), np.array([-10.0, 0.0])  # the bearing jumps from pi to -pi there
    exact = ro.BearingOnly(ro.Sensor())
    np.testing.assert_allclose(Compass().jacobian(pose, behind), exact.jacobian(pose, behind), atol=1e-9)


def test_tracker_takes_it_from_the_scenario() -> None:
    tracker = ro.Tracker(team(Sonar(0.5)))
    plan = tracker.step([])
    assert len(plan.elements) == 4
    tracker.step([ro.Measurement(robot=0, target=1, values=[30.0])])


def test_simulated_tracking_takes_it() -> None:
    own = team(Sonar(0.5))
    plan = ro.ratt(own.problem()).elements
    found = ro.simulate_tracking(own, plan, range(4), seed=1, draws=400)
    assert 0.5 < found.mse / found.trace < 2


@pytest.mark.usefixtures("registry")
@pytest.mark.parametrize("sensor", [Sonar(0.7), Noisy(factor=3.0)])
def test_registered_sensors_go_through_files(tmp_path: Path, sensor) -> None:
    with pytest.raises(ro.InputError, match="must be the library's Sensor or a registered one to be saved"):
        ro.save_scenario(team(sensor), tmp_path / "team.json")
    assert ro.register_sensor("mine", type(sensor)) is type(sensor)
    ro.register_sensor("mine", type(sensor))  # again: as when a notebook's cell runs twice
    mixed = team(sensor)
    robots = (mixed.robots[0].replace(sensor=ro.PositionSensor(2.0)), *mixed.robots[1:])
    mixed = mixed.replace(robots=robots)
    ro.save_scenario(mixed, tmp_path / "team.json")
    read = ro.load_scenario(tmp_path / "team.json")
    assert read == mixed
    assert read.digest == mixed.digest
    assert np.array_equal(read.information, mixed.information)
    document = json.loads((tmp_path / "team.json").read_text())
    assert document["sensor"]["kind"] == "mine"
    assert document["robots"][0]["sensor"] == {"kind": "position", "std": 2.0, "max_range": None}
    jsonschema.validate(document, ro.scenario_schema())
    assert ro.bound(mixed, time_limit=20, guarantees="none").to_dict()["input"]["document"] == document


def test_a_certificate_is_recognised_with_the_file_of_its_sensor(tmp_path: Path) -> None:
    from ratt_opt.certificates.agreement import differences

    own = team(ro.BearingOnly(ro.Sensor()))
    ro.bound(own, time_limit=30, certificate=tmp_path / "c.json")
    ro.verify_certificate(tmp_path / "c.json", expected_problem=differences(own, "trace"))
    other = team(ro.BearingOnly(ro.Sensor(bearing_noise=0.003)))
    with pytest.raises(ro.ProofError, match="field 'information' differs"):
        ro.verify_certificate(tmp_path / "c.json", expected_problem=differences(other, "trace"))


def test_parts_of_the_librarys_sensor_have_names_in_files(tmp_path: Path) -> None:
    drones = team(ro.BearingOnly(ro.Sensor(bearing_noise=0.01)))
    ro.save_scenario(drones, tmp_path / "drones.json")
    document = json.loads((tmp_path / "drones.json").read_text())
    assert document["sensor"]["kind"] == "bearing"
    assert document["sensor"]["bearing_noise"] == 0.01
    assert ro.load_scenario(tmp_path / "drones.json") == drones


@pytest.mark.parametrize(
    ("sensor", "text"),
    [
        (
            {"kind": "sonar"},
            r"sensor.kind must be range, bearing, position,.*spherical, or offered by",
        ),
        ({"kind": 3}, "sensor.kind must be text; got int"),
        ({"kind": "position", "std": -1.0}, "sensor.std must be positive; got -1"),
        ({"kind": "position", "sdt": 1.0}, "sensor must have the fields of PositionSensor; got .*sdt"),
        ({"kind": "bearing", "range_noise": -1.0}, "sensor.range_noise must be >= 1e-12"),
        ({"range_noise": -1.0}, "sensor.range_noise must be >= 1e-12"),
        ({"range_nose": 1.0}, "sensor.range_nose is not a field"),
        (3.0, "sensor must be an object"),
    ],
)
def test_bad_sensors_of_files_are_one_line(tmp_path: Path, sensor, text) -> None:
    document = ro.random_scenario(2, 2, alpha_s=1, alpha_c=0, seed=1).model_dump(mode="json")
    (tmp_path / "team.json").write_text(json.dumps({**document, "sensor": sensor}))
    with pytest.raises(ro.FileFormatError, match=text):
        ro.load_scenario(tmp_path / "team.json")


class NoDataclass(ro.SensorModel):
    size = 1

    def measure(self, poses, points):
        raise NotImplementedError

    def noise(self, poses, points):
        raise NotImplementedError


@dataclass(frozen=True)
class WithKind(Sonar):
    kind: str = "x"


@pytest.mark.parametrize(
    ("kind", "sensor", "text"),
    [
        ("bearing", Sonar, "kind must not be another sensor's"),
        ("", Sonar, "kind must be one line"),
        ("x", NoDataclass, "must name a dataclass"),
        ("x", WithKind, "without a field 'kind'"),
        ("x", int, "must name a subclass of Sensor or SensorModel"),
    ],
)
def test_registrations_that_files_could_not_keep_are_refused(registry, kind, sensor, text) -> None:
    with pytest.raises(ro.InputError, match=text):
        ro.register_sensor(kind, sensor)
    assert registry == {}


@pytest.mark.parametrize("part", [ro.BearingOnly, ro.RangeOnly, ro.RangeBearing])
def test_a_part_of_a_sensor_of_one_s_own_has_no_name_in_files(part, tmp_path: Path) -> None:
    """A file would hold the fields and lose the class: another problem than the one that was planned."""
    divers = team(part(Noisy(factor=50.0)))
    with pytest.raises(ro.InputError, match="to_information"):
        ro.save_scenario(divers, tmp_path / "divers.json")
    report = ro.bound(divers, time_limit=5, guarantees="none").to_dict()
    (tmp_path / "input.json").write_text(json.dumps(report["input"]["document"]))
    again = ro.load_input(tmp_path / "input.json").problem()
    value = again.team_value(report["recommended"]["elements"], ro.Attack())
    assert value == pytest.approx(divers.problem().team_value(report["recommended"]["elements"], ro.Attack()))


def test_a_part_of_another_sensor_is_refused() -> None:
    with pytest.raises(
        ro.InputError, match=r"sensor must be absent, or Sonar of robots\[0\] a range-and-bearing Sensor"
    ):
        ro.run_mission(team(Sonar()), steps=1, model=ro.MissionModel(sensor="bearing"))


def test_an_installed_package_offers_sensors_to_files_and_commands(tmp_path: Path) -> None:
    """Entry points as an installed distribution has them: a folder beside the module."""
    (tmp_path / "sonar_pack.py").write_text(SONAR)
    info = tmp_path / "sonar_pack-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: sonar-pack\nVersion: 1.0\n")
    entries = "[ratt_opt.sensors]\nsonar = sonar_pack:Sonar\nlost = no_such_module:Sonar\n"
    (info / "entry_points.txt").write_text(entries)
    drones = ro.random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=3)
    document = drones.model_dump(mode="json") | {"sensor": {"kind": "sonar", "std": 0.25}}
    (tmp_path / "team.json").write_text(json.dumps(document))
    (tmp_path / "lost.json").write_text(json.dumps({**document, "sensor": {"kind": "lost"}}))
    ro.save_scenario(drones, tmp_path / "plain.json")

    def command(*arguments: str) -> subprocess.CompletedProcess[str]:
        code = f"import sys; sys.path.insert(0, {str(tmp_path)!r}); from ratt_opt.cli import main; sys.exit(main())"
        return subprocess.run(
            [sys.executable, "-c", code, *arguments], cwd=tmp_path, capture_output=True, text=True, check=False
        )

    done = command("bound", "team.json", "--out", "out", "--guarantees", "none", "--json")
    assert done.returncode == 0, done.stderr
    kept = json.loads(done.stdout)["optimum"]
    same = ro.bound(drones.replace(sensor=ro.RangeOnly(ro.Sensor(range_noise=0.0625, range_noise_slope=0.0))))
    assert kept["lower"] == pytest.approx(same.optimum.lower, rel=1e-6)
    assert command("track", "team.json", "--steps", "2", "--out", "flight").returncode == 0
    assert command("track", "plain.json", "--sensor", "sonar", "--steps", "2", "--out", "named").returncode == 0
    missing = command("track", "plain.json", "--sensor", "radar", "--steps", "2", "--out", "missing")
    assert missing.returncode == 2
    assert "sensor must be range and bearing, range, bearing, position, doppler, " in missing.stderr
    lost = command("bound", "lost.json", "--out", "x")
    assert lost.returncode == 2
    assert (
        "must be offered by a package that can be imported; got lost (No module named 'no_such_module')" in lost.stderr
    )


@pytest.mark.parametrize(
    "returned",
    [
        lambda given: given[0],
        sum,
        lambda given: (*given, given[0]),
        lambda _: 1.0,
        lambda _: None,
        lambda given: (given[0], given[1][..., :1, None, None]),
        lambda given: ("a", given[0]),
    ],
)
@pytest.mark.parametrize("n_robots", [1, 2, 3])
def test_variances_that_are_not_two_are_refused_in_one_line(returned, n_robots):
    class Own(ro.Sensor):
        def noise_variances(self, distance, bearing):
            return returned((distance, bearing))

    team = ro.random_scenario(n_robots, 2, alpha_s=0, alpha_c=0, seed=0)
    rule = r"noise_variances of Own must be two arrays of shape \(.*\), of range \[m\^2\] and bearing \[rad\^2\]; got"
    with pytest.raises(ro.InputError, match=rule):
        team.replace(sensor=Own()).problem()


def test_two_variances_may_be_one_array_or_numbers():
    class Stacked(ro.Sensor):
        def noise_variances(self, distance, bearing):
            return np.stack(super().noise_variances(distance, bearing))

    class Constant(ro.Sensor):
        def noise_variances(self, *_):
            return 2.0, 0.25

    team = ro.random_scenario(3, 2, alpha_s=0, alpha_c=0, seed=0)
    same = team.replace(sensor=Stacked()).problem().information_objective.information
    assert np.array_equal(same, team.problem().information_objective.information)
    assert team.replace(sensor=Constant()).problem().information_objective.information.any()
