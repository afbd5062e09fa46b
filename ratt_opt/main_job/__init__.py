"""The main job as one call: plan, attack, bracket the optimum, prove it, list the guarantees.

Open ``bound.py`` first: the four steps in order, how they share the time, and what is told meanwhile. ``result.py`` is
what it returns, also as plain data (what ``report.json`` holds). What tables and figures show is
all in the result: ``report/`` computes nothing.
"""
