"""Thresholds on any network, by dual prices of robots and of blinded robots that no column below the threshold pays.

Open ``decision.py`` first. ``program.py`` finds the prices from the columns it knows; ``column_search.py`` asks
``attack/pricing.py`` whether others have a negative reduced cost, and lowers the prices for those that do.
"""
