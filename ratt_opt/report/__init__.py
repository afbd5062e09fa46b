"""Tables and figures from results; nothing is computed here but where ink goes.

Open ``write.py`` first: the files of a bound report. ``figure.py`` puts ``map.py`` (the team, its targets and the worst
attack, from ``picture.py``) beside ``bars.py`` (what each planner keeps); ``tables.py`` is the same as text.
"""
