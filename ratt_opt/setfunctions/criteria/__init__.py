"""What is lost when targets are known only so well: one file per criterion, and one registry.

Open ``trace.py`` first: a criterion is a subclass of ``InformationObjective`` (``../information.py``) that owns its
name, unit, value, supergradient and, optionally, a Fenchel cut, bounds on its marginals and a two-by-two kernel.
``names.py`` lists them, ``registry.py`` finds them by name; ``two_by_two.py`` has the formulas of planar targets,
``compiled.py`` the same ones compiled, ``compiled_outputs.py`` those of a part of the state.
"""
