"""The mission's loop inside a real system: measurements in, the next plan out.

Open ``tracker.py`` first. ``state.py`` has what a tracker is told and all it knows, as plain data; ``history.py`` takes
measurements in at the time they were made; ``in_time.py`` plans within a limit of seconds; ``roster.py`` is about
robots that are lost and targets that appear or vanish; ``team.py`` has a tracker in every robot.
"""
