"""Motion of targets and robots during a mission, and the sensors of each robot.

Open ``targets.py`` first: the motion models of targets (position, constant velocity, coordinated turn). ``robots.py``
has the two ways in which a robot executes a control, ``sensors.py`` who has which sensor; the sensors themselves are
in ``scenario/sensors``.
"""
