"""The exact max-min search: the plan of largest worst-case value, and a proof that none is better.

Open ``solve.py`` first. ``upper_bound_portfolio.py`` runs the stages of ``stages/schedule.py`` in turns, which lower
the upper end, by time slices (``time_slices.py``). Every number is a field of ``params``.

- Concave relaxations, tree after tree (``restarts.py``): ``concave_tree.py`` bounds and divides the nodes of one
  tree. ``frontier.py`` holds the nodes and the closing rule, ``relaxation.py`` the linear program, ``cut_store.py`` its
  cuts. ``winners.py`` decides which group of an outcome counts, ``small_groups.py`` tabulates small groups.
  ``division.py`` divides a node, by ``mixtures.py``. ``known.py`` is the state that all trees share.
- Searches in depth, if robots see few targets: ``levels.py``, by ``covers/`` or by marginal gains
  (``marginal_search.py``, ``marginal_tables.py``).

The lower bound: ``outcome_pool.py`` keeps the outcomes of attacks, ``candidates.py`` ranks and improves plans by them,
``walk.py`` continues from there, ``adversary.py`` attacks plans, ``incumbent.py`` has the best proved one; its stages
are in the same schedule.
``elements.py`` holds the elements that plans choose from; the tree of ``proof.py`` grows and becomes a proof.
"""
