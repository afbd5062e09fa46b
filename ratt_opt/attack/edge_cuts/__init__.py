"""Edge cuts: the least weight of links for groups of a size, and the smallest size that a number of links leaves.

Open ``fewest.py`` first, then ``cut_search.py``: it generates columns, groups that keep much (``program.py``), and
proves their prices (``kept_links.py``). Partitions into listed groups decide what prices leave open (``listed.py``).
``elimination.py`` decides sparse networks and few cuts by dynamic programming, whatever their number of robots.
``smallest.py`` runs the same search for one size after the other; ``network.py`` is the input of all.
"""
