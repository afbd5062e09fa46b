"""Problems in other coordinates of their targets: equal plans, attacks and values.

``preparation.py`` is the one door that public searches use. ``changed.py`` says what a change of coordinates is and
what it rounds off. ``measured.py`` leaves out coordinates that no sensor tells about; ``unit_prior.py`` takes those in
which the prior is the identity, if digits would be lost.
"""
