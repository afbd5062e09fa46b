"""How targets and robots move during a mission, and which robot measures what.

Open ``targets.py`` first: the motion models of targets (position, constant velocity, coordinated turn). ``robots.py``
has the two ways in which a robot executes a control, ``sensors.py`` who has which sensor; the sensors themselves are
in ``scenario/sensors``.
"""
