"""A scenario file that the commands read."""

from pathlib import Path

import pytest

from ratt_opt import random_scenario, save_scenario


@pytest.fixture
def scenario_file(tmp_path: Path) -> Path:
    path = tmp_path / "scenario.json"
    save_scenario(random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=5), path)
    return path
