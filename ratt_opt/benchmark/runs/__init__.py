"""Runs of solvers: a foreign command under limits, what it is worth, and the page of all.

Open ``runner.py`` first. ``process.py`` lets a command run, ``output.py`` reads it, ``trial.py`` values and measures,
``measures.py`` compares, ``page.py`` and ``figures.py`` show; ``solvers.py`` makes commands of Python functions.
"""
