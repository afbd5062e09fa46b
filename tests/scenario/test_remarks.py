"""Numbers that can hardly be meant are remarked on, in the report and in JSON; others are not."""

import pytest

import ratt_opt as ro
from ratt_opt import InputError, Robot, Scenario, Sensor, Target

GOOD = Scenario(
    robots=[Robot(x=0.0, y=0.0), Robot(x=10.0, y=5.0)], targets=[Target(x=20.0, y=9.0)], alpha_s=1, alpha_c=0
)
NEAR = Target(x=1.0002, y=48.0003, covariance=((4.0, 0.0), (0.0, 4.0)))
CASES = {
    "a turn rate is 45 rad/s: should it be degrees": {"robots": [Robot(x=0.0, y=0.0, controls=((1.0, 45.0),))]},
    "a heading is 135 rad: should it be degrees": {"robots": [Robot(x=0.0, y=0.0, heading=135.0)]},
    "are they latitude and longitude": {
        "robots": [Robot(x=1.0001, y=48.0001, controls=((0.0, 0.0),))],
        "targets": [NEAR],
    },
    "no two robots are linked (communication_range is 1 m)": {"communication_range": 1.0},
    "no sensor sees any target": {"sensor": Sensor(max_range=0.5)},
    "process_std is per sampling period (0.2 s)": {"sampling_period": 0.2},
}


def remarks(team):
    report = ro.bound(team, time_limit=1.0, guarantees="none")
    assert list(report.remarks) == report.to_dict()["remarks"]
    return report.remarks


def test_a_good_team_has_no_remark() -> None:
    assert remarks(GOOD) == ()


@pytest.mark.parametrize("text", CASES)
def test_each_kind_has_one_remark(text: str) -> None:
    (found,) = remarks(GOOD.replace(alpha_s=0, **CASES[text]))
    assert text in found
    assert "\n" not in found


def test_links_that_are_not_there_say_why() -> None:
    with pytest.raises(InputError, match=r"alpha_c must be .*, as no two robots are within 5 m"):
        GOOD.replace(communication_range=5.0, alpha_c=2)


def test_a_certificate_of_a_model_is_about_its_file(tmp_path, capsys) -> None:
    """bound and verify with the same motion are about one problem; without it they are not."""
    from ratt_opt.cli import run

    ro.save_scenario(GOOD, tmp_path / "team.json")
    file, out = str(tmp_path / "team.json"), str(tmp_path / "out")
    assert run(["bound", file, "--out", out, "--motion", "constant velocity", "--time-limit", "20"]) == 0
    proof = [f"{out}/certificate.json", "--problem", file]
    assert run(["verify", *proof, "--motion", "constant velocity"]) == 0
    assert run(["verify", *proof]) == 1
    capsys.readouterr()
