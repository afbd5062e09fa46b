"""Curvatures and ratios: bounds on how far marginals of a set function fall, exact or as brackets.

Open ``curvature.py`` first (``ratios.py`` is its sibling). Over which sets marginals range: ``domains.py``. What is
known of them: ``marginals.py``, by enumeration, or the least certain first by the searches of ``separable/`` (any
information criterion) or ``planar/`` (max-eigenvalue, targets with at most two coordinates).
"""
