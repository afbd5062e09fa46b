"""Sensors as classes: what they measure of a target's position, in scenarios, missions, trackers and files.

Open ``model.py`` first: the base class that a sensor of your own subclasses. ``range_bearing.py`` makes the scenario's
``Sensor`` and its two halves such classes, ``position.py`` measures positions, ``doppler.py`` range rates, too,
``spatial.py`` from a height and in three dimensions, ``own_information.py`` serves sensors
that state their information themselves. ``kinds.py`` knows sensors by the names that files give them.
"""
