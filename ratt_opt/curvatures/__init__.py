"""How far a set function's marginals can fall, over every domain: curvatures and ratios, exact or as brackets.

Open ``curvature.py`` first (``ratios.py`` is its sibling). Over which sets marginals range: ``domains.py``. Where these
can be enumerated ``marginals.py`` does so; elsewhere ``brackets.py`` chooses between ``separable/`` (any information
criterion) and ``planar/`` (max-eigenvalue, targets with at most two coordinates), which both refine the least certain
element first: ``least_certain.py``.
"""
