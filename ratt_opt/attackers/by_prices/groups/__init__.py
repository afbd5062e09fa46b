"""Groups that an attack at given prices may leave: found, bounded, listed and put together, mostly in compiled code.

``cheap_groups.py`` finds groups by annealing; ``seeing_sets.py`` and ``member_sets.py``, which ask first who sees and
who is inside, prove that no others pay, by ``flow.py``, ``room.py``, ``size_forms.py``, ``member_bounds.py`` and
``weak_sizes.py``; ``columns.py`` lists all that nearly do (``needs.py`` says what a group needs blinded), and
``cover.py`` puts listed groups together. ``compiled.py`` has the values of groups, ``blinding.py`` who to blind in one.
"""
