"""Missions: plan, attack, measure, update, again; in simulation, over recorded data, or inside a robot's own loop.

Open ``run.py`` first: the loop of :func:`run_mission`; ``world.py`` is what one of its steps is made of, ``tracker.py``
the same driven from outside. ``memory.py`` says what each group knows, ``players/`` who plans and who attacks,
``ahead/`` looks several steps ahead; ``models/`` has motions and sensors, ``replay/`` real data, ``result.py`` what a
mission returns and ``journal.py`` what survives a kill.
"""
