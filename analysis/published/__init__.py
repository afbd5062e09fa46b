"""The tables that others published, beside ours: ``python -m analysis.published --data FOLDER --rows DIR --page FILE``.

Open ``tables.py`` first: one function a table. ``designs.py`` chooses s of n rows for a log-determinant, with a bound.
"""
