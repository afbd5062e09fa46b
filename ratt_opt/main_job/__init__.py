"""The main job as one call: plan, attack, bracket the optimum, prove it, list the guarantees.

Open ``bound.py`` first: the steps in order, and how they share the time. ``assessment.py`` puts one plan under attack,
``result.py`` is what the call returns: the data of ``findings.py``, and how they are saved and shown. What tables
and figures show is all in the result.
"""
