"""A robot team's own loop, stood in for by a process, drives the tracker over a pipe ten times a second.

``python -m analysis.live_loop --steps 50``

The parent is the world: it moves targets and robots, measures, and writes one line of JSON a step. The child is the
planner: it reads a line, calls ``tracker.step``, and answers with the controls. Both count what is late: the parent
answers that took longer than the period, the tracker plans that were not ready within its share of it.
"""

import argparse
import json
import subprocess
import sys
from dataclasses import dataclass
from time import monotonic, process_time, sleep

import numpy as np

from ratt_opt import Measurement, Scenario, Tracker, random_scenario
from ratt_opt.missions.sensing import simulated_readings
from ratt_opt.missions.world import MissionModel, World

PERIOD = 0.1
"""Period of a step [s]."""
SHARE = 0.7
"""Share of the period for the tracker's step; the rest is for both ends of the pipe."""


def team(seed: int) -> Scenario:
    """Ten robots and fifteen targets, as in the paper, sampled at 10 Hz."""
    return random_scenario(10, 15, alpha_s=3, alpha_c=11, seed=seed, process_std=0.1).replace(sampling_period=PERIOD)


def plan(seed: int) -> None:
    """The child: measurements in, controls out, a line each."""
    tracker = Tracker(team(seed), time_limit=SHARE * PERIOD)
    tracker.step()  # plans from the start, and loads modules
    tracker = Tracker(team(seed), time_limit=SHARE * PERIOD)
    print(json.dumps({"ready": True}), flush=True)
    for line in sys.stdin:
        message = json.loads(line)
        measurements = [Measurement(robot, target, tuple(values)) for robot, target, values in message["measured"]]
        began = process_time()
        tracker.step(measurements, message["now"])
        answer = {"controls": tracker.controls.tolist(), "missed": tracker.state.missed, "busy": process_time() - began}
        print(json.dumps(answer | {"trace": tracker.beliefs.trace}), flush=True)


@dataclass(slots=True)
class Outcome:
    """Steps and late answers, the longest answer [s], and the tracker's own count of plans it missed.

    ``busiest`` : processor time of the longest step [s], whatever else the machine does.
    """

    steps: int = 0
    late: int = 0
    longest: float = 0.0
    busiest: float = 0.0
    missed: int = 0
    trace: float = 0.0


def drive(steps: int, seed: int) -> Outcome:
    """The parent: move, measure, ask, and wait for the next period."""
    world = World(team(seed), MissionModel(), 1)
    rng = np.random.default_rng(seed)
    command = [sys.executable, "-m", "analysis.live_loop", "--child", "--seed", str(seed)]
    outcome, poses = Outcome(), world.scenario.poses
    truth = world.motion.initial(world.scenario).mean + 3.0 * rng.standard_normal((15, 2))
    measured: list[tuple[int, int, list[float]]] = []
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as child:
        assert child.stdin is not None
        assert child.stdout is not None
        child.stdout.readline()
        first = monotonic()
        for step in range(steps):
            asked = monotonic()
            print(json.dumps({"now": step * PERIOD, "measured": measured}), file=child.stdin, flush=True)
            answer = json.loads(child.stdout.readline())
            taken = monotonic() - asked
            outcome.steps, outcome.late = outcome.steps + 1, outcome.late + (taken > PERIOD)
            outcome.longest, outcome.missed = max(outcome.longest, taken), answer["missed"]
            outcome.trace, outcome.busiest = answer["trace"], max(outcome.busiest, answer["busy"])
            poses = world.move.moved(np.arange(len(poses)), poses, np.array(answer["controls"]), PERIOD)
            truth = world.motion.predict(truth, PERIOD, step * PERIOD) + 0.1 * rng.standard_normal((15, 2))
            readings = simulated_readings(world, poses, truth, rng.standard_normal((10, 15, 2)))
            measured = [(i, j, r.values[j].tolist()) for i, r in enumerate(readings) for j in range(15) if r.seen[j]]
            sleep(max(first + (step + 1) * PERIOD - monotonic(), 0.0))
        child.stdin.close()
    return outcome


def main() -> int:
    """Run the parent, or the child that it starts."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=50)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--child", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.child:
        plan(options.seed)
        return 0
    done = drive(options.steps, options.seed)
    print(
        f"{done.steps} steps at {1 / PERIOD:g} Hz: answers late {done.late}, longest {1000 * done.longest:.0f} ms "
        f"({1000 * done.busiest:.0f} ms of the processor at most); "
        f"plans missed {done.missed}; trace {done.trace:.3g} m²"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
