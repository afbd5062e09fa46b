"""The engine of all studies: a study is data, run by one engine, stored as one row per trial.

Open ``study.py`` first: the cases a study compares and what it measures. ``engine.py`` runs the trials where
``executors.py`` says, ``store.py`` keeps the rows; ``instance.py``, ``comparison.py`` and ``quantities.py`` are what a
trial measures; ``statistics.py``, ``claims.py``, ``plots.py`` what is made of all; ``command.py`` the command line.
"""
