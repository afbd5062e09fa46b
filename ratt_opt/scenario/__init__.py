"""The physical model: robots, targets and sensors that become a problem."""
