"""Upper bounds on every plan, and guarantees for RATT's plan, known before or without a search.

Open ``guarantees.py`` first: one function per theorem, with its proof. ``group_size.py`` has one from how few robots an
attack leaves together, ``survivors.py`` one from how many, ``instance.py`` one for a single plan, and ``applicable.py``
says which apply. Apart from these, ``cuts.py`` bounds a group's value for all plans and says what a relaxed plan sees,
and ``relaxation.py`` bounds the optimum against given attacks, or all of them.
"""
