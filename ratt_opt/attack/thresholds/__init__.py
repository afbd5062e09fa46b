"""Thresholds: which values an attack can push a team down to, decided one by one.

Open ``threshold_search.py`` first: it asks thresholds of a decision, ``dual_prices.py`` (any network) or
``size_vectors`` (complete graphs, and bounds on others). ``stages/all_sets.py`` decides small teams by tables,
``listed_columns.py`` networks whose groups can be listed. ``columns.py`` has the linear program,
``pricing.py`` finds columns of negative reduced cost, ``exact_cover.py`` chooses columns.
"""
