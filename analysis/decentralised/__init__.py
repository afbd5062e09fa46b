"""Worth of messages: plans by neighbours against the certified optimum; open ``worth.py`` first.

``radio.py`` times the baselines' messages; ``neighbour_greedy.py`` and ``clique_selection.py`` are baselines.
"""
