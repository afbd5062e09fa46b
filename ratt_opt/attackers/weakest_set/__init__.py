"""The k robots of a plan that are worth least together: found, bounded, enumerated.

Open ``branch_and_bound.py`` first: it bounds nodes that fix some robots, and lets ``enumeration.py`` finish
small families. The bounds are ``weakest_axis.py`` where one axis decides, and else ``minorant.py`` over the polytopes
of ``outer_polytopes.py``, for targets in the plane; for others ``pair_bound.py``. Sharper ones, which take a tenth of
a second each, are in ``by_targets/``, for sets that must pay prices. ``selection.py`` is for all compiled loops.
``exchanges.py`` finds weak sets without a claim, in large teams from where ``linear_descent.py`` ends;
``packed_team.py`` has the arrays all of them share.
"""
