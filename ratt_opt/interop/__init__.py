"""Adapters to other frameworks, each an extra of its own; nothing in ``ratt_opt`` imports them.

``stonesoup`` : the tracking framework Stone Soup (``pip install ratt-opt[stonesoup]``); read ``manager.py`` first.
``pettingzoo_env`` : a mission as a game of many agents against the exact attack (``pip install ratt-opt[pettingzoo]``).
"""
