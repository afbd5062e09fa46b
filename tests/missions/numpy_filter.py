"""An independent filter of one target with a known step: plain NumPy, covariance form, one stacked update.

It shares no code with the library: range, bearing, their derivatives and the second-order term are written out again.
"""

import numpy as np


def wrapped(angle):
    return (angle + np.pi) % (2 * np.pi) - np.pi


def observed(pose, point):
    """Range and bearing with first (2, 2) and second (2, 2, 2) derivatives by the point."""
    dx, dy = point - pose[:2]
    r2 = dx * dx + dy * dy
    r = np.sqrt(r2)
    value = np.array([r, wrapped(np.arctan2(dy, dx) - pose[2])])
    slope = np.array([[dx / r, dy / r], [-dy / r2, dx / r2]])
    bend_range = np.array([[dy * dy, -dx * dy], [-dx * dy, dx * dx]]) / r**3
    bend_bearing = np.array([[2 * dx * dy, dy * dy - dx * dx], [dy * dy - dx * dx, -2 * dx * dy]]) / r2**2
    return value, slope, np.stack([bend_range, bend_bearing])


def updated(mean, covariance, sightings, variances, *, second_order=True):
    """Posterior after ``sightings``: (pose (3,), values (2,), pose covariance (3, 3) or None), seen at one time.

    ``variances(distance, bearing)`` : those of the sensor. The state may be longer than the position.
    """
    d, rows, surprises, blocks = len(mean), [], [], []
    for pose, values, unsure in sightings:
        value, slope, bend = observed(pose, mean[:2])
        noise = np.diag(variances(*value))
        if second_order:
            P = covariance[:2, :2]
            noise = noise + 0.5 * np.array([[np.trace(a @ P @ b @ P) for b in bend] for a in bend])
        if unsure is not None:
            by_pose = np.hstack([-slope, [[0.0], [-1.0]]])
            noise = noise + by_pose @ unsure @ by_pose.T
        surprise = values - value
        surprise[1] = wrapped(surprise[1])
        rows.append(np.hstack([slope, np.zeros((2, d - 2))]))
        surprises.append(surprise)
        blocks.append(noise)
    if not rows:
        return mean, covariance
    H, R = np.concatenate(rows), np.zeros((2 * len(rows), 2 * len(rows)))
    for k, block in enumerate(blocks):
        R[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = block
    S = H @ covariance @ H.T + R
    gain = np.linalg.solve(S, H @ covariance).T
    joseph = np.eye(d) - gain @ H
    return mean + gain @ np.concatenate(surprises), joseph @ covariance @ joseph.T + gain @ R @ gain.T
