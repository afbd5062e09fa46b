"""Set functions: values, and properties with a witness for each violation.

Open ``base.py`` first (the interface of every set function), then ``information.py`` and ``criteria/`` (the criteria
of posterior information; ``criterion_parts.py`` is what one may state of itself). ``reference.py`` has textbook
functions, ``zoo.py`` draws those with known answers. ``properties.py`` finds violations, by whole tables
(``lattice.py``) or by ``sampling.py``.
"""
