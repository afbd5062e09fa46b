"""The k robots of a plan that are worth least together: found, bounded, listed.

Open ``least_set_search.py`` first. ``sets_of_size.py`` searches in depth (in C). If that takes long, bounds of
``underestimator.py`` over the polytopes of ``outer_polytopes.py`` divide the question, or of ``weakest_axis.py`` if one
axis decides; both are for targets in the plane. ``exchanges.py`` finds sets without a claim, in large teams from where
linear descent in ``exchanges.py`` ends.
"""
