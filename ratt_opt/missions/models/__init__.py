"""How targets and robots move during a mission, and what sensors measure.

Open ``sensors.py`` first: the base class that a sensor of your own subclasses, and the four of the library.
``targets.py`` has the motion models of targets (position, constant velocity, coordinated turn), ``robots.py`` the two
ways in which a robot executes a control.
"""
