"""Lower bounds on families of groups by prices of robots and links, for all vectors of sizes at once, without lists.

Open ``threshold_bound.py`` first: it refutes thresholds; ``family_search.py`` says when. ``family_program.py`` finds
the prices from the sets it knows and says what they prove, by the vectors of sizes that there are
(``size_vectors.py``); ``paying_sets.py`` proves that no other weak set pays them, or finds some: along axes
(``paying_axes.py``), or in a tree (``paying_tree.py``) by pairs of robots (``paying_pairs.py``, and ``pair_bound.py``
of the weakest sets) and by minorants; ``annealed_sets.py`` finds most of them sooner. ``family_dive.py`` makes attacks
of such prices.
"""
