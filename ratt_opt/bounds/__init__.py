"""What no plan can exceed, and what RATT's plan keeps at least, known before or without a search.

Open ``guarantees.py`` first: one function per theorem, with its proof; ``instance.py`` has one for a single plan.
Apart from these, ``cuts.py`` bounds a group's value for all plans, and ``relaxation.py`` the optimum against given
attacks, against all of them in ``lazy_relaxation.py``; ``relaxed_plans.py`` says what a relaxed plan sees.
"""
