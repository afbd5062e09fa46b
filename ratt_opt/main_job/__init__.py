"""The main job as one call: plan, attack, bracket the optimum, prove it, list the guarantees.

Open ``bound.py`` first: the four steps in order, and how they share the time. ``result.py`` is what it returns,
``document.py`` the same as plain data (what ``report.json`` holds), ``steps.py`` tells of progress and keeps
the seconds of each step. What tables and figures show is all in the result: ``report/`` computes nothing.
"""
