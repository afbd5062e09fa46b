"""The exact max-min search: the plan of largest worst-case value, and a proof that none is better.

Open ``solve.py`` first. ``upper_ends.py`` lets the searches for the upper end take turns (``turns.py``).

- Concave relaxations, tree after tree: ``search.py`` is the loop over the nodes of one. ``frontier.py`` holds the nodes
  and the closing rule, ``relaxation.py`` the linear program, ``cut_store.py`` its cuts, ``winners.py`` which group of
  an outcome counts, ``small_groups.py`` what small ones can reach, ``division.py`` what a node is divided by, by
  ``mixtures.py``. ``known.py`` is what all trees share.
- Searches in depth, if robots see few targets: ``levels.py``, by ``covers/`` or by marginal gains
  (``marginal_search.py``, ``marginal_tables.py``).

The lower end: ``outcome_pool.py`` keeps what attacks leave, ``candidates.py`` ranks and improves plans by that,
``walk.py`` goes on from them, ``adversary.py`` attacks them, ``incumbent.py`` has the best one proved. ``elements.py``
is what plans choose from; the tree of ``proof.py`` grows and becomes a proof.
"""
