"""How targets and robots move during a mission, and what sensors measure.

Open ``sensor_model.py`` first: the base class that a sensor of your own subclasses. ``range_bearing.py`` has the
scenario's sensor and its two halves, ``own_information.py`` sensors that state their information themselves,
``sensors.py`` positions as measurements and who has which sensor. ``targets.py`` has the motion models of targets
(position, constant velocity, coordinated turn), ``robots.py`` the two ways in which a robot executes a control.
"""
