"""Criteria of the uncertainty about targets: one file per criterion, and one registry.

Open ``trace.py`` first: a criterion is a subclass of ``InformationObjective`` (``../information.py``) that owns its
name, unit, value, supergradient and, optionally, a Fenchel cut, bounds on its marginals and a two-by-two kernel.
``names.py`` lists them, ``registry.py`` finds them by name; ``two_by_two.py`` has the formulas of planar targets, and
``output_covariances.py`` what is known of a part of the state. The searches in C have the criteria in
``native/src/team.c``.
"""
