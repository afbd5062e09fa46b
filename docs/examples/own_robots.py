"""
Robots of your own, from information matrices
=============================================

Three telescopes and a drone watch two satellites. What each choice would tell is given as matrices, so nothing here
needs a motion or sensor model; names and places are for the map.
"""

import numpy as np

import ratt_opt as ro

rng = np.random.default_rng(7)
places = np.array([[0.0, 0.0], [60.0, 5.0], [35.0, 50.0], [20.0, 20.0]])
owners = np.repeat(range(4), 3)  # three directions each


def told(owner):
    """A look from one direction: much along it, nothing across."""
    h = rng.normal(size=(2, 1, 3))
    return (h.swapaxes(1, 2) @ h * (1 + owner)).tolist()


team = ro.InformationInput(
    prior=[(4.0 * np.eye(3)).tolist(), (9.0 * np.eye(3)).tolist()],
    information=[told(owner) for owner in owners],
    robot=owners.tolist(),
    labels=["low", "middle", "high"] * 4,
    alpha_s=1,
    alpha_c=1,
    links=[(0, 1), (0, 3), (1, 2), (2, 3)],
    robot_names=["north", "south", "ridge", "drone"],
    target_names=["alpha", "beta"],
    robot_positions=places.tolist(),
    target_positions=[[30.0, 30.0], [50.0, 25.0]],
)
report = ro.bound(team)
figure = report.plot()

# %%
# What each robot does, and its role under the worst attack.
report.recommended
