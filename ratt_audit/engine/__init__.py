"""Decide a linear claim about all set functions of a class, exactly; open ``claim.py`` first, then ``decide.py``.

``claim.py`` also lists the inequalities that span a class; ``prover.py`` looks for a sum of them that is the claim and
``refuter.py`` for a function that breaks it. Both ask a floating-point solver and believe nothing of it:
``evidence.py`` checks what was found, in the arithmetic of ``rationals.py``.
"""
