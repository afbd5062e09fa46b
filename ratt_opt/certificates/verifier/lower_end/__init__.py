"""What the verifier asks of the lower end's proofs, one kind a file; ``../lower.py`` says which is meant.

Trees over sizes or attacks (``size_tree.py``, ``forced_size.py``); prices that no weak group pays
(``group_prices.py``); prices with slack, and no partition into the groups that nearly pay (``all_groups.py``, and
``group_covers.py`` where a tree leaves most groups out, with ``group_costs.py`` and ``partitions.py``); sizes of the
groups that an attack can leave (``group_sizes.py`` with ``largest_groups.py`` and ``link_scores.py``). ``worth.py``
values sets of robots for all of them.
"""
